//! Ball: volume `4/3 pi R^3`, moments `2/5 V R^2`.

use std::f64::consts::PI;

use glam::DVec3;

use super::{SolidOfRevolution, cylindrical};
use crate::error::{ShapeError, not_negative, positive};

/// Dimensions of a ball.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct BallSpec {
    /// Radius, m.
    pub radius: f64,
}

/// A ball about the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "BallSpec", into = "BallSpec"))]
pub struct Ball {
    radius: f64,
}

impl Ball {
    /// A ball of `radius`, m.
    ///
    /// # Errors
    /// A radius that is not above zero.
    ///
    /// # Example
    /// ```
    /// use dem_shapes::{solids::SolidOfRevolution, Ball};
    ///
    /// // A glass bead of 6 mm diameter.
    /// let bead = Ball::new(3e-3)?;
    /// assert!((bead.volume() * 1e9 - 113.097).abs() < 1e-3); // mm3
    /// assert!((bead.volume() * 2500.0 * 1e3 - 0.2827).abs() < 1e-4); // g
    /// # Ok::<(), dem_shapes::ShapeError>(())
    /// ```
    pub fn new(radius: f64) -> Result<Self, ShapeError> {
        Ok(Self { radius: positive("radius (m)", radius)? })
    }

    /// Radius, m.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Standard deviation of the volume, m3, from that of the radius, m (Gaussian propagation).
    ///
    /// # Errors
    /// A deviation below zero.
    pub fn volume_sd(&self, radius_sd: f64) -> Result<f64, ShapeError> {
        Ok(self.surface_area() * not_negative("standard deviation of the radius (m)", radius_sd)?)
    }
}

impl TryFrom<BallSpec> for Ball {
    type Error = ShapeError;

    fn try_from(spec: BallSpec) -> Result<Self, ShapeError> {
        Self::new(spec.radius)
    }
}

impl From<Ball> for BallSpec {
    fn from(ball: Ball) -> Self {
        Self { radius: ball.radius }
    }
}

impl SolidOfRevolution for Ball {
    fn volume(&self) -> f64 {
        4.0 / 3.0 * PI * self.radius.powi(3)
    }

    fn surface_area(&self) -> f64 {
        4.0 * PI * self.radius.powi(2)
    }

    fn inertia(&self) -> DVec3 {
        DVec3::splat(0.4 * self.volume() * self.radius.powi(2))
    }

    fn half_height(&self) -> f64 {
        self.radius
    }

    fn radius_at(&self, z: f64) -> f64 {
        ((self.radius - z) * (self.radius + z)).max(0.0).sqrt()
    }

    fn edges(&self) -> Vec<f64> {
        Vec::new()
    }

    fn signed_distance(&self, point: DVec3) -> f64 {
        point.length() - self.radius
    }

    fn surface_point(&self, area_fraction: f64, azimuth: f64) -> (DVec3, DVec3) {
        // Archimedes: equal heights carry equal areas.
        let z = (2.0 * area_fraction - 1.0).clamp(-1.0, 1.0);
        let normal = cylindrical(((1.0 - z) * (1.0 + z)).sqrt(), azimuth, z);
        (self.radius * normal, normal)
    }
}
