//! What a run yields: frames of positions, and the mechanical responses of each speed.

use std::sync::Arc;

use dem_core::glam::{DQuat, DVec3};

use crate::grains::{Ball, Grains};
use crate::regime::Regime;
use crate::stationary::Mean;

/// Places of all particles at one instant.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Exposure {
    /// Time, s.
    pub time_s: f64,
    /// Centres of mass, m, by number of the particle; the drum's axis is z through the origin.
    pub positions: Vec<DVec3>,
    /// Turns from the template of a clump to the laboratory; empty for spheres.
    pub orientations: Vec<DQuat>,
}

impl Exposure {
    /// All spheres, clumps expanded.
    pub fn balls<'a>(&'a self, grains: &'a Grains) -> impl Iterator<Item = Ball> + 'a {
        self.positions.iter().enumerate().flat_map(move |(k, &position)| {
            let orientation = self.orientations.get(k).copied().unwrap_or(DQuat::IDENTITY);
            grains.balls(k, position, orientation)
        })
    }
}

/// One frame: the instants that its exposure is made of.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Frame {
    /// Time of its middle, s.
    pub time_s: f64,
    /// Instants, evenly spread over the exposure.
    pub exposures: Vec<Exposure>,
}

/// The steady state at one speed.
///
/// Mechanical responses are measured on the particles themselves, over the whole steady state.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    /// Speed of the schedule, rpm.
    pub speed_rpm: f64,
    /// Speed at which the drum turned (`speed.scale` included), rad/s.
    pub omega: f64,
    /// Froude number of that speed.
    pub froude: f64,
    /// Regime that goes with it.
    pub regime: Regime,
    /// Time from which the motion counts as steady, s; the drum started at `turned_from_s`.
    pub steady_from_s: f64,
    /// Time at which the drum took up this speed, s.
    pub turned_from_s: f64,
    /// Turns at this speed.
    pub revolutions: f64,
    /// Frames.
    pub frames: Vec<Frame>,
    /// Torque that turns the drum, N m.
    pub torque: Mean,
    /// Centre of mass of the bed, m.
    pub centre_of_mass: [Mean; 3],
    /// Direction of the centre of mass from the vertical, degrees: for a bed with a flat surface its
    /// angle of repose.
    pub angle_deg: Mean,
    /// Contacts of a particle with others, mean over particles and frames.
    pub coordination: Mean,
    /// Contacts of a particle with walls.
    pub wall_contacts: Mean,
    /// Sizes and forms, the same for all speeds.
    pub grains: Arc<Grains>,
}

/// Direction of a centre of mass from the vertical, degrees, positive towards the raised side.
pub(crate) fn angle_deg(centre: DVec3) -> f64 {
    centre.x.atan2(-centre.y).to_degrees()
}
