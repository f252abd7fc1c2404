//! Forward (explicit) Euler.
//!
//! `x' = x + v dt`, `v' = v + a dt`. Order 1; gains energy on every oscillation, by a factor
//! `1 + (omega dt)^2` a step: for comparison only.

use glam::DVec3;

use super::{Drift, Integrator, Vector};

/// Forward Euler.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ForwardEuler;

impl Integrator for ForwardEuler {
    const ORDER: u32 = 1;
    const REMEMBERS: bool = false;

    #[inline(always)]
    fn start(&self, _: DVec3, _: DVec3, _: f64) -> DVec3 {
        DVec3::ZERO
    }

    #[inline(always)]
    fn drift<V: Vector>(&self, velocity: V, acceleration: V, _: &mut V, dt: f64) -> Drift<V> {
        Drift { mean_velocity: velocity, end_velocity: velocity + acceleration * dt }
    }

    #[inline(always)]
    fn kick<V: Vector>(
        &self,
        velocity: V,
        _: V,
        old_acceleration: V,
        _: V,
        _: &mut V,
        dt: f64,
    ) -> V {
        velocity + old_acceleration * dt
    }
}
