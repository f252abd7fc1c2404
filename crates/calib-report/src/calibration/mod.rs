//! The report of one calibrated case: plain data in, the whole HTML page out.
//!
//! [`CalibrationReport`] is filled by the caller; what is `None` or empty is left out of the page
//! without a trace. The order of the page: verdict and friction, goodness of fit, contour maps,
//! friction and residuals against speed, the surrogates' summary of fit, then the diagnostics of
//! every response, and last where each number comes from.

mod render;

use crate::page::{Provenance, Section, Table, Verdict};
use crate::pictures::{
    CalibrationMap, CoefficientPlot, EffectPlot, FitSummary, FrictionSpeed, InteractionPlot,
    NormalProbability, ObservedPredicted, PosteriorDensity, ProfileLikelihood, ReplicatePlot,
    ResidualSpeed, ResponseHistogram,
};

/// Everything that the report of one case says.
///
/// ```
/// use calib_report::calibration::{CalibrationReport, FrictionRow};
/// use calib_report::page::{Tone, Verdict};
///
/// let report = CalibrationReport {
///     case: "AZ4_Steel".into(),
///     verdict: Some(Verdict {
///         sentence: "Particle friction is 0.27 (95 %: 0.25 to 0.30).".into(),
///         tone: Tone::Good,
///     }),
///     friction: vec![FrictionRow {
///         mu_pp: Some(0.27),
///         lo: Some(0.25),
///         hi: Some(0.30),
///         ..Default::default()
///     }],
///     ..Default::default()
/// };
/// let html = report.html();
/// assert!(html.starts_with("<!DOCTYPE html>") && html.contains("0.270"));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CalibrationReport {
    /// Name of the case, as "AZ4_Steel".
    pub case: String,
    /// What the case is, in half a sentence: particles, count, wall.
    pub subtitle: String,
    /// The result in one sentence.
    pub verdict: Option<Verdict>,
    /// Facts about the case: (name, value with unit).
    pub facts: Vec<(String, String)>,
    /// Warnings, as speeds left out because they are beyond the surrogate.
    pub warnings: Vec<String>,
    /// Particle friction, per speed and jointly.
    pub friction: Vec<FrictionRow>,
    /// Level of every interval, as "95 %".
    pub interval_level: String,
    /// Wall friction and whether the data determine it.
    pub wall: Option<WallFriction>,
    /// Other free parameters and nuisances.
    pub parameters: Vec<ParameterRow>,
    /// Chi-square under the stated assumptions.
    pub goodness: Vec<GoodnessRow>,
    /// The central pictures, one a speed.
    pub maps: Vec<CalibrationMap>,
    /// Friction against speed beside the printed ranges.
    pub friction_speed: Option<FrictionSpeed>,
    /// Residuals against speed.
    pub residual_speed: Option<ResidualSpeed>,
    /// Residuals as numbers.
    pub residuals: Vec<ResidualRow>,
    /// Cells of the data flagged as outliers or duplicates.
    pub outliers: Vec<OutlierRow>,
    /// Profile likelihoods of the free parameters.
    pub profiles: Vec<ProfileLikelihood>,
    /// Posterior densities of the free parameters.
    pub posteriors: Vec<PosteriorDensity>,
    /// How friction moves with the assumptions: saturating basis over m0, correlations, n_eff.
    pub sensitivity: Vec<Table>,
    /// R2, Q2, validity and reproducibility of every response's surrogate.
    pub fit_summary: Option<FitSummary>,
    /// Diagnostics of every response's surrogate.
    pub responses: Vec<ResponseDiagnostics>,
    /// Sections of the caller's own, put before the notes.
    pub extra: Vec<Section>,
    /// Assumptions made and what they stand on.
    pub assumptions: Vec<String>,
    /// Input files with hashes, seed, version, command.
    pub provenance: Option<Provenance>,
}

/// Particle friction at one speed or over all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrictionRow {
    /// Speed, rpm; none for all speeds together.
    pub omega_rpm: Option<f64>,
    /// What was matched, where it is not all responses: "both angles".
    pub method: String,
    /// Best value; none where nothing fits.
    pub mu_pp: Option<f64>,
    /// Lower end of the interval; none where it is open.
    pub lo: Option<f64>,
    /// Upper end of the interval; none where it is open.
    pub hi: Option<f64>,
    /// The range printed by the author of the data.
    pub printed: Option<(f64, f64)>,
    /// Chi-square at the best value.
    pub chi2: Option<f64>,
    /// Degrees of freedom.
    pub dof: Option<usize>,
    /// Remark, as "flat" or "at the edge of the surrogate".
    pub note: String,
}

/// Wall friction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WallFriction {
    /// Best value.
    pub value: Option<f64>,
    /// Lower end of the interval; none where it is open.
    pub lo: Option<f64>,
    /// Upper end of the interval; none where it is open.
    pub hi: Option<f64>,
    /// Whether the data determine it.
    pub identified: bool,
    /// Why, in one sentence.
    pub reason: String,
}

/// A free parameter or nuisance.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterRow {
    /// Path or name, as "measure.offset_x_pct".
    pub name: String,
    /// Unit, or empty.
    pub unit: String,
    /// Prior in words, as "normal, 0 ± 0.5", or empty.
    pub prior: String,
    /// Best value.
    pub value: Option<f64>,
    /// Lower end of the interval.
    pub lo: Option<f64>,
    /// Upper end of the interval.
    pub hi: Option<f64>,
    /// Remark.
    pub note: String,
}

/// Goodness of fit under one reading of the errors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GoodnessRow {
    /// The reading, as "frame sd" or "error of the mean, n_eff 15".
    pub errors: String,
    /// Chi-square.
    pub chi2: Option<f64>,
    /// Degrees of freedom.
    pub dof: Option<usize>,
    /// Probability of a larger chi-square by its distribution.
    pub p_chi2: Option<f64>,
    /// The same by parametric bootstrap.
    pub p_bootstrap: Option<f64>,
    /// Friction under this reading, where it was fitted anew.
    pub mu_pp: Option<(f64, Option<f64>, Option<f64>)>,
    /// What follows, as "fits" or "rejected".
    pub reading: String,
}

/// One residual.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResidualRow {
    /// Speed, rpm.
    pub omega_rpm: f64,
    /// Response.
    pub response: String,
    /// Unit of the response.
    pub unit: String,
    /// Measured value.
    pub measured: f64,
    /// Model at the best parameters.
    pub model: f64,
    /// Standard deviation of their difference.
    pub sd: f64,
    /// Flagged as an outlier.
    pub outlier: bool,
}

/// A doubtful cell or row of the data.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutlierRow {
    /// Where: file and row, or speed.
    pub place: String,
    /// Response or column.
    pub response: String,
    /// The value as given.
    pub value: Option<f64>,
    /// What the other data let expect.
    pub expected: Option<f64>,
    /// Distance in sd.
    pub distance_sd: Option<f64>,
    /// Remark, as "equals cen_y of the same row".
    pub note: String,
}

/// Diagnostics of one response's surrogate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResponseDiagnostics {
    /// Response.
    pub response: String,
    /// One sentence about the fit: model, terms left out.
    pub summary: String,
    /// Tables: coefficients, analysis of variance, elimination log.
    pub tables: Vec<Table>,
    /// Coefficients, scaled and centred.
    pub coefficients: Option<CoefficientPlot>,
    /// Replicates.
    pub replicates: Option<ReplicatePlot>,
    /// Histogram with skewness.
    pub histogram: Option<ResponseHistogram>,
    /// Residuals on normal-probability axes.
    pub normal: Option<NormalProbability>,
    /// Observed against predicted.
    pub observed: Option<ObservedPredicted>,
    /// Main effects.
    pub effects: Vec<EffectPlot>,
    /// Interactions.
    pub interactions: Vec<InteractionPlot>,
}
