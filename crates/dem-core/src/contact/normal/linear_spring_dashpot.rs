//! Linear spring and dashpot.
//!
//! `F = k delta + c delta'`, `c = 2 zeta sqrt(k m*)`
//!
//! - `F` repulsion, N; `delta` overlap, m; `delta'` its rate, m/s (positive on approach)
//! - `k` stiffness, N/m; `c` damping coefficient (thesis: beta), N s/m; `m*` effective mass, kg
//! - `zeta` damping ratio that yields the asked restitution
//!
//! Validity: a model of the collision as a whole, not of the contact; duration and restitution do
//! not depend on speed. The closed solution is in `linear_impact.rs`.
//! References: P. A. Cundall, O. D. L. Strack, *Geotechnique* 29 (1979) 47-65,
//! doi:10.1680/geot.1979.29.1.47; thesis eq. 8 and 46-56.
//! Departures: with `CUT_TAIL` the force never turns attractive and the damping is raised so that
//! the rebound keeps the asked restitution; the contact radius is Hertz's, `sqrt(R* delta)`.

use super::restitution::{AttractiveTail, damping_ratio};
use crate::contact::error::{LawError, positive};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalLaw, NormalResponse};

/// Parameters of [`LinearSpringDashpot`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LinearSpringDashpotSpec {
    /// Stiffness of the pair, N/m.
    pub stiffness: f64,
    /// Coefficient of normal restitution, above 0 and at most 1.
    pub restitution: f64,
}

/// Linear law of one pair of materials; `CUT_TAIL` cuts the attractive tail off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearSpringDashpot<const CUT_TAIL: bool> {
    /// Stiffness of the pair, N/m.
    pub stiffness: f64,
    /// Damping ratio `zeta`: 0 elastic, 1 critical.
    pub damping_ratio: f64,
}

/// Linear law whose damper may pull at the end of a rebound.
pub type LinearTailKept = LinearSpringDashpot<false>;
/// Linear law that never pulls.
pub type LinearTailCut = LinearSpringDashpot<true>;

impl<const CUT_TAIL: bool> TryFrom<LinearSpringDashpotSpec> for LinearSpringDashpot<CUT_TAIL> {
    type Error = LawError;
    fn try_from(spec: LinearSpringDashpotSpec) -> Result<Self, LawError> {
        let stiffness = positive("LinearSpringDashpot", "stiffness", spec.stiffness)?;
        let tail = if CUT_TAIL { AttractiveTail::Cut } else { AttractiveTail::Kept };
        Ok(Self { stiffness, damping_ratio: damping_ratio(spec.restitution, tail)? })
    }
}

impl<const CUT_TAIL: bool> NormalLaw for LinearSpringDashpot<CUT_TAIL> {
    type Memory = ();

    #[inline]
    fn respond(&self, pair: &PairGeometry, motion: &Kinematics, (): &mut ()) -> NormalResponse {
        let delta = motion.overlap;
        if delta <= 0.0 {
            return NormalResponse::default();
        }
        let elastic = self.stiffness * delta;
        let viscous =
            2.0 * self.damping_ratio * (self.stiffness * pair.m_star).sqrt() * motion.overlap_rate;
        let mut force = elastic + viscous;
        if CUT_TAIL {
            force = force.max(0.0);
        }
        NormalResponse {
            force,
            friction_load: force.max(0.0),
            stiffness: self.stiffness,
            contact_radius: (pair.r_star * delta).sqrt(),
            elastic_energy: 0.5 * elastic * delta,
            dissipated_power: (force - elastic) * motion.overlap_rate,
        }
    }
}

/// Stiffness of two springs in series, N/m (thesis eq. 46).
pub fn series_stiffness(k_i: f64, k_j: f64) -> f64 {
    k_i * k_j / (k_i + k_j)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_stiffness_or_zero_restitution_is_refused() {
        let spec = LinearSpringDashpotSpec { stiffness: -1.0, restitution: 0.5 };
        assert!(LinearTailCut::try_from(spec).is_err());
        let spec = LinearSpringDashpotSpec { stiffness: 1.0, restitution: 0.0 };
        assert!(LinearTailCut::try_from(spec).is_err());
    }

    #[test]
    fn the_cut_tail_needs_more_damping_for_the_same_restitution() {
        let spec = LinearSpringDashpotSpec { stiffness: 1e4, restitution: 0.5 };
        let kept = LinearTailKept::try_from(spec).unwrap();
        let cut = LinearTailCut::try_from(spec).unwrap();
        assert!(cut.damping_ratio > kept.damping_ratio);
    }

    #[test]
    fn equal_springs_in_series_are_half_as_stiff() {
        assert_eq!(series_stiffness(10.0, 10.0), 5.0);
    }
}
