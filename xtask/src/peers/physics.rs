//! What the bed does, from the beads alone, so that all codes are judged by the same measure.

use dem_core::prelude::DVec3;
use serde::Serialize;

use super::scene::{BEAD_RADIUS_M, Bead, DENSITY, GRAVITY};

/// State of the bed at one instant.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub(crate) struct Bed {
    /// Angle of the centre of mass from the plumb line, raised side positive, degrees: for a bed
    /// with a flat surface its angle of repose.
    pub(crate) angle_deg: f64,
    /// Distance of the centre of mass from the axis, mm.
    pub(crate) depth_mm: f64,
    /// Kinetic energy, translation and rotation, mJ.
    pub(crate) kinetic_mj: f64,
    /// Potential energy in gravity relative to the axis, mJ.
    pub(crate) potential_mj: f64,
}

impl Bed {
    /// Look at beads in a drum that turns about +z under gravity along -y.
    pub(crate) fn of(beads: &[Bead]) -> Self {
        let mass = DENSITY * 4.0 / 3.0 * std::f64::consts::PI * BEAD_RADIUS_M.powi(3);
        let moment = 0.4 * mass * BEAD_RADIUS_M * BEAD_RADIUS_M;
        let centre: DVec3 =
            beads.iter().map(|b| b.position).sum::<DVec3>() / beads.len().max(1) as f64;
        let kinetic = |b: &Bead| {
            0.5 * mass * b.velocity.length_squared() + 0.5 * moment * b.spin.length_squared()
        };
        Self {
            angle_deg: centre.x.atan2(-centre.y).to_degrees(),
            depth_mm: 1e3 * centre.x.hypot(centre.y),
            kinetic_mj: 1e3 * beads.iter().map(kinetic).sum::<f64>(),
            potential_mj: 1e3 * mass * GRAVITY * centre.y * beads.len() as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bead_on_the_raised_side_stands_at_its_angle() {
        let position = 0.1 * DVec3::new(0.5, -(0.75f64.sqrt()), 3.0);
        let bead = Bead { position, velocity: DVec3::X, spin: DVec3::ZERO };
        let bed = Bed::of(&[bead]);
        // sin 30 degrees = 1/2; 4/3 pi 27e-9 m3 of glass weigh 0.28274 g.
        assert!((bed.angle_deg - 30.0).abs() < 1e-9);
        assert!((bed.depth_mm - 100.0).abs() < 1e-9);
        assert!((bed.kinetic_mj - 0.141_37).abs() < 1e-5);
        assert!((bed.potential_mj + 0.240_21).abs() < 1e-5);
    }
}
