//! Cundall and Strack's shear spring with Coulomb's limit.
//!
//! `T = T0 - k_t ds - c_t v`, then `|T| <= mu N`
//!
//! - `T` force on body i, N; `T0` spring force of the step before; `ds = v dt` slip of i, m
//! - `k_t` stiffness, N/m; `c_t = 2 zeta_t sqrt(k_t m*)`, N s/m, while the contact sticks
//! - `N` load of the limit, N; `m*` effective mass, kg
//!
//! Validity: goes with the linear normal law; `k_t/k_n` between 2/3 and 1 for most solids.
//! References: P. A. Cundall, O. D. L. Strack, *Geotechnique* 29 (1979) 47-65,
//! doi:10.1680/geot.1979.29.1.47; thesis eq. 9, corrected: the force opposes the slip and has a
//! Coulomb limit; the slip is a vector, so turning back unloads the spring.

use super::spring_step::SpringStep;
use crate::contact::error::{LawError, non_negative, positive};
use crate::contact::friction::{Friction, FrictionSpec};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{NormalResponse, TangentialLaw, TangentialResponse};
use crate::contact::spring::SpringMemory;

/// Parameters of [`LinearSpring`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LinearSpringSpec {
    /// Shear stiffness of the pair, N/m.
    pub stiffness: f64,
    /// Friction coefficients.
    pub friction: FrictionSpec,
    /// Ratio of shear damping, 0 for none.
    #[cfg_attr(feature = "serde", serde(default))]
    pub damping_ratio: f64,
}

/// Linear shear spring of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearSpring {
    /// Shear stiffness of the pair, N/m.
    pub stiffness: f64,
    /// Friction coefficients.
    pub friction: Friction,
    /// Ratio of shear damping.
    pub damping_ratio: f64,
}

impl TryFrom<LinearSpringSpec> for LinearSpring {
    type Error = LawError;
    fn try_from(spec: LinearSpringSpec) -> Result<Self, LawError> {
        Ok(Self {
            stiffness: positive("LinearSpring", "stiffness", spec.stiffness)?,
            friction: spec.friction.try_into()?,
            damping_ratio: non_negative("LinearSpring", "damping_ratio", spec.damping_ratio)?,
        })
    }
}

impl TangentialLaw for LinearSpring {
    type Memory = SpringMemory;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut SpringMemory,
    ) -> TangentialResponse {
        let dashpot = if self.damping_ratio > 0.0 {
            2.0 * self.damping_ratio * (self.stiffness * pair.m_star).sqrt()
        } else {
            0.0
        };
        SpringStep { stiffness: self.stiffness, share: 1.0, dashpot }.advance(
            &self.friction,
            motion,
            normal,
            memory,
        )
    }
}
