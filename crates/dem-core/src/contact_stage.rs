//! The stage of contact forces: kernels over the lists, and sums by sphere.
//!
//! Every contact writes its wrench to its own place; spheres then sum theirs in a fixed order. So
//! any number of threads gives the same bits. Where contacts and bodies go in one pass (`one_pass.rs`),
//! touching pairs are left to it.

use crate::contact::model::ContactLaw;
use crate::forces::{ChunkYield, Contacts, Late, MemoryRun};
use crate::geometry::Nearest;
use crate::neighbour::near_order::Looks;
use crate::neighbour::verlet_list::{LANES, PairList};
use crate::neighbour::wall_gaps::Far;
use crate::neighbour::wall_list::WallList;
use crate::particles::Record;
use crate::simd::{Level, PairKernel, Run, WallRun, Wrenches};
use crate::strips::Strips;
use crate::threads::{EVEN, Stage, Team, chosen, cut, cut_groups, cut_groups_of};
use crate::world::{Make, Scratch};

/// Bodies and contacts in one chunk of work: whole blocks, enough to be worth a hand-over.
pub(crate) const CHUNK: usize = 256;

/// Most chunks of touching pairs that one call of the kernel computes, so that what it does once a call and registers that are half
/// empty at the end of one count less.
pub(crate) const TOGETHER: usize = 8;
const _: () = assert!(
    CHUNK.is_multiple_of(crate::sums::PIECE) && CHUNK.is_multiple_of(u64::BITS as usize),
    "chunks are whole pieces of bodies, and their marks whole words"
);

/// Compute all contacts, or of touching pairs those alone that `strips` let compute ahead; near pairs in action end in `s.wrenches.late`.
pub(crate) fn all_contacts<M: ContactLaw>(
    context: &Contacts<'_, M>,
    vector: Option<(Level, &PairKernel<'_>)>,
    team: &Team,
    make: &Make<M>,
    pairs: &mut PairList,
    walls: &mut WallList,
    s: &mut Scratch,
    strips: Option<&Strips>,
) {
    let (touching, near_begin, slots) = (pairs.touching, pairs.near_begin, pairs.slots);
    let (near, entries) = (pairs.near().len(), walls.len());
    debug_assert_eq!(near_begin % LANES, 0);
    let large = context.spheres.position.len() > make.large;
    match strips {
        None => s.keep_all(near_begin, large),
        Some(strips) => s.keep_some(strips.room(), if large { 0 } else { near_begin }),
    }
    s.wrenches.walls().into_iter().for_each(|v| v.resize(entries, Record::default()));
    s.shares.cover(walls);
    s.room_for_yields(pairs, s.shares.runs());
    let (w, near_chunks) = (&mut s.wrenches, near.div_ceil(CHUNK));
    place_on_meshes(context, make, walls, &mut s.mesh_nearest);

    let (order, moved, shares) = (&s.near_order, &s.moved, &s.shares);
    let runs = &shares.entries[..];
    let (active, near_active) = pairs.active.split_at_mut(near_begin);
    let (memory, near_memory) = pairs.memory.split_at_mut(near_begin * slots);
    let (first, second) = (&pairs.first[..], &pairs.second[..]);
    let ahead = strips.map(Strips::ahead);
    let of_pairs = (cut(active, CHUNK), cut(memory, CHUNK * slots), cut(&mut s.pair_yield, 1));
    let touching_stage = Stage {
        count: ahead.map_or(touching.div_ceil(CHUNK), <[u32]>::len),
        shares: if ahead.is_some() { &shares.ahead } else { EVEN },
        parts: (
            chosen(of_pairs, ahead),
            [
                cut(&mut w.pair_force, CHUNK),
                cut(&mut w.pair_torque_first, CHUNK),
                cut(&mut w.pair_torque_second, CHUNK),
            ],
            cut(&mut s.pair_told, 1),
        ),
        work: |c, ((active, numbers, into), kept, told): TouchingParts<'_>| {
            let begin = ahead.map_or(c, |ahead| ahead[c] as usize) * CHUNK;
            let end = begin + active.len();
            if let Some(bodies) = strips.and_then(|strips| strips.foreign(c)) {
                context.spheres.fetch(bodies);
            }
            let pairs = active.len().min(touching - begin);
            let (first, second) = (&first[begin..end], &second[begin..end]);
            let wrenches = Wrenches::Kept(kept.map(|kept| &mut kept[..end - begin]));
            let chunk = Touching { pairs, slots, first, second, active, numbers, wrenches };
            touching_pairs(context, vector, chunk, &mut into[0]);
            into[0].tell(&mut told[0]);
        },
    };
    let near_stage = Stage {
        count: near_chunks,
        shares: &shares.near,
        parts: (
            cut(near_active, CHUNK),
            cut(near_memory, CHUNK * slots),
            cut(&mut s.near_yield[..near_chunks], 1),
            cut(&mut s.near_told[..near_chunks], 1),
        ),
        work: |c, (active, numbers, into, told): NearParts<'_>| {
            let begin = near_begin + c * CHUNK;
            let chunk = NearPairs { first: &first[begin..], second: &second[begin..], active };
            let memory = MemoryRun { slots, numbers };
            let looks = order.looks(c, near, moved);
            near_pairs(context, vector, looks, chunk, memory, &mut into[0]);
            into[0].tell(&mut told[0]);
        },
    };
    let (sphere, wall, nearest) = (&walls.sphere[..], &walls.wall[..], &s.mesh_nearest[..]);
    let far = s.wall_gaps.far(entries, moved, s.wall_shift);
    let wall_stage = Stage {
        count: shares.runs(),
        shares: &shares.walls,
        parts: (
            (
                cut_groups(&mut walls.active, runs, 1),
                cut_groups_of(&mut walls.memory, runs, 1, slots),
                cut_groups(&mut w.wall_force, runs, 1),
                cut_groups(&mut w.wall_torque, runs, 1),
                cut_groups(&mut w.wall_torque_on_wall, runs, 1),
                cut(&mut s.wall_yield, 1),
            ),
            cut(&mut s.wall_told, 1),
        ),
        work: |c, (parts, told): (PairParts<'_>, &mut [bool])| {
            let (active, numbers, force, torque, on_wall, into) = parts;
            let begin = runs[c] as usize;
            let end = begin + active.len();
            let nearest = nearest.get(begin..end).unwrap_or_default();
            let entries = (&sphere[begin..end], &wall[begin..end]);
            let parts = (active, numbers, force, torque, on_wall, &mut *into);
            let far = Some(far.of(begin..end));
            wall_contacts(context, vector, (slots, far), entries, nearest, parts);
            into[0].tell(&mut told[0]);
        },
    };
    // The largest chunks first: who is done with its own takes small ones from others.
    team.run(&[&touching_stage, &wall_stage, &near_stage]);
    sort_late(s, context.spheres.position.len());
}

/// One chunk of contacts: marks, memory, three wrenches, what it yields.
pub(crate) type PairParts<'a> = (
    &'a mut [u8],
    &'a mut [f64],
    &'a mut [Record],
    &'a mut [Record],
    &'a mut [Record],
    &'a mut [ChunkYield],
);

/// One chunk of touching pairs: marks, memory, what it yields; three wrenches; whether it yields anything.
type TouchingParts<'a> =
    ((&'a mut [u8], &'a mut [f64], &'a mut [ChunkYield]), [&'a mut [Record]; 3], &'a mut [bool]);

/// One chunk of near pairs: marks, memory, what it yields, whether that is anything.
type NearParts<'a> = (&'a mut [u8], &'a mut [f64], &'a mut [ChunkYield], &'a mut [bool]);

/// One chunk of touching pairs, in whole blocks.
pub(crate) struct Touching<'a> {
    /// Pairs; what is beyond them is padding.
    pub(crate) pairs: usize,
    pub(crate) slots: usize,
    pub(crate) first: &'a [u32],
    pub(crate) second: &'a [u32],
    pub(crate) active: &'a mut [u8],
    pub(crate) numbers: &'a mut [f64],
    pub(crate) wrenches: Wrenches<'a>,
}

/// Compute a chunk of touching pairs.
pub(crate) fn touching_pairs<M: ContactLaw>(
    context: &Contacts<'_, M>,
    vector: Option<(Level, &PairKernel<'_>)>,
    chunk: Touching<'_>,
    into: &mut ChunkYield,
) {
    into.reset();
    let Touching { pairs, slots, first, second, active, numbers, mut wrenches } = chunk;
    if let Some((level, kernel)) = vector {
        let mut run = Run { pairs, first, second, active, memory: numbers, wrenches };
        kernel.touching(level, &mut run, into);
        return;
    }
    let mut memory = MemoryRun { slots, numbers };
    for k in 0..pairs {
        let (a, b) = (first[k], second[k]);
        let wrench = context.pair(a, b, k, &mut active[k], &mut memory, into).unwrap_or_default();
        let wrench = context.spheres.about_bodies(a, b, wrench);
        match &mut wrenches {
            Wrenches::Kept([force, torque_first, torque_second]) => {
                force[k].set(wrench.force);
                torque_first[k].set(wrench.torque_on_first);
                torque_second[k].set(wrench.torque_on_second);
            }
            Wrenches::Summed(sums) => {
                let (s, within) = (&context.spheres, sums.len() - 1);
                let sum = &mut sums[s.body(a as usize) & within];
                sum.force.add(wrench.force);
                sum.torque.add(wrench.torque_on_first);
                let sum = &mut sums[s.body(b as usize) & within];
                sum.force.add(-wrench.force);
                sum.torque.add(wrench.torque_on_second);
            }
        }
    }
}

/// A chunk of near pairs.
pub(crate) struct NearPairs<'a> {
    pub(crate) first: &'a [u32],
    pub(crate) second: &'a [u32],
    pub(crate) active: &'a mut [u8],
}

/// Compute the near pairs of a chunk that touch now or acted before: the vector kernel tells which touch, of all or of those that
/// need a look. Where nothing tells, all are computed.
pub(crate) fn near_pairs<M: ContactLaw>(
    context: &Contacts<'_, M>,
    vector: Option<(Level, &PairKernel<'_>)>,
    looks: Option<Looks<'_>>,
    chunk: NearPairs<'_>,
    mut memory: MemoryRun<'_>,
    into: &mut ChunkYield,
) {
    into.reset();
    let NearPairs { first, second, active } = chunk;
    let mut look = |k: usize, active: &mut u8| {
        let (a, b) = (first[k], second[k]);
        if let Some(wrench) = context.pair(a, b, k, active, &mut memory, into) {
            into.late.push(Late { first: a, second: b, wrench });
        }
    };
    let Some((level, kernel)) = vector else {
        active.iter_mut().enumerate().for_each(|(k, active)| look(k, active));
        return;
    };
    // A bit a pair, so that pairs are computed in the order of the list.
    let mut wanted = acted_before(active);
    let mut touching = [u8::MAX; CHUNK / LANES];
    if let Some(looks) = looks {
        let touching = &mut touching[..looks.first.len()];
        kernel.touch(level, looks.first, looks.second, touching);
        for (touching, index) in touching.iter().zip(looks.index) {
            let mut left = *touching;
            while left != 0 {
                let pair = index[left.trailing_zeros() as usize];
                wanted[usize::from(pair / 64)] |= 1 << (pair % 64);
                left &= left - 1;
            }
        }
    } else {
        let (first, second) = (first.as_chunks().0, second.as_chunks().0);
        let whole = (active.len() / LANES).min(first.len());
        kernel.touch(level, first, second, &mut touching[..whole]);
        for (bits, eight) in wanted.iter_mut().zip(touching.as_chunks::<8>().0) {
            *bits |= u64::from_le_bytes(*eight);
        }
    }
    for (word, bits) in wanted.into_iter().enumerate() {
        let mut left = bits;
        while left != 0 {
            let k = 64 * word + left.trailing_zeros() as usize;
            // Behind the last pair of the list nothing is.
            let Some(active) = active.get_mut(k) else { break };
            look(k, active);
            left &= left - 1;
        }
    }
}

/// A bit for each pair that is marked.
fn acted_before(active: &[u8]) -> [u64; CHUNK / 64] {
    let mut bits = [0; CHUNK / 64];
    for (bits, active) in bits.iter_mut().zip(active.chunks(64)) {
        // Few are, and told by wide registers: seldom is one among so many.
        if active.iter().fold(0, |any, mark| any | mark) == 0 {
            continue;
        }
        for (k, mark) in active.iter().enumerate() {
            *bits |= u64::from(*mark != 0) << k;
        }
    }
    bits
}

/// Find the nearest points of meshes.
fn place_on_meshes<M: ContactLaw>(
    context: &Contacts<'_, M>,
    make: &Make<M>,
    walls: &mut WallList,
    nearest: &mut Vec<Option<Nearest>>,
) {
    #[cfg(feature = "mesh")]
    if !walls.facets.is_empty() {
        let position = context.spheres.position;
        let range = make.range;
        crate::mesh_contacts::assign(&make.walls, context.walls, position, range, walls, nearest);
        return;
    }
    let _ = (context, make, walls);
    nearest.clear();
}

/// Contacts of some entries of the wall list. Where it is told which of them are `far`, entries without a mark have no wrench already:
/// for those that stay without one none need be written then.
pub(crate) fn wall_contacts<M: ContactLaw>(
    context: &Contacts<'_, M>,
    vector: Option<(Level, &PairKernel<'_>)>,
    (slots, far): (usize, Option<Far<'_>>),
    (sphere, wall): (&[u32], &[u16]),
    mesh_nearest: &[Option<Nearest>],
    (active, numbers, force, torque, on_wall, into): PairParts<'_>,
) {
    let into = &mut into[0];
    into.reset();
    if let (Some((level, kernel)), true) = (vector, mesh_nearest.is_empty()) {
        let walls = context.walls;
        let memory = numbers;
        let mut run = WallRun { walls, sphere, wall, active, memory, force, torque, on_wall, far };
        kernel.wall_contacts(level, &mut run, into);
        return;
    }
    let contact_only = context.gap_forces.is_empty();
    let mut memory = MemoryRun { slots, numbers };
    for k in 0..active.len() {
        let (a, w) = (sphere[k], wall[k]);
        let centre = &context.spheres.position[a as usize];
        let (x, placed) = (centre.vector(), &context.walls[w as usize]);
        if active[k] == 0 && contact_only && placed.misses(x, centre.w) {
            force[k] = Record::default();
            torque[k] = Record::default();
            on_wall[k] = Record::default();
            continue;
        }
        let analytic = placed.nearest(x);
        let nearest = analytic.or_else(|| mesh_nearest.get(k).copied().flatten());
        let wrench = nearest
            .and_then(|n| context.wall(a, w, &n, k, &mut active[k], &mut memory, into))
            .unwrap_or_default();
        force[k].set(wrench.force);
        torque[k].set(wrench.torque_on_first);
        on_wall[k].set(wrench.torque_on_second);
    }
}

/// Collect the near pairs in action, and their ends by pieces of spheres.
fn sort_late(s: &mut Scratch, spheres: usize) {
    s.wrenches.late.clear();
    s.late_ends.clear(spheres);
    for (chunk, _) in s.near_yield.iter().zip(&s.near_told).filter(|(_, told)| **told) {
        s.late_ends.extend(&mut s.wrenches.late, &chunk.late);
    }
}

impl Scratch {
    /// Yields of near pairs and walls that hold near pairs in action or an overlap that is too deep.
    pub(crate) fn told(&self) -> impl Iterator<Item = &ChunkYield> {
        let near = self.near_yield.iter().zip(&self.near_told);
        let walls = self.wall_yield.iter().zip(&self.wall_told);
        near.chain(walls).filter(|(_, told)| **told).map(|(told, _)| told)
    }

    /// Whether two overlap too deeply, as far as near pairs, walls and what was computed ahead tell.
    pub(crate) fn deep_ahead(&self, strips: &Strips) -> bool {
        let mut ahead = strips.ahead().iter().zip(&self.pair_told).filter(|(_, told)| **told);
        self.told().any(|y| y.deep.is_some())
            || ahead.any(|(&chunk, _)| self.pair_yield[chunk as usize].deep.is_some())
    }

    /// Have room for what the chunks of all contacts yield.
    pub(crate) fn room_for_yields(&mut self, pairs: &PairList, wall_runs: usize) {
        let chunks = pairs.touching.div_ceil(CHUNK);
        self.pair_yield.resize_with(chunks, Default::default);
        self.pair_told.resize(chunks, false);
        let near_chunks = pairs.near().len().div_ceil(CHUNK);
        if self.near_yield.len() < near_chunks {
            // Never fewer, and some more, so that a list with a few pairs more asks for no memory.
            self.near_yield.resize_with(near_chunks + near_chunks / 4 + 1, ChunkYield::with_room);
        }
        self.near_yield[near_chunks..].iter_mut().for_each(ChunkYield::reset);
        self.near_told.resize(self.near_yield.len(), false);
        self.near_told[near_chunks..].fill(false);
        self.wall_yield.resize_with(wall_runs, Default::default);
        self.wall_told.resize(wall_runs, false);
    }
}
