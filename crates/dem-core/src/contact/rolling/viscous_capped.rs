//! Viscous rolling torque with a cap, after Zhou.
//!
//! `M_i = -min(arm N, c |w_r|) w_r/|w_r|`, `M_j = -M_i`, `c = c_0 + c_1 N`
//!
//! - `M` torque, N m; `N` load, N; `w_r` rolling part of the relative spin, rad/s
//! - `arm` coefficient of rolling resistance times effective radius, or as a length, m
//! - `c_0` rotational viscosity, N m s/rad (thesis eq. 31, there "rotational stiffness")
//! - `c_1` the same per load, m s/rad (thesis eq. 58, `k = mu' m g`)
//!
//! Validity: free of the chatter of the constant torque; a slow sphere on an incline creeps, as
//! nothing but viscosity holds it. References: Y. C. Zhou, B. D. Wright, R. Y. Yang, B. H. Xu,
//! A. B. Yu, *Physica A* 269 (1999) 536-553, doi:10.1016/S0378-4371(99)00183-1; thesis eq. 31, 58.

use super::coefficient::{RollingArm, RollingCoefficient};
use crate::contact::error::{LawError, positive};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, RollingLaw, RollingResponse};

/// Viscosity of the rolling torque below its cap.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum RollingViscosity {
    /// Independent of the load, N m s/rad.
    Fixed(f64),
    /// In proportion to the load, m s/rad.
    PerLoad(f64),
}

/// Parameters of [`ViscousCapped`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ViscousCappedSpec {
    /// Coefficient of rolling resistance: the cap.
    pub coefficient: RollingCoefficient,
    /// Viscosity below the cap.
    pub viscosity: RollingViscosity,
}

/// Viscous torque with a cap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViscousCapped {
    /// Lever of the cap.
    pub arm: RollingArm,
    /// Viscosity that does not depend on the load, N m s/rad.
    pub viscosity: f64,
    /// Viscosity per load, m s/rad.
    pub viscosity_per_load: f64,
}

impl TryFrom<ViscousCappedSpec> for ViscousCapped {
    type Error = LawError;
    fn try_from(spec: ViscousCappedSpec) -> Result<Self, LawError> {
        const LAW: &str = "ViscousCapped";
        let (viscosity, viscosity_per_load) = match spec.viscosity {
            RollingViscosity::Fixed(c) => (positive(LAW, "viscosity.fixed", c)?, 0.0),
            RollingViscosity::PerLoad(c) => (0.0, positive(LAW, "viscosity.per_load", c)?),
        };
        Ok(Self { arm: spec.coefficient.try_into()?, viscosity, viscosity_per_load })
    }
}

impl ViscousCapped {
    /// Torque on i over the rolling spin with the minus sign left out, N m s/rad.
    #[inline]
    pub(crate) fn resistance(&self, pair: &PairGeometry, load: f64, speed: f64) -> f64 {
        let cap = self.arm.of(pair) * load / speed.max(f64::MIN_POSITIVE);
        cap.min(self.viscosity + self.viscosity_per_load * load)
    }
}

impl RollingLaw for ViscousCapped {
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
        // A contact without load has no viscosity either.
        let c = if normal.friction_load > 0.0 {
            self.resistance(pair, normal.friction_load, speed)
        } else {
            0.0
        };
        RollingResponse {
            torque_on_i: spin * -c,
            torque_on_j: spin * c,
            elastic_energy: 0.0,
            dissipated_power: c * speed * speed,
        }
    }
}
