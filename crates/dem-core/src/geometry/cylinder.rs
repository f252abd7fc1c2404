//! The circular cylinder, hollow or solid.

use glam::DVec3;

use super::{Nearest, motion::Pose};

/// On which side of a cylinder's mantle the particles are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Side {
    /// A drum: particles inside.
    Inside,
    /// A shaft: particles outside.
    Outside,
}

/// The mantle of a cylinder, without end faces.
///
/// In the Hertz sense the wall counts as a sphere of the same mean curvature: radius `-2 R` seen
/// from inside, `2 R` from outside (one principal curvature of a cylinder is zero).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cylinder {
    /// A point of the axis, m; the middle of the mantle when its length is finite.
    pub point: DVec3,
    /// Direction of the axis (any length).
    pub axis: DVec3,
    /// Radius, m.
    pub radius: f64,
    /// Side of the particles.
    pub side: Side,
    /// Length of the mantle, m; `None` for an unbounded one. A finite mantle has open ends with
    /// a sharp rim.
    pub length: Option<f64>,
}

impl Cylinder {
    /// Nearest point of the mantle to a centre at `x`; on the axis of a hollow cylinder, where
    /// every direction is the same, an arbitrary one.
    #[inline]
    pub fn nearest(&self, x: DVec3) -> Nearest {
        let d = x - self.point;
        let along = d.dot(self.axis);
        let radial = d - self.axis * along;
        let rho = radial.length();
        let outward =
            if rho > 0.0 { radial * (1.0 / rho) } else { self.axis.any_orthonormal_vector() };
        if let Some(length) = self.length {
            let beyond = along.abs() - 0.5 * length;
            if beyond > 0.0 {
                let rim = outward * (self.radius - rho) - self.axis * (beyond * along.signum());
                let distance = rim.length();
                return Nearest {
                    normal_to_wall: rim / distance,
                    distance,
                    wall_radius: f64::INFINITY,
                };
            }
        }
        match self.side {
            Side::Inside => Nearest {
                normal_to_wall: outward,
                distance: self.radius - rho,
                wall_radius: -2.0 * self.radius,
            },
            Side::Outside => Nearest {
                normal_to_wall: -outward,
                distance: rho - self.radius,
                wall_radius: 2.0 * self.radius,
            },
        }
    }

    pub(crate) fn placed(&self, pose: &Pose) -> Self {
        Self {
            point: pose.point(self.point),
            axis: (pose.rotation * self.axis).normalize(),
            ..*self
        }
    }
}
