//! What contacts know of their spheres: bodies themselves, or members of clumps.

use crate::particles::Record;
use crate::simd::{Numbers, V3};
use crate::threads::View;

/// What contacts gather from their spheres.
#[derive(Clone, Copy)]
pub(crate) struct SphereView<'a> {
    /// Centre; radius.
    pub(crate) position: View<'a, Record>,
    /// Of bodies: mean velocity of the step; mass.
    pub(crate) mean_velocity: View<'a, Record>,
    /// Of bodies: mean angular velocity of the step; material.
    pub(crate) mean_spin: View<'a, Record>,
    /// Of bodies: velocity foretold for now; charge.
    pub(crate) end_velocity: View<'a, Record>,
    /// Where spheres sit on bodies; without it every sphere is its own body.
    pub(crate) clumps: Option<ClumpView<'a>>,
}

/// Where spheres sit on their bodies. How they move is worked out for those that touch: a tablet has
/// ten, of which three do.
#[derive(Clone, Copy)]
pub(crate) struct ClumpView<'a> {
    /// Body of a sphere.
    pub(crate) body: &'a [u32],
    /// From the body's centre to the sphere's.
    pub(crate) arm: &'a [Record],
    /// Of bodies: angular velocity foretold for now.
    pub(crate) end_spin: &'a [Record],
    /// Step by which bodies have turned, s.
    pub(crate) dt: f64,
}

/// How a sphere moves.
#[derive(Clone, Copy)]
pub(crate) struct SphereMotion {
    /// Mean velocity of its centre over the step; mass of the body.
    pub(crate) mean_velocity: Record,
    /// Mean angular velocity; material.
    pub(crate) mean_spin: Record,
    /// Velocity of its centre foretold for now; charge.
    pub(crate) end_velocity: Record,
}

impl SphereView<'_> {
    /// Body of a sphere.
    #[inline(always)]
    pub(crate) fn body(&self, sphere: usize) -> usize {
        self.clumps.map_or(sphere, |c| c.body[sphere] as usize)
    }

    /// How a sphere moves.
    #[inline(always)]
    pub(crate) fn motion(&self, sphere: usize) -> SphereMotion {
        let Some(c) = &self.clumps else {
            return SphereMotion {
                mean_velocity: self.mean_velocity[sphere],
                mean_spin: self.mean_spin[sphere],
                end_velocity: self.end_velocity[sphere],
            };
        };
        let body = c.body[sphere] as usize;
        let (mut v, w, mut end) =
            (self.mean_velocity[body], self.mean_spin[body], self.end_velocity[body]);
        let vector = |r: &Record| V3::from(r.vector());
        let (arm, end_spin) = (vector(&c.arm[sphere]), vector(&c.end_spin[body]));
        let [mean, last] = on_arm(arm, [vector(&v), vector(&w)], [vector(&end), end_spin], c.dt);
        v.set(mean.into());
        end.set(last.into());
        SphereMotion { mean_velocity: v, mean_spin: w, end_velocity: end }
    }
}

/// Mean velocity over a step of `dt`, and velocity foretold for its end, of spheres at `arm` from their body's centre; the
/// body's velocity and spin, mean and at the end.
#[inline(always)]
pub(crate) fn on_arm<V: Numbers>(
    arm: V3<V>,
    [velocity, spin]: [V3<V>; 2],
    [end, end_spin]: [V3<V>; 2],
    dt: f64,
) -> [V3<V>; 2] {
    // The mean of the arms at both ends of the step, which the mean spin turns.
    let middle = arm - spin.cross(arm) * V::splat(0.5 * dt);
    [velocity + spin.cross(middle), end + end_spin.cross(arm)]
}
