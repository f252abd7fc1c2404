//! What batches of contacts gather for `staged.rs`, four contacts at a time.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
use std::mem::MaybeUninit;

use super::acting::Acting;
use super::avx::beginning;
use super::carried::Remembered;
use super::group::Group;
use super::half::Half;
use super::lanes::V3;
use super::meeting::Spins;
use super::pairs::{PairKernel, bodies_of};
use crate::spheres::{ClumpView, between, on_arm};

/// Groups of four in a batch: what lies between the loops of spheres alike are 10 kB.
pub(super) const GROUPS: usize = 8;

/// Contacts of a batch: where the numbers of their spheres and their own in the run begin.
#[derive(Clone, Copy)]
pub(super) struct Batch<'a> {
    pub(super) first: &'a [[u32; 4]],
    pub(super) second: &'a [[u32; 4]],
    pub(super) pair: &'a [[u32; 4]],
}

impl<'a> Batch<'a> {
    /// Those from `done` on.
    #[inline(always)]
    pub(super) fn of(acting: &Acting<'a>, done: usize) -> Self {
        let end = acting.pair.len().min(done + 4 * GROUPS);
        Self {
            first: acting.first[done..end].as_chunks().0,
            second: acting.second[done..end].as_chunks().0,
            pair: acting.pair[done..end].as_chunks().0,
        }
    }
}

/// What contacts know of their spheres, and remember.
pub(super) struct Given<const FUSED: bool> {
    pub(super) apart: V3<Half<FUSED>>,
    pub(super) approach: V3<Half<FUSED>>,
    pub(super) end: V3<Half<FUSED>>,
    /// Of both, or their sum and the first's less the second's (`by_sums`).
    pub(super) spins: [V3<Half<FUSED>>; 2],
    pub(super) old: Remembered<Half<FUSED>>,
}

/// Whether the laws need no more of spins than their sums and differences: `spins` of what is given holds those then.
const fn by_sums(fused: bool, alike: bool, more: bool) -> bool {
    fused && alike && !more
}

impl<const FUSED: bool> Given<FUSED> {
    /// How both spheres spin.
    #[inline(always)]
    pub(super) fn spins<const ALIKE: bool, const MORE: bool>(&self) -> Spins<Half<FUSED>> {
        if !by_sums(FUSED, ALIKE, MORE) {
            return Spins::of(self.spins);
        }
        let [sum, difference] = self.spins;
        // Nobody asks for each.
        Spins { each: self.spins, sum, difference }
    }
}

/// Of spheres that are not alike.
#[derive(Clone, Copy)]
pub(super) struct Sizes<const FUSED: bool> {
    pub(super) radii: [Half<FUSED>; 2],
    /// Effective radius and mass.
    pub(super) reduced: [Half<FUSED>; 2],
}

impl<const FUSED: bool> Sizes<FUSED> {
    #[inline(always)]
    fn of([ri, rj]: [Half<FUSED>; 2], [mi, mj]: [Half<FUSED>; 2]) -> Self {
        Self { radii: [ri, rj], reduced: [ri * rj / (ri + rj), mi * mj / (mi + mj)] }
    }
}

/// Of spheres on clumps: where the numbers of their bodies begin, and where they sit on them.
pub(super) struct Seated<const FUSED: bool> {
    pub(super) bodies: [[u32; 4]; 2],
    pub(super) arms: [V3<Half<FUSED>>; 2],
}

/// What the groups of a batch know.
pub(super) struct Gathered<const FUSED: bool> {
    pub(super) given: [MaybeUninit<Given<FUSED>>; GROUPS],
    /// Where spheres are not alike.
    pub(super) sizes: [MaybeUninit<Sizes<FUSED>>; GROUPS],
    /// Where spheres sit on clumps.
    pub(super) seated: [MaybeUninit<Seated<FUSED>>; GROUPS],
}

impl<const FUSED: bool> Gathered<FUSED> {
    /// Nothing yet.
    pub(super) const NONE: Self = Self {
        given: [const { MaybeUninit::uninit() }; GROUPS],
        sizes: [const { MaybeUninit::uninit() }; GROUPS],
        seated: [const { MaybeUninit::uninit() }; GROUPS],
    };
}

/// How spheres on clumps move.
struct OnClump<const FUSED: bool> {
    arm: V3<Half<FUSED>>,
    /// Mean velocity and mass.
    mean: [Half<FUSED>; 4],
    spin: V3<Half<FUSED>>,
    end: V3<Half<FUSED>>,
}

/// What contacts remember, whose numbers begin there.
///
/// # Safety
/// The instructions of the group are there and all numbers can be read.
#[inline(always)]
pub(super) unsafe fn remembered<V: Group<N>, const N: usize>(
    from: *const f64,
    at: &[u32; N],
) -> Remembered<V> {
    // SAFETY: by the caller.
    let [x, y, z, stiffness] = unsafe { V::quads::<1>(from, at) };
    Remembered { spring: V3 { x, y, z }, stiffness }
}

/// Ask the memory for four numbers from `EACH` times a beginning on.
#[inline(always)]
fn ask_for<const EACH: usize>(from: *const f64, at: u32) {
    // SAFETY: nothing is read.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(beginning(from, EACH * at as usize).cast()) }
}

impl PairKernel<'_> {
    /// Gather what the contacts of a batch know, of spheres that are `ALIKE` or of any two, by the usual law or by
    /// `MORE`, which may sit on `CLUMPS` or do not.
    ///
    /// # Safety
    /// AVX2 is there, every place is that of a sphere, and the contacts' memory begins at `memory`.
    #[inline(always)]
    pub(super) unsafe fn gather<
        const FUSED: bool,
        const ALIKE: bool,
        const MORE: bool,
        const CLUMPS: bool,
    >(
        &self,
        to: &mut Gathered<FUSED>,
        batch: Batch<'_>,
        memory: *const f64,
    ) {
        let s = &self.spheres;
        let position = s.position.as_ptr().cast();
        let [velocity, end] = s.numbers_of_velocities();
        let spin = s.mean_spin.as_ptr().cast();
        let groups = batch.first.iter().zip(batch.second).zip(batch.pair);
        for (g, ((i, j), pair)) in groups.enumerate().take(GROUPS) {
            // SAFETY: by the caller.
            unsafe {
                if ALIKE {
                    let mut apart = Half::differences::<1>(position, j, i);
                    if let Some(p) = self.period {
                        apart = apart.shortest(p);
                    }
                    // Field by field: all of them together are more than the registers hold.
                    let to = to.given[g].as_mut_ptr();
                    (&raw mut (*to).apart).write(apart);
                    (&raw mut (*to).old).write(remembered(memory, pair));
                    let [approach, end] = Half::differences_of_twos(velocity, i, j);
                    (&raw mut (*to).approach).write(approach);
                    (&raw mut (*to).end).write(end);
                    if by_sums(FUSED, ALIKE, MORE) {
                        let [sum, less] = Half::sums_and_differences(spin, i, j);
                        (&raw mut (*to).spins[0]).write(sum);
                        (&raw mut (*to).spins[1]).write(less);
                        continue;
                    }
                    (&raw mut (*to).spins[0]).write(V3::of(Half::quads::<1>(spin, i)));
                    (&raw mut (*to).spins[1]).write(V3::of(Half::quads::<1>(spin, j)));
                    continue;
                }
                let old = remembered(memory, pair);
                let (xi, xj) = (Half::quads::<1>(position, i), Half::quads::<1>(position, j));
                let mut apart = V3::of(xj) - V3::of(xi);
                if let Some(p) = self.period {
                    apart = apart.shortest(p);
                }
                if CLUMPS
                    && FUSED
                    && let Some(c) = &s.clumps
                {
                    let (given, seated) = (to.given[g].as_mut_ptr(), to.seated[g].as_mut_ptr());
                    (&raw mut (*given).apart).write(apart);
                    (&raw mut (*given).old).write(old);
                    let masses = self.gather_on_clumps(c, (given, seated), [i, j], [xi, xj]);
                    to.sizes[g].write(Sizes::of([xi[3], xj[3]], masses));
                    continue;
                }
                let clumps = if CLUMPS { s.clumps.as_ref() } else { None };
                let (vi, vj, end, spins) = if let Some(c) = clumps {
                    let bodies = [bodies_of(c, i), bodies_of(c, j)];
                    let a = self.on_clump(c, &bodies[0], V3::of(xi));
                    let b = self.on_clump(c, &bodies[1], V3::of(xj));
                    to.seated[g].write(Seated { bodies, arms: [a.arm, b.arm] });
                    (a.mean, b.mean, a.end - b.end, [a.spin, b.spin])
                } else {
                    let end = Half::differences::<2>(end, i, j);
                    let spins =
                        [V3::of(Half::quads::<1>(spin, i)), V3::of(Half::quads::<1>(spin, j))];
                    (Half::quads::<2>(velocity, i), Half::quads::<2>(velocity, j), end, spins)
                };
                to.sizes[g].write(Sizes::of([xi[3], xj[3]], [vi[3], vj[3]]));
                let approach = V3::of(vi) - V3::of(vj);
                to.given[g].write(Given { apart, approach, end, spins, old });
            }
        }
    }

    /// How spheres at `positions` on clumps move on each other, by fused kernels; returns the masses of their bodies.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn gather_on_clumps<const FUSED: bool>(
        &self,
        c: &ClumpView<'_>,
        (given, seated): (*mut Given<FUSED>, *mut Seated<FUSED>),
        [i, j]: [&[u32; 4]; 2],
        positions: [[Half<FUSED>; 4]; 2],
    ) -> [Half<FUSED>; 2] {
        let s = &self.spheres;
        let [mean, _] = s.numbers_of_velocities();
        // SAFETY: by the caller.
        unsafe {
            let bodies = [bodies_of(c, i), bodies_of(c, j)];
            (&raw mut (*seated).bodies).write(bodies);
            let mut moves =
                Half::differences_of_twos(s.velocities.as_ptr().cast(), &bodies[0], &bodies[1]);
            for k in 0..2 {
                let centre = V3::of(Half::quads::<1>(c.centre.as_ptr().cast(), &bodies[k]));
                let arm = V3::of(positions[k]) - centre;
                let spin = V3::of(Half::quads::<1>(s.mean_spin.as_ptr().cast(), &bodies[k]));
                (&raw mut (*seated).arms[k]).write(arm);
                (&raw mut (*given).spins[k]).write(spin);
                let end_spin = V3::of(Half::quads::<1>(c.end_spin.as_ptr().cast(), &bodies[k]));
                moves = between(moves, arm, [spin, end_spin], c.dt, k == 1);
            }
            (&raw mut (*given).approach).write(moves[0]);
            (&raw mut (*given).end).write(moves[1]);
            [Half::fields::<2>(mean.add(3), &bodies[0]), Half::fields::<2>(mean.add(3), &bodies[1])]
        }
    }

    /// `on_clump` of four spheres at `position` on bodies whose numbers begin there.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn on_clump<const FUSED: bool>(
        &self,
        c: &ClumpView<'_>,
        bodies: &[u32; 4],
        position: V3<Half<FUSED>>,
    ) -> OnClump<FUSED> {
        let s = &self.spheres;
        // SAFETY: by the caller.
        unsafe {
            let arm = position - V3::of(Half::quads::<1>(c.centre.as_ptr().cast(), bodies));
            let [mean, end] = s.numbers_of_velocities();
            let v = Half::quads::<2>(mean, bodies);
            let spin = V3::of(Half::quads::<1>(s.mean_spin.as_ptr().cast(), bodies));
            let end = V3::of(Half::quads::<2>(end, bodies));
            let end_spin = V3::of(Half::quads::<1>(c.end_spin.as_ptr().cast(), bodies));
            let [mean, end] = on_arm(arm, [V3::of(v), spin], [end, end_spin], c.dt);
            OnClump { arm, mean: [mean.x, mean.y, mean.z, v[3]], spin, end }
        }
    }

    /// Ask the memory for what contacts gather of their spheres, and remember, by the places of both and their own: first bodies
    /// were those of contacts before.
    ///
    /// # Safety
    /// They are spheres.
    #[inline(always)]
    pub(super) unsafe fn ask<const CLUMPS: bool>(
        &self,
        [first, second, pair]: [&[u32; 4]; 3],
        memory: *const f64,
    ) {
        let s = &self.spheres;
        let clumps = if CLUMPS { s.clumps.as_ref() } else { None };
        if clumps.is_some() {
            // No look has read where they are if contacts acted before; those of single spheres `one_pass.rs` asks for.
            for sphere in first.iter().chain(second) {
                ask_for::<1>(s.position.as_ptr().cast(), *sphere);
            }
        }
        // SAFETY: by the caller.
        let bodies = clumps.map_or(*second, |c| unsafe { bodies_of(c, second) });
        for (body, pair) in bodies.into_iter().zip(pair) {
            ask_for::<1>(s.mean_spin.as_ptr().cast(), body);
            ask_for::<2>(s.velocities.as_ptr().cast(), body);
            if let Some(c) = clumps {
                ask_for::<1>(c.centre.as_ptr().cast(), body);
                ask_for::<1>(c.end_spin.as_ptr().cast(), body);
            }
            ask_for::<1>(memory, *pair);
        }
    }
}
