//! The stage of contact forces: kernels over the lists, and sums by sphere.
//!
//! Every contact writes its wrench to its own place; spheres then sum theirs in the order of the
//! list. So any number of threads gives the same bits.

use glam::DVec3;

use crate::contact::model::ContactLaw;
use crate::forces::{Contacts, Late, MemoryRun};
use crate::neighbour::verlet_list::{LANES, PairList};
use crate::neighbour::wall_list::WallList;
use crate::particles::Record;
use crate::simd::{Level, PairKernel, Run};
use crate::step::CHUNK;
use crate::threads::for_each_chunk;
use crate::world::{Make, Members, Scratch, Wrenches};

pub(crate) fn touching_pairs<M: ContactLaw>(
    context: &Contacts<'_, M>,
    vector: Option<(Level, &PairKernel<'_>)>,
    threads: usize,
    pairs: &mut PairList,
    s: &mut Scratch,
) {
    let n = pairs.touching;
    for v in [
        &mut s.wrenches.pair_force,
        &mut s.wrenches.pair_torque_first,
        &mut s.wrenches.pair_torque_second,
    ] {
        v.resize(pairs.near_begin, Record::default());
    }
    s.pair_yield.resize_with(n.div_ceil(CHUNK), Default::default);
    let slots = pairs.slots;
    let (first, second) = (&pairs.first, &pairs.second);
    for_each_chunk!(threads, |c|
    active in pairs.active[..pairs.near_begin], CHUNK;
    numbers in pairs.memory, CHUNK * slots;
    force in s.wrenches.pair_force, CHUNK;
    torque_first in s.wrenches.pair_torque_first, CHUNK;
    torque_second in s.wrenches.pair_torque_second, CHUNK;
    result in s.pair_yield, 1
    => {
        let into = &mut result[0];
        into.reset();
        let begin = c * CHUNK;
        let count = active.len().min(n - begin);
        if let Some((level, kernel)) = vector {
            let end = begin + active.len();
            let (first, second) = (&first[begin..end], &second[begin..end]);
            let mut run = Run {
                pairs: count, first, second, active, memory: numbers, force, torque_first, torque_second };
            kernel.touching(level, &mut run, into);
        } else {
            let mut memory = MemoryRun { slots, numbers };
            for k in 0..count {
                let p = begin + k;
                let wrench = context
                    .pair(first[p], second[p], k, &mut active[k], &mut memory, into)
                    .unwrap_or_default();
                force[k].set(wrench.force);
                torque_first[k].set(wrench.torque_on_first);
                torque_second[k].set(wrench.torque_on_second);
            }
        }
    });
}

pub(crate) fn near_pairs<M: ContactLaw>(
    context: &Contacts<'_, M>,
    vector: Option<(Level, &PairKernel<'_>)>,
    threads: usize,
    pairs: &mut PairList,
    s: &mut Scratch,
) {
    let (begin, slots) = (pairs.near_begin, pairs.slots);
    let n = pairs.near().len();
    s.near_yield.resize_with(n.div_ceil(CHUNK), Default::default);
    let (first, second) = (&pairs.first[begin..], &pairs.second[begin..]);
    debug_assert_eq!(begin % LANES, 0);
    let numbers = &mut pairs.memory[begin * slots..];
    for_each_chunk!(threads, |c|
    active in pairs.active[begin..], CHUNK;
    numbers in numbers, CHUNK * slots;
    result in s.near_yield, 1
    => {
        let into = &mut result[0];
        into.reset();
        let begin = c * CHUNK;
        let (first, second) = (&first[begin..], &second[begin..]);
        let mut memory = MemoryRun { slots, numbers };
        let mut look = |k: usize, active: &mut u8| {
            let (a, b) = (first[k], second[k]);
            if let Some(wrench) = context.pair(a, b, k, active, &mut memory, into) {
                into.late.push(Late { first: a, second: b, wrench });
            }
        };
        // The vector kernel passes over blocks in which nothing touches or touched.
        let blocks = if vector.is_some() { active.len() / LANES } else { 0 };
        for (block, active) in active.chunks_mut(LANES).enumerate() {
            let k = block * LANES;
            let mut touch = u8::MAX;
            if let (Some((level, kernel)), true) = (vector, block < blocks)
                && let (Some(f), Some(s)) = (first[k..].first_chunk(), second[k..].first_chunk())
            {
                touch = kernel.touch(level, f, s);
            }
            for (lane, active) in active.iter_mut().enumerate() {
                if touch >> lane & 1 != 0 || *active != 0 {
                    look(k + lane, active);
                }
            }
        }
    });
}

pub(crate) fn wall_contacts<M: ContactLaw>(
    context: &Contacts<'_, M>,
    make: &Make<M>,
    threads: usize,
    walls: &mut WallList,
    s: &mut Scratch,
) {
    let (n, slots) = (walls.len(), walls.slots);
    for v in [
        &mut s.wrenches.wall_force,
        &mut s.wrenches.wall_torque,
        &mut s.wrenches.wall_torque_on_wall,
    ] {
        v.resize(n, Record::default());
    }
    s.wall_yield.resize_with(n.div_ceil(CHUNK), Default::default);
    #[cfg(feature = "mesh")]
    if walls.facets.is_empty() {
        s.mesh_nearest.clear();
    } else {
        let position = context.spheres.position;
        let nearest = &mut s.mesh_nearest;
        crate::mesh_contacts::assign(
            &make.walls,
            context.walls,
            position,
            make.range,
            walls,
            nearest,
        );
    }
    #[cfg(not(feature = "mesh"))]
    let _ = make;
    let contact_only = context.gap_forces.is_empty();
    let mesh_nearest = &s.mesh_nearest;
    let (sphere, wall) = (&walls.sphere, &walls.wall);
    for_each_chunk!(threads, |c|
    active in walls.active, CHUNK;
    numbers in walls.memory, CHUNK * slots;
    force in s.wrenches.wall_force, CHUNK;
    torque in s.wrenches.wall_torque, CHUNK;
    on_wall in s.wrenches.wall_torque_on_wall, CHUNK;
    result in s.wall_yield, 1
    => {
        let into = &mut result[0];
        into.reset();
        let mut memory = MemoryRun { slots, numbers };
        for k in 0..active.len() {
            let e = c * CHUNK + k;
            let (a, w) = (sphere[e], wall[e]);
            let centre = &context.spheres.position[a as usize];
            let (x, placed) = (centre.vector(), &context.walls[w as usize]);
            if active[k] == 0 && contact_only && placed.misses(x, centre.w) {
                force[k] = Record::default();
                torque[k] = Record::default();
                on_wall[k] = Record::default();
                continue;
            }
            let analytic = placed.nearest(x);
            let nearest = analytic.or_else(|| mesh_nearest.get(e).copied().flatten());
            let wrench = nearest
                .and_then(|n| context.wall(a, w, &n, k, &mut active[k], &mut memory, into))
                .unwrap_or_default();
            force[k].set(wrench.force);
            torque[k].set(wrench.torque_on_first);
            on_wall[k].set(wrench.torque_on_second);
        }
    });
}

/// Add the wrenches of near pairs to their spheres, in the order of the list.
pub(crate) fn sum_late(s: &mut Scratch, spheres: usize) {
    for v in [&mut s.sum_force, &mut s.sum_torque] {
        v.clear();
        v.resize(spheres, Record::default());
    }
    s.wrenches.late.clear();
    for late in s.near_yield.iter().flat_map(|chunk| &chunk.late) {
        let (a, b) = (late.first as usize, late.second as usize);
        s.sum_force[a].add(late.wrench.force);
        s.sum_torque[a].add(late.wrench.torque_on_first);
        s.sum_force[b].add(-late.wrench.force);
        s.sum_torque[b].add(late.wrench.torque_on_second);
        s.wrenches.late.push(*late);
    }
}

/// Add the wrenches of touching pairs and walls, in the order of the lists: what `Collect` does
/// sphere by sphere for several threads, here contact by contact and without a branch.
pub(crate) fn sum_all(pairs: &PairList, walls: &WallList, s: &mut Scratch) {
    let w = &s.wrenches;
    let (force, torque) = (&mut s.sum_force[..], &mut s.sum_torque[..]);
    let places = pairs.first[..pairs.touching].iter().zip(&pairs.second);
    let wrenches = w.pair_force.iter().zip(&w.pair_torque_first).zip(&w.pair_torque_second);
    for ((&a, &b), ((f, ta), tb)) in places.zip(wrenches) {
        let (a, b) = (a as usize, b as usize);
        force[a] = force[a].plus(f);
        torque[a] = torque[a].plus(ta);
        force[b] = force[b].minus(f);
        torque[b] = torque[b].plus(tb);
    }
    for ((&k, f), t) in walls.sphere.iter().zip(&w.wall_force).zip(&w.wall_torque) {
        force[k as usize] = force[k as usize].plus(f);
        torque[k as usize] = torque[k as usize].plus(t);
    }
}

/// Where a sphere finds the wrenches that act on it.
pub(crate) struct Collect<'a> {
    pub(crate) pairs: &'a PairList,
    pub(crate) walls: &'a WallList,
    pub(crate) w: &'a Wrenches,
    pub(crate) sum_force: &'a [Record],
    pub(crate) sum_torque: &'a [Record],
    /// The sums are complete already.
    pub(crate) complete: bool,
}

impl Collect<'_> {
    /// Force and torque on a sphere, always summed in the same order.
    #[inline(always)]
    pub(crate) fn sphere(&self, k: usize) -> (DVec3, DVec3) {
        let (p, w) = (self.pairs, self.w);
        let (mut force, mut torque) = (self.sum_force[k], self.sum_torque[k]);
        if self.complete {
            return (force.vector(), torque.vector());
        }
        for &end in &p.ends[p.ends_start[k] as usize..p.ends_start[k + 1] as usize] {
            let pair = (end / 2) as usize;
            if end & 1 == 0 {
                force = force.plus(&w.pair_force[pair]);
                torque = torque.plus(&w.pair_torque_first[pair]);
            } else {
                force = force.minus(&w.pair_force[pair]);
                torque = torque.plus(&w.pair_torque_second[pair]);
            }
        }
        let entries = self.walls.start[k] as usize..self.walls.start[k + 1] as usize;
        for (f, t) in w.wall_force[entries.clone()].iter().zip(&w.wall_torque[entries]) {
            force = force.plus(f);
            torque = torque.plus(t);
        }
        (force.vector(), torque.vector())
    }

    /// Force and torque about the centre of a body of several spheres.
    pub(crate) fn body(&self, m: &Members, k: usize) -> (DVec3, DVec3) {
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for sphere in m.first[k] as usize..m.first[k + 1] as usize {
            let (f, t) = self.sphere(sphere);
            force += f;
            torque += t + m.arm[sphere].vector().cross(f);
        }
        (force, torque)
    }
}
