//! Exact solids that clumps stand for: ball, flat tablet, biconvex tablet.
//!
//! All are convex, have the z axis as axis of revolution and are symmetric about `z = 0`, so that
//! their centroid is the origin and their principal axes are the coordinate axes.

mod ball;
mod biconvex;
mod flat;

use glam::DVec3;

pub use ball::{Ball, BallSpec};
pub use biconvex::{BiconvexTablet, BiconvexTabletSpec};
pub use flat::{FlatTablet, FlatTabletSpec};

/// A convex solid of revolution about the z axis, symmetric about `z = 0`.
///
/// Implement it for a solid of your own to measure clumps against it.
pub trait SolidOfRevolution {
    /// Volume, m3.
    fn volume(&self) -> f64;

    /// Surface, m2.
    fn surface_area(&self) -> f64;

    /// Moments of inertia about x, y and z through the centroid for a density of one, m5.
    fn inertia(&self) -> DVec3;

    /// Half of the extent along the axis, m.
    fn half_height(&self) -> f64;

    /// Radius of the section at height `z`, m; zero beyond the ends.
    fn radius_at(&self, z: f64) -> f64;

    /// Heights above zero, below the half height, at which the profile is not smooth, m.
    fn edges(&self) -> Vec<f64>;

    /// Distance of `point` from the surface, m: below zero inside.
    fn signed_distance(&self, point: DVec3) -> f64;

    /// The surface point below which the share `area_fraction` of the surface lies, at `azimuth`
    /// (rad), and the outward normal there.
    fn surface_point(&self, area_fraction: f64, azimuth: f64) -> (DVec3, DVec3);
}

/// One of the solids of this crate.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Solid {
    /// A ball.
    Ball(Ball),
    /// A flat cylinder.
    FlatTablet(FlatTablet),
    /// A cylinder between two spherical caps.
    BiconvexTablet(BiconvexTablet),
}

impl Solid {
    fn inner(&self) -> &dyn SolidOfRevolution {
        match self {
            Self::Ball(s) => s,
            Self::FlatTablet(s) => s,
            Self::BiconvexTablet(s) => s,
        }
    }
}

impl SolidOfRevolution for Solid {
    fn volume(&self) -> f64 {
        self.inner().volume()
    }

    fn surface_area(&self) -> f64 {
        self.inner().surface_area()
    }

    fn inertia(&self) -> DVec3 {
        self.inner().inertia()
    }

    fn half_height(&self) -> f64 {
        self.inner().half_height()
    }

    fn radius_at(&self, z: f64) -> f64 {
        self.inner().radius_at(z)
    }

    fn edges(&self) -> Vec<f64> {
        self.inner().edges()
    }

    fn signed_distance(&self, point: DVec3) -> f64 {
        self.inner().signed_distance(point)
    }

    fn surface_point(&self, area_fraction: f64, azimuth: f64) -> (DVec3, DVec3) {
        self.inner().surface_point(area_fraction, azimuth)
    }
}

/// `(radius cos, radius sin, z)` of an azimuth in rad.
fn cylindrical(radius: f64, azimuth: f64, z: f64) -> DVec3 {
    let (sin, cos) = azimuth.sin_cos();
    DVec3::new(radius * cos, radius * sin, z)
}
