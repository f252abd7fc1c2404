//! Errors at data that were not fitted, with and without an effect.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rig_schema::Response;

use super::data::Data;
use super::linear::{cholesky, covariance, dot, solve};
use super::model::Model;
use super::solver::{FINE, Search};
use super::{HeldOut, HeldOutResponse};
use crate::CalibError;

/// One predicted point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Predicted {
    pub(super) omega_rpm: f64,
    pub(super) response: Response,
    /// Measured minus what the fitted model says by itself, with the nuisances of the fit.
    pub(super) residual: f64,
    /// Variance of measurement and simulator, nuisances aside.
    pub(super) alone: f64,
    /// Measured minus predicted, given the residuals of what was fitted.
    pub(super) error: f64,
    /// Variance of measurement and simulator, as far as what was fitted does not tell it.
    pub(super) noise: f64,
    /// The same with that of the fitted parameters.
    pub(super) total: f64,
}

/// Points predicted from one fit.
#[derive(Debug, Default)]
pub(super) struct Fold {
    pub(super) points: Vec<Predicted>,
    /// Chi-square of all errors together, which go together.
    pub(super) chi2: f64,
}

/// Fit on `train` from starts in unit ranges, predict the rest of `all`, which begins with the same items.
///
/// What the fit leaves at the speeds that are fitted tells something of the others: a nuisance, the filling's shift, an
/// error of the surface move them all. So a prediction is the mean given those residuals.
pub(super) fn predict(
    model: &Model<'_>,
    train: &Data,
    all: &Data,
    starts: &[Vec<f64>],
) -> Result<Fold, CalibError> {
    let Some(first) = starts.first() else { return Ok(Fold::default()) };
    let at_first = model.predict(&model.theta(first), &train.points)?;
    let weight = train.weight(&at_first, None)?;
    let search = Search { model, data: train, weight: &weight };
    let mut points = Vec::new();
    for unit in starts {
        points.push(search.point_at(unit)?);
    }
    let Some(solved) = search.best(&train.y, &points, FINE)? else { return Ok(Fold::default()) };
    let point = search.point_at(&solved.unit)?;
    // A strength or friction at an end of its range does not scatter beyond it: the prior keeps
    // the spread within the range.
    let spread = covariance(&point.columns, 12.0);
    let there = model.predict(&model.theta(&solved.unit), &all.points)?;
    let mean = all.pick(&there.mean);
    let joint = all.weight(&there, None)?;
    let known = train.len();
    let rest = |v: &[f64]| joint.whiten(v).split_off(known);
    let residual: Vec<f64> = all.y.iter().zip(&mean).map(|(y, m)| y - m).collect();
    let miss = rest(&residual);
    let slopes: Vec<Vec<f64>> =
        raw_slopes(model, all, &solved.unit, &mean)?.iter().map(|s| rest(s)).collect();
    // Whitened errors have the covariance of what the parameters leave added to one.
    let n = all.len() - known;
    let mut both = vec![vec![0.0; n]; n];
    for (i, row) in both.iter_mut().enumerate() {
        row[i] = 1.0;
        for (a, of_a) in spread.iter().flatten().enumerate() {
            for (b, c) in of_a.iter().enumerate() {
                for (j, v) in row.iter_mut().enumerate() {
                    *v += slopes[a][i] * c * slopes[b][j];
                }
            }
        }
    }
    let fault = CalibError::Covariance { what: "predicted points", size: n };
    let factor = cholesky(&both).ok_or(fault)?;
    let chi2 = dot(&miss, &solve(&factor, &miss));
    // Nuisances are those of the fit; what else other speeds tell is not the model's.
    let nuisances = train.nuisance_posterior(&weight, &solved.white);
    let variance = joint.variances();
    let by_itself = |i: usize| {
        let each = || nuisances.iter().zip(&all.nuisance);
        let moved: f64 = each().map(|((estimate, _), g)| estimate * g[i]).sum();
        (residual[i] - moved, variance[i] - each().map(|(_, g)| g[i] * g[i]).sum::<f64>())
    };
    let given = joint.given(known);
    let points = given.into_iter().zip(&all.items[known..]).enumerate().map(|(k, (row, item))| {
        let (residual, alone) = by_itself(known + k);
        Predicted {
            omega_rpm: item.omega_rpm,
            response: item.response,
            residual,
            alone,
            error: dot(row, &miss),
            noise: dot(row, row),
            total: both.iter().zip(row).map(|(b, l)| l * dot(b, row)).sum(),
        }
    });
    Ok(Fold { points: points.collect(), chi2 })
}

fn raw_slopes(
    model: &Model<'_>,
    data: &Data,
    unit: &[f64],
    mean: &[f64],
) -> Result<Vec<Vec<f64>>, CalibError> {
    let mut slopes = Vec::new();
    for k in 0..unit.len() {
        let step = if unit[k] > 0.5 { -1e-4 } else { 1e-4 };
        let mut moved = unit.to_vec();
        moved[k] += step;
        let there = data.pick(&model.expected(&model.theta(&moved), &data.points)?);
        slopes.push(there.iter().zip(mean).map(|(a, b)| (a - b) / step).collect());
    }
    Ok(slopes)
}

/// Predictions of the same points by two models.
#[derive(Clone, Default)]
pub(super) struct Compared {
    pub(super) before: Vec<Predicted>,
    pub(super) after: Vec<Predicted>,
    /// Sum over folds of the chi-square of predictions with the effect.
    pub(super) chi2: f64,
    pub(super) folds: usize,
}

impl Compared {
    /// Most points of one response.
    pub(super) fn speeds(&self) -> usize {
        let of = |r: &Response| self.before.iter().filter(|p| p.response == *r).count();
        Response::ALL.iter().map(of).max().unwrap_or(0)
    }

    /// Take in the points of another set.
    pub(super) fn join(&mut self, other: Self) {
        self.before.extend(other.before);
        self.after.extend(other.after);
        self.chi2 += other.chi2;
        self.folds += other.folds;
    }

    /// Mean over the points of the squared residual in variances, before less after: of the models' own predictions,
    /// without what the residuals of other speeds tell. With that a model that is off by as much everywhere predicts well.
    pub(super) fn gain(&self) -> Option<f64> {
        let n = self.before.len();
        let both = self.before.iter().zip(&self.after);
        let each = both.map(|(b, a)| (b.residual.powi(2) - a.residual.powi(2)) / b.alone);
        (n > 0).then(|| each.sum::<f64>() / n as f64)
    }

    /// Chi-square with the effect over the number of points.
    pub(super) fn surprise(&self) -> Option<f64> {
        (!self.after.is_empty()).then(|| self.chi2 / self.after.len() as f64)
    }

    /// Responses whose error grows by more than one standard deviation of the prediction.
    pub(super) fn worsened(&self) -> Vec<Response> {
        let mut worse = Vec::new();
        for r in Response::ALL {
            let of: Vec<(&Predicted, &Predicted)> =
                self.before.iter().zip(&self.after).filter(|(b, _)| b.response == r).collect();
            if of.is_empty() {
                continue;
            }
            let mean = |f: &dyn Fn(&(&Predicted, &Predicted)) -> f64| {
                (of.iter().map(f).sum::<f64>() / of.len() as f64).sqrt()
            };
            let before = mean(&|(b, a)| b.error * b.error / a.total);
            let after = mean(&|(_, a)| a.error * a.error / a.total);
            if after - before > 1.0 {
                worse.push(r);
            }
        }
        worse
    }

    /// For the report.
    pub(super) fn report(&self, kind: &'static str, name: &str, seed: u64) -> HeldOut {
        let both: Vec<(&Predicted, &Predicted)> = self.before.iter().zip(&self.after).collect();
        let responses = Response::ALL
            .into_iter()
            .filter_map(|r| {
                let of: Vec<_> = both.iter().filter(|(b, _)| b.response == r).collect();
                if of.is_empty() {
                    return None;
                }
                let n = of.len() as f64;
                let mean = |f: &dyn Fn(&(&Predicted, &Predicted)) -> f64| {
                    of.iter().map(|p| f(p)).sum::<f64>() / n
                };
                let before = mean(&|(b, _)| b.error * b.error);
                let after = mean(&|(_, a)| a.error * a.error);
                let floor = mean(&|(b, _)| b.noise);
                Some(HeldOutResponse {
                    response: r.column(),
                    points: of.len(),
                    before: before.sqrt(),
                    after: after.sqrt(),
                    before_sd: mean(&|(b, _)| b.error * b.error / b.noise).sqrt(),
                    after_sd: mean(&|(b, a)| a.error * a.error / b.noise).sqrt(),
                    floor: floor.sqrt(),
                    removed: removed(before, after, floor),
                })
            })
            .collect();
        let n = both.len().max(1) as f64;
        let before = both.iter().map(|(b, _)| b.error * b.error / b.noise).sum::<f64>() / n;
        let after = both.iter().map(|(b, a)| a.error * a.error / b.noise).sum::<f64>() / n;
        HeldOut {
            kind,
            name: name.to_owned(),
            folds: self.folds,
            responses,
            removed: removed(before, after, 1.0),
            permutation_p: self.permutation_p(seed),
        }
    }

    /// Before and after exchanged at random, all responses of a speed together.
    fn permutation_p(&self, seed: u64) -> f64 {
        let mut speeds: Vec<f64> = self.before.iter().map(|b| b.omega_rpm).collect();
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        let block = |s: &f64| -> f64 {
            let both = self.before.iter().zip(&self.after);
            both.filter(|(b, _)| b.omega_rpm == *s).map(|(b, a)| difference(b, a)).sum()
        };
        let blocks: Vec<f64> = speeds.iter().map(block).collect();
        let observed: f64 = blocks.iter().sum();
        let reached = |sum: f64| usize::from(sum >= observed - 1e-12 * observed.abs());
        if blocks.len() <= 12 {
            let all = 1usize << blocks.len();
            let sum = |k: usize| -> f64 {
                let signed = |(i, b): (usize, &f64)| if k >> i & 1 == 0 { *b } else { -b };
                blocks.iter().enumerate().map(signed).sum()
            };
            return (0..all).map(|k| reached(sum(k))).sum::<usize>() as f64 / all as f64;
        }
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let draws = 4095;
        let mut above = 1;
        for _ in 0..draws {
            let sum = blocks.iter().map(|b| if rng.random::<bool>() { *b } else { -b }).sum();
            above += reached(sum);
        }
        above as f64 / (draws + 1) as f64
    }
}

fn difference(before: &Predicted, after: &Predicted) -> f64 {
    (before.error * before.error - after.error * after.error) / before.noise
}

/// Part of the mean square above the floor that is gone.
fn removed(before: f64, after: f64, floor: f64) -> Option<f64> {
    let excess = before - floor;
    (excess > 0.0).then(|| 1.0 - (after - floor).max(0.0) / excess)
}
