//! The coefficient of rolling resistance, as a length or as a pure number.
//!
//! Limit of the rolling torque: `M = arm N`, with `arm = mu_r` where the coefficient is a length
//! (thesis eq. 31, 58-60) and `arm = mu_r R*` where it is a number (LIGGGHTS, EDEM).
//!
//! - `M` torque, N m; `N` load, N; `R*` effective radius, m (a sphere's own radius on a plane)

use crate::contact::error::{LawError, non_negative};
use crate::contact::kinematics::PairGeometry;

/// Coefficient of rolling resistance with its unit in the name.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum RollingCoefficient {
    /// A length, m: the lever of the normal force.
    LengthM(f64),
    /// A pure number: the lever over the effective radius.
    Ratio(f64),
}

/// The coefficient ready for the pair loop: `arm = length + ratio R*`, one of them 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollingArm {
    /// Part that is a length, m.
    pub length: f64,
    /// Part per effective radius.
    pub ratio: f64,
}

impl TryFrom<RollingCoefficient> for RollingArm {
    type Error = LawError;
    fn try_from(coefficient: RollingCoefficient) -> Result<Self, LawError> {
        Ok(match coefficient {
            RollingCoefficient::LengthM(x) => {
                Self { length: non_negative("RollingCoefficient", "length_m", x)?, ratio: 0.0 }
            }
            RollingCoefficient::Ratio(x) => {
                Self { length: 0.0, ratio: non_negative("RollingCoefficient", "ratio", x)? }
            }
        })
    }
}

impl RollingArm {
    /// Lever of the normal force, m.
    ///
    /// ```
    /// use dem_core::contact::kinematics::PairGeometry;
    /// use dem_core::contact::rolling::{RollingArm, RollingCoefficient};
    /// let pair = PairGeometry { r_star: 3e-3, m_star: 1e-4, radius_i: 3e-3, radius_j: f64::INFINITY };
    /// let arm = RollingArm::try_from(RollingCoefficient::Ratio(0.01))?;
    /// assert!((arm.of(&pair) - 3e-5).abs() < 1e-20);
    /// # Ok::<(), dem_core::contact::error::LawError>(())
    /// ```
    #[inline]
    pub fn of(&self, pair: &PairGeometry) -> f64 {
        self.length + self.ratio * pair.r_star
    }
}
