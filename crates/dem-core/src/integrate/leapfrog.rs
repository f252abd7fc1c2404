//! Leapfrog: velocities live at half steps.
//!
//! `v(n+1/2) = v(n-1/2) + a(n) dt`, `x(n+1) = x(n) + v(n+1/2) dt`. Symplectic, order 2; the
//! velocity reported at whole steps is the mean of its two neighbours.
//! Hockney & Eastwood, Computer Simulation Using Particles (1988), chapter 4.

use glam::DVec3;

use super::{Drift, Integrator, Vector};

/// Leapfrog.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Leapfrog;

impl Integrator for Leapfrog {
    const ORDER: u32 = 2;
    const REMEMBERS: bool = true;

    #[inline(always)]
    fn start(&self, velocity: DVec3, acceleration: DVec3, dt: f64) -> DVec3 {
        velocity - acceleration * (0.5 * dt)
    }

    #[inline(always)]
    fn drift<V: Vector>(&self, _: V, acceleration: V, memory: &mut V, dt: f64) -> Drift<V> {
        *memory = *memory + acceleration * dt;
        Drift { mean_velocity: *memory, end_velocity: *memory + acceleration * (0.5 * dt) }
    }

    #[inline(always)]
    fn kick<V: Vector>(&self, _: V, _: V, _: V, acceleration: V, memory: &mut V, dt: f64) -> V {
        *memory + acceleration * (0.5 * dt)
    }
}
