//! The stages of clumps: their turns, their spins, and where their spheres are.

use crate::contact::model::ContactLaw;
use crate::contact_stage::CHUNK;
use crate::integrate::Integrator;
use crate::rigid::spin_of;
use crate::simd::{OnBodies as _, Placing, Turning};
use crate::threads::{cut, cut_groups};
use crate::world::{SPHERE, World};

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Turn the clumps freely between two kicks.
    pub(crate) fn turn_clumps(&mut self) {
        if !self.has_clumps() {
            return;
        }
        let (dt, level, shapes) = (self.make.dt, self.make.level, &self.make.shapes);
        let (b, m) = (&mut self.state.bodies, &mut self.state.members);
        let (torque, shape) = (&b.angular_acceleration, &m.shape);
        let parts = (
            cut(&mut m.attitude, CHUNK),
            cut(&mut b.mean_spin, CHUNK),
            cut(&mut m.end_spin, CHUNK),
            cut(&mut b.angular_memory, CHUNK),
        );
        let count = shape.len().div_ceil(CHUNK);
        self.team.each(count, parts, |c, (attitude, mean_spin, end_spin, momentum)| {
            let own = c * CHUNK..c * CHUNK + attitude.len();
            let (shape, torque) = (&shape[own.clone()], &torque[own]);
            let turning =
                Turning { shapes, shape, torque, attitude, mean_spin, end_spin, momentum, dt };
            turning.run(level);
        });
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
