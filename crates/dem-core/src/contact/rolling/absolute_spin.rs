//! EDEM's standard rolling torque, from each body's own spin. A **compatibility law**: it is not
//! frame-indifferent.
//!
//! `M_i = -(length + ratio l_i) N w_i/|w_i|`, `M_j` likewise with `l_j`, `w_j`
//!
//! - `M` torque, N m; `N` load, N; `l` lever from the centre to the contact point, m
//! - `w` spin of the body itself, rad/s, in the laboratory frame
//!
//! Two spheres that turn together as one solid feel torques, and the torques on a pair do not
//! cancel, so angular momentum is not conserved. Use [`super::ConstantTorque`] for physics; this
//! law is here so that runs of EDEM's "standard rolling friction" compare like with like.
//!
//! References: the form stated in EDEM's documentation; thesis eq. 59 for one sphere on a plane,
//! where both agree. Departure: none known.

use super::coefficient::RollingArm;
use super::constant_torque::ConstantTorqueSpec;
use crate::contact::error::LawError;
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, RollingLaw, RollingResponse};

/// Torque against each body's own spin; its parameters are those of the constant torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AbsoluteSpin {
    /// Coefficient; its `ratio` refers to the lever of each body.
    pub arm: RollingArm,
}

impl TryFrom<ConstantTorqueSpec> for AbsoluteSpin {
    type Error = LawError;
    fn try_from(spec: ConstantTorqueSpec) -> Result<Self, LawError> {
        Ok(Self { arm: spec.coefficient.try_into()? })
    }
}

impl RollingLaw for AbsoluteSpin {
    type Memory = ();

    #[inline]
    fn respond(
        &self,
        _: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        (): &mut (),
    ) -> RollingResponse {
        let load = normal.friction_load;
        let limit_i = (self.arm.length + self.arm.ratio * motion.lever_i) * load;
        let limit_j = (self.arm.length + self.arm.ratio * motion.lever_j) * load;
        let (speed_i, speed_j) = (motion.spin_i.length(), motion.spin_j.length());
        RollingResponse {
            torque_on_i: motion.spin_i * (-limit_i / speed_i.max(f64::MIN_POSITIVE)),
            torque_on_j: motion.spin_j * (-limit_j / speed_j.max(f64::MIN_POSITIVE)),
            elastic_energy: 0.0,
            dissipated_power: limit_i * speed_i + limit_j * speed_j,
        }
    }
}
