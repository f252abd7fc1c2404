//! The stage of bodies: sums of forces, second half of a step, first half of the next.
//!
//! Between two evaluations of forces every body goes its own way, so both halves are done in one
//! pass, piece by piece, while a body is in the cache.

use glam::DVec3;

use crate::contact::model::ContactLaw;
use crate::contact_stage::{CHUNK, Collect, PIECE, Sums};
use crate::energy::Flow;
use crate::integrate::Integrator;
use crate::list::Turn;
use crate::particles::Record;
use crate::rigid::FreeRotation;
use crate::simd::widened;
use crate::threads::cut;
use crate::world::{BodyYield, Make, Members, SPHERE, World};

/// What is done with the bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Halves {
    /// First half of a step: positions.
    Drift,
    /// Second half: forces are summed, velocities brought up.
    Kick,
    /// The second half of one step and the first half of the next.
    KickAndDrift,
    /// Forces are summed, and nothing else.
    Sum,
}

/// A run of bodies.
struct Run<'a> {
    /// Place of the first.
    begin: usize,
    position: &'a mut [Record],
    velocity: &'a mut [Record],
    spin: &'a mut [Record],
    acceleration: &'a mut [Record],
    angular: &'a mut [Record],
    mean_velocity: &'a mut [Record],
    end_velocity: &'a mut [Record],
    mean_spin: &'a mut [Record],
    linear: &'a mut [Record],
    turn: &'a mut [Record],
}

/// What is the same for all bodies in a kick.
struct Kick<'a, M> {
    make: &'a Make<M>,
    members: &'a Members,
    collect: Collect<'a>,
    gravity: DVec3,
    gravity_rate: DVec3,
    ledger: bool,
    /// Time step, s; 0 to sum forces only.
    dt: f64,
}

/// What is the same for all bodies in a drift.
struct Drift<'a> {
    reference: &'a [Record],
    frame: Turn,
    /// Square of the displacement that calls for a list, m2.
    limit: f64,
    dt: f64,
}

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Move all bodies; returns whether after a drift the list may miss a pair.
    pub(crate) fn move_bodies(&mut self, halves: Halves) -> bool {
        let (integrator, level) = (self.integrator, self.make.level);
        let (kicks, drifts) =
            (halves != Halves::Drift, matches!(halves, Halves::Drift | Halves::KickAndDrift));
        let collect = Collect {
            pairs: &self.state.pairs,
            walls: &self.state.wall_list,
            w: &self.scratch.wrenches,
            late_start: &self.scratch.late_start,
            late_ends: &self.scratch.late_ends,
        };
        let kick = Kick {
            make: &self.make,
            members: &self.state.members,
            collect,
            gravity: self.make.gravity.at(self.time()),
            gravity_rate: self.gravity_rate(),
            ledger: self.ledger_wanted,
            dt: if halves == Halves::Sum { 0.0 } else { self.make.dt },
        };
        let drift = Drift {
            reference: &self.state.list.reference,
            frame: self.turn_since_list((self.state.step + 1) as f64 * self.make.dt),
            limit: (0.5 * self.make.skin).powi(2),
            dt: self.make.dt,
        };
        let chunks = &mut self.scratch.body_yield;
        let b = &mut self.state.bodies;
        let count = b.id.len().div_ceil(CHUNK);
        chunks.resize(count, BodyYield::default());
        let parts = (
            cut(&mut b.position, CHUNK),
            cut(&mut b.velocity, CHUNK),
            cut(&mut b.spin, CHUNK),
            cut(&mut b.acceleration, CHUNK),
            cut(&mut b.angular_acceleration, CHUNK),
            cut(&mut b.mean_velocity, CHUNK),
            cut(&mut b.end_velocity, CHUNK),
            cut(&mut b.mean_spin, CHUNK),
            cut(&mut b.linear_memory, CHUNK),
            cut(&mut b.angular_memory, CHUNK),
            cut(chunks, 1),
        );
        self.team.each(count, parts, |c, (x, v, w, a, aw, mv, ev, mw, l, t, result)| {
            let result = &mut result[0];
            if kicks {
                result.flow = Flow::default();
            }
            result.moved_far = false;
            for piece in (0..x.len()).step_by(PIECE) {
                let range = piece..(piece + PIECE).min(x.len());
                let mut run = Run {
                    begin: c * CHUNK + piece,
                    position: &mut x[range.clone()],
                    velocity: &mut v[range.clone()],
                    spin: &mut w[range.clone()],
                    acceleration: &mut a[range.clone()],
                    angular: &mut aw[range.clone()],
                    mean_velocity: &mut mv[range.clone()],
                    end_velocity: &mut ev[range.clone()],
                    mean_spin: &mut mw[range.clone()],
                    linear: &mut l[range.clone()],
                    turn: &mut t[range],
                };
                widened(
                    level,
                    #[inline(always)]
                    || {
                        if kicks {
                            kick.bodies(&integrator, &mut run, &mut result.flow);
                        }
                        if drifts {
                            result.moved_far |= drift.bodies(&integrator, &mut run);
                        }
                    },
                );
            }
        });
        drifts && self.scratch.body_yield.iter().any(|y| y.moved_far)
    }

    /// Turn the clumps freely between two kicks.
    pub(crate) fn turn_clumps(&mut self) {
        let (dt, shapes) = (self.make.dt, &self.make.shapes);
        let b = &mut self.state.bodies;
        let m = &mut self.state.members;
        let torque = &b.angular_acceleration;
        let shape = &m.shape;
        let parts = (
            cut(&mut m.attitude, CHUNK),
            cut(&mut b.mean_spin, CHUNK),
            cut(&mut m.end_spin, CHUNK),
            cut(&mut b.angular_memory, CHUNK),
        );
        let count = shape.len().div_ceil(CHUNK);
        self.team.each(count, parts, |c, (attitude, mean_spin, end_spin, momentum)| {
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
}

impl<M> Kick<'_, M> {
    /// Collect forces and bring the velocities to the end of the step.
    #[inline(always)]
    fn bodies<I: Integrator>(&self, integrator: &I, run: &mut Run<'_>, flow: &mut Flow) {
        let mut sums = Sums::ZERO;
        let (begin, end) = (run.begin, run.begin + run.position.len());
        if self.make.shapes.is_empty() {
            self.collect.spheres(begin, end, &mut sums);
        } else {
            self.collect.bodies(self.members, begin, end, &mut sums);
        }
        let dt = self.dt;
        let sums = sums.force.iter().zip(&sums.torque);
        for (k, (force, torque)) in sums.enumerate().take(run.position.len()) {
            let (mut force, torque) = (force.vector(), torque.vector());
            let mass = run.velocity[k].w;
            if let Some(drag) = &self.make.drag {
                let v = run.end_velocity[k].vector();
                let resistance = drag.force(mass, run.position[k].w, v);
                force += resistance;
                flow.drag -= resistance.dot(v);
            }
            if self.ledger {
                flow.gravity_turn -= mass * self.gravity_rate.dot(run.position[k].vector());
            }
            let new = force * (1.0 / mass) + self.gravity;
            let old = run.acceleration[k].vector();
            run.acceleration[k].set(new);
            let moment = run.spin[k].w;
            let old_turn = run.angular[k].vector();
            let new_turn = if moment > 0.0 { torque * (1.0 / moment) } else { torque };
            run.angular[k].set(new_turn);
            if dt == 0.0 {
                continue;
            }
            let mut memory = recall::<I>(&run.linear[k]);
            let v = integrator.kick(run.velocity[k].vector(), old, new, &mut memory, dt);
            run.velocity[k].set(v);
            remember::<I>(&mut run.linear[k], memory);
            if moment > 0.0 {
                let mut memory = recall::<I>(&run.turn[k]);
                let w = run.spin[k].vector();
                run.spin[k].set(integrator.kick(w, old_turn, new_turn, &mut memory, dt));
                remember::<I>(&mut run.turn[k], memory);
            } else {
                let m = self.members;
                let momentum = run.turn[k].vector() + torque * (0.5 * dt);
                run.turn[k].set(momentum);
                let moments = self.make.shapes[m.shape[begin + k] as usize].moments;
                run.spin[k].set(spin_of(momentum, m.attitude[begin + k], moments));
            }
        }
    }
}

impl Drift<'_> {
    /// Move on to the next step; returns whether the list may miss a pair there.
    #[inline(always)]
    fn bodies<I: Integrator>(&self, integrator: &I, run: &mut Run<'_>) -> bool {
        let dt = self.dt;
        let mut moved_far = false;
        let reference = &self.reference[run.begin..run.begin + run.position.len()];
        for (k, reference) in reference.iter().enumerate() {
            let mut memory = recall::<I>(&run.linear[k]);
            let (v, a) = (run.velocity[k].vector(), run.acceleration[k].vector());
            let d = integrator.drift(v, a, &mut memory, dt);
            remember::<I>(&mut run.linear[k], memory);
            run.position[k].add(d.mean_velocity * dt);
            run.mean_velocity[k].set(d.mean_velocity);
            run.end_velocity[k].set(d.end_velocity);
            // A clump has no single moment of inertia: it turns elsewhere.
            if run.spin[k].w > 0.0 {
                let mut memory = recall::<I>(&run.turn[k]);
                let (w, a) = (run.spin[k].vector(), run.angular[k].vector());
                let d = integrator.drift(w, a, &mut memory, dt);
                remember::<I>(&mut run.turn[k], memory);
                run.mean_spin[k].set(d.mean_velocity);
            }
            let moved = run.position[k].vector() - self.frame.image(reference.vector());
            let moved = moved.length_squared();
            moved_far |= moved > self.limit || moved.is_nan();
        }
        moved_far
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
