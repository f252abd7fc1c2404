//! Vignetting: the lens passes less light towards the corners, here with the square of the distance from the middle.

use crate::canvas::Canvas;
use crate::error::{Error, check};

/// Loss of light towards the corners.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Vignetting {
    /// Share of the light lost in the corner pixels.
    pub corner_loss: f64,
}

impl Vignetting {
    pub(crate) fn check(&self) -> Result<(), Error> {
        check("vignetting.corner_loss", self.corner_loss, "", (0.0, 1.0), "a share from 0 to 1")
    }

    /// Darkens the picture.
    pub(crate) fn apply(&self, canvas: &mut Canvas) {
        if self.corner_loss == 0.0 {
            return;
        }
        let (cx, cy) =
            ((f64::from(canvas.width()) - 1.0) / 2.0, (f64::from(canvas.height()) - 1.0) / 2.0);
        let k = self.corner_loss / (cx * cx + cy * cy);
        canvas.for_rows(|v, row| {
            let dy2 = (f64::from(v) - cy).powi(2);
            for (u, pixel) in row.iter_mut().enumerate() {
                let factor = (1.0 - k * (dy2 + (u as f64 - cx).powi(2))) as f32;
                *pixel = pixel.map(|p| p * factor);
            }
        });
    }
}
