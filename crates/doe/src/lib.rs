//! Designs of experiments and response-surface regression.
#![doc = ""]

mod anova;
mod distribution;
mod double_double;
mod error;
mod factor;
mod fit;
mod lack_of_fit;
mod least_squares;
mod model;
mod model_terms;
mod natural_form;
mod prediction;
mod quality;
mod refinement;
mod run_diagnostics;
mod term;
mod weighting;

pub use anova::{Anova, FTest, LackOfFit, SumOfSquares};
pub use error::{Alias, DoeError};
pub use factor::Factor;
pub use fit::{CoefficientRow, Fit, fit};
pub use model::Model;
pub use model_terms::ModelTerms;
pub use natural_form::NaturalForm;
pub use prediction::Prediction;
pub use quality::Summary;
pub use term::{Power, Saturation, Term};
pub use weighting::Weighting;
