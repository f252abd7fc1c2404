//! The stages of clumps: their turns, their spins, and where their spheres are.

use crate::body_stage::Farthest;
use crate::contact::model::ContactLaw;
use crate::contact_stage::CHUNK;
use crate::integrate::Integrator;
use crate::rigid::spin_of;
use crate::simd::{OnBodies as _, Placing, Since, Turning};
use crate::sums::PIECE;
use crate::threads::{cut, cut_groups};
use crate::world::{BodyYield, SPHERE, World};

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Turn the clumps freely between two kicks, their centres having moved already; returns whether after that the list may miss
    /// a pair of their spheres.
    pub(crate) fn turn_clumps(&mut self) -> bool {
        if !self.has_clumps() {
            return false;
        }
        let turn = self.turn_since_list((self.state.step + 1) as f64 * self.make.dt);
        let (frame, turn) = (turn.columns(), turn.quaternion());
        let (dt, level, shapes) = (self.make.dt, self.make.level, &self.make.shapes);
        let limit = (0.5 * self.make.skin).powi(2);
        let (b, m, list) = (&mut self.state.bodies, &mut self.state.members, &self.state.list);
        let (torque, shape, position) = (&b.angular_acceleration, &m.shape, &b.position);
        let (yields, moved) = (&mut self.scratch.body_yield, &mut self.scratch.moved);
        moved.cover(position.len());
        let count = shape.len().div_ceil(CHUNK);
        yields.resize(count, BodyYield::default());
        let parts = (
            cut(&mut m.attitude, CHUNK),
            cut(&mut b.mean_spin, CHUNK),
            cut(&mut m.end_spin, CHUNK),
            cut(&mut b.angular_memory, CHUNK),
            cut(&mut moved.square, CHUNK / PIECE),
            cut(yields, 1),
        );
        self.team.each(
            count,
            parts,
            |c, (attitude, mean_spin, end_spin, momentum, moved, yields)| {
                yields[0].moved_far = false;
                let whole = attitude.len();
                for (begin, square) in (0..whole).step_by(PIECE).zip(moved) {
                    let piece = begin..(begin + PIECE).min(whole);
                    let own = c * CHUNK + piece.start..c * CHUNK + piece.end;
                    let since = Since {
                        position: &position[own.clone()],
                        reference: &list.reference[own.clone()],
                        attitude: &list.attitude[own.clone()],
                        frame: &frame,
                        turn,
                        limit,
                    };
                    let mut farthest = Farthest::default();
                    let turning = Turning {
                        shapes,
                        shape: &shape[own.clone()],
                        torque: &torque[own],
                        attitude: &mut attitude[piece.clone()],
                        mean_spin: &mut mean_spin[piece.clone()],
                        end_spin: &mut end_spin[piece.clone()],
                        momentum: &mut momentum[piece],
                        dt,
                        since,
                        farthest: &mut farthest,
                    };
                    turning.run(level);
                    yields[0].moved_far |= farthest.too_far;
                    *square = square.max(farthest.square);
                }
            },
        );
        self.scratch.body_yield.iter().any(|y| y.moved_far)
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
        let (level, shapes) = (self.make.level, &self.make.shapes);
        let (b, m) = (&self.state.bodies, &mut self.state.members);
        let (first, attitude, shape) = (&m.first, &m.attitude, &m.shape);
        let parts =
            (cut_groups(&mut m.arm, first, CHUNK), cut_groups(&mut m.position, first, CHUNK));
        let count = b.len().div_ceil(CHUNK);
        self.team.each(count, parts, |c, (arm, position)| {
            let own = c * CHUNK..((c + 1) * CHUNK).min(b.len());
            let placing = Placing {
                shapes,
                shape: &shape[own.clone()],
                attitude: &attitude[own.clone()],
                centre: &b.position[own.clone()],
                first: &first[own.start..=own.end],
                arm,
                position,
            };
            placing.run(level);
        });
    }
}
