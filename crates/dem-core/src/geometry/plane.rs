//! The unbounded plane.

use glam::DVec3;

use super::{Nearest, motion::Pose};

/// A plane that keeps particles on the side to which its normal points.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Plane {
    /// Any point of the plane, m.
    pub point: DVec3,
    /// Normal towards the particles (any length).
    pub normal: DVec3,
}

impl Plane {
    /// Nearest point of the plane to a centre at `x`.
    #[inline]
    pub fn nearest(&self, x: DVec3) -> Nearest {
        Nearest {
            normal_to_wall: -self.normal,
            distance: (x - self.point).dot(self.normal),
            wall_radius: f64::INFINITY,
        }
    }

    pub(crate) fn placed(&self, pose: &Pose) -> Self {
        Self { point: pose.point(self.point), normal: (pose.rotation * self.normal).normalize() }
    }
}
