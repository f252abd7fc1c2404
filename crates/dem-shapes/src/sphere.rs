//! One sphere of a clump.

use glam::DVec3;

use crate::error::ShapeError;

/// A sphere: centre and radius, both in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Sphere {
    /// Position of the centre, m.
    pub center: DVec3,
    /// Radius, m.
    pub radius: f64,
}

impl Sphere {
    /// A sphere of `radius` about `center`, both in metres; functions that take spheres check them.
    #[must_use]
    pub const fn new(center: DVec3, radius: f64) -> Self {
        Self { center, radius }
    }

    /// Volume, m3.
    #[must_use]
    pub fn volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius.powi(3)
    }

    /// Distance of `point` from the surface, m: below zero inside.
    #[must_use]
    pub fn signed_distance(&self, point: DVec3) -> f64 {
        (point - self.center).length() - self.radius
    }
}

/// Refuses an empty list, and the first sphere that is no sphere.
pub(crate) fn check_spheres(spheres: &[Sphere]) -> Result<(), ShapeError> {
    if spheres.is_empty() {
        return Err(ShapeError::NoSpheres);
    }
    for (index, s) in spheres.iter().enumerate() {
        if !s.center.is_finite() {
            return Err(ShapeError::SphereCenter { index, center: s.center });
        }
        if !(s.radius.is_finite() && s.radius > 0.0) {
            return Err(ShapeError::SphereRadius { index, radius: s.radius });
        }
    }
    Ok(())
}
