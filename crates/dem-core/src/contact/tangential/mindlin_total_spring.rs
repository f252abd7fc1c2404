//! EDEM's total-spring form of Mindlin's stiffness. A **compatibility law**: it creates energy.
//!
//! `T = -k s`, `k = 8 G* a`, `|T| <= mu N` (then `s = -T/k`)
//!
//! - `T` force on body i, N; `s` whole tangential displacement since first touch, m
//! - `G*` effective shear modulus, Pa; `a` contact radius, m; `N` load of the limit, N
//!
//! The present stiffness multiplies the *whole* displacement. While the load grows the spring
//! grows stiffer under its own stretch, which nobody pays for: shear under a light load, press,
//! shear back, let go, and the loop returns more work than it took. The incremental form
//! (`mindlin.rs`) does not. In the ledger the gain shows as negative dissipation.
//! It exists so that runs of EDEM's "Hertz-Mindlin (no slip)" can be compared like with like.
//!
//! Reference: the form stated in EDEM's documentation; why it fails: C. Thornton, S. J. Cummins,
//! P. W. Cleary, *Powder Technology* 233 (2013) 30-46, doi:10.1016/j.powtec.2012.08.012.
//! Departure: none known.

use super::mindlin::{Mindlin, MindlinSpec};
use super::spring_step::SpringStep;
use crate::contact::error::LawError;
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, TangentialLaw, TangentialResponse};
use crate::contact::spring::SpringMemory;

/// Total-spring law of one pair of materials; its parameters are those of [`Mindlin`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MindlinTotalSpring(pub Mindlin);

impl TryFrom<MindlinSpec> for MindlinTotalSpring {
    type Error = LawError;
    fn try_from(spec: MindlinSpec) -> Result<Self, LawError> {
        Ok(Self(spec.try_into()?))
    }
}

impl TangentialLaw for MindlinTotalSpring {
    type Memory = SpringMemory;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut SpringMemory,
    ) -> TangentialResponse {
        let (stiffness, dashpot) = self.0.spring(pair, normal);
        // k/k0 unbounded keeps the displacement T0/k0 whatever the load does.
        let share = if memory.stiffness > 0.0 { stiffness / memory.stiffness } else { 1.0 };
        SpringStep { stiffness, share, dashpot }.advance(&self.0.friction, motion, normal, memory)
    }
}
