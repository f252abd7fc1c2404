//! Biconvex tablet: a band (cylinder of radius `R`, height `h`) between two spherical caps that
//! are cut from a sphere of crown radius `r >= R`.
//!
//! Height of a cap `c = r - sqrt(r^2 - R^2)`, volume `V = pi R^2 h + 2/3 pi c^2 (3 r - c)`, surface
//! `S = 2 pi R h + 4 pi r c`. With `t` the depth below an apex, the section's radius squared is
//! `2 r t - t^2`, and the moments of inertia are integrals of polynomials in `t`:
//!
//! ```text
//! I_z = pi/2 * integral of rho^4 dz,   I_x = I_z/2 + pi * integral of rho^2 z^2 dz
//! ```
//!
//! Limits: `r -> infinity` is the flat tablet, `r = R` a capsule, `r = R` and `h = 0` a ball.

use std::f64::consts::PI;

use glam::DVec3;

use super::{SolidOfRevolution, cylindrical};
use crate::error::{ShapeError, not_negative, positive};

/// Dimensions of a biconvex tablet.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct BiconvexTabletSpec {
    /// Radius of the band, m.
    pub radius: f64,
    /// Height of the band, m; zero for a lens.
    pub band_height: f64,
    /// Radius of the sphere that the caps are cut from, m.
    pub crown_radius: f64,
}

/// A biconvex tablet about the origin, its axis along z.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "BiconvexTabletSpec", into = "BiconvexTabletSpec"))]
pub struct BiconvexTablet {
    spec: BiconvexTabletSpec,
}

impl BiconvexTablet {
    /// A biconvex tablet of `radius`, `band_height` and `crown_radius`, m.
    ///
    /// # Errors
    /// A radius that is not above zero, a band height below zero, a crown radius below the radius.
    pub fn new(radius: f64, band_height: f64, crown_radius: f64) -> Result<Self, ShapeError> {
        positive("radius (m)", radius)?;
        not_negative("band height (m)", band_height)?;
        positive("crown radius (m)", crown_radius)?;
        if crown_radius < radius {
            return Err(ShapeError::CrownTooSmall { crown_radius, radius });
        }
        Ok(Self { spec: BiconvexTabletSpec { radius, band_height, crown_radius } })
    }

    /// Dimensions.
    #[must_use]
    pub fn spec(&self) -> BiconvexTabletSpec {
        self.spec
    }

    /// Distance of the plane of the band's rim from the centre of the cap's sphere, m.
    fn rim_depth(&self) -> f64 {
        let BiconvexTabletSpec { radius, crown_radius, .. } = self.spec;
        ((crown_radius - radius) * (crown_radius + radius)).sqrt()
    }

    /// Height of one cap above the band, m.
    #[must_use]
    pub fn cap_height(&self) -> f64 {
        // `r - sqrt(r^2 - R^2)` without its cancellation for flat caps.
        self.spec.radius.powi(2) / (self.spec.crown_radius + self.rim_depth())
    }

    /// Standard deviation of the volume, m3, from those of radius, band height and crown radius, m
    /// (Gaussian propagation for independent dimensions).
    ///
    /// The derivatives are `2 pi R h + 2 pi R^3/(r - c)`, `pi R^2` and
    /// `2 pi c (c - R^2/(r - c))`. A capsule (`r = R`) has none: there the result is infinite.
    ///
    /// # Errors
    /// A deviation below zero.
    ///
    /// # Example
    /// ```
    /// use dem_shapes::{solids::SolidOfRevolution, BiconvexTablet};
    ///
    /// let tablet = BiconvexTablet::new(4.00e-3, 2.25e-3, 9.64e-3)?;
    /// assert!((tablet.volume() * 1e9 - 157.47).abs() < 0.005); // mm3
    /// let sd = tablet.volume_sd(0.03e-3, 0.05e-3, 0.47e-3)?;
    /// assert!((sd * 1e9 - 4.66).abs() < 0.005);
    /// # Ok::<(), dem_shapes::ShapeError>(())
    /// ```
    pub fn volume_sd(
        &self,
        radius_sd: f64,
        band_height_sd: f64,
        crown_radius_sd: f64,
    ) -> Result<f64, ShapeError> {
        let BiconvexTabletSpec { radius, band_height, .. } = self.spec;
        let (c, depth) = (self.cap_height(), self.rim_depth());
        let parts = [
            (
                2.0 * PI * radius * band_height + 2.0 * PI * radius.powi(3) / depth,
                not_negative("standard deviation of the radius (m)", radius_sd)?,
            ),
            (
                PI * radius * radius,
                not_negative("standard deviation of the band height (m)", band_height_sd)?,
            ),
            (
                2.0 * PI * c * (c - radius * radius / depth),
                not_negative("standard deviation of the crown radius (m)", crown_radius_sd)?,
            ),
        ];
        // A dimension known exactly adds nothing, even where its derivative is infinite.
        let known = parts.iter().filter(|(_, sd)| *sd > 0.0);
        Ok(known.map(|(slope, sd)| (slope * sd).powi(2)).sum::<f64>().sqrt())
    }
}

impl TryFrom<BiconvexTabletSpec> for BiconvexTablet {
    type Error = ShapeError;

    fn try_from(spec: BiconvexTabletSpec) -> Result<Self, ShapeError> {
        Self::new(spec.radius, spec.band_height, spec.crown_radius)
    }
}

impl From<BiconvexTablet> for BiconvexTabletSpec {
    fn from(tablet: BiconvexTablet) -> Self {
        tablet.spec
    }
}

impl SolidOfRevolution for BiconvexTablet {
    fn volume(&self) -> f64 {
        let BiconvexTabletSpec { radius, band_height, crown_radius } = self.spec;
        let c = self.cap_height();
        PI * radius.powi(2) * band_height + 2.0 / 3.0 * PI * c * c * (3.0 * crown_radius - c)
    }

    fn surface_area(&self) -> f64 {
        let BiconvexTabletSpec { radius, band_height, crown_radius } = self.spec;
        2.0 * PI * radius * band_height + 4.0 * PI * crown_radius * self.cap_height()
    }

    fn inertia(&self) -> DVec3 {
        let BiconvexTabletSpec { radius, band_height, crown_radius: r } = self.spec;
        let (c, top) = (self.cap_height(), self.half_height());
        let band = PI * radius.powi(2) * band_height;
        // Integrals over one cap of (2 r t - t^2)^2 and of (2 r t - t^2) (top - t)^2.
        let fourth = c.powi(3) * (4.0 / 3.0 * r * r - r * c + 0.2 * c * c);
        let lever = top * top * c * c * (r - c / 3.0)
            - 2.0 * top * c.powi(3) * (2.0 / 3.0 * r - 0.25 * c)
            + c.powi(4) * (0.5 * r - 0.2 * c);
        let axial = 0.5 * band * radius.powi(2) + PI * fourth;
        let across = 0.5 * axial + band * band_height.powi(2) / 12.0 + 2.0 * PI * lever;
        DVec3::new(across, across, axial)
    }

    fn half_height(&self) -> f64 {
        0.5 * self.spec.band_height + self.cap_height()
    }

    fn radius_at(&self, z: f64) -> f64 {
        let depth = self.half_height() - z.abs();
        if depth < 0.0 {
            0.0
        } else if depth > self.cap_height() {
            self.spec.radius
        } else {
            (depth * (2.0 * self.spec.crown_radius - depth)).sqrt()
        }
    }

    fn edges(&self) -> Vec<f64> {
        let rim = 0.5 * self.spec.band_height;
        if rim > 0.0 { vec![rim] } else { Vec::new() }
    }

    fn signed_distance(&self, point: DVec3) -> f64 {
        let BiconvexTabletSpec { radius, band_height, crown_radius } = self.spec;
        let (rho, z) = (f64::hypot(point.x, point.y), point.z.abs());
        let rim = 0.5 * band_height;
        // By symmetry the upper half is enough: band, rim and upper cap.
        let to_band = if z <= rim { (rho - radius).abs() } else { f64::INFINITY };
        let to_rim = f64::hypot(rho - radius, z - rim);
        let up = z - (rim - self.rim_depth());
        let from_center = f64::hypot(rho, up);
        // The cap is seen from its sphere's centre under directions steeper than the rim's.
        let above_cap = up * radius >= rho * self.rim_depth() && up >= 0.0;
        let to_cap = if above_cap { (from_center - crown_radius).abs() } else { f64::INFINITY };
        let distance = to_band.min(to_rim).min(to_cap);
        let inside = rho <= radius && (z <= rim || from_center <= crown_radius);
        if inside { -distance } else { distance }
    }

    fn surface_point(&self, area_fraction: f64, azimuth: f64) -> (DVec3, DVec3) {
        let BiconvexTabletSpec { radius, band_height, crown_radius } = self.spec;
        let (c, top) = (self.cap_height(), self.half_height());
        // Cap, band, cap: surface over 2 pi is r c, R h, r c; on a cap it grows with the depth.
        let (cap, band) = (crown_radius * c, radius * band_height);
        let along = area_fraction.clamp(0.0, 1.0) * (2.0 * cap + band);
        let on_cap = |share: f64, sign: f64| {
            let depth = c * share.clamp(0.0, 1.0);
            let rho = (depth * (2.0 * crown_radius - depth)).sqrt();
            let normal = cylindrical(rho, azimuth, sign * (crown_radius - depth)) / crown_radius;
            (cylindrical(rho, azimuth, sign * (top - depth)), normal)
        };
        if along < cap {
            on_cap(along / cap, -1.0)
        } else if along <= cap + band && band > 0.0 {
            let z = (along - cap) / radius - 0.5 * band_height;
            (cylindrical(radius, azimuth, z), cylindrical(1.0, azimuth, 0.0))
        } else {
            on_cap((2.0 * cap + band - along) / cap, 1.0)
        }
    }
}
