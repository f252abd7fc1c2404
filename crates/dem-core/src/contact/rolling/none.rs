//! No resistance against rolling or twisting.
//!
//! `M = 0`. Exact for smooth elastic spheres; a sphere once in pure rolling rolls on for ever.

use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, RollingLaw, RollingResponse};

/// No rolling torque.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FreeRolling;

impl RollingLaw for FreeRolling {
    type Memory = ();

    #[inline]
    fn respond(
        &self,
        _: &PairGeometry,
        _: &Kinematics,
        _: &NormalResponse,
        (): &mut (),
    ) -> RollingResponse {
        RollingResponse::default()
    }
}
