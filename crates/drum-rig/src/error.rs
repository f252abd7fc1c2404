//! The one error type of the crate.

use rig_schema::SchemaError;

/// Why an experiment could not be set up, run, saved or taken up again.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A parameter without a nominal value was not given.
    #[error("`{path}` is not given, and it has no nominal value: expected {meaning}")]
    Missing {
        /// Path of the parameter.
        path: &'static str,
        /// What it stands for.
        meaning: &'static str,
    },
    /// A parameter was given that cannot change anything in this rig.
    #[error("`{path} = {value}` cannot act: {because}")]
    Inactive {
        /// Path of the parameter.
        path: &'static str,
        /// Value that was given.
        value: f64,
        /// Why nothing would change.
        because: &'static str,
    },
    /// Two choices exclude each other.
    #[error("{first} does not go with {second}: {because}")]
    Contradiction {
        /// One choice.
        first: &'static str,
        /// The other.
        second: &'static str,
        /// Why.
        because: &'static str,
    },
    /// A material is used that the rig does not define.
    #[error("material of the {role}: `{name}` is not in [materials]")]
    UnknownMaterial {
        /// What is made of it.
        role: &'static str,
        /// Name of the material.
        name: String,
    },
    /// An option of the run is not usable.
    #[error("option {name} = {value}: expected {expected}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// Value that was given.
        value: f64,
        /// What would have been accepted.
        expected: &'static str,
    },
    /// The fill rounds to no particle at all.
    #[error("the fill of {wanted} particles rounds to none: expected at least one")]
    NoParticles {
        /// Number before rounding.
        wanted: f64,
    },
    /// Something leaves no room inside the drum.
    #[error("{what} of {size_m} m leaves no room in a drum of {room_m} m")]
    NoRoom {
        /// What takes the room.
        what: &'static str,
        /// Its size, m.
        size_m: f64,
        /// Radius or length of the drum, m.
        room_m: f64,
    },
    /// The particles do not fit into the drum.
    #[error(
        "{count} particles of together {solid_m3:.3e} m3 do not fit into a drum of {drum_m3:.3e} m3: \
         after {rounds} rounds of pushing apart the deepest overlap is {overlap:.3} of a radius"
    )]
    DoesNotFit {
        /// Number of particles.
        count: usize,
        /// Volume of all particles, m3.
        solid_m3: f64,
        /// Volume of the drum, m3.
        drum_m3: f64,
        /// Rounds of pushing overlapping particles apart.
        rounds: u32,
        /// Deepest overlap left over the smaller radius (of spheres enlarged by 2 %).
        overlap: f64,
    },
    /// The bed did not come to rest.
    #[error(
        "the bed did not settle within {time_s} s: {energy:.2e} J of kinetic energy a particle are \
         left, expected less than {limit:.2e} J"
    )]
    Unsettled {
        /// Time given, s.
        time_s: f64,
        /// Mean kinetic energy of a particle, J.
        energy: f64,
        /// Energy that counts as rest, J.
        limit: f64,
    },
    /// The motion did not become stationary.
    #[error(
        "no steady state at {speed_rpm} rpm within {turns} turns: the {signal} still moved from \
         {before:.5} to {after:.5} {unit} between two windows, {sigmas:.1} standard errors"
    )]
    NotSteady {
        /// Speed of the schedule, rpm.
        speed_rpm: f64,
        /// Turns given.
        turns: f64,
        /// Signal that moved most.
        signal: &'static str,
        /// Its unit.
        unit: &'static str,
        /// Mean of the last window but one.
        before: f64,
        /// Mean of the last window.
        after: f64,
        /// Difference over its standard error.
        sigmas: f64,
    },
    /// The rig names a liner, but its surface was not handed in, or the other way round.
    #[error("{problem}")]
    Liner {
        /// What is wrong.
        problem: String,
    },
    /// The liner has a hole.
    #[error(
        "the liner leaks: {edges} open edges inside the drum, one of them at ({x:.5}, {y:.5}, {z:.5}) m; \
         expected a surface whose only borders lie at or beyond the end plates"
    )]
    Leak {
        /// Number of open edges.
        edges: usize,
        /// Middle of one of them, m.
        x: f64,
        /// Middle of one of them, m.
        y: f64,
        /// Middle of one of them, m.
        z: f64,
    },
    /// Bytes that should hold a checkpoint do not.
    #[error("the bytes are not a checkpoint of this version: {what} at byte {offset}")]
    Checkpoint {
        /// What was found wrong.
        what: &'static str,
        /// Where.
        offset: usize,
    },
    /// The checkpoint was made with another rig or other options.
    #[error(
        "the checkpoint belongs to another rig or other options: it is of {found}, this is {expected}"
    )]
    OtherRig {
        /// Fingerprint in the checkpoint.
        found: String,
        /// Fingerprint of this rig.
        expected: String,
    },
    /// A value for a parameter lies outside its declared range.
    #[error("`{path} = {value}` is outside its range: expected {low} to {high}")]
    Range {
        /// Path of the parameter.
        path: &'static str,
        /// Value asked for.
        value: f64,
        /// Lowest value.
        low: f64,
        /// Highest value.
        high: f64,
    },
    /// The rig file itself is wrong.
    #[error(transparent)]
    Schema(#[from] SchemaError),
    /// A particle cannot be made.
    #[error(transparent)]
    Shape(#[from] dem_shapes::ShapeError),
    /// The mechanics refused the world, or a run went wrong.
    #[error(transparent)]
    Mechanics(#[from] dem_core::error::Error),
}

impl From<dem_core::contact::error::LawError> for Error {
    fn from(error: dem_core::contact::error::LawError) -> Self {
        Self::Mechanics(error.into())
    }
}
