//! Whether anything is missing: chi-square of the base, best improvement by one effect, and
//! their parametric bootstrap.
//!
//! The omnibus test asks whether the residual is too large (N - p degrees of freedom), the
//! focused one whether the best of the catalogue's signatures explains too much of it. The first
//! sees effects that nobody thought of, the second sees weak effects that are in the catalogue.
//! The smaller of their nominal p-values is ranked among the draws' smaller ones, so that the
//! rate of false alarms of the combination is the level, not twice the level: nothing need be
//! split, and errors of the nominal values cancel.
//!
//! Where the size of the errors is itself known with few degrees of freedom only, what the effect leaves tells of it too: an
//! improvement is counted in variances of both together, as in the analysis of variance, so that one and the same
//! improvement counts for more beside a small rest than beside a large one ([`Errors`]).

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

use super::data::{Data, Variation, Weight};
use super::model::Model;
use super::solver::{COARSE, Point, Search, Settled, settle, spread};
use super::{Attribution, Gate};
use crate::covariance::square;
use crate::{CalibError, Observations, chi_square_p, variance_ratio_p};

/// Draws after which a bootstrap that shows nothing may stop.
const EARLY: usize = 99;

/// Probability above which both tests show nothing: at 99 draws, eight times the level of 1 %
/// and 2.5 standard deviations of the estimate above it.
const NOTHING: f64 = 0.08;

/// The models with one set of data.
pub(super) struct Case<'a, 's> {
    pub(super) attribution: &'a Attribution<'s>,
    pub(super) observations: Observations,
    variation: Variation,
    with_code: bool,
    pub(super) data: Data,
    pub(super) base: Model<'s>,
    pub(super) singles: Vec<Model<'s>>,
}

impl<'a, 's> Case<'a, 's> {
    pub(super) fn new(
        attribution: &'a Attribution<'s>,
        observations: &Observations,
        variation: Variation,
        with_code: bool,
    ) -> Result<Self, CalibError> {
        let problem = &attribution.base;
        let data = prepare(attribution, observations, variation, with_code);
        let base = Model::base(problem)?;
        let singles = attribution
            .candidates
            .iter()
            .map(|c| Model::single(&problem.free, c))
            .collect::<Result<Vec<_>, _>>()?;
        let simulators = attribution.candidates.iter().map(|c| c.simulator);
        for (model, simulator) in std::iter::once(&base)
            .chain(&singles)
            .zip(std::iter::once(problem.simulator).chain(simulators))
        {
            let (low, high) = simulator.speed_range_rpm();
            let given = attribution.held_out.iter().flat_map(Observations::speeds_rpm);
            let mut speeds = data.points.iter().map(|p| p.omega_rpm).chain(given);
            if let Some(omega_rpm) = speeds.find(|s| !(low..=high).contains(s)) {
                let model = model.name.clone();
                return Err(CalibError::SpeedRange { model, omega_rpm, low, high });
            }
            if data.len() <= model.len() {
                return Err(CalibError::TooFewObservations {
                    model: model.name.clone(),
                    observations: data.len(),
                    parameters: model.len(),
                });
            }
        }
        let observations = observations.clone();
        Ok(Self { attribution, observations, variation, with_code, data, base, singles })
    }

    /// Other observations under the same assumptions.
    pub(super) fn prepare(&self, observations: &Observations) -> Data {
        prepare(self.attribution, observations, self.variation, self.with_code)
    }

    /// The same observations with other errors.
    pub(super) fn vary(&self, variation: Variation) -> Result<Self, CalibError> {
        Self::new(self.attribution, &self.observations, variation, self.with_code)
    }

    pub(super) fn fit_base(&self) -> Result<Settled, CalibError> {
        settle(&self.base, &self.data, &spread(self.base.len()))
    }
}

fn prepare(
    attribution: &Attribution<'_>,
    observations: &Observations,
    variation: Variation,
    with_code: bool,
) -> Data {
    let code = attribution.code_covariance.as_ref().filter(|_| with_code);
    Data::new(observations, &attribution.base.nuisances, code, variation)
}

/// Starts of a candidate's fits around the calibrated base, at a covariance that is held.
pub(super) struct Null {
    weight: Weight,
    starts: Vec<Point>,
    /// Whether it is the base, bit by bit or nearly, where the effect is absent.
    nested: bool,
}

impl Null {
    pub(super) fn new(model: &Model<'_>, data: &Data, base: &Settled) -> Result<Self, CalibError> {
        let absent = model.absent(&base.theta);
        let predicted = model.predict(&absent, &data.points)?;
        let weight = data.weight(&predicted, None)?;
        let search = Search { model, data, weight: &weight };
        let mean = data.pick(&predicted.mean);
        let apart: f64 =
            mean.iter().zip(&base.point.mean).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let nested = apart < 1e-6 && (weight.log_det - base.weight.log_det).abs() < 1e-6;
        let frictions = &model.unit(&absent)[..model.frictions()];
        let mut starts = Vec::new();
        for strengths in model.strength_starts() {
            let unit: Vec<f64> = frictions.iter().copied().chain(strengths).collect();
            starts.push(search.point_at(&unit)?);
        }
        Ok(Self { weight, starts, nested })
    }

    /// Chi-square that the effect gains; `without` is that of the base on the same data.
    pub(super) fn improvement(
        &self,
        model: &Model<'_>,
        data: &Data,
        y: &[f64],
        without: f64,
    ) -> Result<f64, CalibError> {
        let search = Search { model, data, weight: &self.weight };
        let absent = if self.nested {
            without
        } else {
            // A model that is worse than the base where its effect is absent gains nothing by that.
            let own = search.descend(y, &self.starts[0], Some(model.frictions()), COARSE)?.chi2;
            own.min(without)
        };
        let with = search.best(y, &self.starts, COARSE)?.map_or(absent, |s| s.chi2);
        Ok((absent - with).max(0.0))
    }
}

/// What is known of the size of all errors in common.
#[derive(Debug, Clone, Copy)]
pub(super) struct Errors {
    /// Degrees of freedom of the base's residual.
    dof: usize,
    /// Those with which the size was known before; `None` for a size that is known.
    known: Option<f64>,
}

impl Errors {
    /// An improvement of chi-square in variances as all that is left tells them: Fisher's F with one and all other degrees of
    /// freedom if there is one linear effect, and nothing is missing.
    pub(super) fn counted(self, improvement: f64, chi2: f64) -> f64 {
        let Some(known) = self.known else { return improvement };
        let rest = (chi2 - improvement).max(0.0);
        improvement * (known + self.dof as f64 - 1.0) / (known + rest)
    }

    /// Nominal probability of such a chi-square.
    fn p_chi2(self, chi2: f64) -> f64 {
        self.known.map_or_else(
            || chi_square_p(chi2, self.dof),
            |known| variance_ratio_p(chi2, self.dof, known),
        )
    }

    /// Chi-square that is exceeded with probability `p`.
    fn chi2_at(self, p: f64) -> f64 {
        let dof = self.dof as f64;
        match self.known.and_then(|known| FisherSnedecor::new(dof, known).ok()) {
            Some(f) => dof * f.inverse_cdf(1.0 - p),
            None => quantile(self.dof, p),
        }
    }
}

/// The gate with everything that later steps need.
pub(super) struct Screen {
    pub(super) base: Settled,
    pub(super) improvements: Vec<f64>,
    pub(super) errors: Errors,
    /// Improvements of each draw, as counted.
    improvement_draws: Vec<Vec<f64>>,
    pub(super) gate: Gate,
    /// Chi-square above which the omnibus part rejects.
    pub(super) critical_chi2: f64,
    /// Best improvement, as counted, above which the focused part rejects.
    pub(super) critical_improvement: f64,
}

impl Screen {
    pub(super) fn new(
        case: &Case<'_, '_>,
        draws: usize,
        may_stop: bool,
    ) -> Result<Self, CalibError> {
        let settings = &case.attribution.settings;
        let data = &case.data;
        let base = case.fit_base()?;
        let nulls = case
            .singles
            .iter()
            .map(|m| Null::new(m, data, &base))
            .collect::<Result<Vec<_>, _>>()?;
        let improve = |y: &[f64], chi2: f64| -> Result<Vec<f64>, CalibError> {
            let both = nulls.iter().zip(&case.singles);
            both.map(|(null, model)| null.improvement(model, data, y, chi2)).collect()
        };
        let improvements = improve(&data.y, base.chi2)?;
        let lag1 = data.lag1(&base.white);
        let errors = Errors { dof: data.len() - case.base.len(), known: settings.errors_dof };
        let count = |all: &[f64], chi2: f64| -> Vec<f64> {
            all.iter().map(|i| errors.counted(*i, chi2)).collect()
        };
        let best = highest(&count(&improvements, base.chi2));
        let search = Search { model: &case.base, data, weight: &base.weight };
        let start = [base.point.clone()];
        let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
        let mut chi2_draws = Vec::with_capacity(draws);
        let mut best_draws = Vec::with_capacity(draws);
        let mut improvement_draws = Vec::with_capacity(draws);
        let mut lags = 0;
        let unsure =
            settings.errors_dof.and_then(|dof| Some((dof, rand_distr::ChiSquared::new(dof).ok()?)));
        for k in 0..draws {
            if may_stop && k == EARLY {
                let nothing = part(&chi2_draws, base.chi2) > NOTHING;
                if nothing && part(&best_draws, best) > NOTHING {
                    break;
                }
            }
            // Student's t in all data together: one size for all of a draw's errors.
            let size = unsure.map_or(1.0, |(dof, d)| (dof / d.sample(&mut rng)).sqrt());
            let normal = |rng: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(rng) };
            let z: Vec<f64> = (0..data.len()).map(|_| size * normal(&mut rng)).collect();
            let noise = base.weight.colour(&z);
            let y: Vec<f64> = base.point.mean.iter().zip(&noise).map(|(m, e)| m + e).collect();
            let refit = search.best(&y, &start, COARSE)?;
            let (chi2, white) = refit.map_or((square(&z), z), |s| (s.chi2, s.white));
            let gained = count(&improve(&y, chi2)?, chi2);
            chi2_draws.push(chi2);
            best_draws.push(highest(&gained));
            improvement_draws.push(gained);
            lags += usize::from(data.lag1(&white) >= lag1);
        }
        let made = chi2_draws.len();
        let p_bootstrap = part(&chi2_draws, base.chi2);
        let p_focused = part(&best_draws, best);
        let joint = Joint::new(errors, &best_draws);
        let own = joint.smaller(base.chi2, best);
        let mut smaller: Vec<f64> =
            chi2_draws.iter().zip(&best_draws).map(|(c, b)| joint.smaller(*c, *b)).collect();
        let below = smaller.iter().filter(|m| **m <= own).count();
        let p_combined = (1 + below) as f64 / (1 + made) as f64;
        smaller.sort_by(f64::total_cmp);
        // Smallest value of the draws that would not be an alarm any more.
        let place = (settings.level * (1 + made) as f64) as usize;
        let critical = smaller.get(place.saturating_sub(1)).copied().unwrap_or(0.0);
        let gate = Gate {
            chi2: base.chi2,
            dof: errors.dof,
            p_chi2: chi_square_p(base.chi2, errors.dof),
            p_bootstrap,
            p_focused,
            p_combined,
            lag1,
            lag1_p: lag1.map(|_| (1 + lags) as f64 / (1 + made) as f64),
            draws: made,
            passes: p_combined > settings.level,
        };
        Ok(Self {
            base,
            improvements,
            errors,
            improvement_draws,
            gate,
            critical_chi2: errors.chi2_at(critical),
            critical_improvement: joint.improvement_at(critical),
        })
    }

    /// Probability of candidate `k`'s improvement, of itself and of the best of all. Draws are searched about the base, where it
    /// is known; what is found far from there, by `deviance` better than the base, counts by that.
    pub(super) fn p_values(&self, k: usize, deviance: f64) -> (f64, f64) {
        let value = self.errors.counted(self.improvements[k].max(deviance), self.base.chi2);
        let of = |draw: &dyn Fn(&Vec<f64>) -> f64| {
            let above = self.improvement_draws.iter().filter(|d| draw(d) >= value).count();
            (1 + above) as f64 / (1 + self.improvement_draws.len()) as f64
        };
        (of(&|d| d[k]), of(&|d| highest(d)))
    }
}

fn highest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// Bootstrap p of a value that is none of the draws.
fn part(draws: &[f64], value: f64) -> f64 {
    (1 + draws.iter().filter(|d| **d >= value).count()) as f64 / (1 + draws.len()) as f64
}

/// The two tests on one scale: nominal p-values that are continuous, so that few draws rank them
/// without ties. Their own errors do not matter, since the smaller one is ranked among draws.
struct Joint {
    errors: Errors,
    /// Number of independent effects that would raise the best improvement as the catalogue
    /// does, from the median of the draws.
    effects: f64,
    /// By how much the tail of the draws' improvements is longer than that of such effects: with
    /// candidates whose models do not contain the base bit by bit a few draws gain enormously, and
    /// their nominal values would drown what chi-square sees.
    stretch: f64,
}

/// Ratio of a draw to its nominal quantile that chance gives.
const CHANCE: f64 = 1.5;

impl Joint {
    fn new(errors: Errors, best_draws: &[f64]) -> Self {
        let mut sorted = best_draws.to_vec();
        sorted.sort_by(f64::total_cmp);
        let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        let q = chi_square_p(median, 1);
        let effects = if q < 1.0 { 0.5_f64.ln() / (-q).ln_1p() } else { 1.0 };
        let mut joint = Self { errors, effects: effects.max(1.0), stretch: 1.0 };
        let ratio = |(rank, best): (usize, &f64)| {
            best / joint.improvement_at((rank + 1) as f64 / (sorted.len() + 1) as f64)
        };
        let tail = (sorted.len() / 10).max(1);
        let longest = sorted.iter().rev().take(tail).enumerate().map(ratio).fold(0.0, f64::max);
        if longest > CHANCE {
            joint.stretch = longest;
        }
        joint
    }

    fn smaller(&self, chi2: f64, best: f64) -> f64 {
        let q = chi_square_p(best / self.stretch, 1);
        let focused = if q < 1.0 { -(self.effects * (-q).ln_1p()).exp_m1() } else { 1.0 };
        self.errors.p_chi2(chi2).min(focused)
    }

    fn improvement_at(&self, p: f64) -> f64 {
        self.stretch * quantile(1, -((-p).ln_1p() / self.effects).exp_m1())
    }
}

/// Value that chi-square exceeds with probability `p`.
fn quantile(dof: usize, p: f64) -> f64 {
    ChiSquared::new(dof as f64).map_or(f64::INFINITY, |d| d.inverse_cdf(1.0 - p))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_that_gain_enormously_do_not_drown_a_large_chi_square() {
        // Hundred draws as one effect gives, and five in a hundred of a model that does not nest.
        let mut draws: Vec<f64> = (1..=95).map(|k| quantile(1, f64::from(k) / 96.0)).collect();
        let errors = Errors { dof: 11, known: None };
        let plain = Joint::new(errors, &draws);
        assert!((plain.stretch - 1.0).abs() < 1e-12);
        draws.extend([60.0, 80.0, 100.0, 120.0, 140.0]);
        let joint = Joint::new(errors, &draws);
        let own = joint.smaller(49.8, 3.0);
        let drowning = draws.iter().filter(|b| joint.smaller(11.0, **b) <= own).count();
        assert_eq!(drowning, 0, "stretch {}", joint.stretch);
        let critical = joint.improvement_at(1e-4);
        assert!((joint.smaller(11.0, critical) / 1e-4 - 1.0).abs() < 1e-6);
    }
}
