//! Sums of forces and torques, sphere by sphere or body by body, in a fixed order.
//!
//! For a sphere that order is always: touching pairs as they stand in the list (those that it does not own
//! come first), near pairs, walls. Touching pairs are summed in one of two ways, to the same bits: each
//! contact adds to the ring as it is computed, or every contact keeps its wrench, and spheres find theirs.

use crate::forces::Late;
use crate::neighbour::verlet_list::PairList;
use crate::neighbour::wall_list::WallList;
use crate::particles::Record;
use crate::spheres::Seats;
use crate::strips::Received;
use crate::world::Wrenches;

/// Spheres whose forces are summed at once.
pub(crate) const PIECE: usize = 128;

/// Spheres whose late ends follow each other. Which they are tells in what order those of a body of several spheres are summed.
const LATE_PIECE: usize = 64;

/// Force and torque on one body: a line of the cache.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Pull {
    pub(crate) force: Record,
    pub(crate) torque: Record,
}

impl Pull {
    pub(crate) const ZERO: Self = Self { force: Record::ZERO, torque: Record::ZERO };
}

/// Wrenches of touching pairs that were kept.
#[derive(Clone, Copy)]
pub(crate) struct KeptWrenches<'a> {
    pub(crate) pairs: &'a PairList,
    /// Forces, torques on the bodies of first and of second spheres.
    pub(crate) wrenches: [&'a [Record]; 3],
}

/// Where spheres find the wrenches that act on them.
#[derive(Clone, Copy)]
pub(crate) struct Collect<'a> {
    /// Those of touching pairs, unless they are in the sums already.
    pub(crate) pairs: Option<KeptWrenches<'a>>,
    pub(crate) walls: &'a WallList,
    pub(crate) w: &'a Wrenches,
    pub(crate) late_ends: &'a LateEnds,
}

/// Ends of near pairs in action, one after the other for each piece of spheres in the order of the list: the place of the pair,
/// twice, plus one for its second sphere.
#[derive(Debug, Clone, Default)]
pub(crate) struct LateEnds {
    /// First and last end of each piece.
    first: Vec<u32>,
    last: Vec<u32>,
    /// Which end of its piece comes behind each.
    next: Vec<u32>,
}

/// No end.
const NONE: u32 = u32::MAX;

impl LateEnds {
    /// Nobody acts, of so many spheres.
    pub(crate) fn clear(&mut self, spheres: usize) {
        for ends in [&mut self.first, &mut self.last] {
            ends.clear();
            ends.resize(spheres.div_ceil(LATE_PIECE), NONE);
        }
        self.next.clear();
    }

    /// The next near pairs act: they join `all`.
    pub(crate) fn extend(&mut self, all: &mut Vec<Late>, more: &[Late]) {
        all.extend_from_slice(more);
        more.iter().for_each(|late| self.push(late));
    }

    fn push(&mut self, late: &Late) {
        for sphere in [late.first, late.second] {
            let (piece, end) = (sphere as usize / LATE_PIECE, self.next.len() as u32);
            match self.last[piece] {
                NONE => self.first[piece] = end,
                before => self.next[before as usize] = end,
            }
            self.last[piece] = end;
            self.next.push(NONE);
        }
    }

    /// Ends of a piece.
    #[inline(always)]
    fn of(&self, piece: usize) -> impl Iterator<Item = u32> {
        let mut end = self.first[piece];
        std::iter::from_fn(move || {
            let now = end;
            (now != NONE).then(|| {
                end = self.next[now as usize];
                now
            })
        })
    }
}

/// Sums of a window of spheres that moves along the list: sphere `k` has the place `k` modulo the length,
/// which is a power of two.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ring(Vec<Pull>);

impl Ring {
    /// Have room for a window of so many spheres and the piece in which it begins; all sums are zero.
    pub(crate) fn cover(&mut self, window: usize, spheres: usize) {
        let most = spheres.next_multiple_of(PIECE).max(PIECE);
        let length = (window + PIECE).min(most).next_power_of_two();
        if self.0.len() != length {
            self.0.clear();
            // Room for any window, so that no later step has to ask for it.
            self.0.reserve_exact(most.next_power_of_two());
            self.0.resize(length, Pull::ZERO);
        }
        debug_assert!(self.0.iter().all(|sum| *sum == Pull::ZERO), "sums were left over");
    }

    /// Whether all of these spheres have a place of their own.
    pub(crate) fn holds(&self, spheres: std::ops::Range<usize>) -> bool {
        spheres.len() <= self.0.len()
    }

    pub(crate) fn slots(&mut self) -> &mut [Pull] {
        &mut self.0
    }

    /// Add wrenches that were kept (forces, torques on the bodies of first and of second spheres), one pair after the other.
    #[inline(always)]
    pub(crate) fn add(
        &mut self,
        first: &[u32],
        second: &[u32],
        wrenches: [&[Record]; 3],
        seats: Seats<'_>,
    ) {
        let within = self.0.len() - 1;
        let [forces, on_first, on_second] = wrenches;
        let torques = on_first.iter().zip(on_second);
        for (((&a, &b), force), (ti, tj)) in first.iter().zip(second).zip(forces).zip(torques) {
            let sum = &mut self.0[seats.body(a as usize) & within];
            sum.force = sum.force.plus(force);
            sum.torque = sum.torque.plus(ti);
            let sum = &mut self.0[seats.body(b as usize) & within];
            sum.force = sum.force.minus(force);
            sum.torque = sum.torque.plus(tj);
        }
    }

    /// Add to bodies what they receive of wrenches that were kept (forces, torques on the bodies of first and of second spheres).
    pub(crate) fn receive(&mut self, received: &[Received], wrenches: [&[Record]; 3]) {
        let within = self.0.len() - 1;
        let [forces, on_first, on_second] = wrenches;
        let torques = [on_first, on_second];
        for of in received {
            let (pair, role) = ((of.wrench / 2) as usize, (of.wrench % 2) as usize);
            let sum = &mut self.0[of.body as usize & within];
            // The second sphere feels the opposite.
            sum.force = sum.force.plus(&(forces[pair] * [1.0, -1.0][role]));
            sum.torque = sum.torque.plus(&torques[role][pair]);
        }
    }

    /// The sums of the spheres of a piece that begins at `begin`.
    pub(crate) fn piece(&mut self, begin: usize, count: usize) -> &mut [Pull] {
        let place = begin % self.0.len();
        &mut self.0[place..place + count]
    }
}

/// Where forces and torques go.
trait Sink {
    /// A force on a sphere, and a torque on its body.
    fn add(&mut self, sphere: u32, force: &Record, torque: &Record);
    /// A force on a sphere, and a torque about its centre.
    fn add_about_sphere(&mut self, sphere: u32, force: &Record, torque: &Record);
}

/// Spheres by themselves.
struct BySphere<'a> {
    begin: usize,
    sums: &'a mut [Pull],
}

impl Sink for BySphere<'_> {
    #[inline(always)]
    fn add(&mut self, sphere: u32, force: &Record, torque: &Record) {
        let k = (sphere as usize).wrapping_sub(self.begin);
        if let Some(sum) = self.sums.get_mut(k) {
            sum.force = sum.force.plus(force);
            sum.torque = sum.torque.plus(torque);
        }
    }

    #[inline(always)]
    fn add_about_sphere(&mut self, sphere: u32, force: &Record, torque: &Record) {
        self.add(sphere, force, torque);
    }
}

/// A run of bodies of several spheres.
#[derive(Clone, Copy)]
pub(crate) struct Seated<'a> {
    pub(crate) seats: Seats<'a>,
    /// Centres of the bodies of the run, and of their spheres.
    pub(crate) centres: &'a [Record],
    pub(crate) spheres: &'a [Record],
}

/// Bodies of several spheres, with torques about their own centres.
struct ByBody<'a> {
    of: Seated<'a>,
    /// The first body, and its first sphere.
    begin: usize,
    first: usize,
    sums: &'a mut [Pull],
}

impl Sink for ByBody<'_> {
    #[inline(always)]
    fn add(&mut self, sphere: u32, force: &Record, torque: &Record) {
        let k = self.of.seats.body(sphere as usize).wrapping_sub(self.begin);
        if let Some(sum) = self.sums.get_mut(k) {
            sum.force = sum.force.plus(force);
            sum.torque = sum.torque.plus(torque);
        }
    }

    #[inline(always)]
    fn add_about_sphere(&mut self, sphere: u32, force: &Record, torque: &Record) {
        let k = self.of.seats.body(sphere as usize).wrapping_sub(self.begin);
        let place = (sphere as usize).wrapping_sub(self.first);
        if let (Some(at), Some(centre)) = (self.of.spheres.get(place), self.of.centres.get(k)) {
            let arm = at.vector() - centre.vector();
            let about = Record::new(arm.cross(force.vector()), 0.0);
            self.add(sphere, force, &torque.plus(&about));
        }
    }
}

impl Collect<'_> {
    /// Forces and torques on the spheres from `begin` to `end`, at most a piece.
    #[inline(always)]
    pub(crate) fn spheres(&self, begin: usize, end: usize, sums: &mut [Pull]) {
        self.each(begin..end, BySphere { begin, sums });
    }

    /// Forces and torques about their centres on the bodies of several spheres from `begin` to
    /// `end`, at most a piece.
    #[inline(always)]
    pub(crate) fn bodies(&self, begin: usize, end: usize, of: Seated<'_>, sums: &mut [Pull]) {
        let (first, last) = (of.seats.first(begin), of.seats.first(end));
        self.each(first..last, ByBody { of, begin, first, sums });
    }

    /// Forces on a run of spheres and torques, contact by contact.
    #[inline(always)]
    fn each(&self, spheres: std::ops::Range<usize>, mut to: impl Sink) {
        let (begin, end) = (spheres.start, spheres.end);
        if begin == end {
            return;
        }
        let w = self.w;
        if let Some(kept) = self.pairs {
            let (p, [forces, on_first, on_second]) = (kept.pairs, kept.wrenches);
            // By tables, not by branches: which one is the first is a matter of chance.
            let torques = [on_first, on_second];
            let mut add = |pair: usize, sphere: u32, as_second: bool| {
                let role = usize::from(as_second);
                // The second sphere feels the opposite.
                let force = forces[pair] * [1.0, -1.0][role];
                to.add(sphere, &force, &torques[role][pair]);
            };
            let later = p.later_start[begin] as usize..p.later_start[end] as usize;
            for &[pair, sphere] in &p.by_later[later] {
                add((pair / 2) as usize, sphere, pair & 1 != 0);
            }
            let own = p.touching_start[begin] as usize..p.touching_start[end] as usize;
            for (pair, (&a, &b)) in own.clone().zip(p.first[own.clone()].iter().zip(&p.second[own]))
            {
                add(pair, a.min(b), b < a);
            }
        }
        let pieces = begin / LATE_PIECE..(end - 1) / LATE_PIECE + 1;
        for l in pieces.flat_map(|piece| self.late_ends.of(piece)) {
            let late = &w.late[(l / 2) as usize];
            let (sphere, f, t) = if l & 1 == 0 {
                (late.first, late.wrench.force, late.wrench.torque_on_first)
            } else {
                (late.second, -late.wrench.force, late.wrench.torque_on_second)
            };
            if spheres.contains(&(sphere as usize)) {
                to.add_about_sphere(sphere, &Record::new(f, 0.0), &Record::new(t, 0.0));
            }
        }
        let own = self.walls.start[begin] as usize..self.walls.start[end] as usize;
        for entry in own {
            // Without a mark there is no wrench. Where several steps are under way the marks are not those of this one.
            if self.walls.active.get(entry) != Some(&0) {
                let (f, t) = (&w.wall_force[entry], &w.wall_torque[entry]);
                to.add_about_sphere(self.walls.sphere[entry], f, t);
            }
        }
    }
}
