//! Light on a bead: ambient, diffuse (Lambert) and specular share (Phong 1975, doi:10.1145/360825.360839), and a gradient over
//! the picture.

use glam::DVec3;

use crate::camera::View;
use crate::canvas::{Canvas, Color};
use crate::error::{Error, check};

/// One distant lamp and the light of the room.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Light {
    /// Direction towards the lamp in world axes (x right, y up, z to the camera); any length.
    pub direction: DVec3,
    /// Share of the colour that every point shows.
    pub ambient: f64,
    /// Share added in proportion to the cosine of the lamp's incidence.
    pub diffuse: f64,
    /// Brightness of the white reflex of the lamp on a bead.
    pub specular: f64,
    /// Exponent of the reflex: the larger, the smaller the spot.
    pub shininess: f64,
    /// Share of light lost from the front plate to the rear wall, for spheres.
    pub depth_loss: f64,
    /// Change of all light over one drum radius along [`Light::gradient_deg`], as a share.
    pub gradient: f64,
    /// Direction in which the picture grows brighter, degrees counter-clockwise from the right.
    pub gradient_deg: f64,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            direction: DVec3::new(-0.35, 0.6, 0.9),
            ambient: 0.55,
            diffuse: 0.5,
            specular: 0.12,
            shininess: 18.0,
            depth_loss: 0.3,
            gradient: 0.0,
            gradient_deg: 90.0,
        }
    }
}

/// A light made ready for many points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lamp {
    light: Light,
    direction: DVec3,
    /// The exponent where it is a whole number.
    whole: Option<i32>,
}

impl Light {
    /// Light that shows every point in its own colour.
    #[must_use]
    pub fn flat() -> Self {
        Self { ambient: 1.0, diffuse: 0.0, specular: 0.0, depth_loss: 0.0, ..Self::default() }
    }

    /// Whether every point shows its own colour, wherever it lies.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.ambient == 1.0 && self.diffuse == 0.0 && self.specular == 0.0 && self.depth_loss == 0.0
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        check("light.ambient", self.ambient, "", (0.0, 10.0), "0 to 10")?;
        check("light.diffuse", self.diffuse, "", (0.0, 10.0), "0 to 10")?;
        check("light.specular", self.specular, "", (0.0, 10.0), "0 to 10")?;
        check("light.shininess", self.shininess, "", (1e-3, 1e4), "an exponent above 0")?;
        check("light.depth_loss", self.depth_loss, "", (0.0, 1.0), "a share from 0 to 1")?;
        check("light.gradient", self.gradient, "1/R", (-1.0, 1.0), "-1 to 1")?;
        check("light.gradient_deg", self.gradient_deg, "deg", (-360.0, 360.0), "-360 to 360")?;
        let direction = self.direction.length();
        check("light.direction", direction, "", (1e-9, 1e9), "three finite numbers, not all 0")
    }

    pub(crate) fn lamp(&self) -> Lamp {
        let n = self.shininess;
        let whole = (n.fract() == 0.0 && n.abs() <= 1024.0).then_some(n as i32);
        Lamp { light: *self, direction: self.direction.normalize_or(DVec3::Z), whole }
    }

    /// Multiplies the picture by the gradient.
    pub(crate) fn apply_gradient(&self, canvas: &mut Canvas, view: &View, radius_px: f64) {
        if self.gradient == 0.0 {
            return;
        }
        let (sin, cos) = self.gradient_deg.to_radians().sin_cos();
        let (gx, gy) = (self.gradient * cos / radius_px, -self.gradient * sin / radius_px);
        let center = view.center_px;
        canvas.for_rows(|row, pixels| {
            let from_row = 1.0 + gy * (f64::from(row) - center.y);
            for (u, pixel) in pixels.iter_mut().enumerate() {
                let factor = (from_row + gx * (u as f64 - center.x)).max(0.0) as f32;
                *pixel = pixel.map(|v| v * factor);
            }
        });
    }
}

impl Lamp {
    /// Colour of a point with the unit normal `n`, seen from the unit direction `to_eye`.
    pub(crate) fn shade(&self, color: Color, n: DVec3, to_eye: DVec3) -> Color {
        let light = &self.light;
        let cos = n.dot(self.direction);
        let body = (light.ambient + light.diffuse * cos.max(0.0)) as f32;
        let mut reflex = 0.0;
        if light.specular > 0.0 && cos > 0.0 {
            let mirrored = 2.0 * cos * n - self.direction;
            let along = mirrored.dot(to_eye).max(0.0);
            let spot = match self.whole {
                Some(n) => along.powi(n),
                None => along.powf(light.shininess),
            };
            reflex = (light.specular * spot) as f32;
        }
        color.map(|v| v * body + reflex)
    }
}
