//! One step of a sweep (`sweep.rs`), and what goes ahead of its touching pairs: near pairs and walls.

use crate::contact::model::ContactLaw;
use crate::contact_stage::{CHUNK, NearPairs, near_pairs, wall_contacts};
use crate::forces::{ChunkYield, Contacts, DeepOverlap, MemoryRun, deeper};
use crate::geometry::PlacedWall;
use crate::neighbour::near_order::{Moved, NearOrder};
use crate::neighbour::verlet_list::PairList;
use crate::neighbour::wall_list::WallList;
use crate::one_pass::Gone;
use crate::particles::Record;
use crate::simd::{Level, PairKernel};
use crate::sums::{LateEnds, PIECE, Ring};
use crate::threads::{Cut, InTurn};
use crate::world::Wrenches;

/// One step of a sweep.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tier {
    pub(crate) step: u64,
    pub(crate) placed: Vec<PlacedWall>,
    pub(crate) late_ends: LateEnds,
    /// Those of near pairs in action and of walls.
    pub(crate) wrenches: Wrenches,
    pub(crate) ring: Ring,
    /// Chunks of near pairs and of walls that are computed.
    pub(crate) near: usize,
    pub(crate) walls: usize,
    /// Spheres before this place have all of theirs.
    pub(crate) covered: usize,
    pub(crate) gone: Gone,
    /// The deepest of overlaps that are too deep, of near pairs and with walls.
    pub(crate) deep: [Option<DeepOverlap>; 2],
}

impl Tier {
    pub(crate) fn begin(&mut self, step: u64, bodies: usize, window: usize, walls: usize) {
        self.step = step;
        self.wrenches.late.clear();
        self.late_ends.clear(bodies);
        self.wrenches.walls().into_iter().for_each(|v| v.resize(walls, Record::default()));
        self.ring.cover(window, bodies);
        (self.near, self.walls, self.covered, self.deep) = (0, 0, 0, [None; 2]);
        self.gone = Gone::default();
    }

    pub(crate) fn is_deep(&self) -> bool {
        self.gone.into.deep
    }

    /// Bodies before this place have made the step.
    pub(crate) fn finished(&self, bodies: usize) -> usize {
        (self.gone.piece * PIECE).min(bodies)
    }
}

/// A chunk of near pairs or of walls: marks, memory, what it yields.
type Marked<'a> = (&'a mut [u8], &'a mut [f64], &'a mut [ChunkYield]);

/// What near pairs and walls of all tiers read.
pub(crate) struct Ahead<'a> {
    pub(crate) pairs: &'a PairList,
    pub(crate) walls: &'a WallList,
    pub(crate) vector: Option<(Level, &'a PairKernel<'a>)>,
    pub(crate) order: &'a NearOrder,
    pub(crate) moved: &'a Moved,
    pub(crate) near_window: usize,
    /// Owners up to which this goes on.
    pub(crate) target: usize,
}

impl Ahead<'_> {
    /// Near pairs of a tier, where bodies before `limit` have made the step before it; returns the place before which
    /// spheres have all of theirs.
    pub(crate) fn near<'b, M: ContactLaw, C: Cut<Part = Marked<'b>>>(
        &self,
        context: &Contacts<'_, M>,
        tier: &mut Tier,
        limit: usize,
        mut chunks: InTurn<'_, C>,
    ) -> usize {
        let (pairs, near) = (self.pairs, self.pairs.near());
        let count = context.spheres.position.len();
        loop {
            let begin = near.start + tier.near * CHUNK;
            if begin >= near.end {
                return count;
            }
            let owner = pairs.owner(begin);
            if owner > self.target || (owner + self.near_window).min(count) > limit {
                return owner;
            }
            let Some((active, numbers, into)) = chunks.take(tier.near) else { return owner };
            let (first, second) = (&pairs.first[begin..], &pairs.second[begin..]);
            let looks = self.order.looks(tier.near, near.len(), self.moved);
            let chunk = NearPairs { first, second, active };
            let memory = MemoryRun { slots: pairs.slots, numbers };
            near_pairs(context, self.vector, looks, chunk, memory, &mut into[0]);
            tier.late_ends.extend(&mut tier.wrenches.late, &into[0].late);
            tier.deep[0] = deeper(tier.deep[0], into[0].deep.take());
            tier.near += 1;
        }
    }

    /// The same for walls.
    pub(crate) fn walls<'b, M: ContactLaw, C: Cut<Part = Marked<'b>>>(
        &self,
        context: &Contacts<'_, M>,
        tier: &mut Tier,
        limit: usize,
        mut chunks: InTurn<'_, C>,
    ) -> usize {
        let walls = self.walls;
        loop {
            let begin = tier.walls * CHUNK;
            if begin >= walls.len() {
                return context.spheres.position.len();
            }
            let own = begin..(begin + CHUNK).min(walls.len());
            let (first, last) = (walls.sphere[begin] as usize, walls.sphere[own.end - 1] as usize);
            if first > self.target || last >= limit {
                return first;
            }
            let Some((active, numbers, into)) = chunks.take(tier.walls) else { return first };
            let w = &mut tier.wrenches;
            let parts = (
                active,
                numbers,
                &mut w.wall_force[own.clone()],
                &mut w.wall_torque[own.clone()],
                &mut w.wall_torque_on_wall[own.clone()],
                &mut *into,
            );
            let entries = (&walls.sphere[own.clone()], &walls.wall[own]);
            // The wrenches are those of a tier, which had other steps before.
            wall_contacts(context, self.vector, (walls.slots, None), entries, &[], parts);
            tier.deep[1] = deeper(tier.deep[1], into[0].deep.take());
            tier.walls += 1;
        }
    }
}
