//! Integrators of the equations of motion.
//!
//! A step has two halves: [`Integrator::drift`] moves the positions, then the forces are computed
//! there, then [`Integrator::kick`] brings the velocities up to the same time. After a step,
//! positions, velocities and forces all belong to one instant, whatever the integrator.
//!
//! Contact laws see two velocities: springs are stretched by the *mean* velocity of the step (its
//! displacement over its duration), and normal dashpots act on the velocity *foretold* for its
//! end. So damping is as accurate as the integrator, and does not lag half a step behind.

mod beeman;
mod forward_euler;
mod leapfrog;
mod stoermer_verlet;
mod velocity_verlet;

use glam::DVec3;

pub use beeman::Beeman;
pub use forward_euler::ForwardEuler;
pub use leapfrog::Leapfrog;
pub use stoermer_verlet::StoermerVerlet;
pub use velocity_verlet::VelocityVerlet;

/// What the first half of a step yields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Mean velocity of the step, m/s: the displacement over the duration.
    pub mean_velocity: DVec3,
    /// Velocity foretold for the end of the step, m/s.
    pub end_velocity: DVec3,
}

/// A scheme that advances one vector (the position of a centre; the turn of a sphere) in time.
pub trait Integrator: Copy + Send + Sync + 'static {
    /// Global order of convergence in position and velocity.
    const ORDER: u32;

    /// Whether the scheme remembers anything from step to step.
    const REMEMBERS: bool;

    /// What the scheme remembers, at the start or after the velocity was set from outside.
    fn start(&self, velocity: DVec3, acceleration: DVec3, dt: f64) -> DVec3;

    /// First half: from the state at the beginning of the step.
    fn drift(&self, velocity: DVec3, acceleration: DVec3, memory: &mut DVec3, dt: f64) -> Drift;

    /// Second half: the velocity at the end of the step, from that at its beginning and the
    /// accelerations at both ends.
    fn kick(
        &self,
        velocity: DVec3,
        old_acceleration: DVec3,
        acceleration: DVec3,
        memory: &mut DVec3,
        dt: f64,
    ) -> DVec3;
}
