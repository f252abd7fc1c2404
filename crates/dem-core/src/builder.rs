//! Building a world: every number is checked before the first step.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;

use crate::body_force::{Drag, Gravity};
use crate::contact::elasticity::Elasticity;
use crate::contact::kinematics::PairGeometry;
use crate::contact::law::Memory;
use crate::contact::model::ContactLaw;
use crate::error::{Error, finite, positive};
use crate::forces::MAX_SLOTS;
use crate::gap_force::GapForce;
use crate::geometry::{MotionState, PlacedWall, Wall};
use crate::integrate::{Integrator, VelocityVerlet};
use crate::material::{Material, MaterialId, PairTable};
use crate::neighbour::Period;
use crate::noncontact::NonContactForce;
use crate::particles::{Column, END, ParticleId, Record, Sphere};
use crate::rigid::{Clump, PlacedClump};
use crate::simd::{Arithmetic, Level};
use crate::sweep::FAR;
use crate::threads::Team;
use crate::timestep::{hertz_time, rayleigh_time};
use crate::world::{LARGE, Make, SPHERE, Scratch, State, World};

/// Largest ratio of radii that the neighbour search is made for.
pub const LARGEST_SIZE_RATIO: f64 = 100.0;

/// Axis of a periodic domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Axis {
    /// First coordinate.
    X,
    /// Second coordinate.
    Y,
    /// Third coordinate.
    Z,
}

/// Instructions that the contact kernels may use. All but [`Kernels::Fused`] and
/// [`Kernels::FastRoots`] give the same bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Kernels {
    /// The widest that the processor has.
    #[default]
    Fastest,
    /// The widest, with products that are not rounded before they are added to something (in contacts and in the integrator),
    /// one division for several reciprocals and the spring's length by a series, all to rounding, but not the bits of the
    /// others. Runs are the same for any number of threads and with AVX-512 as with AVX2; where there is neither they are those
    /// of [`Kernels::Portable`].
    Fused,
    /// The same, with all roots and reciprocals of contacts from the processor's tables and a series where AVX-512 is
    /// there: two to four units in the last place from exact, each. Runs are still the same for any number
    /// of threads, but not between processors with and without AVX-512.
    FastRoots,
    /// At most AVX2.
    Avx2,
    /// None but those that every processor has.
    Portable,
}

#[derive(Debug, Clone)]
enum Body {
    Sphere(Sphere),
    Clump(PlacedClump),
}

/// Collects what a [`World`] is made of.
///
/// ```
/// use dem_core::prelude::*;
/// let glass = Material::from_shear_modulus(2.52e7, 0.29, 2500.0);
/// let law = ContactModel {
///     normal: HertzTailCut { e_star: glass.youngs_modulus / (2.0 * (1.0 - 0.29f64.powi(2))), damping: 0.1 },
///     tangential: Frictionless,
///     rolling: FreeRolling,
///     cohesion: Cohesionless,
/// };
/// let mut builder = WorldBuilder::new(1e-5);
/// let bead = builder.material(glass);
/// builder.pair_law(bead, bead, law);
/// builder.gravity(DVec3::NEG_Z * 9.81);
/// builder.domain(DVec3::splat(-1.0), DVec3::splat(1.0));
/// let id = builder.sphere(Sphere::at(DVec3::Z * 0.5, 3e-3, bead));
/// let mut world = builder.build()?;
/// world.run(10_000)?;
/// // Free fall for 0.1 s: 49.05 mm, to rounding.
/// assert!((world.position(id).z - (0.5 - 0.04905)).abs() < 1e-12);
/// # Ok::<(), dem_core::error::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct WorldBuilder<M> {
    dt: f64,
    gravity: Gravity,
    drag: Option<Drag>,
    domain: Option<[DVec3; 2]>,
    periodic: Option<Axis>,
    materials: Vec<Material>,
    laws: Vec<(MaterialId, MaterialId, M)>,
    walls: Vec<Wall>,
    shapes: Vec<Clump>,
    bodies: Vec<Body>,
    skin: Option<f64>,
    threads: usize,
    kernels: Kernels,
    overlap_limit: f64,
    time_step_fraction: Option<f64>,
    impact_speed: Option<f64>,
    gap_forces: Vec<Arc<dyn GapForce>>,
    charges: BTreeMap<u32, f64>,
}

impl<M: ContactLaw + 'static> WorldBuilder<M> {
    /// Begin a world with the time step `dt`, s.
    pub fn new(dt: f64) -> Self {
        Self {
            dt,
            gravity: Gravity::default(),
            drag: None,
            domain: None,
            periodic: None,
            materials: Vec::new(),
            laws: Vec::new(),
            walls: Vec::new(),
            shapes: Vec::new(),
            bodies: Vec::new(),
            skin: None,
            threads: 1,
            kernels: Kernels::Fastest,
            overlap_limit: 0.5,
            time_step_fraction: Some(1.0),
            impact_speed: None,
            gap_forces: Vec::new(),
            charges: BTreeMap::new(),
        }
    }

    /// Declare a material.
    pub fn material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId((self.materials.len() - 1) as u16)
    }

    /// Set the contact law between two materials (in both orders; a later one replaces).
    pub fn pair_law(&mut self, a: MaterialId, b: MaterialId, law: M) -> &mut Self {
        self.laws.push((a, b, law));
        self
    }

    /// Let a non-contact force act between the materials that have a law in `table`.
    ///
    /// Several forces add up. A wall takes part as a material with an infinite radius.
    pub fn non_contact<F>(&mut self, table: PairTable<F>) -> &mut Self
    where
        F: NonContactForce + std::fmt::Debug + 'static,
    {
        self.gap_forces.push(Arc::new(table));
        self
    }

    /// Give a particle an electric charge, C (0 unless given).
    pub fn charge(&mut self, particle: ParticleId, coulombs: f64) -> &mut Self {
        self.charges.insert(particle.0, coulombs);
        self
    }

    /// Steady gravity, m/s2.
    pub fn gravity(&mut self, acceleration: DVec3) -> &mut Self {
        self.gravity = Gravity::steady(acceleration);
        self
    }

    /// Gravity that may turn.
    pub fn turning_gravity(&mut self, gravity: Gravity) -> &mut Self {
        self.gravity = gravity;
        self
    }

    /// Drag on every body.
    pub fn drag(&mut self, drag: Drag) -> &mut Self {
        self.drag = Some(drag);
        self
    }

    /// Box outside of which a particle is lost, m.
    pub fn domain(&mut self, min: DVec3, max: DVec3) -> &mut Self {
        self.domain = Some([min, max]);
        self
    }

    /// Let the domain repeat itself along one axis.
    pub fn periodic(&mut self, axis: Axis) -> &mut Self {
        self.periodic = Some(axis);
        self
    }

    /// Add a wall; returns its number.
    pub fn wall(&mut self, wall: Wall) -> usize {
        self.walls.push(wall);
        self.walls.len() - 1
    }

    /// Declare a shape of clumps; returns its number.
    pub fn clump_shape(&mut self, clump: Clump) -> usize {
        self.shapes.push(clump);
        self.shapes.len() - 1
    }

    /// Add a sphere.
    pub fn sphere(&mut self, sphere: Sphere) -> ParticleId {
        self.bodies.push(Body::Sphere(sphere));
        ParticleId((self.bodies.len() - 1) as u32)
    }

    /// Add a clump of a declared shape.
    pub fn clump(&mut self, clump: PlacedClump) -> ParticleId {
        self.bodies.push(Body::Clump(clump));
        ParticleId((self.bodies.len() - 1) as u32)
    }

    /// Gap up to which the neighbour list holds pairs, m; by default 0.4 of the mean radius. Of clumps it holds those up to what both may
    /// move before it is made again, which is less for slow ones.
    pub fn skin(&mut self, skin: f64) -> &mut Self {
        self.skin = Some(skin);
        self
    }

    /// Number of threads (1 by default). It changes no bit of the result.
    pub fn threads(&mut self, threads: usize) -> &mut Self {
        self.threads = threads;
        self
    }

    /// Instructions that the kernels may use (the widest by default).
    pub fn kernels(&mut self, kernels: Kernels) -> &mut Self {
        self.kernels = kernels;
        self
    }

    /// Largest overlap over the smaller radius before the run stops (0.5 by default).
    pub fn largest_overlap(&mut self, fraction: f64) -> &mut Self {
        self.overlap_limit = fraction;
        self
    }

    /// Largest share of the Rayleigh time that the time step may be (1 by default).
    pub fn largest_time_step(&mut self, fraction_of_rayleigh: f64) -> &mut Self {
        self.time_step_fraction = Some(fraction_of_rayleigh);
        self
    }

    /// Speed (m/s) of the fastest impacts that are expected: the time step must then be at most a
    /// quarter of the duration of such a Hertz impact of the smallest spheres.
    pub fn impact_speed(&mut self, speed: f64) -> &mut Self {
        self.impact_speed = Some(speed);
        self
    }

    /// Accept any time step.
    pub fn allow_large_time_step(&mut self) -> &mut Self {
        self.time_step_fraction = None;
        self
    }

    /// Check everything and make the world, advanced by velocity Verlet.
    ///
    /// # Errors
    /// The first thing found wrong: see [`Error`].
    pub fn build(&self) -> Result<World<M>, Error> {
        self.build_with(VelocityVerlet)
    }

    /// Check everything and make the world, advanced by `integrator`.
    ///
    /// # Errors
    /// The first thing found wrong: see [`Error`].
    pub fn build_with<I: Integrator>(&self, integrator: I) -> Result<World<M, I>, Error> {
        positive("time step (s)", self.dt)?;
        positive("largest overlap", self.overlap_limit)?;
        self.gravity.check()?;
        if let Some(d) = &self.drag {
            d.check()?;
        }
        for m in &self.materials {
            m.check()?;
        }
        let walls: Vec<Wall> =
            self.walls.iter().map(|w| w.clone().checked()).collect::<Result<_, _>>()?;
        let domain = self.checked_domain()?;
        let period = self.periodic.map(|axis| {
            let axis = axis as usize;
            Period { axis, min: domain[0][axis], length: domain[1][axis] - domain[0][axis] }
        });
        let state = self.bodies(&domain)?;
        let radii = || {
            let members = state.members.position.iter().map(|p| p.w);
            let singles = state.bodies.position.iter().map(|p| p.w);
            if self.shapes.is_empty() {
                Box::new(singles) as Box<dyn Iterator<Item = f64>>
            } else {
                Box::new(members)
            }
        };
        let largest = radii().fold(0.0, f64::max);
        let smallest = radii().fold(f64::INFINITY, f64::min);
        if largest / smallest > LARGEST_SIZE_RATIO {
            return Err(Error::SizeRatio { ratio: largest / smallest, limit: LARGEST_SIZE_RATIO });
        }
        let count = radii().count().max(1);
        let skin = self.skin.unwrap_or(0.4 * radii().sum::<f64>() / count as f64);
        if !state.bodies.id.is_empty() {
            positive("skin (m)", skin)?;
        }
        let laws = self.dense_laws(&state, &walls)?;
        self.check_time_step(&self.smallest_by_material(&state))?;
        let neck = self.largest_neck(&laws, largest, smallest, &state);
        let range = neck.max(self.largest_range(largest, smallest, &state));
        let slots =
            <M::Memory as Memory>::SLOTS + self.gap_forces.iter().map(|f| f.slots()).sum::<usize>();
        if slots > MAX_SLOTS {
            return Err(Error::Parameter {
                name: "numbers remembered by a contact",
                value: slots as f64,
                expected: "at most 48",
            });
        }
        let bounding = state.bodies.position.iter().map(|p| p.w).fold(0.0, f64::max);
        if let Some(p) = period {
            let least = 2.0 * (2.0 * bounding + skin + range);
            if p.length < least {
                return Err(Error::PeriodTooShort { length: p.length, least });
            }
        }
        let level = match (self.kernels, Level::detect()) {
            (Kernels::Portable, _) | (_, Level::Portable) => Level::Portable,
            (Kernels::Avx2, _) => Level::Avx2,
            (Kernels::Fastest | Kernels::Fused | Kernels::FastRoots, level) => level,
        };
        let known = level != Level::Portable && neck == 0.0 && self.gap_forces.is_empty();
        let fast = if known { crate::simd::constants(&laws) } else { None };
        let first_material = state.bodies.mean_spin.first().map(|s| s.w);
        let one_material =
            first_material.filter(|m| state.bodies.mean_spin.iter().all(|s| s.w == *m));
        let alike = |records: &[Record]| {
            let first = records.first().map(|r| r.w);
            first.filter(|w| records.iter().all(|r| r.w == *w))
        };
        let one_size = match (alike(&state.bodies.position), alike(&state.bodies.velocity)) {
            (Some(radius), Some(mass)) if self.shapes.is_empty() => Some([radius, mass]),
            _ => None,
        };
        let one_inertia = match (one_size, alike(&state.bodies.spin)) {
            (Some([_, mass]), Some(moment)) => Some([mass, moment]),
            _ => None,
        };
        // Spheres by themselves have a moment of inertia.
        let only_clumps = !self.shapes.is_empty() && state.bodies.spin.iter().all(|s| s.w == 0.0);
        let mut state = state;
        if !I::REMEMBERS {
            state.bodies.linear_memory = Column::default();
            if self.shapes.is_empty() {
                state.bodies.angular_memory = Column::default();
            }
        }
        state.walls = walls
            .iter()
            .map(|w| MotionState { motion: w.motion, ..MotionState::default() })
            .collect();
        let placed: Vec<PlacedWall> =
            walls.iter().zip(&state.walls).map(|(w, s)| PlacedWall::new(w, s, 0.0, 0.0)).collect();
        let turning_wall =
            walls.iter().position(|w| w.motion.rotation.is_some_and(|r| r.rate != 0.0));
        Ok(World {
            make: Make {
                dt: self.dt,
                gravity: self.gravity,
                drag: self.drag,
                domain,
                period,
                materials: self.materials.clone(),
                laws,
                walls,
                shapes: self.shapes.clone(),
                skin,
                neck,
                range,
                gap_forces: self.gap_forces.clone(),
                slots: slots.max(1),
                level,
                fast,
                one_material: one_material.map(|m| m as usize),
                one_size,
                one_inertia,
                only_clumps,
                arithmetic: match (self.kernels, level) {
                    (Kernels::FastRoots, Level::Avx512) => Arithmetic::FastRoots,
                    (Kernels::Fused | Kernels::FastRoots, Level::Avx2 | Level::Avx512) => {
                        Arithmetic::Fused
                    }
                    _ => Arithmetic::Exact,
                },
                overlap_limit: self.overlap_limit,
                far: FAR,
                large: LARGE,
                turning_wall,
            },
            integrator,
            state,
            scratch: Scratch { placed_then: placed.clone(), placed, ..Scratch::default() },
            team: Team::new(self.threads),
            ledger_wanted: false,
        })
    }

    fn checked_domain(&self) -> Result<[DVec3; 2], Error> {
        let domain = self.domain.ok_or(Error::Missing { what: "domain", method: "domain" })?;
        finite("domain min (m)", domain[0])?;
        finite("domain max (m)", domain[1])?;
        let size = domain[1] - domain[0];
        if size.min_element() <= 0.0 {
            return Err(Error::Vector {
                name: "domain max - min (m)",
                value: size,
                expected: "three positive lengths",
            });
        }
        Ok(domain)
    }

    fn known(&self, material: MaterialId) -> Result<&Material, Error> {
        self.materials
            .get(usize::from(material.0))
            .ok_or(Error::UnknownMaterial { material: material.0, declared: self.materials.len() })
    }

    fn bodies(&self, domain: &[DVec3; 2]) -> Result<State, Error> {
        let mut state = State { forces_stale: true, list_stale: true, ..State::default() };
        let clumps = !self.shapes.is_empty();
        state.bodies.reserve(self.bodies.len());
        for body in &self.bodies {
            let id = match body {
                Body::Sphere(s) => {
                    let density = self.known(s.material)?.density;
                    positive("sphere radius (m)", s.radius)?;
                    finite("sphere velocity (m/s)", s.velocity)?;
                    finite("sphere spin (rad/s)", s.spin)?;
                    let mass = density * 4.0 / 3.0 * std::f64::consts::PI * s.radius.powi(3);
                    let moment = 0.4 * mass * s.radius * s.radius;
                    if clumps {
                        let m = &mut state.members;
                        m.first_id.push(m.position.len() as u32);
                        m.position.push(Record { w: s.radius, ..Record::default() });
                        m.shape.push(SPHERE);
                        m.attitude.push(glam::DQuat::IDENTITY);
                    }
                    let b = &mut state.bodies;
                    b.push(s.position, s.radius, s.velocity, mass, s.spin, moment, s.material)
                }
                Body::Clump(c) => {
                    let shape = self.shapes.get(c.shape).ok_or(Error::NoSuch {
                        what: "clump shape",
                        number: c.shape,
                        count: self.shapes.len(),
                    })?;
                    self.known(shape.material)?;
                    finite("clump velocity (m/s)", c.velocity)?;
                    finite("clump spin (rad/s)", c.spin)?;
                    if !(c.orientation.is_finite() && c.orientation.length_squared() > 0.0) {
                        return Err(Error::Parameter {
                            name: "length of a clump's orientation quaternion",
                            value: c.orientation.length(),
                            expected: "a finite number above zero",
                        });
                    }
                    let m = &mut state.members;
                    m.first_id.push(m.position.len() as u32);
                    m.shape.push(c.shape as u32);
                    m.attitude.push((c.orientation.normalize() * shape.principal).normalize());
                    m.position.extend(
                        shape.spheres.iter().map(|s| Record { w: s.radius, ..Record::default() }),
                    );
                    let b = &mut state.bodies;
                    let radius = shape.bounding_radius;
                    b.push(c.position, radius, c.velocity, shape.mass, c.spin, 0.0, shape.material)
                }
            };
            if let Some(&charge) = self.charges.get(&id.0) {
                state.bodies.velocities[id.0 as usize][END].w = charge;
            }
            let position = state.bodies.position[id.0 as usize].vector();
            let inside = position.cmpge(domain[0]).all() && position.cmple(domain[1]).all();
            if !inside {
                return Err(Error::OutsideDomain {
                    particle: id,
                    position,
                    min: domain[0],
                    max: domain[1],
                });
            }
        }
        Ok(state)
    }

    fn dense_laws(&self, state: &State, walls: &[Wall]) -> Result<Vec<M>, Error> {
        let n = self.materials.len();
        let mut table = PairTable::new(n);
        for (a, b, law) in &self.laws {
            table.set(*a, *b, *law)?;
        }
        let mut of_particles: Vec<MaterialId> =
            state.bodies.mean_spin.iter().map(|s| MaterialId(s.w as u16)).collect();
        of_particles.sort_unstable();
        of_particles.dedup();
        for wall in walls {
            self.known(wall.material)?;
        }
        for &a in &of_particles {
            for b in of_particles.iter().copied().chain(walls.iter().map(|w| w.material)) {
                if table.get(a, b).is_none() {
                    return Err(Error::MissingPairLaw { a, b });
                }
            }
        }
        let Some((_, _, any)) = self.laws.first() else { return Ok(Vec::new()) };
        let all = (0..n as u16).flat_map(|a| (0..n as u16).map(move |b| (a, b)));
        // A pair without a law cannot meet (checked above): its entry is never read.
        Ok(all.map(|(a, b)| *table.get(MaterialId(a), MaterialId(b)).unwrap_or(any)).collect())
    }

    /// Radius of the smallest sphere of each material; infinite for one that only walls have, as
    /// walls do not move by forces.
    fn smallest_by_material(&self, state: &State) -> Vec<f64> {
        let mut smallest = vec![f64::INFINITY; self.materials.len()];
        let b = &state.bodies;
        let mut see = |body: usize, radius: f64| {
            let least = &mut smallest[b.mean_spin[body].w as usize];
            *least = least.min(radius);
        };
        if self.shapes.is_empty() {
            b.position.iter().enumerate().for_each(|(k, p)| see(k, p.w));
        } else {
            let m = &state.members;
            m.position.iter().zip(&m.body).for_each(|(p, &body)| see(body as usize, p.w));
        }
        smallest
    }

    fn check_time_step(&self, smallest_by_material: &[f64]) -> Result<(), Error> {
        let Some(fraction) = self.time_step_fraction else { return Ok(()) };
        positive("largest time step over the Rayleigh time", fraction)?;
        let refuse = |fraction, limit, criterion| {
            if self.dt > fraction * limit {
                let time_step = self.dt;
                return Err(Error::TimeStepTooLarge { time_step, fraction, limit, criterion });
            }
            Ok(())
        };
        let particles = self.materials.iter().zip(smallest_by_material.iter().copied());
        for (m, smallest) in particles.filter(|(_, radius)| radius.is_finite()) {
            let elasticity = Elasticity::new(m.youngs_modulus, m.poisson_ratio)?;
            refuse(fraction, rayleigh_time(smallest, m.density, &elasticity), "Rayleigh")?;
            if let Some(speed) = self.impact_speed {
                positive("impact speed (m/s)", speed)?;
                let e_star = m.youngs_modulus / (2.0 * (1.0 - m.poisson_ratio.powi(2)));
                let mass = m.density * 4.0 / 3.0 * std::f64::consts::PI * smallest.powi(3);
                let time = hertz_time(e_star, 0.5 * smallest, 0.5 * mass, speed);
                refuse(0.25, time, "Hertz collision")?;
            }
        }
        Ok(())
    }

    fn largest_neck(&self, laws: &[M], largest: f64, smallest: f64, state: &State) -> f64 {
        if state.bodies.id.is_empty() {
            return 0.0;
        }
        let masses = || state.bodies.velocity.iter().map(|v| v.w);
        let mass = masses().fold(f64::INFINITY, f64::min);
        let mut neck = 0.0f64;
        for law in laws {
            for (a, b) in [(largest, largest), (smallest, smallest), (largest, f64::INFINITY)] {
                let r_star = if b.is_finite() { a * b / (a + b) } else { a };
                let pair = PairGeometry { r_star, m_star: 0.5 * mass, radius_i: a, radius_j: b };
                neck = neck.max(law.reach(&pair));
            }
        }
        // A hollow cylinder has a larger effective radius than a plane; necks grow at most with
        // its first power.
        if self.walls.is_empty() { neck } else { 1.5 * neck }
    }

    fn largest_range(&self, largest: f64, smallest: f64, state: &State) -> f64 {
        let ids = 0..self.materials.len() as u16;
        let mass = state.bodies.velocity.iter().map(|v| v.w).fold(f64::INFINITY, f64::min);
        let mut range = 0.0f64;
        for force in &self.gap_forces {
            for (a, b) in ids.clone().flat_map(|a| ids.clone().map(move |b| (a, b))) {
                for (i, j) in [
                    (largest, largest),
                    (largest, smallest),
                    (smallest, smallest),
                    (largest, f64::INFINITY),
                ] {
                    let r_star = if j.is_finite() { i * j / (i + j) } else { i };
                    let pair =
                        PairGeometry { r_star, m_star: 0.5 * mass, radius_i: i, radius_j: j };
                    let reach = force.range(MaterialId(a), MaterialId(b), &pair);
                    range = range.max(reach.unwrap_or(0.0));
                }
            }
        }
        range
    }
}
