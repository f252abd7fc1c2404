//! Flat tablet: a cylinder of radius `R` and height `h`.
//!
//! `V = pi R^2 h`, `S = 2 pi R (R + h)`, `I_z = V R^2/2`, `I_x = V (3 R^2 + h^2)/12`.

use std::f64::consts::PI;

use glam::DVec3;

use super::{SolidOfRevolution, cylindrical};
use crate::error::{ShapeError, not_negative, positive};

/// Dimensions of a flat tablet.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct FlatTabletSpec {
    /// Radius, m.
    pub radius: f64,
    /// Height, m.
    pub height: f64,
}

/// A flat tablet about the origin, its axis along z.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "FlatTabletSpec", into = "FlatTabletSpec"))]
pub struct FlatTablet {
    spec: FlatTabletSpec,
}

impl FlatTablet {
    /// A flat tablet of `radius` and `height`, m.
    ///
    /// # Errors
    /// A dimension that is not above zero.
    pub fn new(radius: f64, height: f64) -> Result<Self, ShapeError> {
        positive("radius (m)", radius)?;
        positive("height (m)", height)?;
        Ok(Self { spec: FlatTabletSpec { radius, height } })
    }

    /// Dimensions.
    #[must_use]
    pub fn spec(&self) -> FlatTabletSpec {
        self.spec
    }

    /// Standard deviation of the volume, m3, from those of radius and height, m (Gaussian
    /// propagation for independent dimensions).
    ///
    /// # Errors
    /// A deviation below zero.
    ///
    /// # Example
    /// ```
    /// use dem_shapes::{solids::SolidOfRevolution, FlatTablet};
    ///
    /// let tablet = FlatTablet::new(4.00e-3, 2.90e-3)?;
    /// assert!((tablet.volume() * 1e9 - 145.77).abs() < 0.005); // mm3
    /// assert!((tablet.volume_sd(0.01e-3, 0.04e-3)? * 1e9 - 2.14).abs() < 0.005);
    /// # Ok::<(), dem_shapes::ShapeError>(())
    /// ```
    pub fn volume_sd(&self, radius_sd: f64, height_sd: f64) -> Result<f64, ShapeError> {
        let FlatTabletSpec { radius, height } = self.spec;
        let by_radius = 2.0 * PI * radius * height;
        let by_height = PI * radius * radius;
        let radius_sd = not_negative("standard deviation of the radius (m)", radius_sd)?;
        let height_sd = not_negative("standard deviation of the height (m)", height_sd)?;
        Ok((by_radius * radius_sd).hypot(by_height * height_sd))
    }
}

impl TryFrom<FlatTabletSpec> for FlatTablet {
    type Error = ShapeError;

    fn try_from(spec: FlatTabletSpec) -> Result<Self, ShapeError> {
        Self::new(spec.radius, spec.height)
    }
}

impl From<FlatTablet> for FlatTabletSpec {
    fn from(tablet: FlatTablet) -> Self {
        tablet.spec
    }
}

impl SolidOfRevolution for FlatTablet {
    fn volume(&self) -> f64 {
        PI * self.spec.radius.powi(2) * self.spec.height
    }

    fn surface_area(&self) -> f64 {
        2.0 * PI * self.spec.radius * (self.spec.radius + self.spec.height)
    }

    fn inertia(&self) -> DVec3 {
        let (r2, h2) = (self.spec.radius.powi(2), self.spec.height.powi(2));
        let across = (3.0 * r2 + h2) / 12.0;
        self.volume() * DVec3::new(across, across, 0.5 * r2)
    }

    fn half_height(&self) -> f64 {
        0.5 * self.spec.height
    }

    fn radius_at(&self, z: f64) -> f64 {
        if z.abs() <= self.half_height() { self.spec.radius } else { 0.0 }
    }

    fn edges(&self) -> Vec<f64> {
        Vec::new()
    }

    fn signed_distance(&self, point: DVec3) -> f64 {
        let beside = f64::hypot(point.x, point.y) - self.spec.radius;
        let above = point.z.abs() - self.half_height();
        if beside > 0.0 && above > 0.0 { beside.hypot(above) } else { beside.max(above) }
    }

    fn surface_point(&self, area_fraction: f64, azimuth: f64) -> (DVec3, DVec3) {
        let FlatTabletSpec { radius, height } = self.spec;
        // Face, band, face: shares R : 2 h : R of the surface.
        let along = area_fraction.clamp(0.0, 1.0) * 2.0 * (radius + height);
        let face = |share: f64| cylindrical(radius * share.clamp(0.0, 1.0).sqrt(), azimuth, 0.0);
        if along < radius {
            (face(along / radius) - DVec3::Z * 0.5 * height, -DVec3::Z)
        } else if along <= radius + 2.0 * height {
            let z = 0.5 * (along - radius) - 0.5 * height;
            (cylindrical(radius, azimuth, z), cylindrical(1.0, azimuth, 0.0))
        } else {
            let left = 2.0 * (radius + height) - along;
            (face(left / radius) + DVec3::Z * 0.5 * height, DVec3::Z)
        }
    }
}
