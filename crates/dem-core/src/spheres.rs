//! What contacts know of their spheres: bodies themselves, or members of clumps.

use crate::forces::Wrench;
use crate::particles::{END, MEAN, Record, Velocities};
use crate::simd::{Numbers, V3, fetch};
use crate::threads::View;

/// What contacts gather from their spheres.
#[derive(Clone, Copy)]
pub(crate) struct SphereView<'a> {
    /// Centre; radius.
    pub(crate) position: View<'a, Record>,
    /// Of bodies: mean velocity of the step and mass; velocity foretold for its end and charge.
    pub(crate) velocities: View<'a, Velocities>,
    /// Of bodies: mean angular velocity of the step; material.
    pub(crate) mean_spin: View<'a, Record>,
    /// Where spheres sit on bodies; without it every sphere is its own body.
    pub(crate) clumps: Option<ClumpView<'a>>,
}

/// Where spheres sit on their bodies. How they move is worked out for those that touch: a tablet has
/// ten, of which three do.
#[derive(Clone, Copy)]
pub(crate) struct ClumpView<'a> {
    /// Body of a sphere.
    pub(crate) body: &'a [u32],
    /// Centres of the bodies.
    pub(crate) centre: View<'a, Record>,
    /// Of bodies: angular velocity foretold for now.
    pub(crate) end_spin: View<'a, Record>,
    /// Step by which bodies have turned, s.
    pub(crate) dt: f64,
}

/// Which bodies spheres sit on: each on its own, or by places of spheres the bodies and by those of bodies their first spheres.
#[derive(Clone, Copy)]
pub(crate) struct Seats<'a>(pub(crate) Option<(&'a [u32], &'a [u32])>);

impl Seats<'_> {
    /// Every sphere is its own body.
    pub(crate) const OWN: Self = Self(None);

    /// Body of a sphere.
    #[inline(always)]
    pub(crate) fn body(self, sphere: usize) -> usize {
        self.0.map_or(sphere, |(body, _)| body[sphere] as usize)
    }

    /// First sphere of a body; behind the last body, how many spheres there are.
    #[inline(always)]
    pub(crate) fn first(self, body: usize) -> usize {
        self.0.map_or(body, |(_, first)| first[body] as usize)
    }
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

    /// Ask the memory for what contacts read of some bodies.
    pub(crate) fn fetch(&self, bodies: std::ops::Range<usize>) {
        fetch(self.clumps.map_or(self.position, |c| c.centre), bodies.clone());
        fetch(self.velocities, bodies.clone());
        fetch(self.mean_spin, bodies);
    }

    /// Where the numbers of mean velocities begin, and those of the ones foretold; those of the next body follow behind two records.
    #[inline(always)]
    pub(crate) fn numbers_of_velocities(&self) -> [*const f64; 2] {
        [MEAN, END].map(
            #[inline(always)]
            |which| self.velocities.as_ptr().cast::<Record>().wrapping_add(which).cast(),
        )
    }

    /// From the body's centre to the sphere's.
    #[inline(always)]
    fn arm(&self, sphere: usize) -> V3<f64> {
        let Some(c) = &self.clumps else { return V3::splat(0.0) };
        let (own, centre) = (&self.position[sphere], &c.centre[c.body[sphere] as usize]);
        V3::from(own.vector()) - V3::from(centre.vector())
    }

    /// A wrench between two spheres, with torques about the centres of their bodies.
    #[inline(always)]
    pub(crate) fn about_bodies(&self, first: u32, second: u32, wrench: Wrench) -> Wrench {
        if self.clumps.is_none() {
            return wrench;
        }
        let about = |sphere: u32| self.arm(sphere as usize).cross(wrench.force.into());
        let [on_first, on_second] = [wrench.torque_on_first, wrench.torque_on_second].map(V3::from);
        Wrench {
            torque_on_first: (on_first + about(first)).into(),
            torque_on_second: (on_second - about(second)).into(),
            ..wrench
        }
    }

    /// How a sphere moves.
    #[inline(always)]
    pub(crate) fn motion(&self, sphere: usize) -> SphereMotion {
        let Some(c) = &self.clumps else {
            let [mean_velocity, end_velocity] = self.velocities[sphere];
            return SphereMotion { mean_velocity, mean_spin: self.mean_spin[sphere], end_velocity };
        };
        let body = c.body[sphere] as usize;
        let ([mut v, mut end], w) = (self.velocities[body], self.mean_spin[body]);
        let vector = |r: &Record| V3::from(r.vector());
        let (arm, end_spin) = (self.arm(sphere), vector(&c.end_spin[body]));
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

/// The same of one of two spheres, by fused kernels: added to how their bodies' centres move on each other, mean and foretold,
/// or as the `second` one's taken away.
#[inline(always)]
pub(crate) fn between<V: Numbers>(
    [velocity, end]: [V3<V>; 2],
    arm: V3<V>,
    [spin, end_spin]: [V3<V>; 2],
    dt: f64,
    second: bool,
) -> [V3<V>; 2] {
    let middle = arm.less_times(spin.cross(arm), V::splat(0.5 * dt));
    if second {
        [middle.cross_plus(spin, velocity), arm.cross_plus(end_spin, end)]
    } else {
        [spin.cross_plus(middle, velocity), end_spin.cross_plus(arm, end)]
    }
}
