//! The one error type of the crate, and the faults that stop a run.

use glam::DVec3;

use crate::material::MaterialId;
use crate::particles::ParticleId;

/// Anything that can go wrong, with the values that were involved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A number is outside the range that its meaning allows.
    #[error("{name} = {value}: expected {expected}")]
    Parameter {
        /// Name of the parameter, with its unit.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// What would have been accepted.
        expected: &'static str,
    },
    /// A vector has no direction (zero length) or is not finite.
    #[error("{name} = {value}: expected {expected}")]
    Vector {
        /// Name of the vector, with its unit.
        name: &'static str,
        /// The value that was given.
        value: DVec3,
        /// What would have been accepted.
        expected: &'static str,
    },
    /// A material is used that was not declared.
    #[error("material {material} is not declared: there are {declared} materials, numbered from 0")]
    UnknownMaterial {
        /// Number of the material asked for.
        material: u16,
        /// How many are declared.
        declared: usize,
    },
    /// Two materials can meet but no contact law was given for them.
    #[error("no contact law for materials {a} and {b}: give one with `pair_law`")]
    MissingPairLaw {
        /// One material.
        a: MaterialId,
        /// The other.
        b: MaterialId,
    },
    /// The builder lacks something that has no default.
    #[error("the world has no {what}: set it with `{method}`")]
    Missing {
        /// What is missing.
        what: &'static str,
        /// Builder method that supplies it.
        method: &'static str,
    },
    /// A particle was placed outside the domain.
    #[error("particle {particle} at {position} m lies outside the domain {min} to {max} m")]
    OutsideDomain {
        /// Its number in the order of adding.
        particle: ParticleId,
        /// Where it is, m.
        position: DVec3,
        /// Lower corner of the domain, m.
        min: DVec3,
        /// Upper corner of the domain, m.
        max: DVec3,
    },
    /// The largest and smallest sphere differ by more than the neighbour search is made for.
    #[error("size ratio {ratio:.1} of the spheres is above {limit}")]
    SizeRatio {
        /// Largest over smallest radius.
        ratio: f64,
        /// Largest ratio supported.
        limit: f64,
    },
    /// The time step exceeds a stability limit that was not lifted (by `allow_large_time_step` of the builder).
    #[error(
        "time step {time_step:e} s exceeds {fraction} of the {criterion} time {limit:e} s: reduce it"
    )]
    TimeStepTooLarge {
        /// The step asked for, s.
        time_step: f64,
        /// Share of the limit that is allowed.
        fraction: f64,
        /// The limiting time, s.
        limit: f64,
        /// Name of the criterion.
        criterion: &'static str,
    },
    /// A periodic box is too short for the particles in it.
    #[error(
        "periodic length {length} m is below {least} m, twice the range of the neighbour search: particles would meet their own images"
    )]
    PeriodTooShort {
        /// Length of the period, m.
        length: f64,
        /// Least length, m.
        least: f64,
    },
    /// The integrator carries a clump's centre, but the crate cannot diagonalise its inertia.
    #[error(
        "inertia tensor of the clump has principal moments {moments} kg m2: expected positive ones that obey the triangle inequality"
    )]
    Inertia {
        /// The principal moments, kg m2.
        moments: DVec3,
    },
    /// No particle, wall or clump has this number.
    #[error("there is no {what} {number}: there are {count}, numbered from 0")]
    NoSuch {
        /// Kind of thing.
        what: &'static str,
        /// The number asked for.
        number: usize,
        /// How many there are.
        count: usize,
    },
    /// A snapshot belongs to a world of another make.
    #[error("the snapshot does not fit this world: {what} is {found}, expected {expected}")]
    SnapshotMismatch {
        /// What differs.
        what: &'static str,
        /// In the snapshot.
        found: u64,
        /// In this world.
        expected: u64,
    },
    /// Bytes that should hold a snapshot do not.
    #[error("the bytes are not a snapshot: {what} at byte {offset}")]
    SnapshotCorrupt {
        /// What was found wrong.
        what: &'static str,
        /// Where.
        offset: usize,
    },
    /// A mesh cannot be used as a wall.
    #[error("the mesh cannot be a wall: {what} ({value})")]
    Mesh {
        /// What is wrong.
        what: &'static str,
        /// Number of the facet or vertex concerned, or a count.
        value: usize,
    },
    /// A mesh could not be read.
    #[error("cannot read the {format} mesh: {reason}")]
    MeshRead {
        /// File format.
        format: &'static str,
        /// What the reader said.
        reason: String,
    },
    /// The parameters of a law were refused.
    #[error(transparent)]
    Law(#[from] crate::contact::error::LawError),
    /// The run itself went wrong.
    #[error(transparent)]
    Fault(#[from] Fault),
}

/// A run that cannot go on: what happened to which particle, when, and the likely cause.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "step {step} ({time:.6} s): particle {particle} at {position} m {kind}{}: likely cause: {cause}",
    partner_text(.partner)
)]
pub struct Fault {
    /// What happened.
    pub kind: FaultKind,
    /// The particle concerned.
    pub particle: ParticleId,
    /// What it was in contact with, if anything.
    pub partner: Option<Partner>,
    /// Where it was, m (not finite when the position is lost).
    pub position: DVec3,
    /// Step number.
    pub step: u64,
    /// Time, s.
    pub time: f64,
    /// What most often leads to this.
    pub cause: Cause,
}

fn partner_text(partner: &Option<Partner>) -> String {
    match partner {
        None => String::new(),
        Some(Partner::Particle(p)) => format!(" against particle {p}"),
        Some(Partner::Wall(w)) => format!(" against wall {w}"),
    }
}

/// What a particle touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Partner {
    /// Another particle.
    Particle(ParticleId),
    /// A wall, by its number in the order of adding.
    Wall(usize),
}

/// Kinds of faults.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FaultKind {
    /// A position or velocity is not a number.
    #[error("has a position or velocity that is not finite")]
    NotFinite,
    /// Two bodies overlap too much for the contact laws to hold.
    #[error("overlaps by {fraction:.3} of the smaller radius (limit {limit})")]
    Overlap {
        /// Overlap over the smaller radius.
        fraction: f64,
        /// Largest fraction allowed.
        limit: f64,
    },
    /// A particle left the domain.
    #[error("left the domain")]
    Lost,
}

/// What most often leads to a fault.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Cause {
    /// The particle moves further in a step than contacts can resolve.
    #[error(
        "it moves {radii_per_step:.3} radii a step: the time step is too long, or, where the step follows from the stiffness, the particles are too soft"
    )]
    TimeStep {
        /// Distance travelled in one step over the radius.
        radii_per_step: f64,
    },
    /// The fault is there from the start.
    #[error("particles were placed into one another")]
    Placement,
    /// The load is more than the stiffness carries.
    #[error("the contact is too soft for its load, or a moving wall crushes the particle")]
    Softness,
    /// Nothing holds the particle.
    #[error("no wall stops it there: a gap between walls, or a domain that is too small")]
    OpenBoundary,
    /// A law or external force returned something that is not a number.
    #[error("a contact law or a body force returned a value that is not finite")]
    Law,
}

/// Check that a number is finite and positive.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Error::Parameter { name, value, expected: "a finite number above zero" })
    }
}

/// Check that a number is finite and not negative.
pub(crate) fn not_negative(name: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(Error::Parameter { name, value, expected: "a finite number, zero or above" })
    }
}

/// Check that a vector is finite.
pub(crate) fn finite(name: &'static str, value: DVec3) -> Result<DVec3, Error> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Error::Vector { name, value, expected: "three finite numbers" })
    }
}

/// Check that a vector has a direction and return it with length one.
pub(crate) fn direction(name: &'static str, value: DVec3) -> Result<DVec3, Error> {
    if value.is_finite() && value.length_squared() > 0.0 {
        Ok(value.normalize())
    } else {
        Err(Error::Vector { name, value, expected: "a finite vector that is not zero" })
    }
}
