//! The particles of an experiment: how many, how large, of what form.

use dem_core::glam::{DQuat, DVec3};
use dem_shapes::{AsphericalKind, ClumpMass, ClumpShape, RingTabletSpec, aspherical_clump};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, LogNormal};
use rig_schema::{Rig, Shape};

use crate::error::Error;
use crate::parameters::{Fill, Physics};

/// A sphere in space: a bead, or one of the spheres of a clump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// Centre, m.
    pub centre: DVec3,
    /// Radius, m.
    pub radius: f64,
    /// Number of the particle to which it belongs.
    pub particle: u32,
}

/// Forms and sizes of all particles; they do not change in a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Grains {
    /// The clump at scale 1; `None` for spheres.
    pub(crate) clump: Option<ClumpShape>,
    /// Spheres of one particle of scale 1 about its centre of mass.
    template: Vec<(DVec3, f64)>,
    /// Size of each particle over that of the mean one.
    scale: Vec<f64>,
    /// Mass of a particle of scale 1, kg.
    mass: f64,
    /// Density, kg/m3.
    pub(crate) density: f64,
}

/// Stream of random numbers for sizes, for places and directions.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Stream {
    Sizes = 1,
    Places = 2,
}

/// The generator of one stream of a run.
pub(crate) fn generator(seed: u64, stream: Stream) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(stream as u64);
    generator
}

impl Grains {
    /// The particles of a rig.
    ///
    /// Diameters are log-normal with the asked mean and standard deviation, so that none is
    /// negative; a fill by mass takes particles until their mass is nearest to the asked one.
    pub(crate) fn of(rig: &Rig, physics: &Physics) -> Result<Self, Error> {
        let material = rig.materials.get(&rig.particles.material).ok_or_else(|| {
            Error::UnknownMaterial { role: "particles", name: rig.particles.material.clone() }
        })?;
        let given = rig.particles.mass_kg;
        let size = physics.size_scale;
        let clump_mass = given.map_or(ClumpMass::Density(material.density_kg_m3), ClumpMass::Total);
        let clump = match rig.particles.shape {
            Shape::Sphere(_) if physics.aspect_ratio == 1.0 => None,
            Shape::Sphere(s) => Some(aspherical_clump(
                AsphericalKind::Rod,
                physics.aspect_ratio,
                0.5 * s.diameter_m * size,
                clump_mass,
            )?),
            Shape::RingTablet(r) => {
                let spec = RingTabletSpec {
                    ring_spheres: r.ring_spheres as usize,
                    ring_radius: r.ring_radius_m * size,
                    sphere_radius: r.sphere_radius_m * size,
                    middle_radius: r.middle_radius_m.map(|m| m * size),
                };
                Some(spec.build()?.clump(clump_mass)?)
            }
        };
        let (template, mass, volume) = match (&clump, rig.particles.shape) {
            (Some(c), _) => {
                let balls = c.spheres.iter().map(|s| (s.center, s.radius)).collect();
                (balls, c.mass, c.volume)
            }
            (None, Shape::Sphere(s)) => {
                let radius = 0.5 * s.diameter_m * size;
                let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
                let mass = given.unwrap_or(material.density_kg_m3 * volume);
                (vec![(DVec3::ZERO, radius)], mass, volume)
            }
            (None, Shape::RingTablet(_)) => return Err(Error::NoParticles { wanted: 0.0 }),
        };
        let mut grains = Self { clump, template, scale: Vec::new(), mass, density: mass / volume };
        let drum_m3 =
            std::f64::consts::PI * rig.drum.radius_m * rig.drum.radius_m * rig.drum.length_m;
        let count = match physics.fill {
            Fill::Count(count) => count,
            Fill::Mass(total) => total / mass,
        };
        // Before a number of particles is drawn that no memory holds.
        if count * volume > drum_m3 {
            return Err(Error::DoesNotFit {
                count: count as usize,
                solid_m3: count * volume,
                drum_m3,
                rounds: 0,
                overlap: 1.0,
            });
        }
        grains.draw(physics, rig.run.seed)?;
        Ok(grains)
    }

    fn draw(&mut self, physics: &Physics, seed: u64) -> Result<(), Error> {
        let mut random = generator(seed, Stream::Sizes);
        // ln d is normal with variance ln(1 + s^2) and mean -ln(1 + s^2)/2: d has mean 1 and sd s.
        let variance = (physics.size_spread * physics.size_spread).ln_1p();
        let sizes = LogNormal::new(-0.5 * variance, variance.sqrt()).map_err(|_| Error::Range {
            path: "size.spread",
            value: physics.size_spread,
            low: 0.0,
            high: 0.5,
        })?;
        let mut next = || if variance > 0.0 { sizes.sample(&mut random) } else { 1.0 };
        match physics.fill {
            Fill::Count(wanted) => {
                let count = wanted.round();
                if !(count >= 1.0) {
                    return Err(Error::NoParticles { wanted });
                }
                self.scale = (0..count as usize).map(|_| next()).collect();
            }
            Fill::Mass(wanted) => {
                let mut left = wanted;
                loop {
                    let scale = next();
                    let mass = self.mass * scale.powi(3);
                    // Nearest: half a particle decides.
                    if left < 0.5 * mass {
                        break;
                    }
                    left -= mass;
                    self.scale.push(scale);
                }
                if self.scale.is_empty() {
                    return Err(Error::NoParticles { wanted: wanted / self.mass });
                }
            }
        }
        Ok(())
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.scale.len()
    }

    /// Whether there is none; an experiment has at least one.
    pub fn is_empty(&self) -> bool {
        self.scale.is_empty()
    }

    /// Whether particles are clumps of spheres.
    pub fn are_clumps(&self) -> bool {
        self.clump.is_some()
    }

    /// Spheres in one particle.
    pub fn spheres_per_particle(&self) -> usize {
        self.template.len()
    }

    /// Size of a particle over that of the mean one.
    pub fn scale(&self, particle: usize) -> f64 {
        self.scale[particle]
    }

    /// Mass of a particle, kg.
    pub fn mass(&self, particle: usize) -> f64 {
        self.mass * self.scale[particle].powi(3)
    }

    /// Mass of all particles, kg.
    pub fn total_mass(&self) -> f64 {
        (0..self.len()).map(|k| self.mass(k)).sum()
    }

    /// Volume of all particles, m3.
    pub fn solid_volume(&self) -> f64 {
        self.total_mass() / self.density
    }

    /// Volume of a particle of scale 1, m3.
    pub(crate) fn mean_volume(&self) -> f64 {
        self.mass / self.density
    }

    /// Radius of the ball that has the volume of the mean particle, m.
    pub fn equivalent_radius(&self) -> f64 {
        (0.75 * self.mass / self.density / std::f64::consts::PI).cbrt()
    }

    /// Radius of the smallest sphere of all, m: it limits the time step.
    pub fn smallest_radius(&self) -> f64 {
        let of_template = self.template.iter().map(|b| b.1).fold(f64::INFINITY, f64::min);
        of_template * self.scale.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Radius about the centre of mass of the largest particle that holds it, m.
    pub fn largest_bounding_radius(&self) -> f64 {
        let reach = self.template.iter().map(|(c, r)| c.length() + r).fold(0.0, f64::max);
        reach * self.scale.iter().copied().fold(0.0, f64::max)
    }

    /// The spheres of one particle with its centre of mass at `position` (m) and `orientation`
    /// from the frame of its template.
    pub fn balls(
        &self,
        particle: usize,
        position: DVec3,
        orientation: DQuat,
    ) -> impl Iterator<Item = Ball> + '_ {
        let scale = self.scale[particle];
        self.template.iter().map(move |(centre, radius)| Ball {
            centre: position + orientation * (*centre * scale),
            radius: radius * scale,
            particle: particle as u32,
        })
    }
}
