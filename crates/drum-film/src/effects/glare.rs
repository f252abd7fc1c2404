//! Glare: lamps and windows mirrored in the front plate as soft bright spots that stand still while the drum turns.

use glam::DVec2;

use crate::camera::View;
use crate::canvas::Canvas;
use crate::error::{Error, check};
use crate::scene::Scene;

/// One mirrored lamp on the front plate: a Gaussian spot, long in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Spot {
    /// Place to the right of the axis, drum radii.
    pub x: f64,
    /// Place above the axis, drum radii.
    pub y: f64,
    /// Standard deviation along its long side, drum radii.
    pub length: f64,
    /// Standard deviation across, drum radii.
    pub width: f64,
    /// Direction of the long side, degrees counter-clockwise from the right.
    pub angle_deg: f64,
    /// Brightness in its middle against the other spots.
    pub weight: f64,
}

/// Spots of glare on the front plate.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Glare {
    /// Brightness added in the middle of a spot of weight 1, as a share of full scale; 0 is no glare.
    pub strength: f64,
    /// The spots.
    pub spots: Vec<Spot>,
}

impl Default for Glare {
    fn default() -> Self {
        let spot = |x, y, length, width, angle_deg, weight| Spot {
            x,
            y,
            length,
            width,
            angle_deg,
            weight,
        };
        Self {
            strength: 0.0,
            spots: vec![
                spot(-0.52, 0.58, 0.16, 0.04, 28.0, 1.0),
                spot(0.30, 0.70, 0.05, 0.035, -20.0, 0.8),
                spot(-0.15, -0.45, 0.07, 0.03, 65.0, 0.6),
            ],
        }
    }
}

impl Glare {
    pub(crate) fn check(&self) -> Result<(), Error> {
        check("glare.strength", self.strength, "", (0.0, 10.0), "0 to 10")?;
        for s in &self.spots {
            check("glare.spots.length", s.length, "R", (1e-4, 100.0), "a length above 0")?;
            check("glare.spots.width", s.width, "R", (1e-4, 100.0), "a width above 0")?;
            check("glare.spots.weight", s.weight, "", (0.0, 10.0), "0 to 10")?;
            check("glare.spots.x", s.x, "R", (-100.0, 100.0), "a place near the plate")?;
            check("glare.spots.y", s.y, "R", (-100.0, 100.0), "a place near the plate")?;
            check("glare.spots.angle_deg", s.angle_deg, "deg", (-360.0, 360.0), "-360 to 360")?;
        }
        Ok(())
    }

    /// Adds the spots to what lies behind the plate.
    pub(crate) fn apply(&self, canvas: &mut Canvas, scene: &Scene, view: &View) {
        if self.strength == 0.0 || self.spots.is_empty() {
            return;
        }
        let front = scene.drum.front_z();
        let plate2 = (scene.plate_radius_m.max(scene.drum.radius_m) / scene.drum.radius_m).powi(2);
        canvas.for_rows(|v, row| {
            for (u, pixel) in row.iter_mut().enumerate() {
                let p = view.on_plane(u as f64, f64::from(v), front) / scene.drum.radius_m;
                if p.length_squared() > plate2 {
                    continue;
                }
                let light: f64 = self.spots.iter().map(|s| s.weight * s.at(p)).sum();
                if light > 1e-4 {
                    let added = (self.strength * light) as f32;
                    *pixel = pixel.map(|value| value + added);
                }
            }
        });
    }
}

impl Spot {
    fn at(&self, p: DVec2) -> f64 {
        let d =
            DVec2::from_angle(-self.angle_deg.to_radians()).rotate(p - DVec2::new(self.x, self.y));
        let q = (d.x / self.length).powi(2) + (d.y / self.width).powi(2);
        if q > 40.0 { 0.0 } else { (-0.5 * q).exp() }
    }
}
