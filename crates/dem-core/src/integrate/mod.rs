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

/// What can be integrated: all that schemes need are sums and multiples.
pub trait Vector:
    Copy
    + std::ops::Add<Output = Self>
    + std::ops::Sub<Output = Self>
    + std::ops::Mul<f64, Output = Self>
{
    /// `self + other * factor`; vectors of fused kernels round it once.
    #[inline(always)]
    #[must_use]
    fn plus_times(self, other: Self, factor: f64) -> Self {
        self + other * factor
    }
}

impl Vector for DVec3 {}

/// What the first half of a step yields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift<V = DVec3> {
    /// Mean velocity of the step, m/s: the displacement over the duration.
    pub mean_velocity: V,
    /// Velocity foretold for the end of the step, m/s.
    pub end_velocity: V,
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
    fn drift<V: Vector>(&self, velocity: V, acceleration: V, memory: &mut V, dt: f64) -> Drift<V>;

    /// Whether the second half asks for nothing of the first but its mean velocity, half-way between the velocity at the beginning
    /// and the one foretold for the end, and the scheme remembers nothing: then steps that follow each other at once need neither
    /// velocities nor accelerations of bodies between them.
    const FROM_MEAN: bool = false;

    /// Second half: the velocity at the end of the step, from that at its beginning, the mean that
    /// [`Integrator::drift`] told, and the accelerations at both ends.
    fn kick<V: Vector>(
        &self,
        velocity: V,
        mean_velocity: V,
        old_acceleration: V,
        acceleration: V,
        memory: &mut V,
        dt: f64,
    ) -> V;
}
