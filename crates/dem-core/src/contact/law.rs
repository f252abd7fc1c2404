//! The roles that a contact law can play, and what each returns.
//!
//! A law is a plain `Copy` struct that holds the constants of *one pair of materials*; sizes and
//! masses come with [`PairGeometry`]. A law has no other state: what a contact remembers is the
//! law's [`Memory`], kept by the engine, transported with the contact frame before each call.

use glam::DVec3;

use super::kinematics::{Kinematics, PairGeometry};

/// What one contact remembers from step to step.
///
/// Stored by the engine as `SLOTS` numbers a contact, so that every combination of laws shares
/// one store, one rebuild and one snapshot.
pub trait Memory: Copy + Default + Send + Sync + 'static {
    /// Numbers needed to store the memory.
    const SLOTS: usize;
    /// Write the memory to `slots` (length `SLOTS`).
    fn store(&self, slots: &mut [f64]);
    /// Read a memory back from `slots` (length `SLOTS`); all zero is a new contact.
    fn load(slots: &[f64]) -> Self;
    /// Turn the memory's vectors with the contact frame: keep them perpendicular to the present
    /// `normal` at unchanged length and turn them by `twist` (rad) about it.
    fn transport(&mut self, normal: DVec3, twist: f64);
}

/// The memory of a law that has none.
impl Memory for () {
    const SLOTS: usize = 0;
    #[inline]
    fn store(&self, _: &mut [f64]) {}
    #[inline]
    fn load(_: &[f64]) -> Self {}
    #[inline]
    fn transport(&mut self, _: DVec3, _: f64) {}
}

/// Result of a normal law.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NormalResponse {
    /// Force along the normal, N; positive repels.
    pub force: f64,
    /// Load that the Coulomb limit refers to, N, never negative (for adhesive laws this is more
    /// than the force: see each law).
    pub friction_load: f64,
    /// Slope of the elastic force over the overlap, N/m.
    pub stiffness: f64,
    /// Radius of the contact circle, m.
    pub contact_radius: f64,
    /// Elastic energy now stored in the contact, J.
    pub elastic_energy: f64,
    /// Power lost by the law now, W, never negative for a physical law.
    pub dissipated_power: f64,
}

/// Normal force between two bodies.
pub trait NormalLaw: Copy + Send + Sync {
    /// What a contact remembers.
    type Memory: Memory;
    /// Force at the present overlap and rate; updates the memory.
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        memory: &mut Self::Memory,
    ) -> NormalResponse;
    /// Largest gap, m, across which an existing contact still acts (0 without a neck).
    fn reach(&self, _pair: &PairGeometry) -> f64 {
        0.0
    }
}

/// Result of a tangential law.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TangentialResponse {
    /// Tangential force on body i, N; on j it is the opposite.
    pub force_on_i: DVec3,
    /// Elastic energy now stored in the contact's shear, J.
    pub elastic_energy: f64,
    /// Power lost to sliding and shear damping, W.
    pub dissipated_power: f64,
    /// Whether the contact slides as a whole.
    pub sliding: bool,
}

/// Friction between two bodies.
pub trait TangentialLaw: Copy + Send + Sync {
    /// What a contact remembers.
    type Memory: Memory;
    /// Force at the present slip velocity and normal response; updates the memory.
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut Self::Memory,
    ) -> TangentialResponse;
}

/// Result of a rolling (and torsion) law.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RollingResponse {
    /// Torque on body i, N m.
    pub torque_on_i: DVec3,
    /// Torque on body j, N m (`-torque_on_i` for every frame-indifferent law).
    pub torque_on_j: DVec3,
    /// Elastic energy now stored, J.
    pub elastic_energy: f64,
    /// Power lost, W.
    pub dissipated_power: f64,
}

/// Resistance against rolling and twisting.
pub trait RollingLaw: Copy + Send + Sync {
    /// What a contact remembers.
    type Memory: Memory;
    /// Torque at the present relative spin and normal response; updates the memory.
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut Self::Memory,
    ) -> RollingResponse;
}

/// Result of a cohesion law.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CohesionResponse {
    /// Attraction along the normal, N; positive pulls the bodies together.
    pub pull: f64,
    /// Addition to the load of the Coulomb limit, N.
    pub friction_load: f64,
    /// Energy stored by the attraction, J (negative in a well).
    pub elastic_energy: f64,
    /// Power lost, W.
    pub dissipated_power: f64,
}

/// Attraction that is added to a normal law that has none of its own.
pub trait CohesionLaw: Copy + Send + Sync {
    /// What a contact remembers.
    type Memory: Memory;
    /// Attraction at the present overlap (negative overlap: a gap within [`CohesionLaw::reach`]).
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut Self::Memory,
    ) -> CohesionResponse;
    /// Largest gap, m, across which the attraction acts on a pair that has touched.
    fn reach(&self, _pair: &PairGeometry) -> f64 {
        0.0
    }
}
