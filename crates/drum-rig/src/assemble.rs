//! From a rig to a world.

use dem_core::contact::elasticity::Elasticity;
use dem_core::contact::model::ContactLaw;
use dem_core::geometry::Motion;
use dem_core::glam::{DMat3, DVec3};
use dem_core::material::{Material, MaterialId, PairTable};
use dem_core::prelude::{
    Axis, Clump, ClumpSpec, ClumpSphere, Drag, PlacedClump, Sphere, WorldBuilder,
};
use dem_core::timestep::rayleigh_time;
use rig_schema::{Cohesion, Ends, Rig};

use crate::drum::{self, Built, Drive};
use crate::engine::Engine;
use crate::error::Error;
use crate::fill::{self, Start};
use crate::grains::Grains;
use crate::laws::{self, Constants, Kind};
use crate::options::Options;
use crate::parameters::Physics;

/// Share of the Rayleigh time taken as time step where a rig gives none, unless it is much damped or cohesive.
pub const DEFAULT_STEP_OVER_RAYLEIGH: f64 = 0.2;

/// Damping ratio above which dashpots and not springs set the default step (a restitution of 0.44). They are integrated explicitly, and at a
/// grain with six contacts the tangential ones act on 2/7 of its mass: soft beds of restitution 0.15 never come to
/// rest at a fifth of the Rayleigh time, and do at a tenth.
const LITTLE_DAMPED: f64 = 0.25;

/// Factor on the default step of cohesive grains, which overlap more and so are stiffer: beds that jitter for ever at a
/// fifth of the Rayleigh time come to rest at 0.14 of it.
const COHESIVE: f64 = 0.7;

/// Drag while the bed settles, over `sqrt(g/R)`: the fall through the drum is damped within itself.
const SETTLING_DRAG: f64 = 1.0;

/// Particles, mantle, end plates: the order of declaration.
const PARTICLE: MaterialId = MaterialId(0);
const MANTLE: MaterialId = MaterialId(1);
const END_PLATE: MaterialId = MaterialId(2);

/// A world at the start, and what the experiment needs to know of it.
pub(crate) struct Assembly {
    pub(crate) engine: Box<dyn Engine>,
    pub(crate) grains: Grains,
    /// Whether each wall turns with the drum.
    pub(crate) turns: Vec<bool>,
    pub(crate) drive: Drive,
    pub(crate) radius: f64,
    pub(crate) dt: f64,
    /// Drag of the experiment itself, 1/s.
    pub(crate) drag: f64,
    pub(crate) gravity: DVec3,
    pub(crate) speed_scale: f64,
}

/// Elastic constants of a named material.
fn elasticity(rig: &Rig, role: &'static str, name: &str, scale: f64) -> Result<Elasticity, Error> {
    let m = rig
        .materials
        .get(name)
        .ok_or_else(|| Error::UnknownMaterial { role, name: name.to_owned() })?;
    let young = 2.0 * (1.0 + m.poisson_ratio) * m.shear_modulus_pa * scale;
    Ok(Elasticity::new(young, m.poisson_ratio)?)
}

/// Time step of a rig, s.
pub(crate) fn time_step(rig: &Rig, physics: &Physics, grains: &Grains) -> Result<f64, Error> {
    let bead = elasticity(rig, "particles", &rig.particles.material, physics.stiffness_scale)?;
    let own = || {
        let loss = -physics.restitution.pp.ln();
        let ratio = loss / loss.hypot(std::f64::consts::PI);
        let damped = if ratio > LITTLE_DAMPED { LITTLE_DAMPED / ratio } else { 1.0 };
        let cohesive = if rig.contact.cohesion == Cohesion::None { 1.0 } else { COHESIVE };
        let rayleigh = rayleigh_time(grains.smallest_radius(), grains.density, &bead);
        DEFAULT_STEP_OVER_RAYLEIGH * damped * cohesive * rayleigh
    };
    Ok(rig.run.time_step_s.unwrap_or_else(own) * physics.step_scale)
}

/// Build the world of a rig.
pub(crate) fn assemble(rig: &Rig, options: &Options) -> Result<Assembly, Error> {
    let physics = Physics::of(rig)?;
    let grains = Grains::of(rig, &physics)?;
    let largest = grains.largest_bounding_radius();
    let liner = options.liner_stl.as_deref();
    let built = drum::build(rig, &physics, liner, largest, MANTLE, END_PLATE)?;
    let parts = Parts { rig, physics: &physics, grains: &grains, built: &built, options };
    let engine = match Kind::of(&rig.contact) {
        Kind::HertzMindlin { cut_tail: true } => parts.world(Constants::hertz_mindlin::<true>)?,
        Kind::HertzMindlin { cut_tail: false } => parts.world(Constants::hertz_mindlin::<false>)?,
        Kind::Cohesive { cut_tail: true } => parts.world(Constants::cohesive::<true>)?,
        Kind::Cohesive { cut_tail: false } => parts.world(Constants::cohesive::<false>)?,
        Kind::Edem { cut_tail: true } => parts.world(Constants::edem::<true>)?,
        Kind::Edem { cut_tail: false } => parts.world(Constants::edem::<false>)?,
        Kind::Spring => parts.world(Constants::spring)?,
        Kind::PartialSlip => parts.world(Constants::partial_slip)?,
    };
    let drive = Drive {
        amplitude: physics.vibration_amplitude,
        frequency_hz: physics.vibration_frequency,
        up: drum::up(physics.inclination_rad),
    };
    Ok(Assembly {
        engine,
        turns: built.parts.iter().map(|p| p.turns).collect(),
        drive,
        radius: built.radius,
        dt: time_step(rig, &physics, &grains)?,
        drag: physics.drag,
        gravity: drum::gravity(physics.inclination_rad),
        speed_scale: physics.speed_scale,
        grains,
    })
}

struct Parts<'a> {
    rig: &'a Rig,
    physics: &'a Physics,
    grains: &'a Grains,
    built: &'a Built,
    options: &'a Options,
}

impl Parts<'_> {
    /// Gap up to which the list holds pairs, m: so that a list serves some forty steps at the speed
    /// of a falling bed, within what was found to be fastest (0.4 to 0.9 of a radius).
    fn skin(&self, dt: f64) -> f64 {
        let radius = self.grains.equivalent_radius();
        let fall = (crate::GRAVITY * self.built.radius).sqrt();
        let skin = (45.0 * dt * fall).clamp(0.4 * radius, 0.9 * radius);
        if self.built.ends == Ends::Periodic {
            // Each pair has one image in reach.
            let room = 0.5 * self.built.length - 2.0 * self.grains.largest_bounding_radius();
            skin.min(0.9 * room).max(0.1 * radius)
        } else {
            skin
        }
    }

    fn world<M: ContactLaw + Send + Sync + 'static>(
        &self,
        law: fn(&Constants) -> Result<M, Error>,
    ) -> Result<Box<dyn Engine>, Error> {
        let (rig, p, built) = (self.rig, self.physics, self.built);
        let dt = time_step(rig, p, self.grains)?;
        let mut b = WorldBuilder::<M>::new(dt);
        let bead = elasticity(rig, "particles", &rig.particles.material, p.stiffness_scale)?;
        // Walls have no mass: the world asks a material only for the density of particles and for
        // their Rayleigh time. Elastic constants of walls are in the laws of their pairs.
        let material = Material {
            youngs_modulus: bead.young_modulus,
            poisson_ratio: bead.poisson_ratio,
            density: self.grains.density,
        };
        for _ in [PARTICLE, MANTLE, END_PLATE] {
            b.material(material);
        }
        for (wall, constants) in self.constants(bead)? {
            b.pair_law(PARTICLE, wall, law(&constants)?);
        }
        self.bridges(&mut b)?;
        b.gravity(drum::settling_gravity(p.inclination_rad)).threads(self.options.threads);
        b.skin(self.skin(dt));
        let settling = SETTLING_DRAG * (crate::GRAVITY / built.radius).sqrt();
        b.drag(Drag::Uniform { rate: settling + p.drag });
        let margin = self.grains.largest_bounding_radius() + p.vibration_amplitude;
        let across = built.outer + margin;
        let half = 0.5 * built.length;
        let along = if built.ends == Ends::Periodic { half } else { half + margin };
        let corner = DVec3::new(across, across, along);
        b.domain(-corner, corner);
        if built.ends == Ends::Periodic {
            b.periodic(Axis::Z);
        }
        // A wall that turns at the start tells the neighbour search that one will; it is stopped
        // before the first step.
        let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 1.0);
        for part in &built.parts {
            let motion = if part.turns { turning } else { Motion::default() };
            b.wall(part.wall.clone().with_motion(motion));
        }
        let start =
            fill::start(self.grains, &built.room, rig.run.seed)?.turned(drum::settling_tilt());
        self.bodies(&mut b, &start)?;
        let mut world = b.build()?;
        for k in 0..built.parts.len() {
            world.set_wall_motion(k, Motion::default())?;
        }
        Ok(Box::new(world))
    }

    /// Constants of the laws of particles with each other, the mantle and the end plates.
    fn constants(&self, bead: Elasticity) -> Result<[(MaterialId, Constants); 3], Error> {
        let (rig, p) = (self.rig, self.physics);
        let radius = self.grains.equivalent_radius();
        let mass = self.grains.density * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        let mantle = elasticity(rig, "mantle", &rig.drum.mantle, 1.0)?;
        let end_plate = elasticity(rig, "end plates", &rig.drum.end_plates, 1.0)?;
        let friction = |mu| laws::friction(mu, p.kinetic_ratio, p.decay_speed);
        let pp = Constants {
            contact: rig.contact,
            i: bead,
            j: bead,
            friction: friction(p.friction.pp)?,
            rolling: p.rolling.pp,
            restitution: p.restitution.pp,
            // Equal solids: twice the surface energy.
            work_of_adhesion: 2.0 * p.surface_energy,
            energy_density: p.energy_density,
            r_star: 0.5 * radius,
            m_star: 0.5 * mass,
            drum_radius: rig.drum.radius_m,
        };
        let wall = Constants {
            work_of_adhesion: pp.work_of_adhesion * p.cohesion_wall_ratio,
            energy_density: pp.energy_density * p.cohesion_wall_ratio,
            r_star: radius,
            m_star: mass,
            ..pp
        };
        let mantle = Constants {
            j: mantle,
            friction: friction(p.friction.mantle)?,
            rolling: p.rolling.mantle,
            restitution: p.restitution.mantle,
            ..wall
        };
        let end_plate = Constants {
            j: end_plate,
            friction: friction(p.friction.end_plate)?,
            rolling: p.rolling.end_plate,
            restitution: p.restitution.end_plate,
            ..wall
        };
        Ok([(PARTICLE, pp), (MANTLE, mantle), (END_PLATE, end_plate)])
    }

    fn bridges<M: ContactLaw + 'static>(&self, b: &mut WorldBuilder<M>) -> Result<(), Error> {
        if self.rig.contact.cohesion != Cohesion::Capillary {
            return Ok(());
        }
        let p = self.physics;
        let particle = self.grains.solid_volume() / self.grains.len() as f64;
        // Six contacts a particle, each shared by two.
        let volume = p.liquid_fraction * particle / 3.0;
        let Some(bridge) = Constants::bridge(volume, p.surface_tension)? else { return Ok(()) };
        let mut table = PairTable::new(3);
        table.set(PARTICLE, PARTICLE, bridge)?;
        let at_wall = Constants::bridge(volume, p.surface_tension * p.cohesion_wall_ratio)?;
        for wall in [MANTLE, END_PLATE] {
            if let Some(bridge) = at_wall {
                table.set(PARTICLE, wall, bridge)?;
            }
        }
        b.non_contact(table);
        Ok(())
    }

    fn bodies<M: ContactLaw + 'static>(
        &self,
        b: &mut WorldBuilder<M>,
        start: &Start,
    ) -> Result<(), Error> {
        let g = self.grains;
        let Some(clump) = &g.clump else {
            for k in 0..g.len() {
                for ball in g.balls(k, start.position[k], start.orientation[k]) {
                    b.sphere(Sphere::at(ball.centre, ball.radius, PARTICLE));
                }
            }
            return Ok(());
        };
        let mut shape = None;
        for k in 0..g.len() {
            let one_size = self.physics.size_spread == 0.0;
            let number = match shape {
                Some(number) if one_size => number,
                _ => {
                    let c = clump.scaled(g.scale(k))?;
                    let balls = c.spheres.iter();
                    let spec = ClumpSpec {
                        spheres: balls
                            .map(|s| ClumpSphere { centre: s.center, radius: s.radius })
                            .collect(),
                        mass: c.mass,
                        centre_of_mass: DVec3::ZERO,
                        inertia: DMat3::from_diagonal(c.principal_moments),
                        material: PARTICLE,
                    };
                    b.clump_shape(Clump::try_from(spec)?)
                }
            };
            shape = Some(number);
            b.clump(PlacedClump {
                shape: number,
                position: start.position[k],
                orientation: start.orientation[k],
                velocity: DVec3::ZERO,
                spin: DVec3::ZERO,
            });
        }
        Ok(())
    }
}
