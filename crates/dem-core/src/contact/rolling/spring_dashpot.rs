//! Iwashita and Oda's rolling spring and dashpot, elastic up to a limit.
//!
//! `M = M0 min(1, k/k0) - k_r w_r dt`, then `|M| <= arm N`; below the limit also `-C_r w_r`
//!
//! `k_r = k_fixed + f S arm^2`, `C_r = 2 eta sqrt(I_r k_r)`, `I_r = 7/5 m* R*^2`
//!
//! - `M` torque on i, N m; `M0`, `k0` of the step before; `w_r` rolling part of the relative spin
//! - `k_r` rolling stiffness, N m/rad; `S` normal stiffness, N/m; `f` 2.25 in Ai et al.
//! - `arm` coefficient of rolling resistance times effective radius, or as a length, m; `N` load, N
//! - `eta` damping ratio; `I_r` inertia about the contact (exact for a sphere on a plane), kg m^2
//!
//! Validity: beds at rest and in quasi-static shear, where it holds torque without chatter.
//! References: K. Iwashita, M. Oda, *J. Eng. Mech.* 124 (1998) 285-292,
//! doi:10.1061/(ASCE)0733-9399(1998)124:3(285); J. Ai, J.-F. Chen, J. M. Rotter, J. Y. Ooi,
//! *Powder Technology* 206 (2011) 269-282, doi:10.1016/j.powtec.2010.09.030; thesis eq. 30 with the
//! relative rotation in both terms. Departure: a stiffness that falls with the load takes its share
//! of the torque along, so that the spring never creates energy (`contact::spring`).

use super::coefficient::{RollingArm, RollingCoefficient};
use crate::contact::error::{LawError, non_negative, positive};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, RollingLaw, RollingResponse};
use crate::contact::spring::SpringMemory;

/// Rolling stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum RollingStiffness {
    /// The same for every contact, N m/rad.
    Fixed(f64),
    /// `f` in `k_r = f S arm^2`; Ai et al. use 2.25.
    OfNormal(f64),
}

/// Parameters of [`RollingSpringDashpot`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct RollingSpringDashpotSpec {
    /// Coefficient of rolling resistance: the limit.
    pub coefficient: RollingCoefficient,
    /// Stiffness of the spring.
    pub stiffness: RollingStiffness,
    /// Damping ratio, 0 for none.
    pub damping_ratio: f64,
}

/// Rolling spring and dashpot of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollingSpringDashpot {
    /// Lever of the limit.
    pub arm: RollingArm,
    /// Stiffness that does not depend on the load, N m/rad.
    pub stiffness: f64,
    /// `f` in `f S arm^2`.
    pub stiffness_ratio: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
}

impl TryFrom<RollingSpringDashpotSpec> for RollingSpringDashpot {
    type Error = LawError;
    fn try_from(spec: RollingSpringDashpotSpec) -> Result<Self, LawError> {
        const LAW: &str = "RollingSpringDashpot";
        let (stiffness, stiffness_ratio) = match spec.stiffness {
            RollingStiffness::Fixed(k) => (positive(LAW, "stiffness.fixed", k)?, 0.0),
            RollingStiffness::OfNormal(f) => (0.0, positive(LAW, "stiffness.of_normal", f)?),
        };
        Ok(Self {
            arm: spec.coefficient.try_into()?,
            stiffness,
            stiffness_ratio,
            damping_ratio: non_negative(LAW, "damping_ratio", spec.damping_ratio)?,
        })
    }
}

impl RollingLaw for RollingSpringDashpot {
    type Memory = SpringMemory;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut SpringMemory,
    ) -> RollingResponse {
        let arm = self.arm.of(pair);
        let limit = arm * normal.friction_load;
        let k = self.stiffness + self.stiffness_ratio * normal.stiffness * arm * arm;
        let spin = motion.rolling_spin();
        let turn = spin * motion.dt;
        let before = *memory;
        let mut torque = before.trial(k, turn);
        let size2 = torque.length_squared();
        let sliding = size2 > limit * limit;
        if sliding {
            torque *= limit / size2.sqrt();
        }
        *memory = SpringMemory { force: torque, stiffness: k, sliding };
        let elastic_energy = memory.energy();
        let work = -0.5 * (before.force + torque).dot(turn);
        let mut lost = (work - (elastic_energy - before.energy())) / motion.dt;
        if !sliding {
            let inertia = 1.4 * pair.m_star * pair.r_star * pair.r_star;
            let c = 2.0 * self.damping_ratio * (inertia * k).sqrt();
            torque -= spin * c;
            lost += c * spin.length_squared();
        }
        RollingResponse {
            torque_on_i: torque,
            torque_on_j: -torque,
            elastic_energy,
            dissipated_power: lost,
        }
    }
}
