//! The scene of all codes: a drum of the AZ1 kind, any number of beads, the speed scaled along.

use anyhow::Context;
use dem_core::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Contact model of the timing: Hertz, Mindlin with history, damping, constant rolling torque.
pub(crate) type Model = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;

/// Beads of configuration AZ1.
pub(crate) const AZ1_BEADS: usize = 7807;
/// Radius of a bead, m.
pub(crate) const BEAD_RADIUS_M: f64 = 3e-3;
/// Time step, s.
pub(crate) const DT_S: f64 = 7e-5;
/// Shear modulus, Pa.
pub(crate) const SHEAR_MODULUS_PA: f64 = 2.52e7;
/// Poisson's ratio.
pub(crate) const POISSON: f64 = 0.29;
/// Density, kg/m3.
pub(crate) const DENSITY: f64 = 2500.0;
/// Friction between beads.
pub(crate) const MU: f64 = 0.5;
/// Friction between a bead and a wall.
pub(crate) const MU_WALL: f64 = 0.6;
/// Coefficient of restitution.
pub(crate) const RESTITUTION: f64 = 0.9;
/// Coefficient of the constant rolling torque.
pub(crate) const ROLLING: f64 = 0.01;
/// Gravity, m/s2.
pub(crate) const GRAVITY: f64 = 9.81;

/// A drum and the number of beads in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scene {
    /// Number of beads.
    pub(crate) beads: usize,
    /// Radius of the drum, m.
    pub(crate) radius: f64,
    /// Length of the drum, m.
    pub(crate) length: f64,
    /// Angular velocity about +z, rad/s.
    pub(crate) rate: f64,
}

/// One bead: centre (m), velocity (m/s), spin (rad/s).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Bead {
    pub(crate) position: DVec3,
    pub(crate) velocity: DVec3,
    pub(crate) spin: DVec3,
}

impl Scene {
    /// A drum similar to that of AZ1 (250 x 150 mm, 17 rpm, 7807 beads of 6 mm) with the same
    /// degree of filling and the same Froude number, for any number of beads.
    pub(crate) fn similar(beads: usize) -> Self {
        let scale = (beads as f64 / AZ1_BEADS as f64).cbrt();
        let az1_rate = 17.0 * std::f64::consts::TAU / 60.0;
        Self { beads, radius: 0.125 * scale, length: 0.150 * scale, rate: az1_rate / scale.sqrt() }
    }

    /// The drum of AZ1 made longer or shorter: the same bed, wherever one cuts it across, for any number of beads.
    pub(crate) fn along(beads: usize) -> Self {
        let length = 0.150 * beads as f64 / AZ1_BEADS as f64;
        Self { beads, length, ..Self::similar(AZ1_BEADS) }
    }

    /// Beads on a lattice with a little noise, from the bottom of the drum upwards.
    pub(crate) fn lattice(&self, seed: u64) -> anyhow::Result<Vec<Bead>> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let pitch = 2.1 * BEAD_RADIUS_M;
        let across = (2.0 * self.radius / pitch) as usize;
        let along = (self.length / pitch) as usize;
        let mut beads = Vec::with_capacity(self.beads);
        for j in 0..across {
            for i in 0..across {
                let place = |n: usize| (n as f64 + 0.5) * pitch - self.radius;
                let (x, y) = (place(i), place(j));
                if x.hypot(y) > self.radius - 1.05 * BEAD_RADIUS_M {
                    continue;
                }
                for k in 0..along {
                    if beads.len() == self.beads {
                        return Ok(beads);
                    }
                    let mut noise = || random.random_range(-1e-4..1e-4);
                    let z = (k as f64 + 0.5) * self.length / along as f64;
                    let position = DVec3::new(x + noise(), y + noise(), z + noise());
                    beads.push(Bead { position, ..Bead::default() });
                }
            }
        }
        anyhow::ensure!(
            beads.len() == self.beads,
            "the drum holds {} beads on a lattice, {} are wanted",
            beads.len(),
            self.beads
        );
        Ok(beads)
    }

    /// The world of this scene with the beads as given.
    pub(crate) fn world(
        &self,
        beads: &[Bead],
        threads: usize,
        skin: f64,
        rolling: f64,
        kernels: Kernels,
    ) -> anyhow::Result<World<Model>> {
        let material = Material::from_shear_modulus(SHEAR_MODULUS_PA, POISSON, DENSITY);
        let mut b = WorldBuilder::<Model>::new(DT_S);
        let (bead, wall) = (b.material(material), b.material(material));
        b.pair_law(bead, bead, law(&material, MU, rolling)?).pair_law(
            bead,
            wall,
            law(&material, MU_WALL, rolling)?,
        );
        b.kernels(kernels);
        b.gravity(DVec3::NEG_Y * GRAVITY).threads(threads).skin(skin);
        let half = self.radius * 1.1;
        let (low, high) = (-0.1 * self.radius, self.length + 0.1 * self.radius);
        b.domain(DVec3::new(-half, -half, low), DVec3::new(half, half, high));
        let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, self.rate);
        let plate = 1.05 * self.radius;
        let far = DVec3::Z * self.length;
        b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, self.radius, wall).with_motion(turning));
        b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, plate, wall).with_motion(turning));
        b.wall(Wall::disc(far, DVec3::NEG_Z, plate, wall).with_motion(turning));
        for at in beads {
            let sphere = Sphere::at(at.position, BEAD_RADIUS_M, bead).with_velocity(at.velocity);
            b.sphere(sphere.with_spin(at.spin));
        }
        b.build().context("the scene of the timing is not a valid world")
    }

    /// Let beads fall from a lattice and the drum turn for `steps` steps.
    pub(crate) fn settled(&self, seed: u64, steps: u64) -> anyhow::Result<Vec<Bead>> {
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
        let mut world = self.world(
            &self.lattice(seed)?,
            threads,
            0.25 * BEAD_RADIUS_M,
            ROLLING,
            Kernels::Fastest,
        )?;
        world.run(steps)?;
        Ok(beads_of(&world))
    }
}

/// Where the beads of a world are.
pub(crate) fn beads_of(world: &World<Model>) -> Vec<Bead> {
    let at = |id| Bead {
        position: world.position(id),
        velocity: world.velocity(id),
        spin: world.spin(id),
    };
    world.particles().map(at).collect()
}

/// Hertz, Mindlin, damping and constant rolling torque between two like bodies.
pub(crate) fn law(material: &Material, friction: f64, rolling: f64) -> anyhow::Result<Model> {
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    let spec = HertzSpec { e_star: e / (2.0 * (1.0 - nu * nu)), restitution: RESTITUTION };
    let normal = HertzTailCut::try_from(spec)?;
    let tangential = Mindlin {
        g_star: material.shear_modulus() / (2.0 * (2.0 - nu)),
        friction: Friction::coulomb(friction)?,
        damping: normal.damping,
    };
    let coefficient = RollingCoefficient::Ratio(rolling);
    let rolling = ConstantTorqueSpec { coefficient }.try_into()?;
    Ok(ContactModel { normal, tangential, rolling, cohesion: Cohesionless })
}
