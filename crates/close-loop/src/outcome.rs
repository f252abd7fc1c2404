//! What a closed loop says: plain numbers.

use calib::attribution::Finding;
use serde::Serialize;

use crate::closest::Closest;
use crate::plan::Effort;

/// A response at a speed: measured, and both models by fresh runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Which load of the drum, 0 for the rig's own.
    pub load: usize,
    /// Speed, rpm.
    pub omega_rpm: f64,
    /// Column of the response.
    pub response: &'static str,
    /// Whether it was fitted.
    pub fitted: bool,
    /// Measured mean.
    pub measured: f64,
    /// Standard deviation of the difference to the calibrated model, all but nuisances.
    pub sd: f64,
    /// The calibrated model without the effect, nuisances at their estimates.
    pub before: f64,
    /// With it; the same as `before` where nothing was named.
    pub after: f64,
}

/// Errors of one response over one set of speeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResponseErrors {
    /// Column of the response.
    pub response: &'static str,
    /// Points.
    pub points: usize,
    /// Root mean square error, deg or percent of R.
    pub rmse: f64,
    /// The same in standard deviations.
    pub rmse_sd: f64,
    /// Error that noise alone would leave, deg or percent of R.
    pub floor: f64,
}

/// Errors of one model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Errors {
    /// At fitted speeds, response by response.
    pub fitted: Vec<ResponseErrors>,
    /// At speeds kept aside.
    pub held_out: Vec<ResponseErrors>,
    /// Chi-square at fitted speeds, nuisances marginalised.
    pub chi2: f64,
    /// Its degrees of freedom.
    pub dof: usize,
    /// Its probability.
    pub p: f64,
    /// Probability of chi-square at fitted and held-out speeds together.
    pub p_all: f64,
}

/// A response at a speed, with what it is uncertain by.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpeedResponse {
    /// Which load of the drum, 0 for the rig's own.
    pub load: usize,
    /// Speed, rpm.
    pub omega_rpm: f64,
    /// Column of the response.
    pub response: &'static str,
    /// Value, deg or percent of R.
    pub mean: f64,
    /// Its standard deviation.
    pub sd: f64,
}

/// One confirmed model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Side {
    /// The effect; `None` for the base model.
    pub effect: Option<String>,
    /// Free parameters (and the effect last) at which fresh runs were made.
    pub at: Vec<(String, f64)>,
    /// Fresh fillings.
    pub fillings: usize,
    /// Errors of the fresh runs.
    pub errors: Errors,
    /// Responses at the speeds that were asked for: means over fresh runs, nuisances at their estimates, with the standard deviation of a
    /// drum filled anew, without that of its frames.
    pub predictions: Vec<SpeedResponse>,
}

/// A load of the drum.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LoadOf {
    /// Path of its amount, and the amount.
    pub fill: (&'static str, f64),
    /// Speeds at which it was simulated, rpm.
    pub speeds_rpm: Vec<f64>,
    /// Fillings that were measured.
    pub fillings: u32,
    /// Standard deviation of the volume of one of them, as a part of it.
    pub volume_sd: f64,
}

/// Strength of a named effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StrengthOf {
    /// Name.
    pub name: String,
    /// What it stands for.
    pub meaning: String,
    /// The rig's own value.
    pub null: f64,
    /// Best value.
    pub value: f64,
    /// Lower end of the 95 % interval; the end of the physical range if the data leave it open.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

/// Everything that closing a loop found.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// Name of the case.
    pub case: String,
    /// `none`, `effect`, `class` or `unknown`.
    pub verdict: &'static str,
    /// Named effects, best first.
    pub members: Vec<String>,
    /// The verdict in a sentence.
    pub sentence: String,
    /// Strength of each member.
    pub strengths: Vec<StrengthOf>,
    /// What comes closest where something is missing that nothing explains.
    pub closest: Option<Closest>,
    /// Free parameters of the calibrated base model: path, value, standard deviation.
    pub calibrated: Vec<(String, f64, Option<f64>)>,
    /// Statistics behind the verdict.
    pub finding: Finding,
    /// The base model by fresh runs.
    pub before: Side,
    /// The winner by fresh runs; the base model where nothing was named.
    pub after: Side,
    /// Further members of the class by fresh runs.
    pub others: Vec<Side>,
    /// Share of the mean square error above the noise floor that the winner removes at held-out
    /// speeds (fitted ones where none are held out), in standard deviations; `None` if none was.
    pub removed: Option<f64>,
    /// Whether fresh runs agree with the winner: `None` where nothing was named.
    pub confirmed: Option<bool>,
    /// Answers before this one that fresh runs refuted: their runs were learnt from.
    pub refuted: usize,
    /// Responses point by point.
    pub points: Vec<Point>,
    /// Speeds at which the rig's own load was simulated, rpm.
    pub speeds_rpm: Vec<f64>,
    /// Loads of the drum, the rig's own first.
    pub loads: Vec<LoadOf>,
    /// Variance of runs over that of their frames.
    pub inflation: f64,
    /// What the rig shows beyond its coarse stand-in, and was added to that; empty where the rig itself was simulated.
    pub off_by: Vec<SpeedResponse>,
    /// How runs were spent.
    pub effort: Effort,
    /// Runs simulated or read back.
    pub runs: usize,
    /// Processor time of all runs when they were made, s.
    pub cost_s: f64,
    /// What the models learnt from: effects (joined by ` + `; empty for the base model), then values of the
    /// free parameters followed by the strengths.
    pub simulated: Vec<(String, Vec<f64>)>,
    /// Runs that failed: what they were, and why.
    pub failed: Vec<(String, String)>,
    /// Effects that were not tried: name, reason.
    pub left_out: Vec<(String, String)>,
    /// What was assumed, in sentences.
    pub assumed: Vec<String>,
}

impl Outcome {
    /// The models of the fresh runs: the calibrated one, the winner where there is one, and the rest of its class.
    pub fn models(&self) -> impl Iterator<Item = &Side> {
        let winner = self.after.effect.is_some().then_some(&self.after);
        std::iter::once(&self.before).chain(winner).chain(&self.others)
    }
}
