//! The store of bodies: one array a quantity, re-sorted in space, with stable names.

mod column;

use glam::DVec3;

pub(crate) use column::{Column, LINE};

use crate::material::MaterialId;
use crate::threads::{PART, Team, cut, part};

/// Name of a particle (a sphere or a clump): its number in the order of adding, for ever.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ParticleId(pub u32);

impl std::fmt::Display for ParticleId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// A sphere to be added to a world.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sphere {
    /// Centre, m.
    pub position: DVec3,
    /// Radius, m.
    pub radius: f64,
    /// Material; its density gives the mass.
    pub material: MaterialId,
    /// Velocity, m/s.
    pub velocity: DVec3,
    /// Angular velocity, rad/s.
    pub spin: DVec3,
}

impl Sphere {
    /// A sphere at rest.
    pub fn at(position: DVec3, radius: f64, material: MaterialId) -> Self {
        Self { position, radius, material, velocity: DVec3::ZERO, spin: DVec3::ZERO }
    }

    /// The same sphere with a velocity, m/s.
    #[must_use]
    pub fn with_velocity(mut self, velocity: DVec3) -> Self {
        self.velocity = velocity;
        self
    }

    /// The same sphere with an angular velocity, rad/s.
    #[must_use]
    pub fn with_spin(mut self, spin: DVec3) -> Self {
        self.spin = spin;
        self
    }
}

/// Four numbers of one body, in one aligned 32-byte record: what a contact gathers at once.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(32))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Record {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) z: f64,
    /// A scalar that belongs to the vector (radius, mass, ...).
    pub(crate) w: f64,
}

impl Record {
    pub(crate) const ZERO: Self = Self { x: 0.0, y: 0.0, z: 0.0, w: 0.0 };

    #[inline(always)]
    pub(crate) fn new(v: DVec3, w: f64) -> Self {
        Self { x: v.x, y: v.y, z: v.z, w }
    }

    /// The same number four times.
    #[inline(always)]
    pub(crate) fn splat(number: f64) -> Self {
        Self { x: number, y: number, z: number, w: number }
    }

    #[inline(always)]
    pub(crate) fn vector(&self) -> DVec3 {
        DVec3::new(self.x, self.y, self.z)
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, v: DVec3) {
        self.x = v.x;
        self.y = v.y;
        self.z = v.z;
    }

    /// Sum of all four fields: one vector addition.
    #[inline(always)]
    pub(crate) fn plus(self, o: &Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z, w: self.w + o.w }
    }

    /// Difference of all four fields.
    #[inline(always)]
    pub(crate) fn minus(self, o: &Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z, w: self.w - o.w }
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, v: DVec3) {
        self.x += v.x;
        self.y += v.y;
        self.z += v.z;
    }
}

impl std::ops::Add for Record {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.plus(&o)
    }
}

impl std::ops::Sub for Record {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.minus(&o)
    }
}

impl std::ops::Mul<f64> for Record {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: f64) -> Self {
        Self { x: self.x * s, y: self.y * s, z: self.z * s, w: self.w * s }
    }
}

impl crate::integrate::Vector for Record {}

/// Two velocities of a body, in one line of the cache: averaged over the last step (its displacement over its duration), and mass;
/// foretold by the last forces for the end of the step, and charge.
pub(crate) type Velocities = [Record; 2];

/// Which of the velocities of a body is which.
pub(crate) const MEAN: usize = 0;
pub(crate) const END: usize = 1;

/// State of all bodies in storage order.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Bodies {
    /// Name of the body at each place.
    pub(crate) id: Vec<u32>,
    /// Centre of mass and bounding radius.
    pub(crate) position: Column<Record>,
    /// Velocity at the end of the last step, and mass.
    pub(crate) velocity: Column<Record>,
    /// Angular velocity (laboratory frame), and moment of inertia of a sphere.
    pub(crate) spin: Column<Record>,
    /// Acceleration at the end of the last step.
    pub(crate) acceleration: Column<Record>,
    /// Angular acceleration of spheres; torque on clumps, N m.
    pub(crate) angular_acceleration: Column<Record>,
    /// Mean velocity and mass; velocity foretold for the end of the step and charge.
    pub(crate) velocities: Column<Velocities>,
    /// Angular velocity averaged over the last step, and material number.
    pub(crate) mean_spin: Column<Record>,
    /// What the integrator remembers of the translation and of the rotation (of a clump: its angular momentum); empty if
    /// nothing.
    pub(crate) linear_memory: Column<Record>,
    pub(crate) angular_memory: Column<Record>,
    /// Place of each body, by its name.
    pub(crate) place: Vec<u32>,
}

impl Bodies {
    pub(crate) fn len(&self) -> usize {
        self.id.len()
    }

    /// Have room for so many bodies.
    pub(crate) fn reserve(&mut self, bodies: usize) {
        for names in [&mut self.id, &mut self.place] {
            names.reserve_exact(bodies.saturating_sub(names.len()));
        }
        self.columns().into_iter().for_each(|column| column.reserve(bodies));
        self.velocities.reserve(bodies);
    }

    /// What is known of every body, a record each: all but velocities.
    fn columns(&mut self) -> [&mut Column<Record>; 8] {
        [
            &mut self.position,
            &mut self.velocity,
            &mut self.spin,
            &mut self.acceleration,
            &mut self.angular_acceleration,
            &mut self.mean_spin,
            &mut self.linear_memory,
            &mut self.angular_memory,
        ]
    }

    pub(crate) fn push(
        &mut self,
        position: DVec3,
        bounding_radius: f64,
        velocity: DVec3,
        mass: f64,
        spin: DVec3,
        moment: f64,
        material: MaterialId,
    ) -> ParticleId {
        let id = self.len() as u32;
        self.id.push(id);
        self.place.push(id);
        self.position.push(Record::new(position, bounding_radius));
        self.velocity.push(Record::new(velocity, mass));
        self.spin.push(Record::new(spin, moment));
        self.velocities.push([Record::new(velocity, mass), Record::new(velocity, 0.0)]);
        self.mean_spin.push(Record::new(spin, f64::from(material.0)));
        for v in [
            &mut self.acceleration,
            &mut self.angular_acceleration,
            &mut self.linear_memory,
            &mut self.angular_memory,
        ] {
            v.push(Record::default());
        }
        ParticleId(id)
    }

    /// Put body `order[k]` at place `k`, for all `k`.
    pub(crate) fn permute(&mut self, order: &[u32], scratch: &mut Column<Record>, team: &Team) {
        for v in self.columns() {
            if v.is_empty() {
                continue;
            }
            gather(order, scratch, team, |from| v[from]);
            std::mem::swap(v, scratch);
        }
        for of_two in [MEAN, END] {
            let v = &mut self.velocities;
            gather(order, scratch, team, |from| v[from][of_two]);
            team.each(order.len().div_ceil(PART), cut(v, PART), |c, to| {
                for (to, from) in to.iter_mut().zip(&scratch[part(c, order.len())]) {
                    to[of_two] = *from;
                }
            });
        }
        // `place` still holds where each name was: use it as scratch for the names.
        let old_ids = &mut self.place;
        old_ids.copy_from_slice(&self.id);
        for (new, &old) in order.iter().enumerate() {
            self.id[new] = old_ids[old as usize];
        }
        for (place, &id) in self.id.iter().enumerate() {
            self.place[id as usize] = place as u32;
        }
    }
}

/// One record of each body, in this order of the bodies.
fn gather(
    order: &[u32],
    to: &mut Column<Record>,
    team: &Team,
    record: impl Fn(usize) -> Record + Sync,
) {
    to.make_room(order.len(), Record::ZERO);
    team.each(order.len().div_ceil(PART), cut(to, PART), |c, to| {
        for (to, &from) in to.iter_mut().zip(&order[part(c, order.len())]) {
            *to = record(from as usize);
        }
    });
}
