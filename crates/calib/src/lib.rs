//! Calibration: which friction makes a simulator say what was measured, how sure that is, and
//! what is left over.
//!
//! The crate knows no particles and no pictures: a simulation is a [`Simulator`], parameters and
//! speeds to responses with their covariance. A [`Surrogate`] over a table of runs is one.
//!
//! The likelihood is normal, with everything uncertain in one covariance over all speeds and
//! responses: scatter of the frames over the effective number of frames (the four responses of a
//! frame are correlated: [`FrameCorrelation`]), error of the surrogate, and nuisances with stated
//! priors, which enter linearly and are marginalised exactly. On it stand the best [`Match`],
//! profile-likelihood intervals, a posterior on a grid, the identifiability of each parameter,
//! goodness of fit and the joint fit over configurations that share a parameter.

pub mod attribution;
mod bootstrap;
mod covariance;
mod duplicates;
mod error;
mod goodness;
mod grid;
mod interpolate;
mod joint;
mod matching;
mod nuisance;
mod observation;
mod operating_point;
mod outlier;
mod problem;
mod sensitivity;
mod simulator;
mod study;
mod surrogate;

pub use bootstrap::Bootstrap;
pub use duplicates::{DuplicateRow, DuplicateTable, duplicate_rows, duplicate_tables};
pub use error::CalibError;
pub use goodness::{Goodness, chi_square_p, upper_quantile, variance_ratio_p};
pub use grid::Marginal;
pub use joint::{JointMatch, JointMember, Tied, WithheldPrediction};
pub use matching::{Estimate, Flatness, Match, Residual, root_mean_square};
pub use nuisance::{Effect, Nuisance, NuisanceEstimate};
pub use observation::{FrameCorrelation, Observation, Observations};
pub use operating_point::OperatingPoint;
pub use outlier::{
    Coincidence, MeasuredOutlier, SimulatedOutlier, measured_outliers, simulated_outliers,
};
pub use problem::{FreeParameter, Problem};
pub use sensitivity::{M0, N_EFF, Sensitivity};
pub use simulator::{Predicted, Simulator};
pub use study::{ResponseSet, Study};
pub use surrogate::{Basis, Surrogate};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
