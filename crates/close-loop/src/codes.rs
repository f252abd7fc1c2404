//! By how much codes differ that simulate the same drum.

use calib::attribution::CodeCovariance;
use campaign::drum_rig::GRAVITY;

use crate::error::CloseLoopError;

/// Froude numbers of the ends of [`MODES`], between which they go with the speed.
const FROUDE: [f64; 2] = [0.0126, 0.274];

/// Straight lines over speed through what LIGGGHTS 3.8 and LAMMPS 20250722 said less what Tumble said, deg, deg, % of R, % of R: at
/// each of six speeds means of two fillings at three frictions, which the lines meet to 0.07 to 0.28, about their
/// own errors (`cargo xtask blind codes`; 560 beads that their bed presses together by some per cent). Each is one
/// standard deviation in its direction.
const MODES: [[[f64; 4]; 2]; 2] = [
    [[-0.13, -0.47, -0.12, 0.09], [-0.44, -0.32, -0.21, 0.30]],
    [[-0.19, -0.31, -0.16, 0.12], [-0.86, -0.94, -0.41, 0.67]],
];

/// By how much the data may differ from any simulation of the model that is meant, beside noise.
///
/// No two codes turn the same drum alike: they differ in the shear spring, and in where they take the slip and the torque
/// of beads that are pressed together. Nor is any of them the drum itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Codes {
    /// As much as LIGGGHTS and LAMMPS were found to differ from Tumble in drums that lack nothing.
    #[default]
    Usual,
    /// Not at all: the data are simulations of this very code.
    Alike,
    /// As given.
    Given(CodeCovariance),
}

impl Codes {
    /// The covariance of such differences in a drum of a radius, m.
    pub(crate) fn covariance(
        &self,
        radius_m: f64,
    ) -> Result<Option<CodeCovariance>, CloseLoopError> {
        match self {
            Self::Alike => Ok(None),
            Self::Given(codes) => Ok(Some(codes.clone())),
            Self::Usual => {
                let rpm = FROUDE.map(|f| rpm(f, radius_m)).to_vec();
                let modes = MODES.map(|m| m.to_vec()).to_vec();
                Ok(Some(CodeCovariance::new(rpm, modes)?))
            }
        }
    }
}

/// Speed at a Froude number, omega^2 R / g.
fn rpm(froude: f64, radius_m: f64) -> f64 {
    (froude * GRAVITY / radius_m).sqrt() * 30.0 / std::f64::consts::PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_differences_go_with_the_froude_number() {
        let usual = |radius| Codes::Usual.covariance(radius).unwrap().unwrap();
        let (small, large) = (usual(0.05), usual(0.2));
        // The drum that was run: at 70 rpm 0.44 and 0.86 deg.
        let at = |codes: &CodeCovariance, rpm: f64| codes.covariance((rpm, 0), (rpm, 0));
        let both = 0.44_f64.powi(2) + 0.86_f64.powi(2);
        assert!((at(&small, 70.0) - both).abs() < 1e-2, "{}", at(&small, 70.0));
        // Four times the radius at half the speed, in between and beyond.
        for rpm in [5.0, 15.0, 40.0, 70.0, 100.0] {
            assert!((at(&small, rpm) - at(&large, 0.5 * rpm)).abs() < 1e-12);
        }
        assert_eq!(Codes::Alike.covariance(0.05).unwrap(), None);
    }
}
