//! The world behind one pointer: which static product of laws it runs is chosen once.

use dem_core::contact::model::ContactLaw;
use dem_core::error::Error;
use dem_core::geometry::Motion;
use dem_core::glam::{DQuat, DVec3};
use dem_core::observe::View;
use dem_core::particles::ParticleId;
use dem_core::prelude::{Drag, Gravity, World};
use dem_core::snapshot::Snapshot;

/// What an experiment asks of a world.
pub(crate) trait Engine: Send {
    fn run(&mut self, steps: u64) -> Result<(), Error>;
    fn view(&self) -> &dyn View;
    fn spin(&self, particle: ParticleId) -> DVec3;
    fn acceleration(&self, particle: ParticleId) -> DVec3;
    fn orientation(&self, particle: ParticleId) -> DQuat;
    fn kinetic_energy(&self) -> f64;
    /// Torque about the drum axis on a wall, N m.
    fn torque(&self, wall: usize) -> Result<f64, Error>;
    fn set_motion(&mut self, wall: usize, motion: Motion) -> Result<(), Error>;
    fn set_drag(&mut self, drag: Option<Drag>) -> Result<(), Error>;
    fn set_gravity(&mut self, acceleration: DVec3) -> Result<(), Error>;
    fn state_hash(&self) -> u64;
    fn snapshot(&self) -> Vec<u8>;
    fn restore(&mut self, bytes: &[u8]) -> Result<(), Error>;
}

impl<M: ContactLaw + Send + Sync + 'static> Engine for World<M> {
    fn run(&mut self, steps: u64) -> Result<(), Error> {
        World::run(self, steps)
    }

    fn view(&self) -> &dyn View {
        self
    }

    fn spin(&self, particle: ParticleId) -> DVec3 {
        World::spin(self, particle)
    }

    fn acceleration(&self, particle: ParticleId) -> DVec3 {
        World::acceleration(self, particle)
    }

    fn orientation(&self, particle: ParticleId) -> DQuat {
        World::orientation(self, particle)
    }

    fn kinetic_energy(&self) -> f64 {
        let e = self.energy();
        e.kinetic_translation + e.kinetic_rotation
    }

    fn torque(&self, wall: usize) -> Result<f64, Error> {
        Ok(self.wall_load(wall)?.torque.z)
    }

    fn set_motion(&mut self, wall: usize, motion: Motion) -> Result<(), Error> {
        self.set_wall_motion(wall, motion)
    }

    fn set_drag(&mut self, drag: Option<Drag>) -> Result<(), Error> {
        World::set_drag(self, drag)
    }

    fn set_gravity(&mut self, acceleration: DVec3) -> Result<(), Error> {
        World::set_gravity(self, Gravity::steady(acceleration))
    }

    fn state_hash(&self) -> u64 {
        World::state_hash(self)
    }

    fn snapshot(&self) -> Vec<u8> {
        World::snapshot(self).to_bytes()
    }

    fn restore(&mut self, bytes: &[u8]) -> Result<(), Error> {
        World::restore(self, &Snapshot::from_bytes(bytes)?)
    }
}
