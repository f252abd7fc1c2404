//! Zhu's modified rolling torque: the capped viscous torque, scaled to what pure rolling leaves.
//!
//! `M_i = -I/(I + m r^2) min(arm N, c |w_r|) w_r/|w_r|`, `M_j = -M_i`
//!
//! - `M` torque, N m; `N` load, N; `w_r` rolling part of the relative spin, rad/s
//! - `I` moment of inertia, kg m^2; `m` mass, kg; `r` distance from centre to contact, m;
//!   `I/(I + m r^2) = 2/7` for a solid sphere
//! - `arm`, `c` as in `viscous_capped.rs`
//!
//! What it does: a sphere in pure rolling under a resisting torque `M` decelerates by
//! `theta'' = -M/(I + m r^2)`, since friction carries the translation along. Scaling the torque by
//! `I/(I + m r^2)` makes the rotation decelerate at that rate by the torque alone, with no tangential
//! force needed to hold it back, so that zero slip and zero tangential displacement stay
//! compatible with a resisting torque (Zhu's third fact).
//! What it leaves open: the equation has no partner in translation. At zero slip and zero
//! displacement `x''` is 0 while `theta''` is not, so slip begins at once, and the tangential
//! spring then takes the translation along: the steady deceleration is `2/7` of that of the
//! unscaled torque. For pairs of spheres the factor of one solid sphere is kept.
//!
//! Reference: thesis eq. 60 and its source (Zhu et al.), with a minus in place of the printed plus:
//! with a plus the term would spin the sphere up.

use super::viscous_capped::{ViscousCapped, ViscousCappedSpec};
use crate::contact::error::LawError;
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, RollingLaw, RollingResponse};

/// `I/(I + m r^2)` of a solid sphere that touches at its radius.
pub const SOLID_SPHERE_SHARE: f64 = 2.0 / 7.0;

/// Parameters of [`Zhu`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct ZhuSpec {
    /// The torque before scaling.
    pub torque: ViscousCappedSpec,
    /// `I/(I + m r^2)`, above 0 and at most 1; 2/7, a solid sphere, where absent.
    #[cfg_attr(feature = "serde", serde(default))]
    pub inertia_share: Option<f64>,
}

/// Zhu's law of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zhu {
    /// The torque before scaling.
    pub torque: ViscousCapped,
    /// `I/(I + m r^2)`.
    pub inertia_share: f64,
}

impl TryFrom<ZhuSpec> for Zhu {
    type Error = LawError;
    fn try_from(spec: ZhuSpec) -> Result<Self, LawError> {
        let inertia_share = spec.inertia_share.unwrap_or(SOLID_SPHERE_SHARE);
        if !(inertia_share > 0.0 && inertia_share <= 1.0) {
            return Err(LawError::OutOfRange {
                law: "Zhu",
                parameter: "inertia_share",
                value: inertia_share,
                expected: "a number above 0 and at most 1",
            });
        }
        Ok(Self { torque: spec.torque.try_into()?, inertia_share })
    }
}

impl RollingLaw for Zhu {
    type Memory = ();

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        (): &mut (),
    ) -> RollingResponse {
        let full = self.torque.respond(pair, motion, normal, &mut ());
        RollingResponse {
            torque_on_i: full.torque_on_i * self.inertia_share,
            torque_on_j: full.torque_on_j * self.inertia_share,
            elastic_energy: 0.0,
            dissipated_power: full.dissipated_power * self.inertia_share,
        }
    }
}
