//! Simplified JKR of LIGGGHTS: a pull proportional to the circle in which the spheres intersect.
//!
//! `pull = k A`, `A = pi (2 r_i - d)(2 r_j - d)(2 r_i + 2 r_j - d) d / (4 D^2)`,
//! `D = r_i + r_j - d`
//!
//! - `pull` N; `k` cohesion energy density, J/m^3; `A` area of the circle, m^2
//! - `d` overlap, m; `r` radii, m (a plane: `A = pi d (2 r_i - d)`; a hollow cylinder: `r_j < 0`)
//!
//! Validity: an empirical glue, not JKR: no neck, no pull-off at rest, no energy lost.
//! Energy `-k V` with `V` the volume that the spheres share, since `dV/dd = A`.
//! Reference: LIGGGHTS-PUBLIC documentation, `cohesion sjkr`. Like there, the Coulomb limit refers
//! to the repulsion, so the pull adds nothing to the load of friction.

use crate::contact::error::{LawError, non_negative};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{CohesionLaw, CohesionResponse, NormalResponse};

/// Parameters of [`Sjkr`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SjkrSpec {
    /// Cohesion energy density, J/m^3.
    pub energy_density: f64,
}

/// Simplified JKR of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sjkr {
    /// Cohesion energy density, J/m^3.
    pub energy_density: f64,
}

impl TryFrom<SjkrSpec> for Sjkr {
    type Error = LawError;
    fn try_from(spec: SjkrSpec) -> Result<Self, LawError> {
        Ok(Self { energy_density: non_negative("Sjkr", "energy_density", spec.energy_density)? })
    }
}

impl CohesionLaw for Sjkr {
    type Memory = ();

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        _: &NormalResponse,
        (): &mut (),
    ) -> CohesionResponse {
        let d = motion.overlap.max(0.0);
        let (r, kappa) = (pair.radius_i, 1.0 / pair.radius_j);
        // Everything over r_j, so that a plane (kappa = 0) needs no branch.
        let sum = r * kappa + 1.0;
        let distance = sum - d * kappa;
        let area =
            std::f64::consts::PI * d * (2.0 * sum - d * kappa) * (2.0 * r - d) * (2.0 - d * kappa)
                / (4.0 * distance * distance);
        let volume = std::f64::consts::PI * d * d * (12.0 * r - 4.0 * sum * d + d * d * kappa)
            / (12.0 * distance);
        CohesionResponse {
            pull: self.energy_density * area,
            friction_load: 0.0,
            elastic_energy: -self.energy_density * volume,
            dissipated_power: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn at(radius_j: f64, overlap: f64) -> CohesionResponse {
        let pair = PairGeometry { r_star: 0.01, m_star: 1.0, radius_i: 0.02, radius_j };
        let motion = Kinematics {
            normal_i_to_j: DVec3::X,
            overlap,
            overlap_rate: 0.0,
            slip_velocity: DVec3::ZERO,
            spin_i: DVec3::ZERO,
            spin_j: DVec3::ZERO,
            lever_i: 0.02,
            lever_j: 0.02,
            dt: 1.0,
        };
        Sjkr { energy_density: 1e5 }.respond(&pair, &motion, &NormalResponse::default(), &mut ())
    }

    #[test]
    fn the_area_is_that_of_the_circle_of_intersection() {
        let (r, d) = (0.02f64, 0.001f64);
        // equal spheres: a^2 = r^2 - (D/2)^2
        let a2 = r * r - (r - 0.5 * d).powi(2);
        assert!((at(r, d).pull / (1e5 * std::f64::consts::PI * a2) - 1.0).abs() < 1e-12);
        // plane: a^2 = r^2 - (r - d)^2, and a very large sphere is nearly one
        let a2 = r * r - (r - d).powi(2);
        assert!(
            (at(f64::INFINITY, d).pull / (1e5 * std::f64::consts::PI * a2) - 1.0).abs() < 1e-12
        );
        assert!((at(1e9, d).pull / at(f64::INFINITY, d).pull - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_pull_is_the_slope_of_the_energy() {
        for radius_j in [0.02, 0.05, f64::INFINITY, -0.1] {
            let (d, h) = (1e-3, 1e-7);
            let slope = (at(radius_j, d + h).elastic_energy - at(radius_j, d - h).elastic_energy)
                / (2.0 * h);
            assert!((slope / at(radius_j, d).pull + 1.0).abs() < 1e-6, "{radius_j}");
        }
    }
}
