//! The time loop on one screen, and its stages.

use glam::DVec3;

use crate::contact::model::ContactLaw;
use crate::error::Error;
use crate::forces::MemoryRun;
use crate::geometry::PlacedWall;
use crate::integrate::Integrator;
use crate::neighbour::verlet_list::LANES;
use crate::neighbour::verlet_list::PairList;
use crate::neighbour::wall_list::WallList;
use crate::particles::Record;
use crate::rigid::FreeRotation;
use crate::threads::for_each_chunk;
use crate::world::{BodyYield, Make, Members, SPHERE, Scratch, World, Wrenches, sphere_view};

/// Bodies and contacts in one chunk of work: whole blocks, enough to be worth a hand-over.
pub(crate) const CHUNK: usize = 512;

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Advance by `steps` time steps.
    ///
    /// # Errors
    /// A [`crate::error::Fault`]; the world is left as it was when the fault was found.
    pub fn run(&mut self, steps: u64) -> Result<(), Error> {
        let team = self.team.clone();
        team.enter(|| {
            self.prepare()?;
            for _ in 0..steps {
                self.advance()?;
            }
            Ok(())
        })
    }

    /// One time step.
    fn advance(&mut self) -> Result<(), Error> {
        let dt = self.make.dt;
        let moved_far = self.drift();
        self.state.step += 1;
        self.move_walls(dt);
        if moved_far || self.walls_moved_far() {
            self.make_list()?;
        }
        self.place_members();
        self.contact_forces(dt);
        self.kick(dt);
        if self.ledger_wanted {
            self.book(dt);
        }
        self.check_overlaps()
    }

    /// Bring lists, forces and accelerations in line with what was set from outside.
    pub(crate) fn prepare(&mut self) -> Result<(), Error> {
        if self.scratch.placed.len() != self.make.walls.len() || self.state.forces_stale {
            self.move_walls(0.0);
        }
        if self.state.list_stale {
            self.make_list()?;
        }
        if !self.state.forces_stale {
            return Ok(());
        }
        let b = &mut self.state.bodies;
        for k in 0..b.len() {
            let (v, w) = (b.velocity[k].vector(), b.spin[k].vector());
            b.mean_velocity[k].set(v);
            b.end_velocity[k].set(v);
            b.mean_spin[k].set(w);
            if let Some(end) = self.state.members.end_spin.get_mut(k) {
                end.set(w);
            }
        }
        self.place_members();
        self.contact_forces(0.0);
        self.kick(0.0);
        self.start_integrator();
        self.state.forces_stale = false;
        self.state.ledger.last = self.flow();
        self.check_overlaps()
    }

    /// First half of the step; returns whether the list may miss a pair now.
    fn drift(&mut self) -> bool {
        let threads = self.team.threads();
        let (dt, integrator) = (self.make.dt, self.integrator);
        let limit = (0.5 * self.make.skin).powi(2);
        let frame = self.turn_since_list((self.state.step + 1) as f64 * dt);
        let b = &mut self.state.bodies;
        let n = b.len();
        let chunks = &mut self.scratch.body_yield;
        chunks.resize(n.div_ceil(CHUNK), BodyYield::default());
        let (velocity, spin) = (&b.velocity, &b.spin);
        let (acceleration, angular) = (&b.acceleration, &b.angular_acceleration);
        let reference = &self.state.list.reference;
        for_each_chunk!(threads, |c|
        position in b.position, CHUNK;
        mean_velocity in b.mean_velocity, CHUNK;
        end_velocity in b.end_velocity, CHUNK;
        mean_spin in b.mean_spin, CHUNK;
        linear in b.linear_memory, CHUNK;
        turn in b.angular_memory, CHUNK;
        result in chunks, 1
        => {
            let begin = c * CHUNK;
            let mut moved_far = false;
            for k in 0..position.len() {
                let g = begin + k;
                let mut memory = linear[k].vector();
                let d = integrator.drift(
                    velocity[g].vector(), acceleration[g].vector(), &mut memory, dt);
                linear[k].set(memory);
                position[k].add(d.displacement);
                mean_velocity[k].set(d.displacement / dt);
                end_velocity[k].set(d.end_velocity);
                // A clump has no single moment of inertia: it turns elsewhere.
                if spin[g].w > 0.0 {
                    let mut memory = turn[k].vector();
                    let d = integrator.drift(
                        spin[g].vector(), angular[g].vector(), &mut memory, dt);
                    turn[k].set(memory);
                    mean_spin[k].set(d.displacement / dt);
                }
                let moved = position[k].vector() - frame.image(reference[g].vector());
                // Written so that a position that is not a number counts as moved.
                moved_far |= !(moved.length_squared() <= limit);
            }
            result[0].moved_far = moved_far;
        });
        if self.has_clumps() {
            self.turn_clumps();
        }
        self.scratch.body_yield.iter().any(|y| y.moved_far)
    }

    /// Turn the clumps freely between two kicks.
    fn turn_clumps(&mut self) {
        let (dt, shapes) = (self.make.dt, &self.make.shapes);
        let b = &mut self.state.bodies;
        let m = &mut self.state.members;
        let (torque, threads) = (&b.angular_acceleration, self.team.threads());
        let shape = &m.shape;
        for_each_chunk!(threads, |c|
        attitude in m.attitude, CHUNK;
        mean_spin in b.mean_spin, CHUNK;
        end_spin in m.end_spin, CHUNK;
        momentum in b.angular_memory, CHUNK
        => {
            for k in 0..attitude.len() {
                let g = c * CHUNK + k;
                if shape[g] == SPHERE {
                    continue;
                }
                let moments = shapes[shape[g] as usize].moments;
                let half = momentum[k].vector() + torque[g].vector() * (0.5 * dt);
                let turn = FreeRotation::turn(moments, attitude[k], half, dt);
                attitude[k] = turn.orientation;
                momentum[k].set(half);
                mean_spin[k].set(turn.mean_spin);
                let end = half + torque[g].vector() * (0.5 * dt);
                end_spin[k].set(spin_of(end, turn.orientation, moments));
            }
        });
    }

    fn move_walls(&mut self, dt: f64) {
        let time = self.time();
        let s = &mut self.scratch;
        if s.placed.len() == self.make.walls.len() {
            for ((p, w), m) in s.placed.iter_mut().zip(&self.make.walls).zip(&self.state.walls) {
                p.update(w, m, time, dt);
            }
        } else {
            s.placed = (self.make.walls.iter().zip(&self.state.walls))
                .map(|(w, m)| PlacedWall::new(w, m, time, dt))
                .collect();
        }
    }

    /// Put the spheres of clumps where their bodies are.
    pub(crate) fn place_members(&mut self) {
        if !self.has_clumps() {
            return;
        }
        let (b, m) = (&self.state.bodies, &mut self.state.members);
        let shapes = &self.make.shapes;
        let dt = if self.state.forces_stale { 0.0 } else { self.make.dt };
        for body in 0..b.len() {
            for (nth, s) in (m.first[body]..m.first[body + 1]).enumerate() {
                let s = s as usize;
                let radius = m.arm[s].w;
                let arm = match m.shape[body] {
                    SPHERE => DVec3::ZERO,
                    shape => m.attitude[body] * shapes[shape as usize].spheres[nth].centre,
                };
                let (mean_spin, end_spin) = (b.mean_spin[body], m.end_spin[body]);
                // The mean of the arms at both ends of the step, which the mean spin turns.
                let back = mean_spin.vector().cross(arm) * (0.5 * dt);
                let middle = arm - back;
                m.arm[s] = Record::new(arm, radius);
                m.position[s] = Record::new(b.position[body].vector() + arm, radius);
                let (v, v_end) = (b.mean_velocity[body], b.end_velocity[body]);
                m.mean_velocity[s] =
                    Record::new(v.vector() + mean_spin.vector().cross(middle), v.w);
                m.mean_spin[s] = mean_spin;
                m.end_velocity[s] =
                    Record::new(v_end.vector() + end_spin.vector().cross(arm), v_end.w);
            }
        }
    }

    /// All contacts: their wrenches go to buffers, in which spheres find them later.
    pub(crate) fn contact_forces(&mut self, dt: f64) {
        let threads = self.team.threads();
        let clumps = self.has_clumps();
        let ledger = self.ledger_wanted;
        let mut pairs = std::mem::take(&mut self.state.pairs);
        let mut walls = std::mem::take(&mut self.state.wall_list);
        let mut s = std::mem::take(&mut self.scratch);
        let placed = std::mem::take(&mut s.placed);
        let context = {
            let make = &self.make;
            crate::forces::Contacts {
                spheres: sphere_view(&self.state, clumps),
                walls: &placed,
                laws: &make.laws,
                materials: make.materials.len(),
                period: make.period,
                dt,
                overlap_limit: make.overlap_limit,
                neck: make.neck,
                gap_forces: &make.gap_forces,
                ledger,
            }
        };
        touching_pairs(&context, threads, &mut pairs, &mut s);
        near_pairs(&context, threads, &mut pairs, &mut s);
        wall_contacts(&context, &self.make, threads, &mut walls, &mut s);
        scatter_late(&mut s, context.spheres.position.len());
        s.placed = placed;
        self.scratch = s;
        self.state.pairs = pairs;
        self.state.wall_list = walls;
    }

    /// Collect forces and bring the velocities to the end of the step (`dt` 0: forces only).
    fn kick(&mut self, dt: f64) {
        let threads = self.team.threads();
        let integrator = self.integrator;
        let ledger = self.ledger_wanted;
        let gravity = self.make.gravity.at(self.time());
        let gravity_rate = self.gravity_rate();
        let drag = self.make.drag;
        let shapes = &self.make.shapes;
        let clumps = !shapes.is_empty();
        let mut chunks = std::mem::take(&mut self.scratch.body_yield);
        let (pairs, walls) = (&self.state.pairs, &self.state.wall_list);
        let collect = Collect { pairs, walls, w: &self.scratch.wrenches };
        let m: &Members = &self.state.members;
        let b = &mut self.state.bodies;
        let (end_velocity, position) = (&b.end_velocity, &b.position);
        chunks.resize(b.id.len().div_ceil(CHUNK), BodyYield::default());
        for_each_chunk!(threads, |c|
        velocity in b.velocity, CHUNK;
        spin in b.spin, CHUNK;
        acceleration in b.acceleration, CHUNK;
        angular in b.angular_acceleration, CHUNK;
        linear in b.linear_memory, CHUNK;
        turn in b.angular_memory, CHUNK;
        result in chunks, 1
        => {
            let mut flow = crate::energy::Flow::default();
            for k in 0..velocity.len() {
                let g = c * CHUNK + k;
                let (mut force, torque) = if clumps {
                    collect.body(m, g)
                } else {
                    collect.sphere(g)
                };
                let mass = velocity[k].w;
                if let Some(drag) = &drag {
                    let v = end_velocity[g].vector();
                    let resistance = drag.force(mass, position[g].w, v);
                    force += resistance;
                    flow.drag -= resistance.dot(v);
                }
                if ledger {
                    flow.gravity_turn -= mass * gravity_rate.dot(position[g].vector());
                }
                let new = force / mass + gravity;
                let old = acceleration[k].vector();
                acceleration[k].set(new);
                let moment = spin[k].w;
                let old_turn = angular[k].vector();
                let new_turn = if moment > 0.0 { torque / moment } else { torque };
                angular[k].set(new_turn);
                if dt == 0.0 {
                    continue;
                }
                let mut memory = linear[k].vector();
                let v = integrator.kick(velocity[k].vector(), old, new, &mut memory, dt);
                velocity[k].set(v);
                linear[k].set(memory);
                if moment > 0.0 {
                    let mut memory = turn[k].vector();
                    let w = integrator.kick(
                        spin[k].vector(), old_turn, new_turn, &mut memory, dt);
                    spin[k].set(w);
                    turn[k].set(memory);
                } else {
                    let momentum = turn[k].vector() + torque * (0.5 * dt);
                    turn[k].set(momentum);
                    let moments = shapes[m.shape[g] as usize].moments;
                    spin[k].set(spin_of(momentum, m.attitude[g], moments));
                }
            }
            result[0].flow = flow;
        });
        self.scratch.body_yield = chunks;
    }

    /// What the integrator remembers, from the present velocities and accelerations.
    fn start_integrator(&mut self) {
        let dt = self.make.dt;
        let b = &mut self.state.bodies;
        for k in 0..b.len() {
            let (v, a) = (b.velocity[k].vector(), b.acceleration[k].vector());
            b.linear_memory[k].set(self.integrator.start(v, a, dt));
            let (w, a) = (b.spin[k].vector(), b.angular_acceleration[k].vector());
            let memory = if b.spin[k].w > 0.0 {
                self.integrator.start(w, a, dt)
            } else {
                let m = &self.state.members;
                let moments = self.make.shapes[m.shape[k] as usize].moments;
                let q = m.attitude[k];
                q * ((q.conjugate() * w) * moments)
            };
            b.angular_memory[k].set(memory);
        }
    }
}

/// Angular velocity in the laboratory of a body with this angular momentum.
fn spin_of(momentum: DVec3, attitude: glam::DQuat, moments: DVec3) -> DVec3 {
    attitude * ((attitude.conjugate() * momentum) / moments)
}

fn touching_pairs<M: ContactLaw>(
    context: &crate::forces::Contacts<'_, M>,
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
        v.resize(n, Record::default());
    }
    s.pair_yield.resize_with(n.div_ceil(CHUNK), Default::default);
    let slots = pairs.slots;
    let (first, second) = (&pairs.first, &pairs.second);
    for_each_chunk!(threads, |c|
    active in pairs.active[..n], CHUNK;
    numbers in pairs.memory, CHUNK * slots;
    force in s.wrenches.pair_force, CHUNK;
    torque_first in s.wrenches.pair_torque_first, CHUNK;
    torque_second in s.wrenches.pair_torque_second, CHUNK;
    result in s.pair_yield, 1
    => {
        let into = &mut result[0];
        into.reset();
        let mut memory = MemoryRun { slots, numbers };
        for k in 0..active.len() {
            let p = c * CHUNK + k;
            let wrench = context
                .pair(first[p], second[p], k, &mut active[k], &mut memory, into)
                .unwrap_or_default();
            force[k].set(wrench.force);
            torque_first[k].set(wrench.torque_on_first);
            torque_second[k].set(wrench.torque_on_second);
        }
    });
}

fn near_pairs<M: ContactLaw>(
    context: &crate::forces::Contacts<'_, M>,
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
        let mut memory = MemoryRun { slots, numbers };
        for k in 0..active.len() {
            let p = c * CHUNK + k;
            let (a, b) = (first[p], second[p]);
            let wrench = context.pair(a, b, k, &mut active[k], &mut memory, into);
            if let Some(wrench) = wrench {
                into.late.push(crate::forces::Late { first: a, second: b, wrench });
            }
        }
    });
}

fn wall_contacts<M: ContactLaw>(
    context: &crate::forces::Contacts<'_, M>,
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
            let x = context.spheres.position[a as usize].vector();
            let analytic = context.walls[w as usize].nearest(x);
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
fn scatter_late(s: &mut Scratch, spheres: usize) {
    for v in [&mut s.wrenches.late_force, &mut s.wrenches.late_torque] {
        v.resize(spheres, Record::default());
    }
    let w = &mut s.wrenches;
    for late in w.late.drain(..) {
        for k in [late.first as usize, late.second as usize] {
            w.late_force[k] = Record::default();
            w.late_torque[k] = Record::default();
        }
    }
    for late in s.near_yield.iter().flat_map(|chunk| &chunk.late) {
        let (a, b) = (late.first as usize, late.second as usize);
        w.late_force[a].add(late.wrench.force);
        w.late_torque[a].add(late.wrench.torque_on_first);
        w.late_force[b].add(-late.wrench.force);
        w.late_torque[b].add(late.wrench.torque_on_second);
        w.late.push(*late);
    }
}

/// Where a sphere finds the wrenches that act on it.
struct Collect<'a> {
    pairs: &'a PairList,
    walls: &'a WallList,
    w: &'a Wrenches,
}

impl Collect<'_> {
    /// Force and torque on a sphere, always summed in the same order.
    #[inline(always)]
    fn sphere(&self, k: usize) -> (DVec3, DVec3) {
        let (p, w) = (self.pairs, self.w);
        let mut force = w.late_force[k].vector();
        let mut torque = w.late_torque[k].vector();
        for pair in p.touching_start[k] as usize..p.touching_start[k + 1] as usize {
            force += w.pair_force[pair].vector();
            torque += w.pair_torque_first[pair].vector();
        }
        for &pair in &p.second_of[p.second_start[k] as usize..p.second_start[k + 1] as usize] {
            force -= w.pair_force[pair as usize].vector();
            torque += w.pair_torque_second[pair as usize].vector();
        }
        for entry in self.walls.start[k] as usize..self.walls.start[k + 1] as usize {
            force += w.wall_force[entry].vector();
            torque += w.wall_torque[entry].vector();
        }
        (force, torque)
    }

    /// Force and torque about the centre of a body of several spheres.
    fn body(&self, m: &Members, k: usize) -> (DVec3, DVec3) {
        let (mut force, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        for sphere in m.first[k] as usize..m.first[k + 1] as usize {
            let (f, t) = self.sphere(sphere);
            force += f;
            torque += t + m.arm[sphere].vector().cross(f);
        }
        (force, torque)
    }
}
