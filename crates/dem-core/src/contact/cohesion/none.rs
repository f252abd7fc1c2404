//! No attraction: dry, uncharged, coarse bodies.
//!
//! `pull = 0`.

use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{CohesionLaw, CohesionResponse, NormalResponse};

/// No attraction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cohesionless;

impl CohesionLaw for Cohesionless {
    type Memory = ();

    #[inline]
    fn respond(
        &self,
        _: &PairGeometry,
        _: &Kinematics,
        _: &NormalResponse,
        (): &mut (),
    ) -> CohesionResponse {
        CohesionResponse::default()
    }
}
