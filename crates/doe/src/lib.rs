//! Designs of experiments and response-surface regression.
//!
//! Plan the runs ([`design`]), fit a model to their responses ([`fit()`]), and see whether to
//! believe it ([`Fit::summary`], [`Fit::studentised_deleted_residuals`], [`Fit::anova`]).
//!
//! ```
//! use doe::{Factor, Model, ModelTerms, Weighting, design::full_factorial, fit};
//!
//! // The slope of a bed of beads, degrees, over drum speed and friction of the beads.
//! let factors = [Factor::new("speed_rpm", 4.0, 30.0)?, Factor::new("friction", 0.1, 0.9)?];
//! let plan = full_factorial(&factors, &[3, 3])?.with_centre_points(1);
//! let slope = [20.4, 22.5, 24.8, 27.7, 28.5, 29.8, 29.6, 30.6, 31.2, 29.0];
//!
//! let model = Model::new(&factors, &ModelTerms::quadratic(&factors))?;
//! let surface = fit(&model, &plan.points, &slope, Weighting::Ordinary)?;
//! let (low, high) = surface.predict(&[17.0, 0.4])?.interval(0.95)?;
//! assert!(low < 27.5 && 27.5 < high && high - low < 2.5);
//! assert!(surface.q2().unwrap() > 0.9);
//! # Ok::<(), doe::DoeError>(())
//! ```
//!
//! | question | answer |
//! |---|---|
//! | which runs | [`design::full_factorial`], [`design::latin_hypercube`], [`design::central_composite`], [`design::box_behnken`] |
//! | which terms | [`ModelTerms`], [`Term`], [`eliminate()`] |
//! | what are the coefficients | [`Fit::coefficient_table`], [`Fit::natural_form`] |
//! | does a factor matter | [`Model::positions_involving`] with [`Fit::f_test`] |
//! | is the model right | [`Fit::anova`] (lack of fit), [`Fit::model_validity`] |
//! | does it predict | [`Fit::q2`], [`Fit::predict`] |
//! | which run is odd | [`Fit::studentised_deleted_residuals`], [`Fit::cooks_distance`] |
//! | is the response skewed | [`Fit::response_skewness`], [`Fit::box_cox`] |
//! | where is the optimum | [`Fit::stationary_point`] |
//!
//! Least squares are solved by QR, tested for aliased terms, and refined in twice the precision;
//! all eleven NIST StRD problems come out to at least twelve digits.

pub mod design;

mod anova;
mod distribution;
mod double_double;
mod elimination;
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
mod stationary;
mod term;
mod transform;
mod weighting;

pub use anova::{Anova, FTest, LackOfFit, SumOfSquares};
pub use design::Design;
pub use elimination::{Elimination, EliminationStep, eliminate};
pub use error::{Alias, DoeError};
pub use factor::Factor;
pub use fit::{CoefficientRow, Fit, fit};
pub use model::Model;
pub use model_terms::ModelTerms;
pub use natural_form::NaturalForm;
pub use prediction::Prediction;
pub use quality::Summary;
pub use stationary::{StationaryKind, StationaryPoint};
pub use term::{Power, Saturation, Term};
pub use transform::{BoxCox, Skewness, Transform};
pub use weighting::Weighting;
