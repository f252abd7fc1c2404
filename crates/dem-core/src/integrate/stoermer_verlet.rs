//! Störmer-Verlet in its two-position form.
//!
//! `x'' = 2 x' - x + a' dt^2`, `v' = (x'' - x) / (2 dt)`. Order 2. The difference of positions is
//! carried instead of the older position, so that no digits are lost far from the origin.
//! Verlet, Phys. Rev. 159 (1967) 98, doi:10.1103/PhysRev.159.98.

use glam::DVec3;

use super::{Drift, Integrator, Vector};

/// Störmer-Verlet.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StoermerVerlet;

impl Integrator for StoermerVerlet {
    const ORDER: u32 = 2;
    const REMEMBERS: bool = true;

    #[inline(always)]
    fn start(&self, velocity: DVec3, acceleration: DVec3, dt: f64) -> DVec3 {
        (velocity - acceleration * (0.5 * dt)) * dt
    }

    #[inline(always)]
    fn drift<V: Vector>(&self, _: V, acceleration: V, memory: &mut V, dt: f64) -> Drift<V> {
        *memory = *memory + acceleration * (dt * dt);
        let mean_velocity = *memory * (1.0 / dt);
        Drift { mean_velocity, end_velocity: mean_velocity + acceleration * (0.5 * dt) }
    }

    #[inline(always)]
    fn kick<V: Vector>(&self, _: V, _: V, _: V, acceleration: V, memory: &mut V, dt: f64) -> V {
        *memory * (1.0 / dt) + acceleration * (0.5 * dt)
    }
}
