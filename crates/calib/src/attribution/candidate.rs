//! What is given to an attribution: candidates, covariance between codes, experiments, settings.

use crate::{CalibError, Nuisance, OperatingPoint, Simulator};

/// Where an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
pub enum Layer {
    /// Definition of a response: lines, averaging, reference circle.
    Measurement,
    /// Projection, exposure, light.
    Camera,
    /// Something that acts on the particles.
    Physics,
    /// A numerical choice of the simulating code.
    Code,
}

/// An effect that the base model may lack.
///
/// The simulator takes the base's free parameters, in their order, followed by the strength of
/// the effect; at [`Candidate::null`] it should say what the base says. The strength enters
/// about linearly if possible: a strength that acts by its square (a friction of rolling, say)
/// is better given by its root or logarithm, and named so.
#[derive(Clone)]
pub struct Candidate<'s> {
    /// Path of the effect in the namespace.
    pub name: String,
    /// Simulation with the effect.
    pub simulator: &'s dyn Simulator,
    /// Strength at which the effect is absent; within `range`.
    pub null: f64,
    /// Lowest and highest strength that is physically possible: the sign of an effect is a
    /// range that begins or ends at `null`.
    pub range: (f64, f64),
    /// Prior standard deviation of the strength about `null`, for errors of known size such as those of
    /// reading a picture; `None` if all strengths within `range` are as likely.
    pub strength_sd: Option<f64>,
    /// Where it acts.
    pub layer: Layer,
    /// Prior weight relative to the other candidates.
    pub prior: f64,
    /// Which experiment would show it.
    pub exposed_by: String,
    /// What it is, in a sentence.
    pub meaning: String,
}

/// Systematic difference between simulating codes, of low rank over (speed, response).
///
/// The covariance is the sum over the modes of v v', v interpolated linearly over speed and held
/// beyond the ends.
#[derive(Debug, Clone, PartialEq)]
pub struct CodeCovariance {
    /// Speeds of the modes, ascending, rpm.
    speeds_rpm: Vec<f64>,
    /// Modes: the four responses at each speed, deg and percent of R.
    modes: Vec<Vec<[f64; 4]>>,
}

impl CodeCovariance {
    /// From modes given at `speeds_rpm`: one standard deviation of each mode.
    ///
    /// # Errors
    /// [`CalibError::Lengths`] if a mode has not one row a speed, or the speeds do not ascend.
    pub fn new(speeds_rpm: Vec<f64>, modes: Vec<Vec<[f64; 4]>>) -> Result<Self, CalibError> {
        let ascending = speeds_rpm.windows(2).all(|w| w[0] < w[1]) && !speeds_rpm.is_empty();
        let wrong = modes.iter().find(|m| m.len() != speeds_rpm.len());
        if !ascending || wrong.is_some() {
            return Err(CalibError::Lengths {
                what: "rows of a mode of the covariance between codes (one for each of its ascending speeds)",
                expected: speeds_rpm.len(),
                given: wrong.map_or(speeds_rpm.len(), Vec::len),
            });
        }
        Ok(Self { speeds_rpm, modes })
    }

    /// From differences between codes in matched runs of the base model: their mean product
    /// about zero.
    ///
    /// ```
    /// use calib::attribution::CodeCovariance;
    /// // Two pairs of runs whose angles differ by +2 and -1 degree at every speed.
    /// let runs = vec![vec![[2.0, 2.0, 0.0, 0.0]; 2], vec![[-1.0, -1.0, 0.0, 0.0]; 2]];
    /// let between = CodeCovariance::from_differences(vec![5.0, 20.0], runs)?;
    /// // Mean square (4 + 1) / 2.
    /// assert!((between.covariance((5.0, 0), (12.0, 1)) - 2.5).abs() < 1e-12);
    /// # Ok::<(), calib::CalibError>(())
    /// ```
    ///
    /// # Errors
    /// As [`CodeCovariance::new`].
    pub fn from_differences(
        speeds_rpm: Vec<f64>,
        mut runs: Vec<Vec<[f64; 4]>>,
    ) -> Result<Self, CalibError> {
        let scale = 1.0 / (runs.len().max(1) as f64).sqrt();
        runs.iter_mut().flatten().flatten().for_each(|v| *v *= scale);
        Self::new(speeds_rpm, runs)
    }

    /// Covariance of two (speed in rpm, index of response).
    pub fn covariance(&self, a: (f64, usize), b: (f64, usize)) -> f64 {
        self.modes.iter().map(|m| self.at(m, a) * self.at(m, b)).sum()
    }

    fn at(&self, mode: &[[f64; 4]], (omega, response): (f64, usize)) -> f64 {
        let s = &self.speeds_rpm;
        let i = s.partition_point(|x| *x < omega);
        if i == 0 {
            return mode[0][response];
        }
        if i == s.len() {
            return mode[i - 1][response];
        }
        let t = (omega - s[i - 1]) / (s[i] - s[i - 1]);
        mode[i - 1][response] * (1.0 - t) + mode[i][response] * t
    }
}

/// Two effects simulated together: their own model in place of the sum of two signatures.
#[derive(Clone)]
pub struct PairModel<'s> {
    /// Names of two candidates.
    pub names: [String; 2],
    /// Simulator of the free parameters, then the strengths of both in that order.
    pub simulator: &'s dyn Simulator,
}

/// An experiment that could be made next to separate effects that the data leave together.
#[derive(Clone)]
pub struct Experiment<'s> {
    /// What is done ("drum turned the other way", say).
    pub name: String,
    /// Where it would be measured.
    pub points: Vec<OperatingPoint>,
    /// Standard deviation of a mean of each response there, deg and percent of R; `None` for what is not measured.
    pub sd: [Option<f64>; 4],
    /// What stays uncertain in it, independently of the present measurement.
    pub nuisances: Vec<Nuisance>,
    /// Name of a candidate and its simulation of this experiment, with the candidate's
    /// parameters. Candidates without one take no part.
    pub simulators: Vec<(String, &'s dyn Simulator)>,
}

/// Levels, prior masses and sizes of an attribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// False-alarm rate of the decision that something is missing; also the level of the
    /// absolute fit that a named effect must reach.
    pub level: f64,
    /// Draws of the bootstrap.
    pub bootstrap: usize,
    /// Draws for each verdict of the table of stability; 0 leaves the table out.
    pub stability_bootstrap: usize,
    /// Degrees of freedom with which the size of the errors itself is known, where few runs tell it: draws are those of
    /// Student's t with as many. `None` for errors that are known.
    pub errors_dof: Option<f64>,
    /// Seed of all draws.
    pub seed: u64,
    /// Prior mass on "nothing is missing".
    pub prior_none: f64,
    /// Prior mass on "something that is not in the catalogue".
    pub prior_unknown: f64,
    /// Prior mass on two effects at once. What remains is divided among the candidates by
    /// their weights.
    pub prior_pairs: f64,
    /// Likelihood ratio to the best effect within which an effect belongs to its class; members beyond
    /// those that hold all but one part in so many of the class's likelihood are left out.
    pub class_ratio: f64,
    /// The same for a class that has fewer than [`Settings::few_members`]: those that are less likely still join it, best first,
    /// until it has so many. Where errors are as stated it may equal [`Settings::class_ratio`]; where models are made of few runs
    /// likelihoods say more than is known.
    pub few_ratio: f64,
    /// Members up to which [`Settings::few_ratio`] counts.
    pub few_members: usize,
    /// Whitened cosine above which two signatures count as collinear.
    pub class_cosine: f64,
    /// Most pairs that may explain the data equally well and still be named, where they have no member in common.
    pub most_pairs: usize,
    /// Power at which detectable strengths are given.
    pub power: f64,
    /// Whether the answer without the covariance between codes is asked for as well, which takes as long as the other.
    pub without_codes: bool,
}

impl Settings {
    /// Deviance beyond the best effect's that [`Settings::class_ratio`] stands for.
    pub fn class_deviance(&self) -> f64 {
        2.0 * self.class_ratio.ln()
    }

    /// Deviance beyond the best effect's at which an effect is out of every class.
    pub fn rival_deviance(&self) -> f64 {
        2.0 * self.few_ratio.max(self.class_ratio).ln()
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            level: 0.01,
            bootstrap: 999,
            stability_bootstrap: 299,
            errors_dof: None,
            seed: 1,
            prior_none: 0.4,
            prior_unknown: 0.1,
            prior_pairs: 0.1,
            class_ratio: 20.0,
            few_ratio: 20.0,
            few_members: 3,
            class_cosine: 0.95,
            most_pairs: 3,
            power: 0.9,
            without_codes: true,
        }
    }
}
