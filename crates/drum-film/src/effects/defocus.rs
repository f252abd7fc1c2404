//! Defocus: every point of the scene becomes a round Gaussian spot.

use rayon::prelude::*;

use crate::canvas::{Canvas, Color};
use crate::error::{Error, check};

/// Blur of the lens.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Defocus {
    /// Standard deviation of the spot, pixels; 0 is sharp.
    pub sigma_px: f64,
}

impl Defocus {
    pub(crate) fn check(&self) -> Result<(), Error> {
        check("defocus.sigma_px", self.sigma_px, "px", (0.0, 200.0), "0 to 200 pixels")
    }

    /// Blurs the picture; beyond its border the nearest pixel goes on.
    pub(crate) fn apply(&self, canvas: &mut Canvas) {
        if self.sigma_px < 1e-3 {
            return;
        }
        // Cut at 4 sigma, where 6e-5 of the light is lost and made up by the normalisation.
        let reach = (4.0 * self.sigma_px).ceil() as i64;
        let mut kernel: Vec<f32> = (-reach..=reach)
            .map(|k| (-0.5 * (k as f64 / self.sigma_px).powi(2)).exp() as f32)
            .collect();
        let sum: f32 = kernel.iter().sum();
        kernel.iter_mut().for_each(|k| *k /= sum);

        let (width, height) = (i64::from(canvas.width()), i64::from(canvas.height()));
        canvas.for_rows(|_, row| {
            let copy = row.to_vec();
            for (u, pixel) in row.iter_mut().enumerate() {
                *pixel = weighted(&kernel, |k| {
                    copy[(u as i64 + k as i64 - reach).clamp(0, width - 1) as usize]
                });
            }
        });
        let across = canvas.clone();
        let source = across.pixels();
        canvas.pixels_mut().par_chunks_mut(width as usize).enumerate().for_each(|(v, row)| {
            for (u, pixel) in row.iter_mut().enumerate() {
                *pixel = weighted(&kernel, |k| {
                    let line = (v as i64 + k as i64 - reach).clamp(0, height - 1);
                    source[(line * width) as usize + u]
                });
            }
        });
    }
}

fn weighted(kernel: &[f32], pixel: impl Fn(usize) -> Color) -> Color {
    let mut sum = [0.0_f32; 3];
    for (k, weight) in kernel.iter().enumerate() {
        let p = pixel(k);
        for q in 0..3 {
            sum[q] += weight * p[q];
        }
    }
    sum
}
