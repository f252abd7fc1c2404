//! The flat disc or ring: an end plate of finite extent.

use glam::DVec3;

use super::{Nearest, motion::Pose};

/// A flat disc, with a hole if `hole_radius` is above zero.
///
/// It has no thickness and acts from both sides; its rim and the edge of its hole are sharp.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Disc {
    /// Centre, m.
    pub centre: DVec3,
    /// Normal (any length, either sense).
    pub normal: DVec3,
    /// Outer radius, m.
    pub radius: f64,
    /// Radius of the hole, m; 0 for a full disc.
    pub hole_radius: f64,
}

impl Disc {
    /// Nearest point of the disc to a centre at `x`.
    #[inline]
    pub fn nearest(&self, x: DVec3) -> Nearest {
        let d = x - self.centre;
        let height = d.dot(self.normal);
        let radial = d - self.normal * height;
        let rho_squared = radial.length_squared();
        if rho_squared <= self.radius * self.radius
            && rho_squared >= self.hole_radius * self.hole_radius
        {
            return Nearest {
                normal_to_wall: if height < 0.0 { self.normal } else { -self.normal },
                distance: height.abs(),
                wall_radius: f64::INFINITY,
            };
        }
        let rho = rho_squared.sqrt();
        let edge = if rho > self.radius { self.radius } else { self.hole_radius };
        let outward = if rho > 0.0 { radial / rho } else { self.normal.any_orthonormal_vector() };
        let to_wall = outward * (edge - rho) - self.normal * height;
        let distance = to_wall.length();
        Nearest { normal_to_wall: to_wall / distance, distance, wall_radius: f64::INFINITY }
    }

    pub(crate) fn placed(&self, pose: &Pose) -> Self {
        Self {
            centre: pose.point(self.centre),
            normal: (pose.rotation * self.normal).normalize(),
            ..*self
        }
    }
}
