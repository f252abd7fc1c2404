//! Which physical effect the model lacks.
//!
//! A calibrated base model either meets the data within their errors, or something is missing.
//! [`Attribution::attribute`] decides that first (the [`Gate`]), then asks which effect of a
//! catalogue, fitted together with the frictions, explains the data, which others explain them as
//! well (a class), and whether speeds that were not fitted agree.

mod candidate;
mod finding;

pub use candidate::{Candidate, CodeCovariance, Experiment, Layer, Settings};
pub use finding::{
    CollinearClass, Detectable, Evidence, Finding, Fit, Gate, HeldOut, HeldOutResponse,
    NextExperiment, Overturn, PairFit, Ranked, ResidualPoint, StabilityRow, Strength, Verdict,
};

use crate::{CalibError, Observations, Problem};

/// Everything that an attribution needs.
pub struct Attribution<'s> {
    /// Base model with its observations, free parameters and nuisances.
    pub base: Problem<'s>,
    /// The catalogue.
    pub candidates: Vec<Candidate<'s>>,
    /// Systematic difference between codes, where the truth came from another code.
    pub code_covariance: Option<CodeCovariance>,
    /// Data that are never fitted, of the same configuration.
    pub held_out: Option<Observations>,
    /// Experiments that could be made next.
    pub experiments: Vec<Experiment<'s>>,
    /// Levels, priors, sizes.
    pub settings: Settings,
}

impl Attribution<'_> {
    /// Decide whether an effect is missing, and which.
    ///
    /// # Errors
    /// [`CalibError`] if the problem is not well posed (fewer observations than parameters), a
    /// candidate's parameters are not the base's followed by one, or a simulator fails.
    pub fn attribute(&self) -> Result<Finding, CalibError> {
        todo!()
    }

    /// Only the verdict, by a bootstrap that stops early where nothing is missing: for studies
    /// of power.
    ///
    /// # Errors
    /// As [`Attribution::attribute`].
    pub fn verdict(&self) -> Result<Verdict, CalibError> {
        todo!()
    }
}
