//! Marginal likelihoods, and the profile of an effect's strength.
//!
//! Priors are uniform over the ranges. Frictions are integrated by Laplace's formula in unit
//! ranges with 2 pi added to the curvature, which makes a flat direction count as exactly its
//! range; the strength of a single effect is integrated over its profile, so that a bound within
//! reach is no matter. The competitor "unknown" is the base with a normal process over speed for
//! each response, its size spread evenly in logarithm from half to sixteen standard deviations.

use std::f64::consts::TAU;

use super::Strength;
use super::data::Data;
use super::linear::{cholesky, covariance, normal};
use super::model::Model;
use super::solver::{FINE, Search, Settled, Solved, renewed};
use crate::grid::crossings;
use crate::matching::LEVEL;
use crate::{CalibError, upper_quantile};

/// Sizes of the unknown discrepancy, in typical standard deviations of a response.
const SIZES: [f64; 6] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0];

/// Length over which the unknown discrepancy varies, part of the range of speeds.
const LENGTH: f64 = 1.0 / 3.0;

/// Searches at a renewed covariance for each strength of a profile.
const RENEWALS: usize = 2;

/// Part of what a model's ignorance costs that counts against a strength, or against an effect beside another: the errors of
/// a surface go together over speeds and responses, so the whole would exclude what was never looked at. A tenth is on the
/// wide side.
pub(super) const IGNORANCE: f64 = 0.1;

/// Logarithm of the volume that the curvature leaves of the unit ranges.
fn log_volume(columns: &[Vec<f64>]) -> f64 {
    let mut h = normal(columns);
    for (i, row) in h.iter_mut().enumerate() {
        row[i] += TAU;
    }
    let log_det = cholesky(&h)
        .map_or(f64::INFINITY, |l| 2.0 * (0..l.len()).map(|i| l[i][i].ln()).sum::<f64>());
    0.5 * (columns.len() as f64 * TAU.ln() - log_det)
}

/// Logarithm of the marginal likelihood by Laplace's formula over all parameters.
pub(super) fn laplace(fit: &Settled) -> f64 {
    -0.5 * fit.deviance() + log_volume(&fit.point.columns)
}

/// Profile of a strength: its interval and the marginal likelihood.
pub(super) struct Profile {
    pub(super) strength: Strength,
    pub(super) log_likelihood: f64,
}

/// Profile of the strength of a single effect.
pub(super) fn profile(
    model: &Model<'_>,
    data: &Data,
    fit: &Settled,
) -> Result<Profile, CalibError> {
    let Walk { strength, values, chi2, volume } = walk(model, data, fit, model.frictions())?;
    let lowest = chi2.iter().copied().fold(f64::INFINITY, f64::min);
    let height: Vec<f64> =
        chi2.iter().zip(&volume).map(|(c, v)| (-0.5 * (c - lowest) + v).exp()).collect();
    let area: f64 = values
        .windows(2)
        .zip(height.windows(2))
        .map(|(v, h)| 0.5 * (h[0] + h[1]) * (v[1] - v[0]))
        .sum();
    let log_likelihood = -0.5 * (lowest + fit.weight.log_det) + area.ln();
    Ok(Profile { strength, log_likelihood })
}

/// Interval of the strength that is this parameter of a model, all others fitted anew at each of its values.
pub(super) fn interval(
    model: &Model<'_>,
    data: &Data,
    fit: &Settled,
    axis: usize,
) -> Result<Strength, CalibError> {
    Ok(walk(model, data, fit, axis)?.strength)
}

/// A parameter through its range, others fitted anew.
struct Walk {
    strength: Strength,
    /// Parts of the range.
    values: Vec<f64>,
    /// Chi-square at the covariance of the best.
    chi2: Vec<f64>,
    /// Logarithm of the volume that the parameters before it are free in.
    volume: Vec<f64>,
}

fn walk(model: &Model<'_>, data: &Data, fit: &Settled, axis: usize) -> Result<Walk, CalibError> {
    let dof = data.len() - model.len();
    let best = fit.point.unit[axis];
    let spread = covariance(&fit.point.columns, TAU).map_or(0.1, |c| c[axis][axis].sqrt());
    let mut values: Vec<f64> = (0..=16).map(|i| f64::from(i) / 16.0).collect();
    for k in 0..=16 {
        values.push((best + spread * (f64::from(k) - 8.0) / 2.0).clamp(0.0, 1.0));
    }
    values.push(best);
    values.sort_by(f64::total_cmp);
    values.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let search = Search { model, data, weight: &fit.weight };
    let mut chi2 = vec![0.0; values.len()];
    let mut volume = vec![0.0; values.len()];
    // The same with what the model knows at each point, which away from its runs is less; no value beyond the interval.
    let mut own = vec![f64::INFINITY; values.len()];
    let inflation = if dof == 0 { 1.0 } else { (fit.chi2 / dof as f64).max(1.0) };
    let level = fit.chi2 + upper_quantile(LEVEL) * inflation;
    let middle = values.partition_point(|v| *v < best - 1e-12);
    // Outwards from the best, each from its neighbour's frictions.
    let upwards: Vec<usize> = (middle..values.len()).collect();
    let downwards: Vec<usize> = (0..middle).rev().collect();
    for way in [upwards, downwards] {
        let mut unit = fit.point.unit.clone();
        let mut open = true;
        for i in way {
            unit[axis] = values[i];
            let start = search.point_at(&unit)?;
            let solved = search.descend(&data.y, &start, Some(axis), FINE)?;
            unit.clone_from(&solved.unit);
            chi2[i] = solved.chi2;
            volume[i] = log_volume(&start.columns[..axis]);
            if open && values[i] != best {
                own[i] = settled(&search, &solved, axis)?;
                open = own[i] <= level;
            }
        }
    }
    let (lo, hi) = crossings(&values, &own, (best, fit.chi2), level);
    let (low, high) = model.ranges[axis];
    let scale = |u: f64| low + u * (high - low);
    let strength = Strength { value: fit.theta[axis], lo: lo.map(scale), hi: hi.map(scale) };
    Ok(Walk { strength, values, chi2, volume })
}

/// Chi-square where a search with a strength held ended, fitted anew at the covariance of its own result, so that a
/// strength near which nothing was simulated is not excluded by what is known elsewhere.
fn settled(search: &Search<'_, '_>, from: &Solved, axis: usize) -> Result<f64, CalibError> {
    let mut unit = from.unit.clone();
    let mut value = from.chi2;
    for _ in 0..RENEWALS {
        let (weight, solved) = renewed(search.model, search.data, &unit, Some(axis))?;
        value = solved.chi2 + IGNORANCE * (weight.log_det - search.weight.log_det);
        unit = solved.unit;
    }
    Ok(value)
}

/// Marginal likelihood of the base with an unknown discrepancy.
pub(super) fn unknown(model: &Model<'_>, data: &Data, base: &Settled) -> Result<f64, CalibError> {
    let speeds = || data.points.iter().map(|p| p.omega_rpm);
    let (first, last) = speeds().fold((f64::INFINITY, 0.0f64), |(a, b), s| (a.min(s), b.max(s)));
    let length = ((last - first) * LENGTH).max(1e-9);
    let scale: Vec<f64> = data.items.iter().map(|o| data.typical_sd(o.response.index())).collect();
    let predicted = model.predict(&base.theta, &data.points)?;
    let mut each = Vec::with_capacity(SIZES.len());
    for size in SIZES {
        let more = |i: usize, j: usize| {
            let (a, b) = (&data.items[i], &data.items[j]);
            if a.response != b.response || a.load != b.load {
                return 0.0;
            }
            let apart = (a.omega_rpm - b.omega_rpm) / length;
            size * size * scale[i] * scale[j] * (-0.5 * apart * apart).exp()
        };
        let weight = data.weight(&predicted, Some(&more))?;
        let search = Search { model, data, weight: &weight };
        let start = search.point_at(&base.point.unit)?;
        let solved = search.descend(&data.y, &start, None, FINE)?;
        let point = search.point_at(&solved.unit)?;
        each.push(-0.5 * (solved.chi2 + weight.log_det) + log_volume(&point.columns));
    }
    Ok(log_mean(&each))
}

/// Logarithm of the mean of exponentials.
pub(super) fn log_mean(logs: &[f64]) -> f64 {
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if top == f64::NEG_INFINITY {
        return top;
    }
    top + (logs.iter().map(|l| (l - top).exp()).sum::<f64>() / logs.len() as f64).ln()
}
