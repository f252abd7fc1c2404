//! Mindlin's no-slip shear stiffness in incremental form, with Coulomb's limit.
//!
//! `T = T0 min(1, k/k0) - k ds`, `k = 8 G* a`, then `|T| <= mu N`; optional shear dashpot
//! `-alpha sqrt(m* k) v` while the contact sticks, inside the same limit.
//!
//! - `T` force on i, N; `T0`, `k0` force and stiffness of the step before
//! - `ds = v dt` slip of i against j, m; `v` slip velocity, m/s
//! - `G*` effective shear modulus, Pa (`1/G* = (2 - nu_i)/G_i + (2 - nu_j)/G_j`)
//! - `a` radius of the contact circle, m, from the normal law; `N` load of the limit, N
//! - `alpha` damping factor, `2 sqrt(5/6) zeta` with the ratio of a normal restitution
//!
//! Validity: contact circle much smaller than the bodies; micro-slip at its rim is neglected, so
//! the stiffness is that of full stick up to the limit (Mindlin-Deresiewicz has the rim).
//! References: R. D. Mindlin, *J. Appl. Mech.* 16 (1949) 259-268, doi:10.1115/1.4009973;
//! C. Thornton, S. J. Cummins, P. W. Cleary, *Powder Technology* 233 (2013) 30-46,
//! doi:10.1016/j.powtec.2012.08.012 (rescaling under unloading: see `contact::spring`).
//! Departure: static and kinetic friction differ (see `contact::friction`).
//! The energy that a change of contact area takes from the spring counts as dissipated.

use super::spring_step::SpringStep;
use crate::contact::error::{LawError, non_negative, positive};
use crate::contact::friction::{Friction, FrictionSpec};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, TangentialLaw, TangentialResponse};
use crate::contact::spring::{SpringMemory, kept_share};

/// Parameters of [`Mindlin`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct MindlinSpec {
    /// Effective shear modulus, Pa.
    pub g_star: f64,
    /// Friction coefficients.
    pub friction: FrictionSpec,
    /// Shear damping factor `alpha`, 0 for none; see [`crate::contact::normal::hertz::damping_factor`].
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping: f64,
}

/// Mindlin's no-slip law of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mindlin {
    /// Effective shear modulus, Pa.
    pub g_star: f64,
    /// Friction coefficients.
    pub friction: Friction,
    /// Shear damping factor: the dashpot is `damping sqrt(m* k)`.
    pub damping: f64,
}

impl TryFrom<MindlinSpec> for Mindlin {
    type Error = LawError;
    fn try_from(spec: MindlinSpec) -> Result<Self, LawError> {
        Ok(Self {
            g_star: positive("Mindlin", "g_star", spec.g_star)?,
            friction: spec.friction.try_into()?,
            damping: non_negative("Mindlin", "damping", spec.damping)?,
        })
    }
}

impl Mindlin {
    /// Stiffness `k`, N/m, and the dashpot `alpha sqrt(m* k)`, N s/m.
    #[inline]
    pub(super) fn spring(&self, pair: &PairGeometry, normal: &NormalResponse) -> (f64, f64) {
        let stiffness = 8.0 * self.g_star * normal.contact_radius;
        let root = (pair.m_star * normal.contact_radius).sqrt() * (8.0 * self.g_star).sqrt();
        (stiffness, if self.damping > 0.0 { self.damping * root } else { 0.0 })
    }
}

impl TangentialLaw for Mindlin {
    type Memory = SpringMemory;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut SpringMemory,
    ) -> TangentialResponse {
        let (stiffness, dashpot) = self.spring(pair, normal);
        let share = kept_share(stiffness, memory.stiffness);
        SpringStep { stiffness, share, dashpot }.advance(&self.friction, motion, normal, memory)
    }
}
