//! The best match of one problem: estimates with intervals, residuals, goodness.

use rig_schema::Response;

use crate::covariance::square;
use crate::grid::{Grid, crossings, refine};
use crate::{Bootstrap, CalibError, Goodness, Marginal, NuisanceEstimate, Problem, upper_quantile};

/// Level of all intervals.
pub(crate) const LEVEL: f64 = 0.95;

/// Part of its range above which an interval says nothing.
const FLAT_PART: f64 = 0.8;

/// How strongly the data depend on a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flatness {
    /// Largest deviance over the range less the lowest, others profiled.
    pub deviance_range: f64,
    /// Part of the range that the interval covers.
    pub covered: f64,
    /// Whether the interval ends inside the range on both sides and covers less than four fifths
    /// of it.
    pub identified: bool,
}

/// One fitted parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Path.
    pub name: String,
    /// Most likely value.
    pub value: f64,
    /// Lower end of the 95 % profile-likelihood interval; `None` if the range ends first.
    pub lo: Option<f64>,
    /// Upper end; `None` if the range ends first.
    pub hi: Option<f64>,
    /// Range that was searched.
    pub range: (f64, f64),
    /// How far the data determine it.
    pub flatness: Flatness,
    /// Values of the profile.
    pub profile: Vec<(f64, f64)>,
    /// Marginal posterior under a uniform prior over the range.
    pub marginal: Marginal,
}

/// One observation beside the fitted model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// Speed, rpm.
    pub omega_rpm: f64,
    /// Which response.
    pub response: Response,
    /// Measured mean.
    pub measured: f64,
    /// Fitted model, nuisances at their estimates.
    pub model: f64,
    /// Standard deviation of the difference: error of the mean and of the simulator, without
    /// the nuisances.
    pub sd: f64,
}

impl Residual {
    /// Measured minus model in units of `sd`.
    pub fn in_sd(&self) -> f64 {
        (self.measured - self.model) / self.sd
    }
}

/// Root mean square of measured less model over one response, in its unit; `None` without residuals of it.
pub fn root_mean_square(residuals: &[Residual], response: Response) -> Option<f64> {
    let of = residuals.iter().filter(|x| x.response == response);
    let squares: Vec<f64> = of.map(|x| (x.measured - x.model).powi(2)).collect();
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// A solved problem.
#[derive(Debug, Clone, PartialEq)]
pub struct Match {
    /// Fitted parameters in the order of the problem.
    pub estimates: Vec<Estimate>,
    /// Goodness of fit.
    pub goodness: Goodness,
    /// Residuals in the order of the observations.
    pub residuals: Vec<Residual>,
    /// Nuisances at the best fit.
    pub nuisances: Vec<NuisanceEstimate>,
    /// Lag-1 correlation over speed of the residuals, averaged over the responses; near 0 for
    /// independent errors.
    pub lag1: Option<f64>,
    /// Parametric bootstrap of the chi-square, where it was asked for.
    pub bootstrap: Option<Bootstrap>,
}

impl Problem<'_> {
    /// Find the best match; `bootstrap` draws are made with `seed` (0: none).
    ///
    /// Intervals are widened by the Birge ratio where the fit is worse than its errors allow.
    ///
    /// # Errors
    /// [`CalibError`] if the problem is not well posed or the simulator fails.
    pub fn solve(&self, bootstrap: usize, seed: u64) -> Result<Match, CalibError> {
        self.check()?;
        let grid = Grid::new(self)?;
        let steps: Vec<f64> = grid.axes.iter().map(|a| 0.5 * (a[1] - a[0])).collect();
        let (theta, best) = refine(self, grid.point(grid.best()), &steps, None)?;
        let dof = self.observations.items.len().saturating_sub(self.free.len());
        let goodness = Goodness::new(best.chi2(), dof);
        let inflation = goodness.inflation();
        let level = best.deviance() + upper_quantile(LEVEL) * inflation;
        let estimates = (0..self.free.len())
            .map(|axis| {
                let profile = grid.profile(axis);
                let values = &grid.axes[axis];
                let at = (theta[axis], best.deviance());
                let (lo, hi) = crossings(values, &profile, at, level);
                let range = self.free[axis].range;
                let covered = (hi.unwrap_or(range.1) - lo.unwrap_or(range.0)) / (range.1 - range.0);
                let highest = profile.iter().copied().fold(f64::MIN, f64::max);
                Estimate {
                    name: self.free[axis].name.clone(),
                    value: theta[axis],
                    lo,
                    hi,
                    range,
                    flatness: Flatness {
                        deviance_range: highest - best.deviance(),
                        covered,
                        identified: lo.is_some() && hi.is_some() && covered < FLAT_PART,
                    },
                    profile: values
                        .iter()
                        .zip(&profile)
                        .map(|(v, d)| (*v, d - best.deviance()))
                        .collect(),
                    marginal: Marginal::from_log(values, &grid.log_marginal(axis, inflation)),
                }
            })
            .collect();
        let model = self.adjusted_model(&best);
        let residuals = self.residuals(&theta, &model)?;
        let bootstrap =
            (bootstrap > 0).then(|| Bootstrap::draw(&best, &grid.model, bootstrap, seed));
        Ok(Match {
            estimates,
            goodness,
            lag1: lag1(&residuals),
            residuals,
            nuisances: self.nuisance_estimates(&best),
            bootstrap,
        })
    }

    /// Chi-square at given parameters, nuisances marginalised.
    ///
    /// # Errors
    /// [`CalibError`] if the simulator fails.
    pub fn chi2_at(&self, theta: &[f64]) -> Result<f64, CalibError> {
        Ok(square(&self.evaluate(theta)?.white))
    }

    /// Residuals at given parameters with the nuisances at their estimates there.
    ///
    /// # Errors
    /// [`CalibError`] if the simulator fails.
    pub fn residuals_at(&self, theta: &[f64]) -> Result<Vec<Residual>, CalibError> {
        let model = self.adjusted_model(&self.evaluate(theta)?);
        self.residuals(theta, &model)
    }

    fn residuals(&self, theta: &[f64], model: &[f64]) -> Result<Vec<Residual>, CalibError> {
        let (points, place) = self.observations.places();
        let predicted = self.simulator.predict(theta, &points)?;
        let items = self.observations.items.iter().zip(place).enumerate();
        Ok(items
            .map(|(i, (o, k))| {
                let variance = self.observations.covariance(i, i) + predicted.covariance(k, k);
                Residual {
                    omega_rpm: o.omega_rpm,
                    response: o.response,
                    measured: o.mean,
                    model: model[i],
                    sd: variance.sqrt(),
                }
            })
            .collect())
    }
}

fn lag1(residuals: &[Residual]) -> Option<f64> {
    let mut values = Vec::new();
    for response in Response::ALL {
        let r: Vec<f64> =
            residuals.iter().filter(|r| r.response == response).map(Residual::in_sd).collect();
        if r.len() < 4 {
            continue;
        }
        let mean = r.iter().sum::<f64>() / r.len() as f64;
        let products: f64 = r.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
        let squares: f64 = r.iter().map(|x| (x - mean) * (x - mean)).sum();
        if squares > 0.0 {
            values.push(products / squares);
        }
    }
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
