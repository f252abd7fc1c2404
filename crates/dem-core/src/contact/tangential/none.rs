//! No friction: the bodies slide freely.
//!
//! `T = 0`. The choice for benchmarks of normal laws; exact for a lubricated pair without
//! viscosity. No parameters, no reference.

use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, TangentialLaw, TangentialResponse};

/// No tangential force.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Frictionless;

impl TangentialLaw for Frictionless {
    type Memory = ();

    #[inline]
    fn respond(
        &self,
        _: &PairGeometry,
        _: &Kinematics,
        _: &NormalResponse,
        (): &mut (),
    ) -> TangentialResponse {
        TangentialResponse::default()
    }
}
