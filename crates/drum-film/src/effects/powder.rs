//! Powder: abrasion that clings to the inside of the front plate and veils what lies behind, unevenly.
//!
//! The local opacity is the mean opacity times `1 + variation n`, n being smooth noise of standard deviation near 1/2
//! (three octaves of cubic interpolation between random lattice values), cut to 0..1.

use glam::DVec2;

use crate::camera::View;
use crate::canvas::{Canvas, Color, mixed};
use crate::error::{Error, check};
use crate::scene::Scene;
use crate::texture::{hash, unit};

/// A film of powder on the front plate.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Powder {
    /// Mean opacity; 0 is a clean plate, 1 hides everything.
    pub opacity: f64,
    /// Unevenness: how much the opacity varies, as a multiple of its mean.
    pub variation: f64,
    /// Size of the patches, drum radii.
    pub patch: f64,
    /// Colour of the powder in the light.
    pub color: Color,
    /// Seed of the patches.
    pub seed: u64,
}

impl Default for Powder {
    fn default() -> Self {
        Self { opacity: 0.0, variation: 0.6, patch: 0.35, color: [0.70, 0.69, 0.66], seed: 7 }
    }
}

impl Powder {
    pub(crate) fn check(&self) -> Result<(), Error> {
        check("powder.opacity", self.opacity, "", (0.0, 1.0), "a share from 0 to 1")?;
        check("powder.variation", self.variation, "", (0.0, 10.0), "0 to 10")?;
        check("powder.patch", self.patch, "R", (1e-3, 100.0), "a length above 0")
    }

    /// Veils everything inside the drum's circle.
    pub(crate) fn apply(&self, canvas: &mut Canvas, scene: &Scene, view: &View) {
        if self.opacity == 0.0 {
            return;
        }
        let front = scene.drum.front_z();
        canvas.for_rows(|v, row| {
            for (u, pixel) in row.iter_mut().enumerate() {
                let p = view.on_plane(u as f64, f64::from(v), front) / scene.drum.radius_m;
                if p.length_squared() < 1.0 {
                    *pixel = mixed(*pixel, self.color, self.opacity_at(p) as f32);
                }
            }
        });
    }

    /// Opacity at a place of the plate, drum radii.
    #[must_use]
    pub fn opacity_at(&self, p: DVec2) -> f64 {
        let q = p / self.patch;
        let noise = smooth(self.seed, q)
            + 0.5 * smooth(self.seed ^ 0xA5A5, q * 2.0)
            + 0.25 * smooth(self.seed ^ 0x5A5A, q * 4.0);
        (self.opacity * (1.0 + self.variation * noise)).clamp(0.0, 1.0)
    }
}

/// Smooth noise from -1 to 1: lattice values joined by the cubic `3 f^2 - 2 f^3`.
fn smooth(seed: u64, p: DVec2) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let f = f * f * (3.0 - 2.0 * f);
    let at = |i: i64, j: i64| 2.0 * unit(hash(seed, cell.x as i64 + i, cell.y as i64 + j)) - 1.0;
    let low = at(0, 0) + f.x * (at(1, 0) - at(0, 0));
    let high = at(0, 1) + f.x * (at(1, 1) - at(0, 1));
    low + f.y * (high - low)
}
