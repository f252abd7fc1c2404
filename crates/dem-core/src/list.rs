//! Making the neighbour list, and knowing when it has to be made again.
//!
//! The list holds every pair whose gap spheres may close before it is made again. It is good as long as no sphere has moved
//! by more than half the skin at most since it was made; those of a clump move with its centre and by its turns. In a drum most of the bed turns with the wall
//! like a solid, and a common rigid motion brings no two bodies nearer: so displacements are
//! measured in the frame of the turning wall whenever that makes them smaller.
//!
//! Most of a bed moves slowly in that frame, and need not list pairs for the sake of the few that are fast: each body has a share
//! of the skin by its speed. The list is good as long as none has moved by more than its own, and a pair is listed whose
//! gap is below what both may move. In beds that no cache holds, which ask seldom whether the list holds, all have half the skin.

use glam::DVec3;

use crate::contact::model::ContactLaw;
use crate::error::Error;
use crate::geometry::{PlacedWall, Pose};
use crate::integrate::Integrator;
use crate::neighbour::Period;
use crate::neighbour::cell_list::columns_of;
use crate::neighbour::search::Search;
use crate::neighbour::verlet_list::{Found, LANES};
use crate::particles::{MEAN, Record};
use crate::simd::widened_for;
use crate::step::kernel_of;
use crate::sums::PIECE;
use crate::sweep::{FAR, MOST_STEPS};
use crate::threads::{PART, cut, part};
use crate::world::{Kept, SPHERE, World, sphere_view};

/// Lists between two re-sortings of the bodies in memory.
const BUILDS_PER_SORT: u64 = 16;

/// Share of the skin up to which a gap counts as touching when the list is made; of spheres of clumps, of which few of many near pairs
/// ever touch, less.
const TOUCHING_MARGIN: f64 = 0.05;
const TOUCHING_MARGIN_OF_CLUMPS: f64 = 0.02;

/// What a body at rest may move before the list is made again, over half the skin: more by its speed over that of the fastest.
const LEAST_RESERVE: f64 = 0.25;

/// What a body moves in a step at least, if it stood still when the list was made: as share of the skin.
const LEAST_STRIDE: f64 = 1e-3;

/// Bodies whose partners are searched in one chunk of work.
const SEARCH: usize = 512;

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
        self.share_out_skin();
        self.find_pairs();
        let slots = self.make.slots;
        let spheres = self.sphere_positions().len();
        let (state, s) = (&mut self.state, &mut self.scratch);
        std::mem::swap(&mut state.pairs, &mut s.old_pairs);
        std::mem::swap(&mut state.wall_list, &mut s.old_walls);
        // The old list is only read for what its contacts remember: one such index is enough.
        std::mem::swap(&mut state.pairs.by_later, &mut s.old_pairs.by_later);
        std::mem::swap(&mut state.pairs.later_start, &mut s.old_pairs.later_start);
        if sorted {
            s.new_sphere_place.clear();
            s.new_sphere_place.resize(s.old_sphere_place.len(), 0);
            for (new, &old) in s.old_sphere_place.iter().enumerate() {
                s.new_sphere_place[old as usize] = new as u32;
            }
        }
        let new_place = sorted.then_some(&s.new_sphere_place[..]);
        let seats = state.members.seats();
        let old = (&s.old_pairs, new_place);
        state.pairs.fill(spheres, slots, &s.found, old, seats, &self.team);
        self.list_walls(sorted);
        // Entries without a mark have no wrench.
        self.scratch.wrenches.clear_walls();
        let (state, s) = (&mut self.state, &mut self.scratch);
        let (position, reserve) = (&state.bodies.position, &s.reserve);
        state.list.reference.make_room(position.len(), Record::ZERO);
        let parts = cut(&mut state.list.reference, PART);
        self.team.each(position.len().div_ceil(PART), parts, |c, reference| {
            let own = part(c, position.len());
            for ((to, x), reserve) in
                reference.iter_mut().zip(&position[own.clone()]).zip(&reserve[own])
            {
                *to = Record { w: reserve * reserve, ..*x };
            }
        });
        state.list.attitude.clone_from(&state.members.attitude);
        state.list.time = state.step as f64 * self.make.dt;
        state.list.builds += 1;
        state.list_stale = false;
        s.moved.reset(&s.reserve);
        s.placed_then.clone_from(&s.placed);
        s.kept = Kept::None;
        s.strips.forget();
        s.shares.forget();
        s.whole.forget();
        self.scratch.stride = self.longest_stride();
        self.order_near();
        Ok(())
    }

    /// Give every body what it may move before the list is made again: half the skin, and those that move slowly less, but in beds
    /// that no cache holds.
    fn share_out_skin(&mut self) {
        let (half, dt) = (0.5 * self.make.skin, self.make.dt);
        let turn = match self.make.turning_wall.filter(|_| self.state.list.turning) {
            Some(wall) => {
                let (motion, now) = (&self.state.walls[wall], self.time());
                Turn::between(&motion.pose(now), &motion.pose(now + dt))
            }
            None => Turn::NONE,
        };
        let (b, m, s) = (&self.state.bodies, &self.state.members, &mut self.scratch);
        if self.make.shapes.is_empty() && b.len() > FAR {
            s.reserve.clear();
            s.reserve.resize(b.len(), half);
            return;
        }
        let (angular, shapes) = (turn.angular_velocity(dt), &self.make.shapes);
        let stride = |k: usize| {
            let x = b.position[k].vector();
            let carried = turn.image(x) - x;
            let shape = m.shape.get(k).and_then(|shape| shapes.get(*shape as usize));
            let reach = shape.map_or(0.0, |s| s.reach);
            let spin = b.mean_spin[k].vector() - angular;
            (b.velocities[k][MEAN].vector() * dt - carried).length() + reach * spin.length() * dt
        };
        s.reserve.resize(b.len(), 0.0);
        self.team.each(b.len().div_ceil(PART), cut(&mut s.reserve, PART), |c, strides| {
            for (to, k) in strides.iter_mut().zip(part(c, b.len())) {
                *to = stride(k);
            }
        });
        let most = s.reserve.iter().fold(1e-3 * half, |most, stride| most.max(*stride));
        for reserve in &mut s.reserve {
            *reserve = (LEAST_RESERVE * half + half / most * *reserve).min(half);
        }
    }

    /// Sort the near pairs by their gaps, where kernels look at pairs.
    fn order_near(&mut self) {
        let clumps = self.has_clumps();
        let s = &mut self.scratch;
        let (bodies, members, make) = (&self.state.bodies, &self.state.members, &self.make);
        let spheres = sphere_view(bodies, members, clumps, make.dt);
        match kernel_of(make, spheres, make.dt, false) {
            Some(kernel) => {
                let range = make.skin + make.range;
                let body = clumps.then_some(&members.body[..]);
                let gaps = |first: &[_], second: &[_], gaps: &mut [_]| {
                    kernel.gaps(make.level, first, second, gaps);
                };
                s.near_order.make(&self.state.pairs, range, &self.team, body, gaps);
            }
            None => s.near_order.forget(),
        }
    }

    /// Check that every body is somewhere in the domain; wrap it into the period.
    fn wrap_and_check(&mut self) -> Result<(), Error> {
        let ([min, max], period) = (self.make.domain, self.make.period);
        let stays = |body: &Record| {
            let x = body.vector();
            let here = period.is_none_or(|p| wrapped(&p, x[p.axis]) == x[p.axis]);
            here && x.is_finite() && x.cmpge(min).all() && x.cmple(max).all()
        };
        let (position, bodies) = (&self.state.bodies.position, self.len());
        if self.team.all(bodies.div_ceil(PART), |c| position[part(c, bodies)].iter().all(stays)) {
            return Ok(());
        }
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
        let (period, position, reference) =
            (self.make.period, &self.state.bodies.position, &list.reference);
        let largest = |turn: &Turn| {
            let moved = |(x, r): (&Record, &Record)| {
                let d = Period::shortest(period, x.vector() - turn.image(r.vector()));
                d.length_squared()
            };
            let farthest = self.team.largest(position.len().div_ceil(PART), |c| {
                let own = part(c, position.len());
                let bodies = position[own.clone()].iter().zip(&reference[own]).map(moved);
                bodies.fold(0.0, f64::max)
            });
            farthest.sqrt().max(self.wall_shift(&self.scratch.placed, turn))
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
        self.is_far(self.shift_of_walls())
    }

    /// Tell those who ask which spheres are far from walls by how much these have moved: in beds of clumps alone.
    pub(crate) fn tell_shift_of_walls(&mut self) {
        if self.has_clumps() {
            self.scratch.wall_shift = self.shift_of_walls();
        }
    }

    /// Largest shift of any wall surface by now since the list was made, in its frame, m.
    fn shift_of_walls(&self) -> f64 {
        if self.state.walls.iter().all(|w| w.motion == crate::geometry::Motion::default()) {
            return 0.0;
        }
        self.wall_shift(&self.scratch.placed, &self.turn_since_list(self.time()))
    }

    /// Whether walls have moved further than the list allows: it reaches a skin far, and half of that is left to the spheres.
    fn is_far(&self, shift: f64) -> bool {
        shift.is_nan() || shift > 0.5 * self.make.skin
    }

    /// More than any body moves in a step in the frame of the list, m: twice what the fastest does now, and a little.
    fn longest_stride(&self) -> f64 {
        let (b, dt) = (&self.state.bodies, self.make.dt);
        if b.len() <= self.make.far {
            return f64::INFINITY;
        }
        let turn = self.turn_since_list(self.time() + dt);
        let bodies = b.position.iter().zip(b.velocity.iter().zip(&b.velocities));
        let strides = bodies.flat_map(|(x, (now, of_two))| {
            let carried = turn.image(x.vector()) - x.vector();
            [now, &of_two[MEAN]].map(|v| (v.vector() * dt - carried).length_squared())
        });
        let longest = strides.fold(0.0, f64::max);
        2.0 * longest.sqrt() + LEAST_STRIDE * self.make.skin
    }

    /// For how many steps after this one the list surely holds and is not asked: none but in a far bed, where several steps
    /// may go in one sweep. (Should a body double its speed in so few steps, the list is made when they are over.)
    pub(crate) fn list_holds(&mut self) -> u64 {
        let s = &self.scratch;
        if self.len() <= self.make.far
            || self.has_clumps()
            || !self.state.wall_list.facets.is_empty()
        {
            return 0;
        }
        if s.moved.square.len() != self.len().div_ceil(PIECE) {
            return 0;
        }
        let (room, stride) = (s.moved.room(), s.stride);
        // None where one of them is not known.
        let in_room = |step: &u64| *step as f64 * stride <= room;
        let holds = (1..MOST_STEPS as u64).take_while(in_room).count() as u64;
        if self.state.walls.iter().all(|w| w.motion == crate::geometry::Motion::default()) {
            return holds;
        }
        let mut placed = std::mem::take(&mut self.scratch.placed_later);
        let stays = |step: &u64| {
            let time = (self.state.step + step) as f64 * self.make.dt;
            self.place_walls(&mut placed, time, self.make.dt);
            !self.is_far(self.wall_shift(&placed, &self.turn_since_list(time)))
        };
        let holds = (1..=holds).take_while(stays).count() as u64;
        self.scratch.placed_later = placed;
        holds
    }

    /// Largest shift of any wall surface since the list was made, as seen in a turning frame, m.
    fn wall_shift(&self, placed: &[PlacedWall], turn: &Turn) -> f64 {
        let [min, max] = self.make.domain;
        let (centre, extent) = (0.5 * (min + max), 0.5 * (max - min).length());
        let pose = turn.pose();
        let walls = placed.iter().zip(&self.scratch.placed_then);
        walls
            .map(|(now, then)| now.surface_shift(&then.carried(&pose), centre, extent))
            .fold(0.0, f64::max)
    }

    /// Sort the bodies in memory by cells.
    fn sort_bodies(&mut self) {
        let range = self.make.skin + self.make.range;
        let clumps = self.has_clumps();
        let s = &mut self.scratch;
        s.cells.sort(&self.state.bodies.position, range, self.make.period, &self.team);
        s.order.clear();
        s.order.extend_from_slice(s.cells.order());
        // The search sorts anew afterwards, so its positions lend their memory.
        self.state.bodies.permute(&s.order, &mut s.cells.sorted, &self.team);
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
        m.position.clear();
        for body in 0..b.len() {
            m.first.push(m.id.len() as u32);
            let first_id = m.first_id[b.id[body] as usize];
            let mut push = |nth: u32, radius: f64| {
                m.id.push(first_id + nth);
                m.body.push(body as u32);
                m.position.push(Record { w: radius, ..Record::default() });
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
        m.end_spin.resize(b.len(), Record::default());
    }

    /// Find all pairs of spheres in reach of each other.
    fn find_pairs(&mut self) {
        let range = self.make.skin + self.make.range;
        let (period, level) = (self.make.period, self.make.level);
        let clumps = self.has_clumps();
        let margin = if clumps { TOUCHING_MARGIN_OF_CLUMPS } else { TOUCHING_MARGIN };
        let s = &mut self.scratch;
        let bodies = self.state.bodies.len();
        s.cells.sort(&self.state.bodies.position, range, period, &self.team);
        s.sorted_reserve.make_room(bodies + LANES, 0.0);
        s.sorted_reserve[bodies..].fill(0.0);
        let (order, reserve) = (s.cells.order(), &s.reserve);
        let parts = cut(&mut s.sorted_reserve[..bodies], PART);
        self.team.each(bodies.div_ceil(PART), parts, |c, sorted| {
            for (to, &from) in sorted.iter_mut().zip(&order[part(c, bodies)]) {
                *to = reserve[from as usize];
            }
        });
        if clumps {
            columns_of(&self.state.members.position, &mut s.sphere_columns);
        }
        let search = Search {
            cells: &s.cells,
            bodies: &self.state.bodies,
            members: clumps.then_some(&self.state.members),
            spheres: &s.sphere_columns,
            range,
            reserve: &s.reserve,
            sorted_reserve: &s.sorted_reserve,
            reach: self.make.range,
            margin: margin * self.make.skin,
            period,
        };
        let count = bodies.div_ceil(SEARCH);
        s.found.resize_with(count, Found::default);
        self.team.each(count, cut(&mut s.found, 1), |c, found| {
            found[0].begin(SEARCH);
            let places = c * SEARCH..((c + 1) * SEARCH).min(bodies);
            widened_for(
                level,
                #[inline(always)]
                |level| search.pairs_of(level, places, &mut found[0]),
            );
        });
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

    /// Columns of the rotation and the translation, as records.
    pub(crate) fn columns(&self) -> [Record; 4] {
        let r = &self.rotation;
        [r.x_axis, r.y_axis, r.z_axis, self.translation].map(|v| Record::new(v, 0.0))
    }

    /// Angular velocity of a turn that takes `dt`, rad/s.
    pub(crate) fn angular_velocity(&self, dt: f64) -> DVec3 {
        self.quaternion().to_scaled_axis() / dt
    }

    /// The rotation as a quaternion.
    pub(crate) fn quaternion(&self) -> glam::DQuat {
        glam::DQuat::from_mat3(&self.rotation)
    }

    pub(crate) fn pose(&self) -> crate::geometry::Pose {
        crate::geometry::Pose { rotation: self.quaternion(), translation: self.translation }
    }
}

/// Wrap a coordinate into its period.
fn wrapped(period: &Period, x: f64) -> f64 {
    let y = x - period.length * ((x - period.min) / period.length).floor();
    // Rounding may land on the upper end, which belongs to the lower one.
    if y >= period.min + period.length { period.min } else { y }
}
