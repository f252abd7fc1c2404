//! Contacts of one law where there is AVX2 alone: part of the work by part, four contacts at a time.
//!
//! The whole law of a contact is a chain of some 250 operations that wait for each other, of which the processor
//! looks ahead over a fifth, and sixteen registers hold a quarter of what it remembers on the way. So a batch of
//! contacts goes through one short loop after the other: in each, several groups of four are under way at a time and
//! what one of them needs fits the registers. What a loop hands over to the next lies in the first-level cache.
//! Operations on each contact are those of `pairs.rs`, in the same order, and so are the bits.
#![cfg(target_arch = "x86_64")]

use std::mem::MaybeUninit;

use super::acting::Acting;
use super::avx::{add_pair, put_quad};
use super::carried::Before;
use super::gathering::{Batch, GROUPS, Gathered, Given, Seated, Sizes};
use super::group::Group;
use super::half::{Half, Which};
use super::hertz_mindlin::{
    Features, Laws, Motion, Pressed, Squeezed, answer, damp, hold, squeeze, would_be,
};
use super::lanes::{Mask, Numbers, V3};
use super::meeting::{Line, Slide, meet, slide, too_deep};
use super::pairs::{PairKernel, Sink, Sinks};
use crate::forces::ChunkYield;
use crate::neighbour::search::lowest_bits;

/// Where they meet and how they press on each other.
struct Met<const FUSED: bool> {
    touching: Which,
    inverse: Half<FUSED>,
    overlap: Half<FUSED>,
    /// Radius of the contact.
    a: Half<FUSED>,
    /// Force without dashpots.
    elastic: Half<FUSED>,
}

/// How they move on each other.
struct Moved<const FUSED: bool> {
    normal: V3<Half<FUSED>>,
    slip: V3<Half<FUSED>>,
    rolling: V3<Half<FUSED>>,
    trial: V3<Half<FUSED>>,
    pressed: Pressed<Half<FUSED>>,
}

/// What the loops hand over, group by group.
struct Desk<const FUSED: bool> {
    gathered: Gathered<FUSED>,
    /// In fused kernels alone.
    before: [MaybeUninit<Before<Half<FUSED>>>; GROUPS],
    met: [MaybeUninit<Met<FUSED>>; GROUPS],
    moved: [MaybeUninit<Moved<FUSED>>; GROUPS],
}

impl PairKernel<'_> {
    /// Compute the pairs that act, of spheres that are `ALIKE` or of any two, by the usual law or by `MORE`: by one law
    /// in any case. Only where there may be `CLUMPS` do spheres sit on them.
    ///
    /// # Safety
    /// AVX2 is there, every place is that of a sphere, and the sinks hold what the pairs write.
    #[inline(always)]
    pub(super) unsafe fn staged<
        const FUSED: bool,
        const ALIKE: bool,
        const MORE: bool,
        const CLUMPS: bool,
    >(
        &self,
        acting: &Acting<'_>,
        sinks: Sinks,
        into: &mut ChunkYield,
    ) {
        let mut desk = Desk::<FUSED> {
            gathered: Gathered::NONE,
            before: [const { MaybeUninit::uninit() }; GROUPS],
            met: [const { MaybeUninit::uninit() }; GROUPS],
            moved: [const { MaybeUninit::uninit() }; GROUPS],
        };
        let laws = Laws::splat(&self.constants[0]);
        let (mut done, mut batch) = (0, Batch::of(acting, 0));
        while !batch.pair.is_empty() {
            let next = Batch::of(acting, done + 4 * batch.pair.len());
            // SAFETY: by the caller; each loop reads what those before it have written of the batch.
            let deep = unsafe {
                self.gather::<FUSED, ALIKE, MORE, CLUMPS>(&mut desk.gathered, batch, sinks.memory);
                let left = acting.count - done;
                let deep = self.press_all::<FUSED, ALIKE>(&mut desk, (batch, sinks), left, &laws);
                self.move_all::<FUSED, ALIKE, MORE, CLUMPS>(
                    &mut desk,
                    batch.pair.len(),
                    next,
                    sinks,
                    &laws,
                );
                self.answer_all::<FUSED, ALIKE, MORE, CLUMPS>(&desk, batch, sinks, &laws);
                deep
            };
            if !deep.is_empty() {
                // SAFETY: as above.
                unsafe { self.note_deep_of::<FUSED, ALIKE>(&desk, batch, into) };
            }
            (done, batch) = (done + 4 * batch.pair.len(), next);
        }
    }

    /// Note contacts of a batch that overlap too deeply.
    ///
    /// # Safety
    /// As above.
    #[cold]
    #[inline(never)]
    unsafe fn note_deep_of<const FUSED: bool, const ALIKE: bool>(
        &self,
        desk: &Desk<FUSED>,
        batch: Batch<'_>,
        into: &mut ChunkYield,
    ) {
        for (g, (first, second)) in batch.first.iter().zip(batch.second).enumerate() {
            // SAFETY: by the caller.
            let (Met { overlap, touching, .. }, sizes) =
                unsafe { (desk.met[g].assume_init_ref(), self.sizes::<FUSED, ALIKE>(desk, g)) };
            let deep = too_deep(sizes.radii, self.overlap_limit).less(*overlap) & *touching;
            self.note_deep(deep.bits(), first, second, into);
        }
    }

    /// Radii, effective radius and effective mass of a group.
    ///
    /// # Safety
    /// The group was gathered.
    #[inline(always)]
    unsafe fn sizes<const FUSED: bool, const ALIKE: bool>(
        &self,
        desk: &Desk<FUSED>,
        g: usize,
    ) -> Sizes<FUSED> {
        if ALIKE {
            let size = self.one_size.unwrap_or_default();
            let (r_star, m_star) = PairKernel::reduced(size);
            return Sizes { radii: [Half::splat(size[0]); 2], reduced: [r_star, m_star] };
        }
        // SAFETY: by the caller.
        unsafe { desk.gathered.sizes[g].assume_init() }
    }

    /// Distances, normal forces and stiffnesses of a batch, of which `count` contacts matter; those that touch no more lose their
    /// marks.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn press_all<const FUSED: bool, const ALIKE: bool>(
        &self,
        desk: &mut Desk<FUSED>,
        (batch, sinks): (Batch<'_>, Sinks),
        count: usize,
        laws: &Laws<Half<FUSED>>,
    ) -> Which {
        let mut any_deep = Which::of(0);
        for (g, pairs) in batch.pair.iter().enumerate().take(GROUPS) {
            // SAFETY: by the caller.
            let (Given { apart, old, .. }, sizes) = unsafe {
                (desk.gathered.given[g].assume_init_ref(), self.sizes::<FUSED, ALIKE>(desk, g))
            };
            let valid = if 4 * g + 4 <= count {
                Which::of(0xf)
            } else {
                Which::of(lowest_bits(count.saturating_sub(4 * g)) & 0xf)
            };
            let met = meet(*apart, sizes.radii, old, valid, self.overlap_limit);
            // SAFETY: by the caller.
            unsafe { sinks.unmark((valid & !met.touching).bits(), pairs) };
            any_deep = any_deep | met.deep;
            if FUSED {
                desk.before[g].write(met.before);
            }
            let [r_star, m_star] = sizes.reduced;
            // Nothing where they do not touch: nothing else comes of it then.
            let overlap = met.overlap.only(met.touching);
            let squeezed = squeeze::<_, ALIKE>(overlap, [r_star, m_star], laws);
            desk.met[g].write(Met {
                touching: met.touching,
                inverse: met.inverse,
                overlap,
                a: squeezed.a,
                elastic: squeezed.elastic,
            });
        }
        any_deep
    }

    /// Arms of the forces on both spheres of a group.
    #[inline(always)]
    fn levers<const FUSED: bool>(sizes: &Sizes<FUSED>, overlap: Half<FUSED>) -> [Half<FUSED>; 2] {
        let [ri, rj] = sizes.radii;
        [ri.less_times(Half::splat(0.5), overlap), rj.less_times(Half::splat(0.5), overlap)]
    }

    /// Slip and springs, if nothing slid, of so many groups; what the next batch needs is asked of the memory.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn move_all<
        const FUSED: bool,
        const ALIKE: bool,
        const MORE: bool,
        const CLUMPS: bool,
    >(
        &self,
        desk: &mut Desk<FUSED>,
        groups: usize,
        next: Batch<'_>,
        sinks: Sinks,
        laws: &Laws<Half<FUSED>>,
    ) {
        for g in 0..groups.min(GROUPS) {
            let next = (next.first.get(g), next.second.get(g), next.pair.get(g));
            if let (Some(first), Some(second), Some(pair)) = next {
                // SAFETY: by the caller.
                unsafe { self.ask::<CLUMPS>([first, second, pair], sinks.memory) };
            }
            // SAFETY: by the caller.
            let (given, met, sizes) = unsafe {
                let sizes = self.sizes::<FUSED, ALIKE>(desk, g);
                (desk.gathered.given[g].assume_init_ref(), desk.met[g].assume_init_ref(), sizes)
            };
            let to = desk.moved[g].as_mut_ptr();
            let line = Line::of(given.apart, met.inverse);
            let rate = line.along(given.end);
            let levers = Self::levers(&sizes, met.overlap);
            let spins = given.spins::<ALIKE, MORE>();
            let Slide { slip, rolling, twist } =
                slide::<_, ALIKE>(&line, given.approach, &spins, levers, self.dt);
            // Field by field: what is not needed here any more leaves the registers.
            // SAFETY: room for it.
            unsafe {
                (&raw mut (*to).normal).write(line.normal);
                (&raw mut (*to).rolling).write(rolling);
                (&raw mut (*to).slip).write(slip);
            }
            // Here that root never comes with the radius.
            let squeezed = Squeezed { a: met.a, inertia: None, elastic: met.elastic };
            let pressed = damp(&squeezed, [rate, sizes.reduced[1]], laws);
            // SAFETY: room for it; by the caller.
            let before = unsafe {
                (&raw mut (*to).pressed).write(pressed);
                if FUSED { desk.before[g].assume_init() } else { Before::nothing() }
            };
            let features = if MORE { self.features } else { Features::NONE };
            let trial = would_be(
                [line.normal, slip],
                twist,
                Half::splat(self.dt),
                &pressed,
                (&given.old, &before),
                features.form(),
                met.touching,
            );
            // SAFETY: room for it.
            unsafe { (&raw mut (*to).trial).write(trial) };
        }
    }

    /// Friction and rolling; what comes of it goes to the sinks.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn answer_all<
        const FUSED: bool,
        const ALIKE: bool,
        const MORE: bool,
        const CLUMPS: bool,
    >(
        &self,
        desk: &Desk<FUSED>,
        batch: Batch<'_>,
        sinks: Sinks,
        laws: &Laws<Half<FUSED>>,
    ) {
        let (zero, none) = (Half::splat(0.0), V3::splat(0.0));
        let features = if MORE { self.features } else { Features::NONE };
        let groups = batch.first.iter().zip(batch.second).zip(batch.pair);
        for (g, ((first, second), pair)) in groups.enumerate().take(GROUPS) {
            // SAFETY: by the caller.
            let (given, met, moved, sizes) = unsafe {
                let (given, met) =
                    (desk.gathered.given[g].assume_init_ref(), desk.met[g].assume_init_ref());
                (given, met, desk.moved[g].assume_init_ref(), self.sizes::<FUSED, ALIKE>(desk, g))
            };
            let used = met.touching;
            let held = hold(laws, features, &moved.pressed, moved.trial, given.old.stiffness, used);
            // SAFETY: by the caller.
            unsafe { Half::put_used(held.spring, held.stiffness, used, sinks.memory, pair) };
            let [lever_i, lever_j] = Self::levers(&sizes, met.overlap);
            // The usual laws do without spins.
            let [spin_i, spin_j] = if MORE { given.spins } else { [none; 2] };
            let motion = Motion {
                normal: moved.normal,
                slip: moved.slip,
                rolling: moved.rolling,
                spin_i,
                spin_j,
                lever_i,
                lever_j,
                overlap: met.overlap,
                r_star: sizes.reduced[0],
                radius_i: sizes.radii[0],
                radius_j: sizes.radii[1],
            };
            let mut out = answer::<_, ALIKE>(&motion, laws, features, &moved.pressed, &held);
            let mut of = [first, second];
            if CLUMPS && self.spheres.clumps.is_some() {
                // SAFETY: the group was gathered.
                let Seated { bodies, arms } = unsafe { desk.gathered.seated[g].assume_init_ref() };
                // Torques about the centres of the bodies, which have the sums.
                out.torque_i = out.torque_i + arms[0].cross(out.force);
                out.torque_j = out.torque_j - arms[1].cross(out.force);
                of = [&bodies[0], &bodies[1]];
            }
            // Of those that do not touch they are nothing.
            let force = Half::rows(out.force, zero);
            let torques = [Half::rows(out.torque_i, zero), Half::rows(out.torque_j, zero)];
            // SAFETY: by the caller.
            unsafe {
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
                            let at = of.map(
                                #[inline(always)]
                                |places| places[k] & within,
                            );
                            add_pair(to, at, [force[k], torques[0][k], torques[1][k]]);
                        }
                    }
                }
            }
        }
    }
}
