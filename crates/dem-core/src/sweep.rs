//! Several steps in one sweep over a bed that no cache holds.
//!
//! Where one pass (`one_pass.rs`) goes, spheres behind its window have made their step, and those of the next step need
//! nothing but their neighbours: so the next step may follow a window behind, and another one behind that, and the records
//! that one of them has left in the cache are found there by the next. A bed is fetched from memory once for several
//! steps. Each of these *tiers* has its own walls, near pairs in action and sums. Within a tier near pairs and walls go
//! ahead of touching pairs, which finish spheres.
//!
//! Between two looks at how far they have come no tier touches a body that another one touches, so each of several threads
//! may go on with some of them.
//!
//! Everything is computed from the same numbers in the same order as by one pass after the other: the bits are the same.
//! The list is asked whether it still holds only between sweeps (`World::list_holds`), with any number of threads.

use crate::body_run::{Run, SPIN, cut_bodies};
use crate::body_stage::{Drift, Kick};
use crate::contact::model::ContactLaw;
use crate::contact_stage::CHUNK;
use crate::error::Error;
use crate::forces::deeper;
use crate::integrate::Integrator;
use crate::neighbour::verlet_list::PairList;
use crate::neighbour::wall_list::WallList;
use crate::one_pass::{Chunk, OfBodies, Pass, moments_of, no_clumps};
use crate::particles::{Bodies, Record};
use crate::spheres::{Seats, SphereView};
use crate::step::{contacts_of, kernel_of};
use crate::strips::{Strips, ends};
use crate::sums::{Collect, PIECE, Ring};
use crate::threads::{Cut, CutJoined, InTurn, Runs, View, cut};
use crate::tier::{Ahead, Tier};
use crate::world::{Kept, Scratch, World, sphere_view};

/// Bodies above which a bed is far: several steps go in a sweep.
pub(crate) const FAR: usize = 20_000;
/// Steps of a sweep at most.
pub(crate) const MOST_STEPS: usize = 4;
/// Bodies by which one tier goes on before the next follows.
const STATION: usize = 1024;
/// Bodies between the first tier and the last at most: what the cache is to hold.
const IN_CACHE: usize = 24_000;

/// Bodies of a station: fewer in beds that are no far ones but by a test's word.
fn station(bodies: usize) -> usize {
    STATION.min(bodies / 16 + 1)
}

/// What a sweep works on.
struct Bed<'a> {
    bodies: &'a mut Bodies,
    pairs: &'a PairList,
    walls: &'a WallList,
    /// Marks and memory of pairs and of walls.
    of_pairs: (&'a mut [u8], &'a mut [f64]),
    of_walls: (&'a mut [u8], &'a mut [f64]),
    s: &'a mut Scratch,
}

/// Places at which the runs of tiers begin, in the order of the tiers in memory, and an end.
fn starts(tiers: &[Tier], of: impl Fn(&Tier) -> usize, end: usize) -> [u32; MOST_STEPS + 1] {
    let mut starts = [end as u32; MOST_STEPS + 1];
    for (start, tier) in starts.iter_mut().zip(tiers) {
        *start = of(tier) as u32;
    }
    starts
}

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// How many steps may go in one sweep, as far as the cache and the threads let them.
    pub(crate) fn steps_in_a_sweep(&mut self) -> u64 {
        let (bodies, threads) = (self.len(), self.team.threads());
        // More threads than tiers go in strips, and where energies are booked or bodies are clumps, in stages.
        let alone = self.ledger_wanted || self.has_clumps();
        if bodies <= self.make.far || threads > MOST_STEPS || alone {
            return 1;
        }
        let (s, pairs) = (&mut self.scratch, &self.state.pairs);
        if !s.whole.are_cut() {
            s.whole.cut(pairs, bodies, 1, Seats::OWN);
            s.near_window = pairs.near_window();
        }
        let tier = pairs.window.max(s.near_window) + station(bodies);
        (IN_CACHE / tier).clamp(1, MOST_STEPS) as u64
    }

    /// Contacts of so many steps, of which the list holds for all, each with its second half and the first half of the
    /// next one; returns whether after that the list may miss a pair.
    ///
    /// Where two overlap too deeply, the world is left at that step: who went ahead is put back by the velocity with which
    /// it moved last, which is off by what it was accelerated in a step where it had gone on by more than one.
    pub(crate) fn sweep(&mut self, steps: usize) -> Result<bool, Error> {
        let (begin, dt) = (self.state.step, self.make.dt);
        let mut pairs = std::mem::take(&mut self.state.pairs);
        let mut walls = std::mem::take(&mut self.state.wall_list);
        let mut bodies = std::mem::take(&mut self.state.bodies);
        let mut s = std::mem::take(&mut self.scratch);
        let mut kept = std::mem::take(&mut s.tiers);
        let (mut active, mut memory) =
            (std::mem::take(&mut pairs.active), std::mem::take(&mut pairs.memory));
        let (mut wall_active, mut wall_memory) =
            (std::mem::take(&mut walls.active), std::mem::take(&mut walls.memory));
        let count = bodies.len();
        kept.resize_with(kept.len().max(steps), Tier::default);
        // The last step first, as they follow each other in memory.
        let tiers = &mut kept[..steps];
        for (tier, step) in tiers.iter_mut().rev().zip(begin..) {
            tier.begin(step, count, pairs.window, walls.len());
            tier.placed.clone_from(&s.placed);
            self.place_walls(&mut tier.placed, step as f64 * dt, dt);
        }
        s.room_for_yields(&pairs, walls.len().div_ceil(CHUNK));
        s.moved.cover(count);
        // Nothing is kept of what touches.
        if count > self.make.large {
            s.keep_none(pairs.near_begin);
        }
        s.kept = Kept::None;
        let mut bed = Bed {
            bodies: &mut bodies,
            pairs: &pairs,
            walls: &walls,
            of_pairs: (&mut active, &mut memory),
            of_walls: (&mut wall_active, &mut wall_memory),
            s: &mut s,
        };
        let (mut stopped, mut target) = (0, 0);
        while tiers[stopped].finished(count) < count {
            target += station(count);
            let goes_on = [stopped, target];
            self.near_and_walls_of_tiers(tiers, goes_on, &mut bed);
            self.passes_of_tiers(tiers, goes_on, &mut bed);
            // Steps after a fault are none.
            stopped = tiers.iter().rposition(Tier::is_deep).unwrap_or_default();
        }
        let last = &mut tiers[stopped];
        self.state.step = last.step;
        std::mem::swap(&mut s.placed, &mut last.placed);
        // Who looks at a fault sees near pairs and walls of its step.
        std::mem::swap(&mut s.wrenches.late, &mut last.wrenches.late);
        for (of_step, of_tier) in s.wrenches.walls().into_iter().zip(last.wrenches.walls()) {
            std::mem::swap(of_step, of_tier);
        }
        let deepest = deeper(deeper(last.gone.deepest, last.deep[0]), last.deep[1]);
        let moved_far = last.gone.into.moved_far;
        if last.is_deep() {
            for tier in &tiers[..=stopped] {
                let columns = cut_bodies(&mut bodies, PIECE);
                let put_back = |_, columns| Run::of(0, columns).undo_drift(dt);
                self.team.each(tier.gone.into.drifted, columns, put_back);
            }
            if I::FROM_MEAN {
                let drifted = tiers[stopped].gone.into.drifted;
                let columns = cut_bodies(&mut bodies, PIECE);
                self.team
                    .each(drifted, columns, |_, columns| Run::of(0, columns).recall(dt, false));
            }
            // What went ahead has left sums behind.
            tiers[..stopped].iter_mut().for_each(|tier| tier.ring = Ring::default());
            self.state.forces_stale = true;
        }
        s.tiers = kept;
        (pairs.active, pairs.memory) = (active, memory);
        (walls.active, walls.memory) = (wall_active, wall_memory);
        self.scratch = s;
        self.state.pairs = pairs;
        self.state.wall_list = walls;
        self.state.bodies = bodies;
        self.check_overlap(deepest).map(|()| moved_far)
    }

    /// All tiers go on with near pairs and walls, those from `stopped` on: up to owners at `target`.
    fn near_and_walls_of_tiers(
        &self,
        tiers: &mut [Tier],
        [stopped, target]: [usize; 2],
        bed: &mut Bed<'_>,
    ) {
        let (make, s) = (&self.make, &mut *bed.s);
        let (count, steps) = (bed.bodies.len(), tiers.len());
        let (begin, slots) = (bed.pairs.near_begin, bed.pairs.slots);
        let spheres = sphere_view(bed.bodies, &self.state.members, false, make.dt);
        let kernel = kernel_of(make, spheres, make.dt, false);
        let near = bed.pairs.near().len();
        let ahead = Ahead {
            pairs: bed.pairs,
            walls: bed.walls,
            vector: kernel.as_ref().map(|kernel| (make.level, kernel)),
            order: &s.near_order,
            moved: &s.moved,
            near_window: s.near_window,
            target,
        };
        let finished = starts(tiers, |tier| tier.finished(count), count);
        let of_near = starts(tiers, |tier| tier.near, near.div_ceil(CHUNK));
        let of_walls = starts(tiers, |tier| tier.walls, bed.walls.len().div_ceil(CHUNK));
        let mut near = (
            cut(&mut bed.of_pairs.0[begin..], CHUNK),
            cut(&mut bed.of_pairs.1[begin * slots..], CHUNK * slots),
            cut(&mut s.near_yield, 1),
        );
        let mut walls = (
            cut(bed.of_walls.0, CHUNK),
            cut(bed.of_walls.1, CHUNK * slots),
            cut(&mut s.wall_yield, 1),
        );
        let parts = (
            Runs::new(&mut near, &of_near[..=steps]),
            Runs::new(&mut walls, &of_walls[..=steps]),
            cut(tiers, 1),
        );
        self.team.each(steps, parts, |nth, (near, walls, tier)| {
            if nth < stopped {
                return;
            }
            let (tier, limit) = (&mut tier[0], finished[nth + 1] as usize);
            let placed = std::mem::take(&mut tier.placed);
            let context = contacts_of(make, spheres, &placed, make.dt, false);
            let owner = ahead.near(&context, tier, limit, near);
            let sphere = ahead.walls(&context, tier, limit, walls);
            tier.placed = placed;
            tier.covered = owner.min(sphere);
            tier.gone.into.deep |= tier.deep.iter().any(Option::is_some);
        });
    }

    /// All tiers go on with touching pairs and the bodies that they finish.
    fn passes_of_tiers(
        &self,
        tiers: &mut [Tier],
        [stopped, target]: [usize; 2],
        bed: &mut Bed<'_>,
    ) {
        let (s, pairs) = (&mut *bed.s, bed.pairs);
        let (count, steps) = (bed.bodies.len(), tiers.len());
        let (begin, slots) = (pairs.near_begin, pairs.slots);
        let chunks = pairs.touching.div_ceil(CHUNK);
        let finished = starts(tiers, |tier| tier.finished(count), count);
        let of_pieces = starts(tiers, |tier| tier.gone.piece, count.div_ceil(PIECE));
        let of_chunks = starts(tiers, |tier| tier.gone.chunk, chunks);
        let columns = cut_bodies(bed.bodies, PIECE);
        let (spheres, spins) = (SphereView::of_columns(&columns, None), columns.0[SPIN].view());
        let mut to_do = (
            cut(&mut bed.of_pairs.0[..begin], CHUNK),
            cut(&mut bed.of_pairs.1[..begin * slots], CHUNK * slots),
            cut(&mut s.pair_yield, 1),
        );
        let mut pieces = (columns, cut(&mut s.moved.square, 1), no_clumps());
        let (walls, strips) = (bed.walls, &s.whole);
        let parts = (
            Runs::new(&mut pieces, &of_pieces[..=steps]),
            Runs::new(&mut to_do, &of_chunks[..=steps]),
            cut(tiers, 1),
        );
        self.team.each(steps, parts, |nth, (bodies, to_do, tier)| {
            let (tier, limit) = (&mut tier[0], finished[nth + 1] as usize);
            let ready = |chunk: usize| {
                let owner = pairs.owner(chunk * CHUNK);
                owner <= target.min(tier.covered) && (owner + pairs.window).min(count) <= limit
            };
            let mut until = tier.gone.chunk;
            while until < chunks && ready(until) {
                until += 1;
            }
            let to_its_end = until == chunks && limit == count && tier.covered == count;
            if nth < stopped || !(until > tier.gone.chunk || to_its_end) {
                return;
            }
            debug_assert!(
                (tier.gone.chunk..until)
                    .flat_map(|c| ends(pairs, c))
                    .all(|sphere| bodies.left().contains(&(sphere / PIECE))),
                "others' bodies are read"
            );
            // Later tiers find in the cache what the first has left there.
            let far = (nth + 1 == steps).then_some(spins);
            self.pass(
                tier,
                spheres,
                far,
                (pairs, walls, strips),
                bodies,
                to_do,
                (until, to_its_end),
            );
        });
    }

    /// One tier goes on with touching pairs and the bodies that they finish.
    #[expect(clippy::too_many_arguments, reason = "what one tier works on")]
    fn pass<'b, B, C>(
        &self,
        tier: &mut Tier,
        spheres: SphereView<'_>,
        far: Option<View<'_, Record>>,
        (pairs, walls, strips): (&PairList, &WallList, &Strips),
        mut bodies: InTurn<'_, B>,
        mut chunks: InTurn<'_, C>,
        until: (usize, bool),
    ) where
        B: Cut<Part = OfBodies<'b>>,
        C: CutJoined<Part = Chunk<'b>>,
    {
        let make = &self.make;
        let (dt, level) = (make.dt, make.level);
        let kick = Kick {
            make,
            seats: Seats::OWN,
            collect: Collect { pairs: None, walls, w: &tier.wrenches, late_ends: &tier.late_ends },
            gravity: make.gravity.at(tier.step as f64 * dt),
            // Nobody books energies here.
            gravity_rate: glam::DVec3::ZERO,
            ledger: false,
            dt,
        };
        let drift = Drift {
            reference: &self.state.list.reference,
            frame: self.turn_since_list((tier.step + 1) as f64 * dt).columns(),
            dt,
        };
        let kernel = kernel_of(make, spheres, dt, false);
        let pass = Pass {
            context: contacts_of(make, spheres, &tier.placed, dt, false),
            vector: kernel.as_ref().map(|kernel| (level, kernel)),
            integrator: self.integrator,
            level,
            strips,
            pairs,
            bodies: spheres.position.len(),
            kick: &kick,
            drift: &drift,
            turns: &self.turns(&[], &[]),
            kept: [&[]; 3],
            warm: far.is_some(),
            far: far.map(|spins| [Some(drift.reference.into()), moments_of(make, spins)]),
        };
        pass.go(0, &mut bodies, &mut chunks, &mut tier.ring, &mut tier.gone, until);
    }
}

#[cfg(test)]
#[path = "sweep_tests.rs"]
mod tests;
