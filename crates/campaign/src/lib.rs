//! From parameters to responses: a drum simulated, filmed and measured like the real one.
//!
//! An [`Observatory`] is the camera and the reader of one rig. It says how positions must be
//! sampled ([`Observatory::options`]: exposures and sub-frames), films what a
//! [`drum_rig::Experiment`] has sampled, and measures the frames by the same chain as photographs
//! ([`Observatory::observe`]). A bias of the method cancels between the two.

pub use {drum_film, drum_rig, drum_vision, rig_schema};

mod error;
pub mod export;
mod laboratory;
mod observatory;
pub mod plan;
pub mod vtk;

pub use error::CampaignError;
pub use laboratory::{Done, Footage, Laboratory, Run, Sampling, SpeedRow};
pub use observatory::{Observatory, Observed, Resolution};

/// The examples of the README, compiled.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
