//! Beeman's scheme.
//!
//! `x' = x + v dt + (4 a - a_old) dt^2 / 6`, `v' = v + (2 a' + 5 a - a_old) dt / 6`. Its
//! positions are those of Verlet. A global order of 3 is often stated for it; what it measures,
//! in position and velocity, is 2. It is not self-starting: the first step takes `a_old = a`.
//! Beeman, J. Comput. Phys. 20 (1976) 130, doi:10.1016/0021-9991(76)90059-0.

use glam::DVec3;

use super::{Drift, Integrator, Vector};

/// Beeman.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Beeman;

impl Integrator for Beeman {
    const ORDER: u32 = 2;
    const REMEMBERS: bool = true;

    #[inline(always)]
    fn start(&self, _: DVec3, acceleration: DVec3, _: f64) -> DVec3 {
        acceleration
    }

    #[inline(always)]
    fn drift<V: Vector>(&self, velocity: V, acceleration: V, memory: &mut V, dt: f64) -> Drift<V> {
        Drift {
            mean_velocity: velocity + (acceleration * 4.0 - *memory) * (dt / 6.0),
            end_velocity: velocity + (acceleration * 3.0 - *memory) * (0.5 * dt),
        }
    }

    #[inline(always)]
    fn kick<V: Vector>(
        &self,
        velocity: V,
        _: V,
        old_acceleration: V,
        acceleration: V,
        memory: &mut V,
        dt: f64,
    ) -> V {
        let older = std::mem::replace(memory, old_acceleration);
        velocity + (acceleration * 2.0 + old_acceleration * 5.0 - older) * (dt / 6.0)
    }
}
