//! What an attribution finds: plain numbers.
//!
//! Responses are named by their columns (`aor_lin_deg`), which `rig_schema::Response::from_column`
//! turns back.

use super::Layer;

/// The answer.
#[derive(Debug, Clone, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Verdict {
    /// No missing effect can be detected.
    None,
    /// One effect explains the data and no other does.
    Effect(String),
    /// Several effects explain the data and cannot be told apart, best first.
    Class(Vec<String>),
    /// No single effect explains the data; these pairs do and cannot be told apart, best first.
    Pairs(Vec<[String; 2]>),
    /// Something is missing that is not in the catalogue, or cannot be named from these data.
    Unknown,
}

/// A fit of one model.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Fit {
    /// Paths of the fitted parameters.
    pub parameters: Vec<String>,
    /// Their values.
    pub theta: Vec<f64>,
    /// Standard deviations from the curvature; `None` at an end of the range or where the data
    /// say nothing.
    pub sd: Vec<Option<f64>>,
    /// Squared whitened residual.
    pub chi2: f64,
    /// Chi-square plus logarithm of the determinant of the covariance.
    pub deviance: f64,
    /// Observations less parameters.
    pub dof: usize,
    /// Chi-square probability.
    pub p: f64,
    /// Residual at every observation, nuisances at their estimates.
    pub residuals: Vec<ResidualPoint>,
}

/// A model with one effect at given parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Squared whitened residual.
    pub chi2: f64,
    /// What the strength costs by its prior, and by how much more than the base's what was measured besides deviates.
    pub penalty: f64,
    /// Chi-square, logarithm of the determinant of the covariance, and penalty.
    pub deviance: f64,
    /// Chi-square probability with a degree of freedom for each observation less one for each parameter.
    pub p: f64,
}

/// One residual.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ResidualPoint {
    /// Which load of the drum, 0 for the rig's own.
    pub load: usize,
    /// Speed, rpm.
    pub omega_rpm: f64,
    /// Column of the response.
    pub response: &'static str,
    /// Measured minus model, deg or percent of R.
    pub value: f64,
    /// Standard deviation of the difference without the nuisances.
    pub sd: f64,
}

/// Whether anything is missing at all.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Gate {
    /// Chi-square of the calibrated base model.
    pub chi2: f64,
    /// Observations less parameters.
    pub dof: usize,
    /// Its probability by the chi-square distribution.
    pub p_chi2: f64,
    /// Its probability by the parametric bootstrap.
    pub p_bootstrap: f64,
    /// Probability of the best improvement that any single effect brings, under the base model.
    pub p_focused: f64,
    /// Probability of the smaller of the two above, under the base model: what decides.
    pub p_combined: f64,
    /// Lag-1 correlation over speed of the whitened residuals; `None` with fewer than 2 speeds.
    pub lag1: Option<f64>,
    /// Probability of one as large under the base model.
    pub lag1_p: Option<f64>,
    /// Draws of the bootstrap that were made.
    pub draws: usize,
    /// Whether the base model passes: `p_combined` above the level.
    pub passes: bool,
}

/// Strength of an effect with its 95 % profile interval.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Strength {
    /// Best value.
    pub value: f64,
    /// Lower end; `None` if the physical range ends first.
    pub lo: Option<f64>,
    /// Upper end; `None` if the physical range ends first.
    pub hi: Option<f64>,
}

/// One candidate, fitted.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Ranked {
    /// Path.
    pub name: String,
    /// Where it acts.
    pub layer: Layer,
    /// Which experiment would show it.
    pub exposed_by: String,
    /// What it is.
    pub meaning: String,
    /// The fit with the effect.
    pub fit: Fit,
    /// Strength of the effect.
    pub strength: Strength,
    /// Whether the strength sits at an end of its range other than "absent".
    pub at_bound: bool,
    /// Deviance of what was measured besides the observations ([`crate::Simulator::aside`]), less that from the base: below 0
    /// where it speaks for the effect.
    pub aside: f64,
    /// Probability of the chi-square with the effect; must be above the level.
    pub p_absolute: f64,
    /// Chi-square gained over the same simulator without the effect, at the covariance of the
    /// base; 0 where the best strength is "absent".
    pub improvement: f64,
    /// Bootstrap probability of such an improvement by this effect.
    pub p_single: f64,
    /// Bootstrap probability of such an improvement by any effect of the catalogue.
    pub p_family: f64,
    /// Posterior probability.
    pub evidence: f64,
    /// Mean squared residual at speeds left out, in variances, base less this model: positive is better. Of the models' own
    /// predictions, without what residuals at the other speeds tell. `None` where no speed can be left out.
    pub held_out_gain: Option<f64>,
    /// Responses that it worsens at speeds left out by more than one standard deviation of the
    /// prediction (columns).
    pub worsens: Vec<&'static str>,
    /// Whether it passes all conditions for being named.
    pub eligible: bool,
    /// Why not, in words.
    pub objections: Vec<String>,
    /// Its class of collinear signatures: index into [`Finding::classes`].
    pub class: usize,
}

/// Effects whose signatures are collinear here after frictions and nuisances took their part.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CollinearClass {
    /// Candidates.
    pub names: Vec<String>,
    /// Smallest whitened cosine between any two of them (1 for one alone).
    pub least_cosine: f64,
}

/// Two effects together.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PairFit {
    /// Candidates.
    pub names: [String; 2],
    /// The fit.
    pub fit: Fit,
    /// Strengths of both with 95 % intervals: by profile, all else fitted anew, where the pair passes all conditions, from the
    /// curvature at the best fit where it does not.
    pub strengths: [Strength; 2],
    /// As [`Ranked::held_out_gain`], over the base.
    pub held_out_gain: Option<f64>,
    /// Mean squared error at the lowest and highest speed when both are left out, in squared
    /// standard deviations of the prediction: about 1 if the model is right.
    pub at_ends: Option<f64>,
    /// Whether it passes all conditions for being named.
    pub eligible: bool,
}

/// Two effects at their best fit, or at one friction with their strengths fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct PairPlace {
    /// Candidates.
    pub names: [String; 2],
    /// Frictions, then both strengths.
    pub theta: Vec<f64>,
    /// How well they explain the data there.
    pub trial: Trial,
    /// Whether it is the best fit of both, which fits, and no strength is absent or at an end of its range.
    pub eligible: bool,
}

/// Posterior probability of one hypothesis.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Evidence {
    /// `none`, `unknown`, `pairs` or a candidate.
    pub name: String,
    /// Prior mass.
    pub prior: f64,
    /// Logarithm of the marginal likelihood, up to a constant common to all.
    pub log_likelihood: f64,
    /// Posterior probability.
    pub posterior: f64,
    /// The same with the hypothesis's prior mass halved.
    pub halved: f64,
    /// The same with it doubled.
    pub doubled: f64,
}

/// Smallest strength of an effect that would have been seen.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Detectable {
    /// Candidate.
    pub name: String,
    /// End of the range towards which it is searched.
    pub towards: f64,
    /// Strength that the gate would show with the power asked for; `None` if not even the end
    /// of the range.
    pub strength: Option<f64>,
    /// Free parameters of the drum with that strength which calibrates to what these data calibrate to; with that of the end of
    /// the range if not even it would be seen.
    pub at: Vec<f64>,
    /// Power at the end of the range.
    pub power_at_end: f64,
}

/// Error at data that were not fitted, for one response.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct HeldOutResponse {
    /// Column.
    pub response: &'static str,
    /// Points.
    pub points: usize,
    /// Root mean square error without the effect, deg or percent of R.
    pub before: f64,
    /// With it.
    pub after: f64,
    /// Root mean square error without the effect, in standard deviations of the measurement and
    /// simulator.
    pub before_sd: f64,
    /// With it.
    pub after_sd: f64,
    /// Error that noise alone would leave, deg or percent of R.
    pub floor: f64,
    /// Part of the mean square error above the floor that the effect removes; `None` where
    /// there was none.
    pub removed: Option<f64>,
}

/// Prediction of one set of data that were not fitted, with and without the winner.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct HeldOut {
    /// `leave one speed out`, `both ends` or `given set`.
    pub kind: &'static str,
    /// The effect (or `a + b`) that makes the difference.
    pub name: String,
    /// Folds.
    pub folds: usize,
    /// Each response.
    pub responses: Vec<HeldOutResponse>,
    /// Part of the mean square error above the floor that is removed over all responses, in
    /// squared standard deviations.
    pub removed: Option<f64>,
    /// Probability of so much improvement if before and after were exchangeable within each
    /// speed.
    pub permutation_p: f64,
}

/// The verdict under one change of the data.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct StabilityRow {
    /// What was changed ("without 10 rpm", "sd x 0.75").
    pub change: String,
    /// The verdict, or why there is none.
    pub verdict: Result<Verdict, String>,
}

/// Scatter of the set-up that would overturn the verdict.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Overturn {
    /// Standard deviation, the same for all responses (deg and percent of R) and independent
    /// between points, at which the gate passes; `None` if not below 30.
    pub independent: Option<f64>,
    /// The same for one shift of each response shared by all speeds.
    pub shared: Option<f64>,
}

/// How well an experiment would separate the effects that are left.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NextExperiment {
    /// Experiment.
    pub name: String,
    /// Candidates that it was computed for.
    pub between: Vec<String>,
    /// Expected information gain about which effect it is, bits.
    pub gain_bits: f64,
    /// Most that could be gained, bits.
    pub most_bits: f64,
}

/// Everything that an attribution found.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Finding {
    /// The answer.
    pub verdict: Verdict,
    /// The answer without the covariance between codes, where one was given and this was asked for.
    pub verdict_without_code: Option<Verdict>,
    /// Whether anything is missing.
    pub gate: Gate,
    /// The calibrated base model.
    pub base: Fit,
    /// Candidates, best first. Where the gate passes, for information only.
    pub ranked: Vec<Ranked>,
    /// Classes of collinear signatures.
    pub classes: Vec<CollinearClass>,
    /// Cosine between the signatures of [`Finding::names`], frictions and nuisances projected
    /// out; rows and columns in that order.
    pub cosines: Vec<Vec<f64>>,
    /// Candidates in the order given.
    pub names: Vec<String>,
    /// Pairs, best first; empty unless something is missing that no single effect explains.
    pub pairs: Vec<PairFit>,
    /// Posterior of every hypothesis.
    pub evidence: Vec<Evidence>,
    /// What would have been seen.
    pub detectable: Vec<Detectable>,
    /// Error before and after at data not fitted, for the best candidate (or pair).
    pub held_out: Vec<HeldOut>,
    /// Verdicts under changes of the data.
    pub stability: Vec<StabilityRow>,
    /// Scatter of the set-up that would overturn the verdict; `None` where the gate passes.
    pub overturn: Option<Overturn>,
    /// Experiments, most informative first.
    pub next: Vec<NextExperiment>,
}
