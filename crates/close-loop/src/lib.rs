//! Closing the loop: find the residual that a calibrated drum simulation leaves, name the effect
//! behind it, add it, and report the error before and after.
//!
//! [`CloseLoop`] takes a case (a rig with measured responses and free frictions) and a
//! [`campaign::Laboratory`] that simulates. It calibrates the rig on its own simulations, decides
//! whether anything is missing, simulates every effect of the [`Catalogue`] near the calibrated
//! point, asks [`calib::attribution`] which of them the data call for, simulates around the best
//! ones again, and confirms the winner by fresh runs at all speeds, those held out included.

pub use {calib, campaign, rig_schema};

mod anchors;
mod calibrate;
mod catalogue;
mod claims;
mod clock;
mod closest;
mod coded;
mod codes;
mod compare;
mod confirm;
mod curve;
mod driver;
mod emulator;
mod error;
mod fillings;
mod filmed;
#[cfg(test)]
mod fixture;
mod ignorance;
mod models;
mod mostly;
mod next;
mod outcome;
mod outlook;
mod pairs;
mod plan;
mod predict;
mod probe;
mod process;
mod refine;
mod runs;
mod scale;
mod speeds;
mod stand_in;
mod table;
mod unrest;
mod volume;
mod whole_rig;

pub use catalogue::{Catalogue, Effect, Needs};
pub use closest::{Closest, Nearest};
pub use codes::Codes;
pub use curve::{Change, Curve};
pub use driver::{CloseLoop, Pilot, Stage, Told};
pub use emulator::{Axis, Emulator, Sample};
pub use error::CloseLoopError;
pub use next::HALF_AS_MUCH;
pub use outcome::{
    Errors, LoadOf, Outcome, Point, ResponseErrors, Side, SpeedResponse, StrengthOf,
};
pub use plan::{Effort, LoopSettings};
pub use scale::Scale;
pub use stand_in::Fidelity;
pub use table::close_with_table;

/// The examples of the README, compiled.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct Readme;
