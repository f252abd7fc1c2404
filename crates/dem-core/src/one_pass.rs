//! One pass over touching pairs and bodies.
//!
//! Pairs are sorted by the earlier of their two spheres, so a sphere has all its pairs as soon as those that
//! it owns are computed. Then it is finished, while it lies in the cache: forces are summed, velocities brought
//! up, and it moves on to the next step. The partners of a sphere lie within two layers of cells, so the window
//! between what is touched first and what is finished is small, however many spheres there are, and a step
//! fetches every sphere once from memory. Wrenches are not kept: they are added to sums as they come,
//! in the order in which the stages of `contact_stage.rs` and `body_stage.rs` add them, so to the same bits.
//!
//! Several threads go so in several strips (`strips.rs`). The few chunks of pairs that touch bodies of a later strip are computed
//! ahead, as near pairs and walls are, and both strips find their wrenches.

use std::ops::Range;

use crate::body_run::{Columns, POSITION, Run, SPIN, cut_bodies};
use crate::body_stage::{Drift, Farthest, Kick, Piece};
use crate::clump_stage::{Turned, Turns};
use crate::contact::model::ContactLaw;
use crate::contact_stage::{CHUNK, TOGETHER, Touching, all_contacts, touching_pairs};
use crate::error::Error;
use crate::forces::{ChunkYield, Contacts, DeepOverlap, deeper};
use crate::integrate::Integrator;
use crate::neighbour::verlet_list::PairList;
use crate::particles::Record;
use crate::simd::{Level, PairKernel, Wrenches, fetch, on_records, widened};
use crate::spheres::{ClumpView, SphereView};
use crate::step::{contacts_of, kernel_of};
use crate::strips::Strips;
use crate::sums::{Collect, PIECE, Pull, Ring};
use crate::threads::{Chunks, Cut, CutJoined, Groups, InTurn, Runs, View, chosen, cut, cut_groups};
use crate::world::{Make, StripYield, World, sphere_view};

/// One chunk of touching pairs: marks, memory, what it yields.
pub(crate) type Chunk<'a> = (&'a mut [u8], &'a mut [f64], &'a mut [ChunkYield]);

/// One piece of bodies: their columns, how far they have moved, what clumps have besides.
pub(crate) type OfBodies<'a> = (Columns<'a>, &'a mut [f64], Turned<'a>);

/// What clumps have besides, in pieces of bodies whose first spheres are given.
fn cut_clumps<'a>(
    attitude: &'a mut [glam::DQuat],
    end_spin: &'a mut [Record],
    spheres: &'a mut [Record],
    first: &'a [u32],
) -> (Chunks<'a, glam::DQuat>, Chunks<'a, Record>, Groups<'a, Record>) {
    (cut(attitude, PIECE), cut(end_spin, PIECE), cut_groups(spheres, first, PIECE))
}

/// Pieces of bodies that have nothing besides.
pub(crate) fn no_clumps<'a>() -> (Chunks<'a, glam::DQuat>, Chunks<'a, Record>, Groups<'a, Record>) {
    cut_clumps(&mut [], &mut [], &mut [], &[])
}

/// Spins, which have the moments of inertia, where these are not one for all.
pub(crate) fn moments_of<'a, M>(
    make: &Make<M>,
    spins: View<'a, Record>,
) -> Option<View<'a, Record>> {
    make.one_inertia.is_none().then_some(spins)
}

/// What is the same for all strips.
pub(crate) struct Pass<'a, M, I> {
    pub(crate) context: Contacts<'a, M>,
    pub(crate) vector: Option<(Level, &'a PairKernel<'a>)>,
    pub(crate) integrator: I,
    pub(crate) level: Level,
    pub(crate) strips: &'a Strips,
    pub(crate) pairs: &'a PairList,
    pub(crate) bodies: usize,
    pub(crate) kick: &'a Kick<'a, M>,
    pub(crate) drift: &'a Drift<'a>,
    pub(crate) turns: &'a Turns<'a>,
    /// Wrenches of the chunks that were computed ahead.
    pub(crate) kept: [&'a [Record]; 3],
    /// Whether places are asked for before they are needed: where the second-level cache does not hold the bed.
    pub(crate) warm: bool,
    /// Places when the list was made, and what has the moments of inertia where they differ, of a bed that no cache holds: there
    /// everything is asked for.
    pub(crate) far: Option<[Option<View<'a, Record>>; 2]>,
}

/// How far a strip has been gone through.
#[derive(Debug, Clone, Default)]
pub(crate) struct Gone {
    /// The next chunk of pairs, and the next piece of bodies.
    pub(crate) chunk: usize,
    pub(crate) piece: usize,
    /// Spheres that its pairs have touched lie before this place.
    reach: usize,
    /// What was asked for ahead of that, and of what is finished.
    asked: [usize; 2],
    pub(crate) into: StripYield,
    /// The deepest of overlaps that are too deep.
    pub(crate) deepest: Option<DeepOverlap>,
}

/// Spheres beyond the window of a chunk for which sums have room, so that several chunks go together.
const SPARE: usize = 2 * CHUNK;

/// How many bodies before.
const AHEAD: usize = 192;
/// Bodies above which places are asked for before they are needed: more than a second-level cache holds.
const WARM: usize = 2000;

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Whether a step goes in one pass: where nobody books energies, and the threads find strips that keep out of each
    /// other's way.
    pub(crate) fn goes_in_one_pass(&mut self) -> bool {
        if self.ledger_wanted {
            return false;
        }
        let strips = &mut self.scratch.strips;
        if !strips.are_cut() {
            let seats = self.state.members.seats();
            let (pairs, walls) = (&self.state.pairs, &self.state.wall_list);
            let bodies = self.state.bodies.len();
            strips.cut(pairs, bodies, self.team.threads(), seats);
            self.scratch.shares.follow(strips, pairs, walls, seats, bodies);
        }
        strips.pay()
    }

    /// Contacts of a step, its second half, and the first half of the next one; returns whether after that
    /// the list may miss a pair.
    pub(crate) fn one_pass(&mut self) -> Result<bool, Error> {
        let (integrator, dt) = (self.integrator, self.make.dt);
        self.tell_shift_of_walls();
        let mut pairs = std::mem::take(&mut self.state.pairs);
        let mut walls = std::mem::take(&mut self.state.wall_list);
        let mut bodies = std::mem::take(&mut self.state.bodies);
        let mut s = std::mem::take(&mut self.scratch);
        let placed = std::mem::take(&mut s.placed);
        let strips = std::mem::take(&mut s.strips);
        let clumps = self.has_clumps();
        let (make, level) = (&self.make, self.make.level);
        {
            let spheres = sphere_view(&bodies, &self.state.members, clumps, dt);
            let context = contacts_of(make, spheres, &placed, dt, false);
            let kernel = kernel_of(make, spheres, dt, false);
            let vector = kernel.as_ref().map(|kernel| (level, kernel));
            if bodies.len() > make.large {
                s.keep_none(pairs.near_begin);
            }
            let (team, ahead) = (&self.team, Some(&strips));
            all_contacts(&context, vector, team, make, &mut pairs, &mut walls, &mut s, ahead);
        }
        let mut deep = s.deep_ahead(&strips);
        s.moved.cover(bodies.len());
        s.rings.resize_with(strips.count(), Ring::default);
        s.strip_yield.resize(strips.count(), StripYield::default());
        s.rings.iter_mut().for_each(|ring| ring.cover(pairs.window + SPARE, bodies.len()));
        let mut members = std::mem::take(&mut self.state.members);
        let mut attitude = std::mem::take(&mut members.attitude);
        let mut end_spin = std::mem::take(&mut members.end_spin);
        let mut positions = std::mem::take(&mut members.position);
        let (seats, turns) = (members.seats(), self.turns(&members.shape, &members.first));
        let collect =
            Collect { pairs: None, walls: &walls, w: &s.wrenches, late_ends: &s.late_ends };
        let kick = Kick {
            make,
            seats,
            collect,
            gravity: make.gravity.at(self.time()),
            gravity_rate: self.gravity_rate(),
            ledger: false,
            dt,
        };
        let drift = Drift {
            reference: &self.state.list.reference,
            frame: self.turn_since_list((self.state.step + 1) as f64 * dt).columns(),
            dt,
        };
        let (mut active, mut memory) =
            (std::mem::take(&mut pairs.active), std::mem::take(&mut pairs.memory));
        {
            let count = bodies.len();
            let cut_columns = cut_bodies(&mut bodies, PIECE);
            let of_clumps =
                cut_clumps(&mut attitude, &mut end_spin, &mut positions, &members.first);
            let spheres = SphereView::of_columns(
                &cut_columns,
                clumps.then(|| {
                    let (centre, end_spin) = (cut_columns.0[POSITION].view(), of_clumps.1.view());
                    let view = ClumpView { body: &members.body, centre, end_spin, dt };
                    (of_clumps.2.view(), view)
                }),
            );
            let spins = cut_columns.0[SPIN].view();
            let kernel = kernel_of(make, spheres, dt, false);
            let w = &s.wrenches;
            let pass = Pass {
                context: contacts_of(make, spheres, &placed, dt, false),
                vector: kernel.as_ref().map(|kernel| (level, kernel)),
                integrator,
                level,
                strips: &strips,
                pairs: &pairs,
                bodies: count,
                kick: &kick,
                drift: &drift,
                turns: &turns,
                kept: [&w.pair_force, &w.pair_torque_first, &w.pair_torque_second],
                warm: count > WARM && !clumps,
                far: (count > make.far && !clumps)
                    .then(|| [Some(drift.reference.into()), moments_of(make, spins)]),
            };
            let near_begin = pairs.near_begin;
            let mut chunks = (
                cut(&mut active[..near_begin], CHUNK),
                cut(&mut memory[..near_begin * pairs.slots], CHUNK * pairs.slots),
                cut(&mut s.pair_yield, 1),
            );
            let mut pieces = (cut_columns, cut(&mut s.moved.square, 1), of_clumps);
            let parts = (
                Runs::new(&mut pieces, &strips.pieces),
                Runs::new(&mut chunks, &strips.chunks),
                cut(&mut s.rings, 1),
                cut(&mut s.strip_yield, 1),
            );
            self.team.each(strips.count(), parts, |strip, (bodies, chunks, ring, into)| {
                let begin = std::time::Instant::now();
                into[0] = pass.strip(strip, bodies, chunks, &mut ring[0], deep);
                into[0].seconds = begin.elapsed().as_secs_f64();
            });
        }
        (pairs.active, pairs.memory) = (active, memory);
        deep |= s.strip_yield.iter().any(|y| y.deep);
        let moved_far = s.strip_yield.iter().any(|y| y.moved_far);
        if deep {
            // A fault leaves bodies where they were when it was found.
            let turned = (cut(&mut attitude, PIECE), cut(&mut end_spin, PIECE));
            let columns = (cut_bodies(&mut bodies, PIECE), turned);
            let moved: Vec<_> = strips.moved(&s.strip_yield).collect();
            let parts = chosen(columns, Some(&moved));
            let from_mean = I::FROM_MEAN && make.moves_on_without_velocities();
            self.team.each(moved.len(), parts, |k, (columns, (attitude, end_spin))| {
                let mut run = Run::of(moved[k] as usize * PIECE, columns);
                run.undo_drift(dt);
                if from_mean && clumps {
                    turns.recall(&mut run, attitude, end_spin);
                }
                if clumps {
                    turns.undo(&mut run, attitude);
                }
                if from_mean {
                    run.recall(dt, clumps);
                }
            });
            self.state.forces_stale = true;
        }
        (members.attitude, members.end_spin, members.position) = (attitude, end_spin, positions);
        self.state.members = members;
        s.members_placed = !deep;
        s.strips = strips;
        s.strips.note(&s.strip_yield);
        s.placed = placed;
        self.scratch = s;
        self.state.pairs = pairs;
        self.state.wall_list = walls;
        self.state.bodies = bodies;
        if deep {
            self.place_members();
        }
        // What all parts have told need not be asked of each of them.
        if deep { self.check_overlaps().map(|()| moved_far) } else { Ok(moved_far) }
    }
}

impl<M: ContactLaw, I: Integrator> Pass<'_, M, I> {
    /// Go through a strip: compute its pairs, and finish its bodies; `deep` tells whether two overlap too deeply already.
    fn strip<'b, B, C>(
        &self,
        strip: usize,
        mut bodies: InTurn<'_, B>,
        mut chunks: InTurn<'_, C>,
        ring: &mut Ring,
        deep: bool,
    ) -> StripYield
    where
        B: Cut<Part = OfBodies<'b>>,
        C: CutJoined<Part = Chunk<'b>>,
    {
        let (all, first) = (chunks.left(), bodies.left().start);
        let mut gone = Gone { chunk: all.start, piece: first, ..Gone::default() };
        gone.into.deep = deep;
        ring.receive(self.strips.received(strip), self.kept);
        self.go(strip, &mut bodies, &mut chunks, ring, &mut gone, (all.end, true));
        gone.into
    }

    /// Finish the bodies of a strip before a piece.
    #[inline(always)]
    fn finish<'b, B: Cut<Part = OfBodies<'b>>>(
        &self,
        before: usize,
        own: &Range<usize>,
        bodies: &mut InTurn<'_, B>,
        ring: &mut Ring,
        gone: &mut Gone,
    ) {
        while gone.piece < before {
            let begin = gone.piece * PIECE;
            let sums = ring.piece(begin, PIECE.min(self.bodies - begin));
            if !own.contains(&gone.piece) {
                sums.fill(Pull::ZERO);
            } else if let Some(of) = bodies.take(gone.piece) {
                let finish = Finish {
                    integrator: self.integrator,
                    kick: self.kick,
                    drift: (!gone.into.deep).then_some(self.drift),
                    turns: self.turns,
                    level: self.level,
                };
                gone.into.moved_far |= finish.piece(begin, of, sums).too_far;
            }
            gone.piece += 1;
            if !gone.into.deep {
                gone.into.drifted = gone.piece;
            }
        }
    }

    /// Body of the owner of the first pair of a chunk.
    #[inline(always)]
    fn owner(&self, chunk: usize) -> usize {
        self.kick.seats.body(self.pairs.owner(chunk * CHUNK))
    }

    /// Bodies that a chunk touches lie before this place.
    #[inline(always)]
    fn reach(&self, chunk: usize) -> usize {
        (self.owner(chunk) + self.pairs.window).min(self.bodies)
    }

    /// Behind the last chunk that goes through the kernel together with this one, before `until`: none whose wrenches are kept, and as
    /// many as there is room for sums of.
    #[inline(always)]
    fn together(&self, chunk: usize, until: usize, ring: &Ring) -> usize {
        let mut next = chunk + 1;
        if self.strips.kept(chunk).is_some() {
            return next;
        }
        let first = self.owner(chunk) / PIECE * PIECE;
        while next < until.min(chunk + TOGETHER)
            && self.strips.kept(next).is_none()
            && ring.holds(first..self.reach(next))
        {
            next += 1;
        }
        next
    }

    /// Go on through a strip up to a chunk, and behind its last one to its end.
    pub(crate) fn go<'b, B, C>(
        &self,
        strip: usize,
        bodies: &mut InTurn<'_, B>,
        chunks: &mut InTurn<'_, C>,
        ring: &mut Ring,
        gone: &mut Gone,
        (until, to_its_end): (usize, bool),
    ) where
        B: Cut<Part = OfBodies<'b>>,
        C: CutJoined<Part = Chunk<'b>>,
    {
        let (pairs, slots) = (self.pairs, self.pairs.slots);
        let (own, seats) = (bodies.left(), self.kick.seats);
        let (mut chunk, end) = (gone.chunk, until + usize::from(to_its_end));
        while chunk < end {
            let (begin, mut next) = (chunk * CHUNK, chunk + 1);
            // Spheres before the owner of the next pair have all theirs; behind the last pair all of the strip have,
            // and others that it touched need nothing from here.
            let frontier = if chunk < until {
                next = self.together(chunk, until, ring);
                gone.reach = self.reach(next - 1);
                self.owner(chunk) / PIECE
            } else {
                own.end.max(gone.reach.div_ceil(PIECE))
            };
            if self.warm {
                let s = &self.context.spheres;
                let (touched, finished) = (
                    (gone.reach + AHEAD).min(self.bodies),
                    (frontier * PIECE + AHEAD).min(self.bodies),
                );
                let spheres = gone.asked[0].max(gone.reach.saturating_sub(AHEAD))..touched;
                fetch(s.position, spheres.clone());
                if let Some(own) = self.far {
                    fetch(s.mean_spin, spheres.clone());
                    fetch(s.velocities, spheres.clone());
                    for records in own.into_iter().flatten() {
                        let begin = gone.asked[1].max(finished.saturating_sub(2 * AHEAD));
                        fetch(records, begin..finished);
                    }
                }
                gone.asked = [touched, finished];
            }
            self.finish(frontier, &own, bodies, ring, gone);
            if chunk == until {
                break;
            }
            if let Some(kept) = self.strips.kept(chunk) {
                let own = begin..(begin + CHUNK).min(pairs.touching);
                let at = kept * CHUNK..kept * CHUNK + own.len();
                let kept = self.kept.map(|kept| &kept[at.clone()]);
                let (first, second) = (&pairs.first[own.clone()], &pairs.second[own]);
                widened(
                    self.level,
                    #[inline(always)]
                    || ring.add(first, second, kept, seats),
                );
                (chunk, gone.chunk) = (next, next);
                continue;
            }
            let taken = chunks.take_joined(chunk..next);
            let Some((active, numbers, found)) = taken else { break };
            debug_assert!(
                (chunk..next).all(|chunk| {
                    self.strips.stays_within(strip, pairs, chunk, (seats, self.bodies))
                }),
                "others' bodies are read"
            );
            let all = active.len();
            let places = begin..begin + all;
            let (first, second) = (&pairs.first[places.clone()], &pairs.second[places]);
            let count = all.min(pairs.touching - begin);
            // The first tells of all.
            found.iter_mut().skip(1).for_each(ChunkYield::reset);
            let wrenches = Wrenches::Summed(ring.slots());
            let run = Touching { pairs: count, slots, first, second, active, numbers, wrenches };
            touching_pairs(&self.context, self.vector, run, &mut found[0]);
            gone.into.deep |= found[0].deep.is_some();
            gone.deepest = deeper(gone.deepest, found[0].deep);
            (chunk, gone.chunk) = (next, next);
        }
    }
}

/// What finishes bodies of which all forces are known.
struct Finish<'a, M, I> {
    integrator: I,
    kick: &'a Kick<'a, M>,
    /// Nothing when they stay where they are.
    drift: Option<&'a Drift<'a>>,
    turns: &'a Turns<'a>,
    level: Level,
}

impl<M, I: Integrator> Finish<'_, M, I> {
    /// Bring a piece of bodies to the next step, of which `sums` has a part of the forces; returns how far they have moved.
    #[inline(always)]
    fn piece(
        self,
        begin: usize,
        (columns, moved, clumps): OfBodies<'_>,
        sums: &mut [Pull],
    ) -> Farthest {
        let mut whole = Run::of(begin, columns);
        let count = whole.count();
        let (integrator, kick, drift) = (self.integrator, Some(self.kick), self.drift);
        // Torques on clumps that move on are needed for their turn alone, and stay in the cache.
        let mut torques;
        if I::FROM_MEAN && drift.is_some() && self.kick.make.only_clumps {
            torques = [Record::ZERO; PIECE];
            whole.angular = &mut torques[..count];
        }
        let (run, spheres) = (whole.some(0..count), &*clumps.2);
        let piece = Piece { integrator, kick, drift, run, spheres, sums };
        let (_, mut farthest) = on_records(self.level, self.kick.make.arithmetic, piece);
        if drift.is_some() {
            let turned = self.turns.turn_and_place(&mut whole, clumps);
            farthest.too_far |= turned.too_far;
            farthest.square = farthest.square.max(turned.square);
        }
        moved[0] = moved[0].max(farthest.square);
        farthest
    }
}
