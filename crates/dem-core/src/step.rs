//! The time loop on one screen, and its stages.

use glam::DVec3;

use crate::contact::model::ContactLaw;
use crate::contact_stage::{Collect, near_pairs, sum_all, sum_late, touching_pairs, wall_contacts};
use crate::energy::Flow;
use crate::error::Error;
use crate::geometry::PlacedWall;
use crate::integrate::Integrator;
use crate::particles::Record;
use crate::rigid::FreeRotation;
use crate::simd::widened;
use crate::threads::for_each_chunk;
use crate::world::{BodyYield, Members, SPHERE, World, sphere_view};

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
        let (dt, integrator, level) = (self.make.dt, self.integrator, self.make.level);
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
            result[0].moved_far = widened(level, #[inline(always)] || {
                let mut moved_far = false;
                for k in 0..position.len() {
                    let g = begin + k;
                    let mut memory = recall::<I>(&linear[k]);
                    let (v, a) = (velocity[g].vector(), acceleration[g].vector());
                    let d = integrator.drift(v, a, &mut memory, dt);
                    remember::<I>(&mut linear[k], memory);
                    position[k].add(d.mean_velocity * dt);
                    mean_velocity[k].set(d.mean_velocity);
                    end_velocity[k].set(d.end_velocity);
                    // A clump has no single moment of inertia: it turns elsewhere.
                    if spin[g].w > 0.0 {
                        let mut memory = recall::<I>(&turn[k]);
                        let (w, a) = (spin[g].vector(), angular[g].vector());
                        let d = integrator.drift(w, a, &mut memory, dt);
                        remember::<I>(&mut turn[k], memory);
                        mean_spin[k].set(d.mean_velocity);
                    }
                    let moved = position[k].vector() - frame.image(reference[g].vector());
                    let moved = moved.length_squared();
                    moved_far |= moved > limit || moved.is_nan();
                }
                moved_far
            });
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
        // The portable kernel books energies and gives the same bits, unless roots are fast.
        let fast_roots = self.make.fast_roots;
        let fast = self.make.fast.as_deref().filter(|_| !ledger || fast_roots);
        let only = self.make.one_material.map(|m| m * self.make.materials.len() + m);
        let level = self.make.level;
        let vector = fast.map(|all| crate::simd::PairKernel {
            spheres: context.spheres,
            constants: only.map_or(all, |k| &all[k..=k]),
            materials: context.materials,
            one_size: self.make.one_size,
            period: context.period,
            dt,
            overlap_limit: context.overlap_limit,
            fast_roots,
        });
        let vector = vector.as_ref().map(|kernel| (level, kernel));
        // With fast roots a copy of the contacts is booked, and the contacts go their own way.
        let mut booked = Flow::default();
        if ledger && vector.is_some() {
            touching_pairs(&context, None, threads, &mut pairs.clone(), &mut s);
            s.pair_yield.iter().for_each(|y| booked.add(&y.flow));
        }
        touching_pairs(&context, vector, threads, &mut pairs, &mut s);
        if let Some(first) = s.pair_yield.first_mut() {
            first.flow.add(&booked);
        }
        near_pairs(&context, vector, threads, &mut pairs, &mut s);
        wall_contacts(&context, &self.make, threads, &mut walls, &mut s);
        sum_late(&mut s, context.spheres.position.len());
        if threads == 1 {
            sum_all(&pairs, &walls, &mut s);
        }
        s.placed = placed;
        self.scratch = s;
        self.state.pairs = pairs;
        self.state.wall_list = walls;
    }

    /// Collect forces and bring the velocities to the end of the step (`dt` 0: forces only).
    fn kick(&mut self, dt: f64) {
        let threads = self.team.threads();
        let (integrator, level) = (self.integrator, self.make.level);
        let ledger = self.ledger_wanted;
        let gravity = self.make.gravity.at(self.time());
        let gravity_rate = self.gravity_rate();
        let drag = self.make.drag;
        let shapes = &self.make.shapes;
        let clumps = !shapes.is_empty();
        let mut chunks = std::mem::take(&mut self.scratch.body_yield);
        let (pairs, walls) = (&self.state.pairs, &self.state.wall_list);
        let collect = Collect {
            pairs,
            walls,
            w: &self.scratch.wrenches,
            sum_force: &self.scratch.sum_force,
            sum_torque: &self.scratch.sum_torque,
            complete: threads == 1,
        };
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
            let mut flow = Flow::default();
            widened(level, #[inline(always)] || {
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
                let new = force * (1.0 / mass) + gravity;
                let old = acceleration[k].vector();
                acceleration[k].set(new);
                let moment = spin[k].w;
                let old_turn = angular[k].vector();
                let new_turn = if moment > 0.0 { torque * (1.0 / moment) } else { torque };
                angular[k].set(new_turn);
                if dt == 0.0 {
                    continue;
                }
                let mut memory = recall::<I>(&linear[k]);
                let v = integrator.kick(velocity[k].vector(), old, new, &mut memory, dt);
                velocity[k].set(v);
                remember::<I>(&mut linear[k], memory);
                if moment > 0.0 {
                    let mut memory = recall::<I>(&turn[k]);
                    let w = integrator.kick(
                        spin[k].vector(), old_turn, new_turn, &mut memory, dt);
                    spin[k].set(w);
                    remember::<I>(&mut turn[k], memory);
                } else {
                    let momentum = turn[k].vector() + torque * (0.5 * dt);
                    turn[k].set(momentum);
                    let moments = shapes[m.shape[g] as usize].moments;
                    spin[k].set(spin_of(momentum, m.attitude[g], moments));
                }
            }
            });
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

/// What the integrator remembers, if it does.
#[inline(always)]
fn recall<I: Integrator>(record: &Record) -> DVec3 {
    if I::REMEMBERS { record.vector() } else { DVec3::ZERO }
}

/// Keep what the integrator remembers, if it does.
#[inline(always)]
fn remember<I: Integrator>(record: &mut Record, memory: DVec3) {
    if I::REMEMBERS {
        record.set(memory);
    }
}

/// Angular velocity in the laboratory of a body with this angular momentum.
fn spin_of(momentum: DVec3, attitude: glam::DQuat, moments: DVec3) -> DVec3 {
    attitude * ((attitude.conjugate() * momentum) / moments)
}
