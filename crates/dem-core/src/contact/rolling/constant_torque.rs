//! Constant rolling torque ("model A", directional constant torque).
//!
//! `M_i = -arm N w_r/|w_r|`, `M_j = -M_i`
//!
//! - `M` torque, N m; `N` load of the contact, N
//! - `arm` coefficient times effective radius, or the coefficient as a length, m
//! - `w_r` rolling part of the relative spin `w_i - w_j`, rad/s
//!
//! Validity: steady rolling. At rest the torque jumps between its signs: with a time step `dt`
//! a resting sphere chatters with an angular speed of up to `arm N dt/I`; use the spring-dashpot
//! law for beds at rest. At exactly zero spin the torque is zero.
//! References: thesis eq. 59 (with the sign of the spin that the text dropped); J. Ai, J.-F. Chen,
//! J. M. Rotter, J. Y. Ooi, *Powder Technology* 206 (2011) 269-282,
//! doi:10.1016/j.powtec.2010.09.030.

use super::coefficient::{RollingArm, RollingCoefficient};
use crate::contact::error::LawError;
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, RollingLaw, RollingResponse};

/// Parameters of [`ConstantTorque`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ConstantTorqueSpec {
    /// Coefficient of rolling resistance.
    pub coefficient: RollingCoefficient,
}

/// Constant torque against relative rolling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantTorque {
    /// Lever of the normal force.
    pub arm: RollingArm,
}

impl TryFrom<ConstantTorqueSpec> for ConstantTorque {
    type Error = LawError;
    fn try_from(spec: ConstantTorqueSpec) -> Result<Self, LawError> {
        Ok(Self { arm: spec.coefficient.try_into()? })
    }
}

impl RollingLaw for ConstantTorque {
    type Memory = ();

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        (): &mut (),
    ) -> RollingResponse {
        let spin = motion.rolling_spin();
        let speed = spin.length();
        let limit = self.arm.of(pair) * normal.friction_load;
        let torque = spin * (-limit / speed.max(f64::MIN_POSITIVE));
        RollingResponse {
            torque_on_i: torque,
            torque_on_j: -torque,
            elastic_energy: 0.0,
            dissipated_power: limit * speed,
        }
    }
}
