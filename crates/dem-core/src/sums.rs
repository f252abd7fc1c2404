//! Sums of forces and torques, sphere by sphere or body by body, in a fixed order.

use crate::neighbour::verlet_list::PairList;
use crate::neighbour::wall_list::WallList;
use crate::particles::Record;
use crate::world::{Members, Wrenches};

/// Spheres whose forces are summed at once.
pub(crate) const PIECE: usize = 64;

/// Where spheres find the wrenches that act on them.
#[derive(Clone, Copy)]
pub(crate) struct Collect<'a> {
    pub(crate) pairs: &'a PairList,
    pub(crate) walls: &'a WallList,
    pub(crate) w: &'a Wrenches,
    pub(crate) late_start: &'a [u32],
    pub(crate) late_ends: &'a [u32],
}

/// Forces and torques on up to `PIECE` spheres (or bodies).
pub(crate) struct Sums {
    pub(crate) force: [Record; PIECE],
    pub(crate) torque: [Record; PIECE],
}

impl Sums {
    pub(crate) const ZERO: Self =
        Self { force: [Record::ZERO; PIECE], torque: [Record::ZERO; PIECE] };

    fn clear(&mut self, count: usize) {
        self.force[..count].fill(Record::ZERO);
        self.torque[..count].fill(Record::ZERO);
    }
}

/// Where forces on spheres and torques about their centres go.
trait Sink {
    /// They act on a sphere.
    fn add(&mut self, sphere: u32, force: &Record, torque: &Record);
    /// The force acts the other way.
    fn react(&mut self, sphere: u32, force: &Record, torque: &Record);
}

/// Spheres by themselves.
struct BySphere<'a> {
    begin: usize,
    sums: &'a mut Sums,
}

impl Sink for BySphere<'_> {
    #[inline(always)]
    fn add(&mut self, sphere: u32, force: &Record, torque: &Record) {
        let k = (sphere as usize).wrapping_sub(self.begin) % PIECE;
        self.sums.force[k] = self.sums.force[k].plus(force);
        self.sums.torque[k] = self.sums.torque[k].plus(torque);
    }
    #[inline(always)]
    fn react(&mut self, sphere: u32, force: &Record, torque: &Record) {
        let k = (sphere as usize).wrapping_sub(self.begin) % PIECE;
        self.sums.force[k] = self.sums.force[k].minus(force);
        self.sums.torque[k] = self.sums.torque[k].plus(torque);
    }
}

/// Bodies of several spheres, with torques about their own centres.
struct ByBody<'a> {
    members: &'a Members,
    begin: usize,
    sums: &'a mut Sums,
}

impl Sink for ByBody<'_> {
    #[inline(always)]
    fn add(&mut self, sphere: u32, force: &Record, torque: &Record) {
        let (m, sphere) = (self.members, sphere as usize);
        let k = (m.body[sphere] as usize).wrapping_sub(self.begin) % PIECE;
        let about = Record::new(m.arm[sphere].vector().cross(force.vector()), 0.0);
        self.sums.force[k] = self.sums.force[k].plus(force);
        self.sums.torque[k] = self.sums.torque[k].plus(torque).plus(&about);
    }
    #[inline(always)]
    fn react(&mut self, sphere: u32, force: &Record, torque: &Record) {
        self.add(sphere, &Record::ZERO.minus(force), torque);
    }
}

impl Collect<'_> {
    /// Forces and torques on the spheres from `begin` to `end`, at most a piece.
    #[inline(always)]
    pub(crate) fn spheres(&self, begin: usize, end: usize, sums: &mut Sums) {
        sums.clear(end - begin);
        self.each(begin..end, BySphere { begin, sums });
    }

    /// Forces and torques about their centres on the bodies of several spheres from `begin` to
    /// `end`, at most a piece.
    #[inline(always)]
    pub(crate) fn bodies(&self, members: &Members, begin: usize, end: usize, sums: &mut Sums) {
        sums.clear(end - begin);
        let spheres = members.first[begin] as usize..members.first[end] as usize;
        self.each(spheres, ByBody { members, begin, sums });
    }

    /// Forces on a run of spheres and torques about their centres, contact by contact.
    ///
    /// The order for a sphere is always the same: near pairs, touching pairs in which it is the
    /// first, those in which it is the second, walls. The loops run over contacts and have no branch.
    #[inline(always)]
    fn each(&self, spheres: std::ops::Range<usize>, mut to: impl Sink) {
        let (begin, end) = (spheres.start, spheres.end);
        if begin == end {
            return;
        }
        let (p, w) = (self.pairs, self.w);
        let pieces = begin / PIECE..(end - 1) / PIECE + 1;
        let late = self.late_start[pieces.start] as usize..self.late_start[pieces.end] as usize;
        for &l in &self.late_ends[late] {
            let late = &w.late[(l / 2) as usize];
            let (sphere, f, t) = if l & 1 == 0 {
                (late.first, late.wrench.force, late.wrench.torque_on_first)
            } else {
                (late.second, -late.wrench.force, late.wrench.torque_on_second)
            };
            if spheres.contains(&(sphere as usize)) {
                to.add(sphere, &Record::new(f, 0.0), &Record::new(t, 0.0));
            }
        }
        let own = p.touching_start[begin] as usize..p.touching_start[end] as usize;
        let wrenches = w.pair_force[own.clone()].iter().zip(&w.pair_torque_first[own.clone()]);
        for (&a, (f, t)) in p.first[own].iter().zip(wrenches) {
            to.add(a, f, t);
        }
        let own = p.second_start[begin] as usize..p.second_start[end] as usize;
        for &[pair, b] in &p.by_second[own] {
            let pair = pair as usize;
            to.react(b, &w.pair_force[pair], &w.pair_torque_second[pair]);
        }
        let own = self.walls.start[begin] as usize..self.walls.start[end] as usize;
        let wrenches = w.wall_force[own.clone()].iter().zip(&w.wall_torque[own.clone()]);
        for (&a, (f, t)) in self.walls.sphere[own].iter().zip(wrenches) {
            to.add(a, f, t);
        }
    }
}
