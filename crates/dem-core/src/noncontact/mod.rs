//! Forces that act across a gap: van der Waals, liquid bridges, electric charges.
//!
//! A law holds the constants of one pair of materials; sizes, gap and charges come with
//! [`Separation`]. The force acts along the line of centres.

use glam::DVec3;

use crate::contact::kinematics::PairGeometry;
use crate::contact::law::Memory;

pub mod capillary_bridge;
pub mod electrostatic;
pub mod van_der_waals;

pub use capillary_bridge::{CapillaryBridge, CapillaryBridgeSpec};
pub use electrostatic::{Coulomb, CoulombSpec, ImageCharge, ImageChargeSpec};
pub use van_der_waals::{VanDerWaals, VanDerWaalsSpec};

/// How two bodies lie to each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Unit vector from the centre of i towards j.
    pub normal_i_to_j: DVec3,
    /// Distance of the surfaces, m; negative when they overlap.
    pub gap: f64,
    /// Distance of the centres (to a wall: of the centre from its surface), m.
    pub distance: f64,
    /// Charge of i, C.
    pub charge_i: f64,
    /// Charge of j, C.
    pub charge_j: f64,
}

/// Result of a non-contact law.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NonContactResponse {
    /// Pull along the normal, N; negative pushes the bodies apart.
    pub attraction: f64,
    /// Energy, J; 0 at the range of the force.
    pub energy: f64,
    /// Energy lost in this step, J (a bridge that forms).
    pub lost_energy: f64,
}

impl NonContactResponse {
    /// Force on body i, N; on j it is the opposite.
    #[inline]
    pub fn force_on_i(&self, separation: &Separation) -> DVec3 {
        separation.normal_i_to_j * self.attraction
    }
}

/// A force across a gap.
pub trait NonContactForce: Copy + Send + Sync {
    /// What a pair remembers.
    type Memory: Memory;
    /// Force at the present separation; updates the memory.
    fn respond(
        &self,
        pair: &PairGeometry,
        separation: &Separation,
        memory: &mut Self::Memory,
    ) -> NonContactResponse;
    /// Largest gap at which the force acts, m.
    fn range(&self, pair: &PairGeometry) -> f64;
}
