//! Derjaguin, Muller and Toporov: Hertz with a constant adhesive pull.
//!
//! `F = 4/3 E* sqrt(R*) delta^(3/2) - 2 pi w R* + alpha sqrt(m* S) delta'` for `delta >= 0`
//!
//! - `F` repulsion, N; `delta` overlap, m; `S = 2 E* sqrt(R* delta)`, N/m
//! - `w` work of adhesion, J/m^2 (`2 gamma` for equal solids); `E*` Pa; `R*` m; `m*` kg
//! - `alpha` damping factor, that of Hertz
//!
//! Pull-off force `2 pi w R*` at overlap 0. Validity: small, hard, weakly adhesive bodies
//! (Tabor's number below about 0.1). Forming and parting follow one curve: no energy is lost.
//! The Coulomb limit refers to Hertz's load, `F + 2 pi w R*`.
//! Reference: B. V. Derjaguin, V. M. Muller, Y. P. Toporov, *J. Colloid Interface Sci.* 53 (1975)
//! 314-326, doi:10.1016/0021-9797(75)90018-1.
//! Departure: the attraction outside the contact circle ends where the bodies part; use the van
//! der Waals law for its tail across the gap.

use super::hertz::damping_factor;
use super::restitution::AttractiveTail;
use crate::contact::error::{LawError, non_negative, positive};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalLaw, NormalResponse};

/// Parameters of [`Dmt`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct DmtSpec {
    /// Effective Young's modulus, Pa.
    pub e_star: f64,
    /// Work of adhesion, J/m^2.
    pub work_of_adhesion: f64,
    /// Coefficient of restitution in the absence of adhesion, above 0 and at most 1.
    pub restitution: f64,
}

/// DMT law of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dmt {
    /// Effective Young's modulus, Pa.
    pub e_star: f64,
    /// Work of adhesion, J/m^2.
    pub work_of_adhesion: f64,
    /// Damping factor `alpha`.
    pub damping: f64,
}

impl TryFrom<DmtSpec> for Dmt {
    type Error = LawError;
    fn try_from(spec: DmtSpec) -> Result<Self, LawError> {
        Ok(Self {
            e_star: positive("Dmt", "e_star", spec.e_star)?,
            work_of_adhesion: non_negative("Dmt", "work_of_adhesion", spec.work_of_adhesion)?,
            damping: damping_factor(spec.restitution, AttractiveTail::Kept)?,
        })
    }
}

impl Dmt {
    /// Pull-off force `2 pi w R*`, N.
    #[inline]
    pub fn pull_off_force(&self, r_star: f64) -> f64 {
        std::f64::consts::TAU * self.work_of_adhesion * r_star
    }
}

impl NormalLaw for Dmt {
    type Memory = ();

    #[inline]
    fn respond(&self, pair: &PairGeometry, motion: &Kinematics, (): &mut ()) -> NormalResponse {
        let delta = motion.overlap;
        if delta < 0.0 {
            return NormalResponse::default();
        }
        let a = (pair.r_star * delta).sqrt();
        let stiffness = 2.0 * self.e_star * a;
        let hertz = 2.0 / 3.0 * stiffness * delta;
        let pull = self.pull_off_force(pair.r_star);
        let viscous = self.damping * (pair.m_star * stiffness).sqrt() * motion.overlap_rate;
        NormalResponse {
            force: hertz - pull + viscous,
            friction_load: (hertz + viscous).max(0.0),
            stiffness,
            contact_radius: a,
            elastic_energy: (0.4 * hertz - pull) * delta,
            dissipated_power: viscous * motion.overlap_rate,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn the_pull_at_zero_overlap_is_two_pi_w_r_and_force_follows_energy() {
        let pair = PairGeometry { r_star: 1e-4, m_star: 1e-9, radius_i: 2e-4, radius_j: 2e-4 };
        let law: Dmt =
            DmtSpec { e_star: 1e9, work_of_adhesion: 0.05, restitution: 1.0 }.try_into().unwrap();
        let at = |overlap| {
            let motion = Kinematics {
                normal_i_to_j: DVec3::X,
                overlap,
                overlap_rate: 0.0,
                slip_velocity: DVec3::ZERO,
                spin_i: DVec3::ZERO,
                spin_j: DVec3::ZERO,
                lever_i: 1.0,
                lever_j: 1.0,
                dt: 1.0,
            };
            law.respond(&pair, &motion, &mut ())
        };
        let want = std::f64::consts::TAU * 0.05 * 1e-4;
        assert!((at(0.0).force / want + 1.0).abs() < 1e-15);
        assert_eq!(at(-1e-12).force, 0.0);
        let (d, h) = (1e-7, 1e-11);
        let slope = (at(d + h).elastic_energy - at(d - h).elastic_energy) / (2.0 * h);
        assert!((slope / at(d).force - 1.0).abs() < 1e-6);
    }
}
