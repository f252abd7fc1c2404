//! The stages of clumps: how they move on, their turns, their spins, and where their spheres are.

use glam::DQuat;

use crate::body_run::{Run, cut_bodies};
use crate::body_stage::{Farthest, Kick};
use crate::contact::model::ContactLaw;
use crate::contact_stage::CHUNK;
use crate::energy::Flow;
use crate::integrate::Integrator;
use crate::particles::{END, MEAN, Record};
use crate::rigid::{Clump, spin_of};
use crate::simd::{Arithmetic, Level, OnBodies as _, Placing, Quad, Since, Turning};
use crate::sums::{PIECE, Pull, Seated};
use crate::threads::{cut, cut_groups};
use crate::world::{BodyYield, SPHERE, World};

/// What is the same for all clumps that turn.
#[derive(Clone, Copy)]
pub(crate) struct Turns<'a> {
    pub(crate) shapes: &'a [Clump],
    /// Shape of each body.
    pub(crate) shape: &'a [u32],
    pub(crate) first: &'a [u32],
    /// Positions and attitudes when the list was made.
    reference: &'a [Record],
    attitude: &'a [DQuat],
    /// How far the frame of the list has turned since: columns of the rotation and the translation, and the rotation.
    frame: [Record; 4],
    turn: DQuat,
    dt: f64,
    level: Level,
    arithmetic: Arithmetic,
}

/// Attitudes of some bodies, their spins foretold for the end of a step, and where their spheres are.
pub(crate) type Turned<'a> = (&'a mut [DQuat], &'a mut [Record], &'a mut [Record]);

impl Turns<'_> {
    /// Turn a run of bodies freely, their centres having moved already; returns how far their spheres have moved.
    pub(crate) fn turn(
        &self,
        run: &mut Run<'_>,
        attitude: &mut [DQuat],
        end_spin: &mut [Record],
    ) -> Farthest {
        let own = run.begin..run.begin + attitude.len();
        let since = Since {
            position: run.position,
            reference: &self.reference[own.clone()],
            attitude: &self.attitude[own.clone()],
            frame: &self.frame,
            turn: self.turn,
        };
        let mut farthest = Farthest::default();
        let turning = Turning {
            shapes: self.shapes,
            shape: &self.shape[own],
            torque: run.angular,
            attitude,
            mean_spin: run.mean_spin,
            end_spin,
            momentum: run.turn,
            dt: self.dt,
            since,
            farthest: &mut farthest,
        };
        turning.run(self.level, self.arithmetic);
        farthest
    }

    /// Turn a run of bodies and put their spheres in their places.
    pub(crate) fn turn_and_place(
        &self,
        run: &mut Run<'_>,
        (attitude, end_spin, spheres): Turned<'_>,
    ) -> Farthest {
        if self.shapes.is_empty() {
            return Farthest::default();
        }
        let farthest = self.turn(run, attitude, end_spin);
        let own = run.begin..run.begin + attitude.len();
        let placing = Placing {
            shapes: self.shapes,
            shape: &self.shape[own.clone()],
            attitude,
            centre: run.position,
            first: &self.first[own.start..=own.end],
            position: spheres,
        };
        placing.run(self.level, self.arithmetic);
        farthest
    }

    /// Torques that were not kept when clumps moved on, to rounding: the spins foretold for the end of the step to come have those of
    /// half a step in them, the momenta have not.
    pub(crate) fn recall(&self, run: &mut Run<'_>, attitude: &[DQuat], end_spin: &[Record]) {
        for (k, (q, spin)) in attitude.iter().zip(end_spin).enumerate() {
            let moments = self.shapes[self.shape[run.begin + k] as usize].moments;
            let end = *q * ((q.conjugate() * spin.vector()) * moments);
            run.angular[k].set((end - run.turn[k].vector()) * (2.0 / self.dt));
        }
    }

    /// Turn a run of bodies back by what they have turned last, to rounding.
    pub(crate) fn undo(&self, run: &mut Run<'_>, attitude: &mut [DQuat]) {
        let dt = self.dt;
        for (k, q) in attitude.iter_mut().enumerate() {
            if self.shape[run.begin + k] == SPHERE {
                continue;
            }
            let half = run.mean_spin[k].vector() * (-0.5 * dt);
            *q = (DQuat::from_xyzw(half.x, half.y, half.z, 1.0) * *q).normalize();
            let momentum = run.turn[k].vector() - run.angular[k].vector() * (0.5 * dt);
            run.turn[k].set(momentum);
        }
    }
}

impl<M> Kick<'_, M> {
    /// [`Kick::and_drift`] for clumps, whose torques and angular momenta are brought up for the turn to come: of their columns
    /// velocities, accelerations and angular velocities are left alone.
    #[inline(always)]
    pub(crate) fn clumps_and_drift<Q: Quad, I: Integrator>(
        &self,
        integrator: &I,
        run: &mut Run<'_>,
        spheres: &[Record],
        sums: &mut [Pull],
        flow: &mut Flow,
    ) {
        let (begin, end) = (run.begin, run.begin + run.position.len());
        let of = Seated { seats: self.seats, centres: run.position, spheres };
        self.collect.bodies(begin, end, of, sums);
        self.add_drag(run, sums, flow);
        let (dt, none) = (self.dt, Q::load(&Record::ZERO));
        let gravity = Q::load(&Record::new(self.gravity, 0.0));
        let run = run.even();
        // Neighbours are mostly of one mass: they need no division.
        let (mut mass, mut by_mass) = (1.0, 1.0);
        for (k, sum) in sums.iter_mut().enumerate().take(end - begin) {
            // Zero again for whose turn comes next.
            let Pull { force, torque } = std::mem::take(sum);
            let own = run.velocities[k][MEAN].w;
            if own.to_bits() != f64::to_bits(mass) {
                (mass, by_mass) = (own, 1.0 / own);
            }
            let a = gravity.plus_times(Q::load(&force), by_mass);
            let mean = Q::load(&run.velocities[k][MEAN]);
            let v = integrator.kick(none, mean, none, a, &mut { none }, dt);
            let d = integrator.drift(v, a, &mut { none }, dt);
            let position = Q::load(&run.position[k]);
            let position = position.plus_times(d.mean_velocity, dt).with_scalar_of(position);
            position.store(&mut run.position[k]);
            d.mean_velocity.with_scalar_of(mean).store(&mut run.velocities[k][MEAN]);
            let old = Q::load(&run.velocities[k][END]);
            d.end_velocity.with_scalar_of(old).store(&mut run.velocities[k][END]);
            let torque = Q::load(&torque);
            torque.store(&mut run.angular[k]);
            let momentum = Q::load(&run.turn[k]);
            (momentum + torque * (0.5 * dt)).store(&mut run.turn[k]);
        }
    }
}

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// What is the same for all clumps that turn after the present step, whose shapes and first spheres are given.
    pub(crate) fn turns<'a>(&'a self, shape: &'a [u32], first: &'a [u32]) -> Turns<'a> {
        let (make, list) = (&self.make, &self.state.list);
        let turn = self.turn_since_list((self.state.step + 1) as f64 * make.dt);
        Turns {
            shapes: &make.shapes,
            shape,
            first,
            reference: &list.reference,
            attitude: &list.attitude,
            frame: turn.columns(),
            turn: turn.quaternion(),
            dt: make.dt,
            level: make.level,
            arithmetic: make.arithmetic,
        }
    }

    /// Turn the clumps freely between two kicks, their centres having moved already; returns whether after that the list may miss
    /// a pair of their spheres.
    pub(crate) fn turn_clumps(&mut self) -> bool {
        if !self.has_clumps() {
            return false;
        }
        let mut bodies = std::mem::take(&mut self.state.bodies);
        let mut attitude = std::mem::take(&mut self.state.members.attitude);
        let mut end_spin = std::mem::take(&mut self.state.members.end_spin);
        let mut s = std::mem::take(&mut self.scratch);
        s.moved.cover(bodies.len());
        let count = bodies.len().div_ceil(CHUNK);
        s.body_yield.resize(count, BodyYield::default());
        let turns = self.turns(&self.state.members.shape, &self.state.members.first);
        let parts = (
            cut_bodies(&mut bodies, CHUNK),
            (cut(&mut attitude, CHUNK), cut(&mut end_spin, CHUNK)),
            (cut(&mut s.moved.square, CHUNK / PIECE), cut(&mut s.body_yield, 1)),
        );
        self.team.each(count, parts, |c, (columns, (attitude, end_spin), (moved, yields))| {
            let mut whole = Run::of(c * CHUNK, columns);
            let count = whole.count();
            yields[0].moved_far = false;
            for (begin, moved) in (0..count).step_by(PIECE).zip(moved) {
                let own = begin..(begin + PIECE).min(count);
                let (attitude, end_spin) = (&mut attitude[own.clone()], &mut end_spin[own.clone()]);
                let farthest = turns.turn(&mut whole.some(own), attitude, end_spin);
                yields[0].moved_far |= farthest.too_far;
                *moved = moved.max(farthest.square);
            }
        });
        let moved_far = s.body_yield.iter().any(|y| y.moved_far);
        (self.state.bodies, self.scratch) = (bodies, s);
        (self.state.members.attitude, self.state.members.end_spin) = (attitude, end_spin);
        moved_far
    }

    /// Bring the spins of clumps up to their angular momentum: steps need none.
    pub(crate) fn spin_clumps(&mut self) {
        let (b, m) = (&mut self.state.bodies, &self.state.members);
        for (k, &shape) in m.shape.iter().enumerate().filter(|s| *s.1 != SPHERE) {
            let inverse = self.make.shapes[shape as usize].moments.recip().into();
            let momentum = b.angular_memory[k].vector().into();
            b.spin[k].set(spin_of(inverse, m.attitude[k].to_array(), momentum).into());
        }
    }

    /// Put the spheres of clumps where their bodies are.
    pub(crate) fn place_members(&mut self) {
        if !self.has_clumps() {
            return;
        }
        let (level, arithmetic, shapes) =
            (self.make.level, self.make.arithmetic, &self.make.shapes);
        let (b, m) = (&self.state.bodies, &mut self.state.members);
        let (first, attitude, shape) = (&m.first, &m.attitude, &m.shape);
        let count = b.len().div_ceil(CHUNK);
        self.team.each(count, cut_groups(&mut m.position, first, CHUNK), |c, position| {
            let own = c * CHUNK..((c + 1) * CHUNK).min(b.len());
            let placing = Placing {
                shapes,
                shape: &shape[own.clone()],
                attitude: &attitude[own.clone()],
                centre: &b.position[own.clone()],
                first: &first[own.start..=own.end],
                position,
            };
            placing.run(level, arithmetic);
        });
    }
}
