//! Spheres alike under the usual laws where there is AVX2 alone: part of the work by part, four contacts at a time.
//!
//! The whole law of a contact is a chain of some 250 operations that wait for each other, of which the processor
//! looks ahead over a fifth, and sixteen registers hold a quarter of what it remembers on the way. So a batch of
//! contacts goes through one short loop after the other: in each, several groups of four are under way at a time and
//! what one of them needs fits the registers. What a loop hands over to the next lies in the first-level cache.
//! Operations on each contact are those of `pairs.rs`, in the same order, and so are the bits.
#![cfg(target_arch = "x86_64")]

use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
use std::mem::MaybeUninit;

use super::acting::Acting;
use super::avx::{add_pair, put_quad};
use super::carried::{Before, Remembered};
use super::half::{Half, Which};
use super::hertz_mindlin::{Features, Laws, Motion, Pressed, Pressing, answer, press, would_be};
use super::lanes::{Numbers, V3};
use super::meeting::{Line, Slide, meet, slide};
use super::pairs::{PairKernel, Sink, Sinks};
use crate::forces::ChunkYield;
use crate::neighbour::search::lowest_bits;

/// Groups of four in a batch: what lies between the loops are 9 kB.
const GROUPS: usize = 8;

/// What contacts know of their spheres, and remember.
struct Given<const FUSED: bool> {
    apart: V3<Half<FUSED>>,
    approach: V3<Half<FUSED>>,
    end: V3<Half<FUSED>>,
    spins: [V3<Half<FUSED>>; 2],
    old: Remembered<Half<FUSED>>,
}

/// Where they meet and how they press on each other.
struct Met<const FUSED: bool> {
    touching: Which,
    inverse: Half<FUSED>,
    lever: Half<FUSED>,
    pressed: Pressed<Half<FUSED>>,
}

/// How they move on each other.
struct Moved<const FUSED: bool> {
    normal: V3<Half<FUSED>>,
    slip: V3<Half<FUSED>>,
    rolling: V3<Half<FUSED>>,
    trial: V3<Half<FUSED>>,
}

/// What the loops hand over, group by group.
struct Desk<const FUSED: bool> {
    given: [MaybeUninit<Given<FUSED>>; GROUPS],
    /// In fused kernels alone.
    before: [MaybeUninit<Before<Half<FUSED>>>; GROUPS],
    met: [MaybeUninit<Met<FUSED>>; GROUPS],
    moved: [MaybeUninit<Moved<FUSED>>; GROUPS],
    deep: [u8; GROUPS],
}

/// Contacts of a batch: where the numbers of their spheres and their own in the run begin.
#[derive(Clone, Copy)]
struct Batch<'a> {
    first: &'a [[u32; 4]],
    second: &'a [[u32; 4]],
    pair: &'a [[u32; 4]],
}

impl<'a> Batch<'a> {
    /// Those from `done` on.
    #[inline(always)]
    fn of(acting: &Acting<'a>, done: usize) -> Self {
        let end = acting.pair.len().min(done + 4 * GROUPS);
        Self {
            first: acting.first[done..end].as_chunks().0,
            second: acting.second[done..end].as_chunks().0,
            pair: acting.pair[done..end].as_chunks().0,
        }
    }
}

impl PairKernel<'_> {
    /// Compute the pairs that act.
    ///
    /// # Safety
    /// AVX2 is there, every place is that of a sphere, and the sinks hold what the pairs write.
    #[inline(always)]
    pub(super) unsafe fn staged<const FUSED: bool>(
        &self,
        acting: &Acting<'_>,
        sinks: Sinks,
        into: &mut ChunkYield,
    ) {
        let mut desk = Desk::<FUSED> {
            given: [const { MaybeUninit::uninit() }; GROUPS],
            before: [const { MaybeUninit::uninit() }; GROUPS],
            met: [const { MaybeUninit::uninit() }; GROUPS],
            moved: [const { MaybeUninit::uninit() }; GROUPS],
            deep: [0; GROUPS],
        };
        let laws = Laws::splat(&self.constants[0]);
        let (mut done, mut batch) = (0, Batch::of(acting, 0));
        while !batch.pair.is_empty() {
            let next = Batch::of(acting, done + 4 * batch.pair.len());
            // SAFETY: by the caller; each loop reads what those before it have written of the batch.
            unsafe {
                self.gather(&mut desk, batch, sinks);
                self.press_all(&mut desk, batch.pair.len(), acting.count - done, &laws);
                self.move_all(&mut desk, batch.pair.len(), next, sinks);
                self.answer_all(&desk, batch, sinks, &laws);
            }
            let groups = batch.first.iter().zip(batch.second).zip(desk.deep);
            for ((first, second), deep) in groups.filter(|(_, deep)| *deep != 0) {
                self.note_deep(deep, first, second, into);
            }
            (done, batch) = (done + 4 * batch.pair.len(), next);
        }
    }

    /// Gather what a batch knows.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn gather<const FUSED: bool>(
        &self,
        desk: &mut Desk<FUSED>,
        batch: Batch<'_>,
        sinks: Sinks,
    ) {
        let s = &self.spheres;
        let position = s.position.as_ptr().cast();
        let velocity = s.mean_velocity.as_ptr().cast();
        let end = s.end_velocity.as_ptr().cast();
        let spin = s.mean_spin.as_ptr().cast();
        let groups = batch.first.iter().zip(batch.second).zip(batch.pair);
        for (((i, j), pair), to) in groups.zip(&mut desk.given) {
            // SAFETY: by the caller.
            unsafe {
                let mut apart = Half::differences(position, j, i);
                if let Some(p) = self.period {
                    apart = apart.shortest(p);
                }
                let approach = Half::differences(velocity, i, j);
                let end = Half::differences(end, i, j);
                let spins = [V3::of(Half::quads(spin, i)), V3::of(Half::quads(spin, j))];
                let [x, y, z, stiffness] = Half::quads(sinks.memory, pair);
                let old = Remembered { spring: V3 { x, y, z }, stiffness };
                to.write(Given { apart, approach, end, spins, old });
            }
        }
    }

    /// Distances, normal forces and stiffnesses of so many groups, of which `count` contacts matter.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn press_all<const FUSED: bool>(
        &self,
        desk: &mut Desk<FUSED>,
        groups: usize,
        count: usize,
        laws: &Laws<Half<FUSED>>,
    ) {
        let size = self.one_size.unwrap_or_default();
        let (radius, (r_star, m_star)) = (Half::splat(size[0]), PairKernel::reduced(size));
        for g in 0..groups.min(GROUPS) {
            // SAFETY: by the caller.
            let Given { apart, end, old, .. } = unsafe { desk.given[g].assume_init_ref() };
            let valid = Which::of(lowest_bits(count.saturating_sub(4 * g)));
            let met = meet(*apart, [radius; 2], old, valid, self.overlap_limit);
            desk.deep[g] = met.deep.bits();
            if FUSED {
                desk.before[g].write(met.before);
            }
            let rate = Line::of(*apart, met.inverse).along(*end);
            desk.met[g].write(Met {
                touching: met.touching,
                inverse: met.inverse,
                lever: radius.less_times(Half::splat(0.5), met.overlap),
                pressed: press(&Pressing { overlap: met.overlap, rate, r_star, m_star }, laws),
            });
        }
    }

    /// Slip and springs, if nothing slid, of so many groups; what the next batch needs is asked of the memory.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn move_all<const FUSED: bool>(
        &self,
        desk: &mut Desk<FUSED>,
        groups: usize,
        next: Batch<'_>,
        sinks: Sinks,
    ) {
        for g in 0..groups.min(GROUPS) {
            if let (Some(second), Some(pair)) = (next.second.get(g), next.pair.get(g)) {
                self.ask(second, pair, sinks);
            }
            // SAFETY: by the caller.
            let (given, met, before) = unsafe {
                let before = if FUSED { desk.before[g].assume_init() } else { Before::nothing() };
                (desk.given[g].assume_init_ref(), desk.met[g].assume_init_ref(), before)
            };
            let line = Line::of(given.apart, met.inverse);
            let Slide { slip, rolling, twist } =
                slide::<_, true>(&line, given.approach, given.spins, [met.lever; 2], self.dt);
            let trial = would_be(
                [line.normal, slip],
                twist,
                Half::splat(self.dt),
                &met.pressed,
                (&given.old, &before),
                Features::NONE.form(),
                met.touching,
            );
            desk.moved[g].write(Moved { normal: line.normal, slip, rolling, trial });
        }
    }

    /// Ask the memory for what contacts gather of their second spheres, and remember: first spheres were those of
    /// contacts before.
    #[inline(always)]
    fn ask(&self, second: &[u32; 4], pair: &[u32; 4], sinks: Sinks) {
        let s = &self.spheres;
        let records = [&s.mean_velocity, &s.mean_spin, &s.end_velocity];
        for (sphere, pair) in second.iter().zip(pair) {
            for from in records {
                let at = from.as_ptr().cast::<f64>().wrapping_add(*sphere as usize);
                // SAFETY: nothing is read.
                unsafe { _mm_prefetch::<_MM_HINT_T0>(at.cast()) }
            }
            let at = sinks.memory.wrapping_add(*pair as usize);
            // SAFETY: as above.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(at.cast_const().cast()) }
        }
    }

    /// Friction and rolling; what comes of it goes to the sinks.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn answer_all<const FUSED: bool>(
        &self,
        desk: &Desk<FUSED>,
        batch: Batch<'_>,
        sinks: Sinks,
        laws: &Laws<Half<FUSED>>,
    ) {
        let (zero, none) = (Half::splat(0.0), V3::splat(0.0));
        let size = self.one_size.unwrap_or_default();
        let (radius, (r_star, _)) =
            (Half::splat(size[0]), PairKernel::reduced::<Half<FUSED>>(size));
        let groups = batch.first.iter().zip(batch.second).zip(batch.pair);
        for (g, ((first, second), pair)) in groups.enumerate().take(GROUPS) {
            // SAFETY: by the caller.
            let (old, met, moved) = unsafe {
                let old = desk.given[g].assume_init_ref().old.stiffness;
                (old, desk.met[g].assume_init_ref(), desk.moved[g].assume_init_ref())
            };
            let motion = Motion {
                normal: moved.normal,
                slip: moved.slip,
                rolling: moved.rolling,
                lever_i: met.lever,
                lever_j: met.lever,
                r_star,
                // The usual laws do without.
                spin_i: none,
                spin_j: none,
                overlap: zero,
                radius_i: radius,
                radius_j: radius,
            };
            let out = answer::<_, false, true>(
                &motion,
                laws,
                Features::NONE,
                &met.pressed,
                moved.trial,
                old,
                met.touching,
            );
            let used = met.touching;
            let force = Half::rows(out.force, zero, used);
            let torques =
                [Half::rows(out.torque_i, zero, used), Half::rows(out.torque_j, zero, used)];
            // SAFETY: by the caller.
            unsafe {
                let spring = Half::rows(out.spring, out.stiffness, used);
                for (at, spring) in pair.iter().zip(spring) {
                    put_quad(sinks.memory, *at, spring);
                }
                match sinks.wrenches {
                    Sink::Kept(to) => {
                        for (rows, to) in [force, torques[0], torques[1]].into_iter().zip(to) {
                            for (at, row) in pair.iter().zip(rows) {
                                put_quad(to, *at, row);
                            }
                        }
                    }
                    Sink::Summed(to, within) => {
                        for k in 0..4 {
                            let at = [2 * (first[k] & within), 2 * (second[k] & within)];
                            add_pair(to, at, [force[k], torques[0][k], torques[1][k]]);
                        }
                    }
                }
            }
        }
    }
}
