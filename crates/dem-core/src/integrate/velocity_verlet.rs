//! Velocity Verlet.
//!
//! `x' = x + v dt + a dt^2 / 2`, `v' = v + (a + a') dt / 2`, of which `v + a dt / 2` is the mean velocity of the step. Symplectic, order 2.
//! Swope, Andersen, Berens & Wilson, J. Chem. Phys. 76 (1982) 637, doi:10.1063/1.442716.

use glam::DVec3;

use super::{Drift, Integrator, Vector};

/// Velocity Verlet: the default.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct VelocityVerlet;

impl Integrator for VelocityVerlet {
    const ORDER: u32 = 2;
    const REMEMBERS: bool = false;
    const FROM_MEAN: bool = true;

    #[inline(always)]
    fn start(&self, _: DVec3, _: DVec3, _: f64) -> DVec3 {
        DVec3::ZERO
    }

    #[inline(always)]
    fn drift<V: Vector>(&self, velocity: V, acceleration: V, _: &mut V, dt: f64) -> Drift<V> {
        let middle = velocity.plus_times(acceleration, 0.5 * dt);
        Drift { mean_velocity: middle, end_velocity: middle.plus_times(acceleration, 0.5 * dt) }
    }

    #[inline(always)]
    fn kick<V: Vector>(
        &self,
        _: V,
        mean_velocity: V,
        _: V,
        acceleration: V,
        _: &mut V,
        dt: f64,
    ) -> V {
        mean_velocity.plus_times(acceleration, 0.5 * dt)
    }
}
