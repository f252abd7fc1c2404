//! Making the neighbour list, and knowing when it has to be made again.
//!
//! The list holds every pair whose gap is below the skin. It is good as long as no body has moved
//! by more than half the skin since it was made. In a drum most of the bed turns with the wall
//! like a solid, and a common rigid motion brings no two bodies nearer: so displacements are
//! measured in the frame of the turning wall whenever that makes them smaller.

use glam::DVec3;

use crate::contact::model::ContactLaw;
use crate::error::Error;
use crate::geometry::{PlacedWall, Pose};
use crate::integrate::Integrator;
use crate::neighbour::Period;
use crate::neighbour::verlet_list::Found;
use crate::particles::Record;
use crate::world::{SPHERE, World};

/// Lists between two re-sortings of the bodies in memory.
const BUILDS_PER_SORT: u64 = 16;

/// Share of the skin up to which a gap counts as touching when the list is made.
const TOUCHING_MARGIN: f64 = 0.02;

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Make the list anew.
    pub(crate) fn make_list(&mut self) -> Result<(), Error> {
        self.wrap_and_check()?;
        self.choose_frame();
        let sorted = self.state.list.builds.is_multiple_of(BUILDS_PER_SORT) && !self.is_empty();
        if sorted {
            self.sort_bodies();
        }
        if self.has_clumps() {
            if self.state.members.body.is_empty() {
                self.lay_out_members();
            }
            self.place_members();
        }
        self.find_pairs();
        let slots = self.make.slots;
        let spheres = self.spheres().position.len();
        let (state, s) = (&mut self.state, &mut self.scratch);
        std::mem::swap(&mut state.pairs, &mut s.old_pairs);
        std::mem::swap(&mut state.wall_list, &mut s.old_walls);
        let old_place = sorted.then_some(&s.old_sphere_place[..]);
        state.pairs.fill(spheres, slots, &s.found, &s.old_pairs, old_place);
        self.list_walls(sorted);
        let (state, s) = (&mut self.state, &mut self.scratch);
        state.list.reference.clone_from(&state.bodies.position);
        state.list.time = state.step as f64 * self.make.dt;
        state.list.builds += 1;
        state.list_stale = false;
        s.placed_then.clone_from(&s.placed);
        Ok(())
    }

    /// Check that every body is somewhere in the domain; wrap it into the period.
    fn wrap_and_check(&mut self) -> Result<(), Error> {
        let [min, max] = self.make.domain;
        let gravity = self.make.gravity.at(self.time());
        for k in 0..self.len() {
            let body = &mut self.state.bodies.position[k];
            let mut x = body.vector();
            if !x.is_finite() {
                return Err(self.not_finite(k));
            }
            if let Some(p) = self.make.period {
                let wrapped = wrapped(&p, x[p.axis]);
                let jump = wrapped - x[p.axis];
                if jump != 0.0 {
                    x[p.axis] = wrapped;
                    body.set(x);
                    // The potential counts from the origin: a jump along gravity is no work.
                    let mass = self.state.bodies.velocity[k].w;
                    self.state.ledger.work_of_gravity_turn -= mass * gravity[p.axis] * jump;
                }
            }
            if !(x.cmpge(min).all() && x.cmple(max).all()) {
                return Err(self.lost(k));
            }
        }
        Ok(())
    }

    /// Measure displacements in the frame in which those of the last interval were smaller.
    fn choose_frame(&mut self) {
        let list = &self.state.list;
        if self.make.turning_wall.is_none() || list.reference.len() != self.len() {
            self.state.list.turning = false;
            return;
        }
        let largest = |turn: &Turn| {
            let moved = |(x, r): (&Record, &Record)| {
                let d = Period::shortest(self.make.period, x.vector() - turn.image(r.vector()));
                d.length_squared()
            };
            let bodies = self.state.bodies.position.iter().zip(&list.reference).map(moved);
            bodies.fold(0.0, f64::max).sqrt().max(self.wall_shift(turn))
        };
        let with_wall = self.turn_of_wall(self.time());
        self.state.list.turning = largest(&with_wall) < largest(&Turn::NONE);
    }

    /// Turn of the frame in which displacements are measured, at `time`.
    pub(crate) fn turn_since_list(&self, time: f64) -> Turn {
        if self.state.list.turning { self.turn_of_wall(time) } else { Turn::NONE }
    }

    fn turn_of_wall(&self, time: f64) -> Turn {
        let Some(wall) = self.make.turning_wall else { return Turn::NONE };
        let motion = &self.state.walls[wall];
        Turn::between(&motion.pose(self.state.list.time), &motion.pose(time))
    }

    /// Whether a wall may have come within reach of a sphere that is not listed with it.
    pub(crate) fn walls_moved_far(&self) -> bool {
        if self.state.walls.iter().all(|w| w.motion == crate::geometry::Motion::default()) {
            return false;
        }
        let turn = self.turn_since_list(self.time());
        // The wall list reaches a skin far; half of it is left to the spheres.
        let shift = self.wall_shift(&turn);
        shift.is_nan() || shift > 0.5 * self.make.skin
    }

    /// Largest shift of any wall surface since the list was made, as seen in a turning frame, m.
    fn wall_shift(&self, turn: &Turn) -> f64 {
        let [min, max] = self.make.domain;
        let (centre, extent) = (0.5 * (min + max), 0.5 * (max - min).length());
        let pose = turn.pose();
        let walls = self.scratch.placed.iter().zip(&self.scratch.placed_then);
        walls
            .map(|(now, then)| now.surface_shift(&then.carried(&pose), centre, extent))
            .fold(0.0, f64::max)
    }

    /// Sort the bodies in memory by cells.
    fn sort_bodies(&mut self) {
        let range = self.make.skin + self.make.range;
        let clumps = self.has_clumps();
        let s = &mut self.scratch;
        s.cells.sort(&self.state.bodies.position, range, self.make.period);
        s.order.clone_from(&s.cells.order);
        self.state.bodies.permute(&s.order, &mut s.records);
        // The reference goes with the bodies: it is read once more before it is renewed.
        let had_members = !self.state.members.body.is_empty();
        if !clumps {
            s.old_sphere_place.clone_from(&s.order);
            return;
        }
        let m = &mut self.state.members;
        let old_first = m.first.clone();
        m.shape = s.order.iter().map(|&k| m.shape[k as usize]).collect();
        m.end_spin = s.order.iter().filter_map(|&k| m.end_spin.get(k as usize).copied()).collect();
        m.attitude = s.order.iter().map(|&k| m.attitude[k as usize]).collect();
        self.lay_out_members();
        let (m, s) = (&self.state.members, &mut self.scratch);
        s.old_sphere_place.clear();
        for (body, &old) in s.order.iter().enumerate() {
            let own = m.first[body + 1] - m.first[body];
            let begin = if had_members { old_first[old as usize] } else { 0 };
            s.old_sphere_place.extend((0..own).map(|nth| begin + nth));
        }
    }

    /// Give every body its run of spheres, in the order of the bodies.
    fn lay_out_members(&mut self) {
        let (b, m) = (&self.state.bodies, &mut self.state.members);
        m.first.clear();
        m.id.clear();
        m.body.clear();
        m.arm.clear();
        for body in 0..b.len() {
            m.first.push(m.id.len() as u32);
            let first_id = m.first_id[b.id[body] as usize];
            let mut push = |nth: u32, radius: f64| {
                m.id.push(first_id + nth);
                m.body.push(body as u32);
                m.arm.push(Record { w: radius, ..Record::default() });
            };
            match m.shape[body] {
                SPHERE => push(0, b.position[body].w),
                shape => {
                    for (nth, s) in self.make.shapes[shape as usize].spheres.iter().enumerate() {
                        push(nth as u32, s.radius);
                    }
                }
            }
        }
        m.first.push(m.id.len() as u32);
        for v in [&mut m.position, &mut m.mean_velocity, &mut m.mean_spin, &mut m.end_velocity] {
            v.resize(m.id.len(), Record::default());
        }
        m.end_spin.resize(b.len(), Record::default());
    }

    /// Find all pairs of spheres in reach of each other.
    fn find_pairs(&mut self) {
        let range = self.make.skin + self.make.range;
        let margin = TOUCHING_MARGIN * self.make.skin;
        let (period, clumps) = (self.make.period, self.has_clumps());
        let (b, m, s) = (&self.state.bodies, &self.state.members, &mut self.scratch);
        s.cells.sort(&b.position, range, period);
        s.found.clear();
        let (cells, found) = (&s.cells, &mut s.found);
        let mut keep = |i: u32, j: u32, ids: &[u32], pi: &Record, pj: &Record| {
            let d = Period::shortest(period, pj.vector() - pi.vector()).length_squared();
            let touching = pi.w + pj.w;
            if d < (touching + range).powi(2) {
                let (first, second) =
                    if ids[i as usize] < ids[j as usize] { (i, j) } else { (j, i) };
                found.push(Found { first, second, touching: d < (touching + margin).powi(2) });
            }
        };
        cells.for_each_candidate(0..b.len(), range, period, |k, row| {
            let (i, pi) = (cells.order[k], &cells.sorted[k]);
            for other in row {
                let (j, pj) = (cells.order[other], &cells.sorted[other]);
                if !clumps {
                    keep(i, j, &b.id, pi, pj);
                    continue;
                }
                let d = Period::shortest(period, pj.vector() - pi.vector()).length_squared();
                if d >= (pi.w + pj.w + range).powi(2) {
                    continue;
                }
                for s in m.first[i as usize]..m.first[i as usize + 1] {
                    for t in m.first[j as usize]..m.first[j as usize + 1] {
                        keep(s, t, &m.id, &m.position[s as usize], &m.position[t as usize]);
                    }
                }
            }
        });
    }

    /// List the spheres near walls.
    fn list_walls(&mut self, sorted: bool) {
        let range = self.make.skin + self.make.range;
        let slots = self.make.slots;
        let mut list = std::mem::take(&mut self.state.wall_list);
        list.clear(slots);
        let position = self.spheres().position;
        for (k, p) in position.iter().enumerate() {
            list.start.push(list.len() as u32);
            for (w, wall) in self.scratch.placed.iter().enumerate() {
                if let Some(nearest) = wall.nearest(p.vector()) {
                    // A centre further behind the surface than its diameter is on the other side.
                    if nearest.distance < p.w + range && nearest.distance > -(p.w + range) {
                        list.push(k as u32, w as u16, [0, 0]);
                    }
                }
                #[cfg(feature = "mesh")]
                if let crate::geometry::Shape::Mesh(mesh) = &self.make.walls[w].shape {
                    let local = wall.pose.inverse_point(p.vector());
                    let begin = list.facets.len() as u32;
                    mesh.facets_near(local, p.w + range, &mut list.facets);
                    let end = list.facets.len() as u32;
                    if end > begin {
                        for _ in 0..crate::geometry::mesh::CONTACTS_PER_SPHERE {
                            list.push(k as u32, w as u16, [begin, end]);
                        }
                    }
                }
            }
        }
        list.start.push(list.len() as u32);
        let old_place = sorted.then_some(&self.scratch.old_sphere_place[..]);
        list.take_over(&self.scratch.old_walls, old_place);
        self.state.wall_list = list;
    }
}

impl PlacedWall {
    /// The wall after a rigid motion.
    pub(crate) fn carried(&self, by: &Pose) -> PlacedWall {
        use crate::geometry::PlacedShape;
        PlacedWall {
            shape: match &self.shape {
                PlacedShape::Plane(p) => PlacedShape::Plane(p.placed(by)),
                PlacedShape::Cylinder(c) => PlacedShape::Cylinder(c.placed(by)),
                PlacedShape::Disc(d) => PlacedShape::Disc(d.placed(by)),
                #[cfg(feature = "mesh")]
                PlacedShape::Mesh => PlacedShape::Mesh,
            },
            pose: self.pose.then(by),
            ..self.clone()
        }
    }
}

/// A rigid motion since the list was made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turn {
    rotation: glam::DMat3,
    translation: DVec3,
}

impl Turn {
    pub(crate) const NONE: Self =
        Self { rotation: glam::DMat3::IDENTITY, translation: DVec3::ZERO };

    pub(crate) fn between(then: &crate::geometry::Pose, now: &crate::geometry::Pose) -> Self {
        let q = now.rotation * then.rotation.conjugate();
        Self {
            rotation: glam::DMat3::from_quat(q),
            translation: now.translation - q * then.translation,
        }
    }

    #[inline(always)]
    pub(crate) fn image(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    pub(crate) fn pose(&self) -> crate::geometry::Pose {
        crate::geometry::Pose {
            rotation: glam::DQuat::from_mat3(&self.rotation),
            translation: self.translation,
        }
    }
}

/// Wrap a coordinate into its period.
fn wrapped(period: &Period, x: f64) -> f64 {
    let y = x - period.length * ((x - period.min) / period.length).floor();
    // Rounding may land on the upper end, which belongs to the lower one.
    if y >= period.min + period.length { period.min } else { y }
}
