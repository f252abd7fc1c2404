//! The stage of bodies: sums of forces, second half of a step, first half of the next.
//!
//! Between two evaluations of forces every body goes its own way, so both halves are done in one
//! pass, piece by piece, while a body is in the cache.

use glam::DVec3;

use crate::body_run::{Run, cut_bodies, remember, remembered};
use crate::contact::model::ContactLaw;
use crate::contact_stage::CHUNK;
use crate::energy::Flow;
use crate::integrate::Integrator;
use crate::particles::{END, MEAN, Record};
use crate::simd::{Apart, Quad, Quads, RecordWork, on_records};
use crate::spheres::Seats;
use crate::sums::{Collect, KeptWrenches, PIECE, Pull, Seated};
use crate::threads::cut;
use crate::world::{BodyYield, Make, World};

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

/// What is the same for all bodies in a kick.
pub(crate) struct Kick<'a, M> {
    pub(crate) make: &'a Make<M>,
    pub(crate) seats: Seats<'a>,
    pub(crate) collect: Collect<'a>,
    pub(crate) gravity: DVec3,
    pub(crate) gravity_rate: DVec3,
    pub(crate) ledger: bool,
    /// Time step, s; 0 to sum forces only.
    pub(crate) dt: f64,
}

/// What is the same for all bodies in a drift.
pub(crate) struct Drift<'a> {
    pub(crate) reference: &'a [Record],
    /// Columns of the turn of the frame since then.
    pub(crate) frame: [Record; 4],
    pub(crate) dt: f64,
}

/// How far a piece of bodies has moved since the list was made.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Farthest {
    /// Whether the list may miss a pair.
    pub(crate) too_far: bool,
    /// The largest displacement, m, squared.
    pub(crate) square: f64,
}

/// The halves of a step for one piece of bodies.
pub(crate) struct Piece<'a, M, I> {
    pub(crate) integrator: I,
    pub(crate) kick: Option<&'a Kick<'a, M>>,
    pub(crate) drift: Option<&'a Drift<'a>>,
    pub(crate) run: Run<'a>,
    /// Centres of the spheres of these bodies, if some are clumps.
    pub(crate) spheres: &'a [Record],
    /// What acts on them, or zero; zero when they are done.
    pub(crate) sums: &'a mut [Pull],
}

impl<M, I: Integrator> RecordWork for Piece<'_, M, I> {
    /// Powers, and how far they have moved.
    type Yield = (Flow, Farthest);

    #[inline(always)]
    fn run<Q: Quad, W: Quads>(mut self) -> (Flow, Farthest) {
        let mut flow = Flow::default();
        if let (true, Some(kick), Some(drift)) = (I::FROM_MEAN, self.kick, self.drift)
            && kick.moves_on()
        {
            let (integrator, run, sums) = (&self.integrator, &mut self.run, self.sums);
            if kick.make.only_clumps {
                kick.clumps_and_drift::<Q, I>(integrator, run, self.spheres, sums, &mut flow);
                // How far they have moved is told when they have turned.
                return (flow, Farthest::default());
            }
            let farthest = kick.and_drift::<Q, W, I>(drift, integrator, run, sums, &mut flow);
            return (flow, farthest);
        }
        if let Some(kick) = self.kick {
            kick.bodies::<Q, I>(
                &self.integrator,
                &mut self.run,
                self.spheres,
                self.sums,
                &mut flow,
            );
        }
        let farthest = match self.drift {
            Some(drift) => drift.bodies::<Q, I>(&self.integrator, &mut self.run),
            None => Farthest::default(),
        };
        (flow, farthest)
    }
}

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Move all bodies; returns whether after a drift the list may miss a pair.
    pub(crate) fn move_bodies(&mut self, halves: Halves) -> bool {
        let (integrator, level) = (self.integrator, self.make.level);
        let (kicks, drifts) =
            (halves != Halves::Drift, matches!(halves, Halves::Drift | Halves::KickAndDrift));
        let (w, members) = (&self.scratch.wrenches, &self.state.members);
        let seats = members.seats();
        let collect = Collect {
            pairs: Some(KeptWrenches {
                pairs: &self.state.pairs,
                wrenches: [&w.pair_force, &w.pair_torque_first, &w.pair_torque_second],
            }),
            walls: &self.state.wall_list,
            w,
            late_ends: &self.scratch.late_ends,
        };
        let kick = Kick {
            make: &self.make,
            seats,
            collect,
            gravity: self.make.gravity.at(self.time()),
            gravity_rate: self.gravity_rate(),
            ledger: self.ledger_wanted,
            dt: if halves == Halves::Sum { 0.0 } else { self.make.dt },
        };
        let drift = Drift {
            reference: &self.state.list.reference,
            frame: self.turn_since_list((self.state.step + 1) as f64 * self.make.dt).columns(),
            dt: self.make.dt,
        };
        let (chunks, moved) = (&mut self.scratch.body_yield, &mut self.scratch.moved);
        let b = &mut self.state.bodies;
        moved.cover(b.id.len());
        let count = b.id.len().div_ceil(CHUNK);
        chunks.resize(count, BodyYield::default());
        let parts = (cut_bodies(b, CHUNK), cut(&mut moved.square, CHUNK / PIECE), cut(chunks, 1));
        self.team.each(count, parts, |c, (columns, moved, result)| {
            let (mut whole, result) = (Run::of(c * CHUNK, columns), &mut result[0]);
            if kicks {
                result.flow = Flow::default();
            }
            result.moved_far = false;
            let mut sums = [Pull::ZERO; PIECE];
            let count = whole.count();
            for (piece, moved) in (0..count).step_by(PIECE).zip(moved) {
                let range = piece..(piece + PIECE).min(count);
                let run = whole.some(range.clone());
                let kick = kicks.then_some(&kick);
                let drift = drifts.then_some(&drift);
                let spheres = members.of_bodies(run.begin..run.begin + range.len());
                let sums = &mut sums[..range.len()];
                let piece = Piece { integrator, kick, drift, run, spheres, sums };
                let (flow, farthest) = on_records(level, self.make.arithmetic, piece);
                result.flow.add(&flow);
                result.moved_far |= farthest.too_far;
                *moved = moved.max(farthest.square);
            }
        });
        drifts && self.scratch.body_yield.iter().any(|y| y.moved_far)
    }
}

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Velocities and accelerations of the last step, where they were not kept, to rounding.
    pub(crate) fn recall(&mut self) {
        if !(I::FROM_MEAN && self.make.moves_on_without_velocities()) {
            return;
        }
        let (dt, clumps) = (self.make.dt, self.make.only_clumps);
        let mut bodies = std::mem::take(&mut self.state.bodies);
        let m = &self.state.members;
        let turns = self.turns(&m.shape, &m.first);
        let count = bodies.id.len().div_ceil(CHUNK);
        self.team.each(count, cut_bodies(&mut bodies, CHUNK), |c, columns| {
            let mut run = Run::of(c * CHUNK, columns);
            if clumps {
                let own = run.begin..run.begin + run.count();
                turns.recall(&mut run, &m.attitude[own.clone()], &m.end_spin[own]);
            }
            run.recall(dt, clumps);
        });
        self.state.bodies = bodies;
    }
}

impl<M> Kick<'_, M> {
    /// Collect forces and bring the velocities to the end of the step.
    ///
    /// Four numbers at once; the fourth, a scalar that stays, is put back at the end.
    #[inline(always)]
    fn bodies<Q: Quad, I: Integrator>(
        &self,
        integrator: &I,
        run: &mut Run<'_>,
        spheres: &[Record],
        sums: &mut [Pull],
        flow: &mut Flow,
    ) {
        let (begin, end) = (run.begin, run.begin + run.position.len());
        if self.make.shapes.is_empty() {
            self.collect.spheres(begin, end, sums);
        } else {
            let of = Seated { seats: self.seats, centres: run.position, spheres };
            self.collect.bodies(begin, end, of, sums);
        }
        let dt = self.dt;
        let gravity = Q::load(&Record::new(self.gravity, 0.0));
        let run = run.even();
        for (k, sum) in sums.iter_mut().enumerate().take(end - begin) {
            // Zero again for whose turn comes next.
            let Pull { mut force, torque } = std::mem::take(sum);
            let mass = run.velocity[k].w;
            if let Some(drag) = &self.make.drag {
                let v = run.velocities[k][END].vector();
                let resistance = drag.force(mass, run.position[k].w, v);
                force.add(resistance);
                flow.drag -= resistance.dot(v);
            }
            if self.ledger {
                flow.gravity_turn -= mass * self.gravity_rate.dot(run.position[k].vector());
            }
            let new = gravity.plus_times(Q::load(&force), 1.0 / mass);
            let old = Q::load(&run.acceleration[k]);
            new.with_scalar_of(old).store(&mut run.acceleration[k]);
            let moment = run.spin[k].w;
            let old_turn = Q::load(&run.angular[k]);
            let inverse = if moment > 0.0 { 1.0 / moment } else { 1.0 };
            let new_turn = Q::load(&torque) * inverse;
            new_turn.with_scalar_of(old_turn).store(&mut run.angular[k]);
            if dt == 0.0 {
                continue;
            }
            let mut memory = remembered::<Q, I>(run.linear, k);
            let (velocity, mean) = (Q::load(&run.velocity[k]), Q::load(&run.velocities[k][MEAN]));
            let v = integrator.kick(velocity, mean, old, new, &mut memory, dt);
            v.with_scalar_of(velocity).store(&mut run.velocity[k]);
            remember::<Q, I>(run.linear, k, memory);
            if moment > 0.0 {
                let mut memory = remembered::<Q, I>(run.turn, k);
                let (spin, mean) = (Q::load(&run.spin[k]), Q::load(&run.mean_spin[k]));
                let w = integrator.kick(spin, mean, old_turn, new_turn, &mut memory, dt);
                w.with_scalar_of(spin).store(&mut run.spin[k]);
                remember::<Q, I>(run.turn, k, memory);
            } else {
                // Its spin follows from that where anybody asks for it.
                let momentum = run.turn[k].vector() + torque.vector() * (0.5 * dt);
                run.turn[k].set(momentum);
            }
        }
    }
}

impl<M> Kick<'_, M> {
    /// Whether nobody reads velocities and accelerations between steps: where all bodies are spheres, or all are clumps, and no energies
    /// are booked.
    fn moves_on(&self) -> bool {
        self.make.moves_on_without_velocities() && !self.ledger && self.dt > 0.0
    }

    /// What the medium does to bodies.
    #[inline(always)]
    pub(crate) fn add_drag(&self, run: &Run<'_>, sums: &mut [Pull], flow: &mut Flow) {
        let Some(drag) = &self.make.drag else { return };
        for (k, sum) in sums.iter_mut().enumerate().take(run.position.len()) {
            let v = run.velocities[k][END].vector();
            let resistance = drag.force(run.velocities[k][MEAN].w, run.position[k].w, v);
            sum.force.add(resistance);
            flow.drag -= resistance.dot(v);
        }
    }

    /// [`Kick::bodies`] and [`Drift::bodies`] at once for schemes that need nothing of the first half but mean velocities:
    /// four of ten records a body are left alone, but for the moments of inertia beside the spins of spheres that differ. What
    /// velocities and accelerations are follows from what is kept ([`Run::recall`]); the last step of a run keeps them.
    #[inline(always)]
    fn and_drift<Q: Quad, W: Quads, I: Integrator>(
        &self,
        drift: &Drift<'_>,
        integrator: &I,
        run: &mut Run<'_>,
        sums: &mut [Pull],
        flow: &mut Flow,
    ) -> Farthest {
        let (begin, count) = (run.begin, run.position.len());
        self.collect.spheres(begin, begin + count, sums);
        self.add_drag(run, sums, flow);
        let mut farthest = Farthest::default();
        let whole = count - count % W::COUNT;
        let (far, of) = (&mut farthest, (drift, integrator));
        if self.make.one_inertia.is_some() {
            self.some_and_drift::<W, I, true>(of, run, sums, 0..whole, far);
            self.some_and_drift::<Q, I, true>(of, run, sums, whole..count, far);
        } else {
            self.some_and_drift::<W, I, false>(of, run, sums, 0..whole, far);
            self.some_and_drift::<Q, I, false>(of, run, sums, whole..count, far);
        }
        farthest
    }

    /// The same for some of them, as many at a time as `W` holds: of bodies `ALIKE`, mass and moment of inertia are those
    /// of all.
    #[inline(always)]
    fn some_and_drift<W: Quads, I: Integrator, const ALIKE: bool>(
        &self,
        (drift, integrator): (&Drift<'_>, &I),
        run: &mut Run<'_>,
        sums: &mut [Pull],
        bodies: std::ops::Range<usize>,
        farthest: &mut Farthest,
    ) {
        let [mass, moment] = self.make.one_inertia.unwrap_or([1.0; 2]);
        let same = Same {
            gravity: W::alike(&Record::new(self.gravity, 0.0)),
            none: W::alike(&Record::ZERO),
            by_mass: 1.0 / mass,
            by_moment: 1.0 / moment,
            dt: self.dt,
        };
        let reference = &drift.reference[run.begin..run.begin + run.position.len()];
        let mut run = run.even();
        let mut apart = Apart { largest: same.none, beyond: 0 };
        let (begin, end) = (bodies.start, bodies.end);
        let four = 4 * W::COUNT;
        let fours = begin..end - (end - begin) % four;
        for k in fours.clone().step_by(four) {
            // Cut to a length that is known, so that nobody asks for it once more.
            let (sums, reference) = (&mut sums[k..k + four], &reference[k..k + four]);
            let mut run = run.some(k..k + four);
            let (mut now, mut then) = ([same.none; 4], [same.none; 4]);
            for (nth, (now, then)) in now.iter_mut().zip(&mut then).enumerate() {
                let k = nth * W::COUNT;
                *now = same.moved_on::<I, ALIKE>(integrator, &mut run, sums, k);
                *then = W::load_some(&reference[k..]);
            }
            W::four_apart(&now, &then, &drift.frame, &mut apart);
        }
        for k in (fours.end..end).step_by(W::COUNT) {
            let position = same.moved_on::<I, ALIKE>(integrator, &mut run, sums, k);
            position.apart(W::load_some(&reference[k..]), &drift.frame, &mut apart);
        }
        farthest.too_far |= apart.beyond != 0;
        farthest.square = farthest.square.max(apart.largest.largest());
    }
}

/// What is the same for bodies that move on, as many at a time as `W` holds.
struct Same<W> {
    gravity: W,
    none: W,
    /// Where all bodies are alike.
    by_mass: f64,
    by_moment: f64,
    dt: f64,
}

impl<W: Quads> Same<W> {
    /// Move some on; where they are then.
    #[inline(always)]
    fn moved_on<I: Integrator, const ALIKE: bool>(
        &self,
        integrator: &I,
        run: &mut Run<'_>,
        sums: &mut [Pull],
        k: usize,
    ) -> W {
        let &Self { gravity, none, by_mass, by_moment, dt } = self;
        // The sums are zero again for whose turn comes next.
        debug_assert!(sums[k].force.w == 0.0 && sums[k].torque.w == 0.0, "a sum has a scalar");
        let [force, torque] = W::take(&mut sums[k..]);
        // All is read before anything is written: columns often begin at the same place of a page, and some
        // processors take what is read for what has just been written at the same place of another page.
        let [mean, end] = W::load_twos(&run.velocities[k..]);
        let position = W::load_some(&run.position[k..]);
        // Of spins only the moments of inertia beside them count.
        let moments = if ALIKE { none } else { W::load_some(&run.spin[k..]) };
        let mean_spin = W::load_some(&run.mean_spin[k..]);
        // Sums have no scalars, so that those of means stay.
        let a = if ALIKE {
            gravity.plus_times(force, by_mass)
        } else {
            gravity.plus_over_scalars(force, mean)
        };
        let v = integrator.kick(none, mean, none, a, &mut { none }, dt);
        let d = integrator.drift(v, a, &mut { none }, dt);
        let position = position.plus_times(d.mean_velocity, dt).with_scalars_of(position);
        let a = if ALIKE { torque * by_moment } else { torque.over_scalars_of(moments) };
        let w = integrator.kick(none, mean_spin, none, a, &mut { none }, dt);
        let turn = integrator.drift(w, a, &mut { none }, dt);
        let end = d.end_velocity.with_scalars_of(end);
        W::store_twos([d.mean_velocity, end], &mut run.velocities[k..]);
        position.store_some(&mut run.position[k..]);
        turn.mean_velocity.store_some(&mut run.mean_spin[k..]);
        position
    }
}

impl Farthest {
    /// Note the square of a displacement since the list was made.
    #[inline(always)]
    pub(crate) fn note(&mut self, square: f64, limit: f64) {
        // Also if it is no number.
        self.too_far |= !(square <= limit);
        if square > self.square {
            self.square = square;
        }
    }
}

impl Drift<'_> {
    /// Move on to the next step; returns how far they have moved then.
    #[inline(always)]
    fn bodies<Q: Quad, I: Integrator>(&self, integrator: &I, run: &mut Run<'_>) -> Farthest {
        let dt = self.dt;
        let mut farthest = Farthest::default();
        let reference = &self.reference[run.begin..run.begin + run.position.len()];
        let run = run.even();
        for (k, r) in reference.iter().enumerate().take(run.position.len()) {
            let mut memory = remembered::<Q, I>(run.linear, k);
            let (v, a) = (Q::load(&run.velocity[k]), Q::load(&run.acceleration[k]));
            let d = integrator.drift(v, a, &mut memory, dt);
            remember::<Q, I>(run.linear, k, memory);
            let position = Q::load(&run.position[k]);
            let position = position.plus_times(d.mean_velocity, dt).with_scalar_of(position);
            position.store(&mut run.position[k]);
            let old = Q::load(&run.velocities[k][MEAN]);
            d.mean_velocity.with_scalar_of(old).store(&mut run.velocities[k][MEAN]);
            let old = Q::load(&run.velocities[k][END]);
            d.end_velocity.with_scalar_of(old).store(&mut run.velocities[k][END]);
            // A clump has no single moment of inertia: it turns elsewhere.
            if run.spin[k].w > 0.0 {
                let mut memory = remembered::<Q, I>(run.turn, k);
                let (w, a) = (Q::load(&run.spin[k]), Q::load(&run.angular[k]));
                let d = integrator.drift(w, a, &mut memory, dt);
                remember::<Q, I>(run.turn, k, memory);
                let old = Q::load(&run.mean_spin[k]);
                d.mean_velocity.with_scalar_of(old).store(&mut run.mean_spin[k]);
            }
            farthest.note(position.apart_squared(r, &self.frame), r.w);
        }
        farthest
    }
}
