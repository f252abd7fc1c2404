//! Pure error from replicates, and what a model misses beyond it.

use crate::anova::{LackOfFit, SumOfSquares};
use crate::distribution::f_upper;
use crate::error::DoeError;
use crate::least_squares::{Factored, dot};
use crate::model::Model;
use crate::weighting::Whitener;

/// Difference below which two settings of a factor are the same, in half ranges.
const SAME_SETTING: f64 = 1.0e-9;

/// Runs that share a point, in the order of first appearance.
pub(crate) fn replicate_groups(model: &Model, points: &[Vec<f64>]) -> Vec<Vec<usize>> {
    let same = |a: &[f64], b: &[f64]| {
        model
            .factors()
            .iter()
            .zip(a.iter().zip(b))
            .all(|(f, (a, b))| (a - b).abs() <= SAME_SETTING * f.half_range())
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (run, point) in points.iter().enumerate() {
        match groups.iter_mut().find(|g| same(&points[g[0]], point)) {
            Some(group) => group.push(run),
            None => groups.push(vec![run]),
        }
    }
    groups
}

/// Splits the residual; none where no two runs share a point.
///
/// A point is the setting of *every* factor of the model, in a term or not: leave a factor out
/// of the model's list to pool over it.
pub(crate) fn split_by_replicates(
    model: &Model,
    points: &[Vec<f64>],
    y: &[f64],
    whitener: &Whitener,
    residual: SumOfSquares,
) -> Result<Option<LackOfFit>, DoeError> {
    let groups = replicate_groups(model, points);
    if groups.len() == points.len() {
        return Ok(None);
    }
    let ss = match whitener {
        Whitener::Identity => scatter_about_means(&groups, y, |_| 1.0),
        Whitener::RootWeights(root) => scatter_about_means(&groups, y, |run| root[run].powi(2)),
        Whitener::Lower(_) => scatter_about_cell_model(&groups, y, whitener)?,
    };
    let pure_error = SumOfSquares { ss, df: points.len() - groups.len() };
    let lack_of_fit =
        SumOfSquares { ss: (residual.ss - ss).max(0.0), df: residual.df - pure_error.df };
    let f = match (lack_of_fit.mean_square(), pure_error.mean_square()) {
        (Some(lack), Some(pure)) if pure > 0.0 => Some(lack / pure),
        _ => None,
    };
    let p = f.map(|f| f_upper(f, lack_of_fit.df as f64, pure_error.df as f64));
    Ok(Some(LackOfFit { lack_of_fit, pure_error, f, p }))
}

/// Weighted squares about each group's mean. Values are taken relative to the group's first, so
/// that equal replicates scatter by exactly zero.
fn scatter_about_means(groups: &[Vec<usize>], y: &[f64], weight: impl Fn(usize) -> f64) -> f64 {
    let scatter = |group: &Vec<usize>| {
        let relative = |run: usize| y[run] - y[group[0]];
        let total: f64 = group.iter().map(|&run| weight(run)).sum();
        let mean = group.iter().map(|&run| weight(run) * relative(run)).sum::<f64>() / total;
        group.iter().map(|&run| weight(run) * (relative(run) - mean).powi(2)).sum::<f64>()
    };
    groups.iter().map(scatter).sum()
}

/// Residual squares of the model with one free mean a point, for correlated runs.
fn scatter_about_cell_model(
    groups: &[Vec<usize>],
    y: &[f64],
    whitener: &Whitener,
) -> Result<f64, DoeError> {
    let mut columns = Vec::with_capacity(groups.len());
    let mut relative = y.to_vec();
    for group in groups {
        let mut column = vec![0.0; y.len()];
        for &run in group {
            column[run] = 1.0;
            relative[run] = y[run] - y[group[0]];
        }
        whitener.whiten(&mut column);
        columns.push(column);
    }
    whitener.whiten(&mut relative);
    let names: Vec<String> = (0..groups.len()).map(|g| format!("point {g}")).collect();
    let (_, left) = Factored::new(&columns, &names)?.project(&relative);
    Ok(dot(&left, &left))
}
