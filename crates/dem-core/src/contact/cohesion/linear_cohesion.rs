//! Linear cohesion: a pull proportional to the area of Hertz's contact circle.
//!
//! `pull = k pi a^2 = k pi R* delta` for `delta > 0`
//!
//! - `pull` N; `k` cohesion energy density, J/m^3; `a` contact radius, m
//! - `R*` effective radius, m; `delta` overlap, m
//!
//! Validity: an empirical glue for damp or fine material; no neck, no energy lost. Near overlap
//! zero the pull outgrows Hertz's repulsion, so a resting contact sits at
//! `delta = R* (3 pi k/(4 E*))^2` without load.
//! Reference: EDEM's model "linear cohesion". Departure: the Coulomb limit refers to the repulsion.

use crate::contact::error::{LawError, non_negative};
use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::{CohesionLaw, CohesionResponse, NormalResponse};

/// Parameters of [`LinearCohesion`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct LinearCohesionSpec {
    /// Cohesion energy density, J/m^3.
    pub energy_density: f64,
}

/// Linear cohesion of one pair of materials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearCohesion {
    /// Cohesion energy density, J/m^3.
    pub energy_density: f64,
}

impl TryFrom<LinearCohesionSpec> for LinearCohesion {
    type Error = LawError;
    fn try_from(spec: LinearCohesionSpec) -> Result<Self, LawError> {
        let energy_density = non_negative("LinearCohesion", "energy_density", spec.energy_density)?;
        Ok(Self { energy_density })
    }
}

impl CohesionLaw for LinearCohesion {
    type Memory = ();

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        _: &NormalResponse,
        (): &mut (),
    ) -> CohesionResponse {
        let delta = motion.overlap.max(0.0);
        let pull = std::f64::consts::PI * self.energy_density * pair.r_star * delta;
        CohesionResponse {
            pull,
            friction_load: 0.0,
            elastic_energy: -0.5 * pull * delta,
            dissipated_power: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::law::NormalLaw;
    use crate::contact::normal::HertzTailKept;
    use glam::DVec3;

    #[test]
    fn the_unloaded_overlap_is_the_closed_form() {
        let (e_star, k, r_star) = (1e7, 1e5, 0.01);
        let pair = PairGeometry { r_star, m_star: 1.0, radius_i: 0.02, radius_j: 0.02 };
        let overlap = r_star * (3.0 * std::f64::consts::PI * k / (4.0 * e_star)).powi(2);
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
        let hertz = HertzTailKept { e_star, damping: 0.0 }.respond(&pair, &motion, &mut ());
        let glue = LinearCohesion { energy_density: k }.respond(&pair, &motion, &hertz, &mut ());
        assert!((glue.pull / hertz.force - 1.0).abs() < 1e-12);
    }
}
