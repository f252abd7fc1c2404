//! Observers: they look at a world from time to time and change nothing.

mod collision_energy;
mod coordination;
mod lacey;
mod stress;
mod velocity_distribution;

use glam::DVec3;

pub use collision_energy::{CollisionEnergy, EnergyHistogram, PairKind};
pub use coordination::CoordinationNumber;
pub use lacey::LaceyIndex;
pub use stress::Stress;
pub use velocity_distribution::{LogNormalFit, VelocityDistribution};

use crate::contact::model::ContactLaw;
use crate::error::{Error, Partner};
use crate::forces::TOUCHES;
use crate::integrate::Integrator;
use crate::material::MaterialId;
use crate::particles::ParticleId;
use crate::world::World;

/// One contact at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// A particle.
    pub particle: ParticleId,
    /// What it touches.
    pub partner: Partner,
    /// Centre of the particle's sphere that touches, m.
    pub centre: DVec3,
    /// From there to the centre of the partner's sphere, or to the wall, m.
    pub branch: DVec3,
    /// Force on the particle, N.
    pub force: DVec3,
    /// Velocity of the particle's centre relative to the partner's (or to the wall there), m/s.
    pub relative_velocity: DVec3,
    /// Effective mass `m_i m_j / (m_i + m_j)`, kg (the particle's own against a wall).
    pub effective_mass: f64,
    /// Materials of the particle and of its partner.
    pub materials: [MaterialId; 2],
}

/// What an observer may ask of a world.
pub trait View {
    /// Number of particles.
    fn particle_count(&self) -> usize;
    /// Time, s.
    fn time(&self) -> f64;
    /// Steps done.
    fn step_number(&self) -> u64;
    /// Centre of mass, m.
    fn position(&self, particle: ParticleId) -> DVec3;
    /// Velocity, m/s.
    fn velocity(&self, particle: ParticleId) -> DVec3;
    /// Mass, kg.
    fn mass(&self, particle: ParticleId) -> f64;
    /// Material.
    fn material(&self, particle: ParticleId) -> MaterialId;
    /// Call `each` for every contact, in a fixed order.
    fn for_each_contact(&self, each: &mut dyn FnMut(&Contact));
}

/// Something that looks at the world every so many steps.
pub trait Observer {
    /// Steps between two looks (at least 1).
    fn every(&self) -> u64;
    /// Look.
    fn observe(&mut self, world: &dyn View);
}

impl<M: ContactLaw + 'static, I: Integrator> View for World<M, I> {
    fn particle_count(&self) -> usize {
        self.len()
    }

    fn time(&self) -> f64 {
        World::time(self)
    }

    fn step_number(&self) -> u64 {
        World::step_number(self)
    }

    fn position(&self, particle: ParticleId) -> DVec3 {
        World::position(self, particle)
    }

    fn velocity(&self, particle: ParticleId) -> DVec3 {
        World::velocity(self, particle)
    }

    fn mass(&self, particle: ParticleId) -> f64 {
        World::mass(self, particle)
    }

    fn material(&self, particle: ParticleId) -> MaterialId {
        World::material(self, particle)
    }

    fn for_each_contact(&self, each: &mut dyn FnMut(&Contact)) {
        let (pairs, w) = (&self.state.pairs, &self.scratch.wrenches);
        for p in 0..pairs.touching.min(w.pair_force.len()) {
            if pairs.active[p] & TOUCHES != 0 {
                each(&self.pair_contact(pairs.first[p], pairs.second[p], w.pair_force[p].vector()));
            }
        }
        for late in &w.late {
            each(&self.pair_contact(late.first, late.second, late.wrench.force));
        }
        let list = &self.state.wall_list;
        for e in 0..list.len().min(w.wall_force.len()) {
            if list.active[e] & TOUCHES != 0 {
                each(&self.wall_contact(e));
            }
        }
    }
}

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// Advance by `steps`, and let every observer look when its steps have passed.
    ///
    /// # Errors
    /// As [`World::run`].
    pub fn run_observed(
        &mut self,
        steps: u64,
        observers: &mut [&mut dyn Observer],
    ) -> Result<(), Error> {
        let end = self.step_number() + steps;
        while self.step_number() < end {
            let now = self.step_number();
            let due = |o: &&mut dyn Observer| (now / o.every().max(1) + 1) * o.every().max(1);
            let next = observers.iter().map(due).min().unwrap_or(end).min(end);
            self.run(next - now)?;
            for o in observers.iter_mut() {
                if self.step_number().is_multiple_of(o.every().max(1)) {
                    o.observe(self);
                }
            }
        }
        Ok(())
    }

    fn owner(&self, sphere: u32) -> usize {
        let members = &self.state.members.body;
        members.get(sphere as usize).map_or(sphere as usize, |&b| b as usize)
    }

    fn velocity_at(&self, body: usize, arm: DVec3) -> DVec3 {
        let b = &self.state.bodies;
        b.velocity[body].vector() + b.spin[body].vector().cross(arm)
    }

    fn pair_contact(&self, first: u32, second: u32, force: DVec3) -> Contact {
        let position = self.sphere_positions();
        let (i, j) = (self.owner(first), self.owner(second));
        let b = &self.state.bodies;
        let (xi, xj) = (position[first as usize].vector(), position[second as usize].vector());
        let branch = crate::neighbour::Period::shortest(self.make.period, xj - xi);
        let (mi, mj) = (b.velocity[i].w, b.velocity[j].w);
        let arm = |x: DVec3, body: usize| x - b.position[body].vector();
        Contact {
            particle: ParticleId(b.id[i]),
            partner: Partner::Particle(ParticleId(b.id[j])),
            centre: xi,
            branch,
            force,
            relative_velocity: self.velocity_at(i, arm(xi, i)) - self.velocity_at(j, arm(xj, j)),
            effective_mass: mi * mj / (mi + mj),
            materials: [i, j].map(|k| MaterialId(b.mean_spin[k].w as u16)),
        }
    }

    fn wall_contact(&self, entry: usize) -> Contact {
        let list = &self.state.wall_list;
        let (sphere, w) = (list.sphere[entry], list.wall[entry] as usize);
        let body = self.owner(sphere);
        let b = &self.state.bodies;
        let x = self.sphere_positions()[sphere as usize].vector();
        let wall = &self.scratch.placed[w];
        let mesh = || self.scratch.mesh_nearest.get(entry).copied().flatten();
        let nearest = wall.nearest(x).or_else(mesh);
        let branch = nearest.map_or(DVec3::ZERO, |n| n.normal_to_wall * n.distance);
        let own = self.velocity_at(body, x - b.position[body].vector());
        Contact {
            particle: ParticleId(b.id[body]),
            partner: Partner::Wall(w),
            centre: x,
            branch,
            force: self.scratch.wrenches.wall_force[entry].vector(),
            relative_velocity: own - wall.velocity.at(x + branch),
            effective_mass: b.velocity[body].w,
            materials: [MaterialId(b.mean_spin[body].w as u16), wall.material],
        }
    }
}
