//! Mean stress in a box.
//!
//! `sigma = (sum_c l_c (x) f_c + sum_i m_i v'_i (x) v'_i) / V`, compressive positive, where `l` is
//! the branch vector of a contact, `f` the force along it on the far body, and `v'` the velocity
//! relative to the mean of the box. A contact counts where the middle of its branch lies, one with
//! a wall where the centre of its sphere lies.
//! Christoffersen, Mehrabadi & Nemat-Nasser, J. Appl. Mech. 48 (1981) 339, doi:10.1115/1.3157619.

use glam::{DMat3, DVec3};

use super::{Observer, View};

/// Stress tensor in a box, averaged over the looks.
#[derive(Debug, Clone, PartialEq)]
pub struct Stress {
    every: u64,
    min: DVec3,
    max: DVec3,
    sum: DMat3,
    looks: u64,
}

impl Stress {
    /// Look every `every` steps at the box from `min` to `max`, m.
    pub fn new(every: u64, min: DVec3, max: DVec3) -> Self {
        Self { every, min, max, sum: DMat3::ZERO, looks: 0 }
    }

    /// Mean stress tensor so far, Pa; compression is positive.
    pub fn mean(&self) -> DMat3 {
        self.sum * (1.0 / self.looks.max(1) as f64)
    }

    /// Mean pressure so far, Pa: a third of the trace.
    pub fn pressure(&self) -> f64 {
        let m = self.mean();
        (m.x_axis.x + m.y_axis.y + m.z_axis.z) / 3.0
    }

    fn holds(&self, x: DVec3) -> bool {
        x.cmpge(self.min).all() && x.cmplt(self.max).all()
    }
}

/// `a (x) b`.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

impl Observer for Stress {
    fn every(&self) -> u64 {
        self.every
    }

    fn observe(&mut self, world: &dyn View) {
        let inside: Vec<_> = (0..world.particle_count() as u32)
            .map(crate::particles::ParticleId)
            .filter(|&id| self.holds(world.position(id)))
            .collect();
        let mass: f64 = inside.iter().map(|&id| world.mass(id)).sum();
        let momentum: DVec3 = inside.iter().map(|&id| world.velocity(id) * world.mass(id)).sum();
        let mean = if mass > 0.0 { momentum / mass } else { DVec3::ZERO };
        let mut sum = DMat3::ZERO;
        for &id in &inside {
            let v = world.velocity(id) - mean;
            sum += outer(v, v) * world.mass(id);
        }
        world.for_each_contact(&mut |c| {
            // Where the contact is: in the middle of the branch, or at the wall.
            let at = match c.partner {
                crate::error::Partner::Particle(_) => c.centre + 0.5 * c.branch,
                crate::error::Partner::Wall(_) => c.centre,
            };
            if self.holds(at) {
                // The force on the far body is the opposite of the one on the particle.
                sum += outer(c.branch, -c.force);
            }
        });
        let size = self.max - self.min;
        self.sum += sum * (1.0 / (size.x * size.y * size.z));
        self.looks += 1;
    }
}
