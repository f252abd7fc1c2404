//! The virtual rotating-drum experiment: build, fill, settle, turn, wait for the steady state,
//! sample.
//!
//! An [`Experiment`] takes a [`rig_schema::Rig`], builds its drum and particles, and runs its
//! speeds in ascending order. Each is held until drum torque and centre of mass are stationary
//! over two windows. Frames of positions are taken meanwhile: those of these windows count, and more
//! are taken where they are too few. Mechanical responses come with errors that know of
//! autocorrelation. Every physics parameter of the namespace acts on the world, or is an error.
//!
//! The drum's axis is z through the origin, y is up; the drum turns counter-clockwise as seen from
//! positive z, so the bed rises on the side of positive x.
//!
//! ```
//! use drum_rig::{Experiment, Flow, Options, Outcome};
//! let rig = rig_schema::Rig::parse("drum.toml", r#"
//! name = "a handful of beads"
//! drum = { radius_m = 0.02, length_m = 0.02, mantle = "glass", end_plates = "glass", ends = "periodic" }
//! particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
//! fill.count = 90
//! friction = { pp = 0.5, mantle = 0.6 }
//! restitution = { pp = 0.7, mantle = 0.7 }
//! rolling = { pp = 0.01, mantle = 0.01 }
//! run = { speeds_rpm = [60.0], frames = 5 }
//! [materials]
//! glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e6 }
//! "#)?;
//! let mut drum = Experiment::new(&rig, &Options::default())?;
//! assert_eq!(drum.run(|_, _| Flow::Go)?, Outcome::Finished);
//! let steady = &drum.sampled()[0];
//! assert_eq!(steady.frames.len(), 5);
//! // Frictional beads climb on the side that the drum carries upwards.
//! assert!(steady.angle_deg.mean > 15.0 && steady.angle_deg.mean < 60.0);
//! # Ok::<(), drum_rig::Error>(())
//! ```

pub use {dem_core, rig_schema};

mod assemble;
mod coarse;
mod codec;
mod drum;
mod engine;
mod error;
mod experiment;
mod fill;
mod frame;
mod grains;
mod laws;
mod liner;
mod options;
mod outline;
mod parameters;
mod regime;
mod schedule;
mod script;
mod soft;
mod stationary;
mod volume;

pub use assemble::DEFAULT_STEP_OVER_RAYLEIGH;
pub use coarse::{Coarsening, coarse};
pub use error::Error;
pub use experiment::{ContactState, Experiment, Flow, Outcome, ParticleState, Progress};
pub use frame::{Exposure, Frame, Sampled};
pub use grains::{Ball, Grains};
pub use options::Options;
pub use outline::{Outline, outline};
pub use regime::{Regime, froude};
pub use script::Phase;
pub use soft::soft;
pub use stationary::{Mean, mean_of};
pub use volume::{SolidVolume, solid_volume};

/// Standard gravity as the engines of the field take it, m/s2.
pub const GRAVITY: f64 = 9.81;

/// The examples of the README, compiled as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
