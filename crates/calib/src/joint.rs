//! Matching over several configurations that share a parameter.
//!
//! Beads turned on two walls and at two fills are the same beads: their sliding friction is one
//! number. Each configuration keeps its own other parameters and nuisances, so that the joint
//! deviance is a sum of profiles over the shared value.

use crate::grid::{Grid, crossings, refine};
use crate::matching::LEVEL;
use crate::{CalibError, Goodness, Marginal, Problem, Residual, upper_quantile};

/// One configuration of a joint match.
pub struct JointMember<'s> {
    /// Name of the configuration.
    pub name: String,
    /// Its problem; the shared parameter is one of its free ones.
    pub problem: Problem<'s>,
}

/// One configuration at the joint optimum.
#[derive(Debug, Clone, PartialEq)]
pub struct Tied {
    /// Name of the configuration.
    pub name: String,
    /// All its free parameters at the joint optimum.
    pub theta: Vec<f64>,
    /// Chi-square there.
    pub chi2: f64,
    /// Observations.
    pub observations: usize,
    /// Most likely shared value for this configuration alone.
    pub alone: f64,
    /// Deviance that the tie costs this configuration: above 4, it disagrees with the others.
    pub strain: f64,
    /// Residuals at the joint optimum.
    pub residuals: Vec<Residual>,
}

/// A joint match.
#[derive(Debug, Clone, PartialEq)]
pub struct JointMatch {
    /// Path of the shared parameter.
    pub name: String,
    /// Most likely shared value.
    pub value: f64,
    /// Lower end of its 95 % profile interval, widened by the Birge ratio.
    pub lo: Option<f64>,
    /// Upper end.
    pub hi: Option<f64>,
    /// Marginal posterior of the shared value.
    pub marginal: Marginal,
    /// Goodness over all configurations.
    pub goodness: Goodness,
    /// Whether one value serves all: extra deviance of the tie, over the factor by which the fit
    /// misses its errors anyway, against chi-square with configurations less one.
    pub tie: Goodness,
    /// The configurations.
    pub members: Vec<Tied>,
}

/// A configuration predicted from the others.
#[derive(Debug, Clone, PartialEq)]
pub struct WithheldPrediction {
    /// The configuration that was not fitted.
    pub name: String,
    /// The shared value fitted on the others.
    pub value: f64,
    /// Interval of that value.
    pub interval: (Option<f64>, Option<f64>),
    /// Chi-square of the withheld data at that value, their own other parameters profiled.
    pub goodness: Goodness,
    /// Chi-square of the withheld data at their own best value.
    pub own: Goodness,
    /// Their own best value.
    pub own_value: f64,
    /// Residuals of the prediction.
    pub residuals: Vec<Residual>,
}

struct Profiled {
    axis: usize,
    grid: Grid,
    profile: Vec<f64>,
}

impl JointMatch {
    /// Match all `members` with one value of the parameter `name`.
    ///
    /// # Errors
    /// [`CalibError::NothingShared`] if a member does not have the parameter free in the same
    /// range; otherwise as [`Problem::solve`].
    pub fn solve(name: &str, members: &[JointMember<'_>]) -> Result<Self, CalibError> {
        let all: Vec<&JointMember<'_>> = members.iter().collect();
        solve(name, &all)
    }

    /// Leave each member out in turn, fit the others and predict it.
    ///
    /// # Errors
    /// As [`JointMatch::solve`].
    pub fn withhold_each(
        name: &str,
        members: &[JointMember<'_>],
    ) -> Result<Vec<WithheldPrediction>, CalibError> {
        let mut predictions = Vec::new();
        for (k, withheld) in members.iter().enumerate() {
            let others: Vec<&JointMember<'_>> =
                members.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, m)| m).collect();
            let fitted = solve(name, &others)?;
            let problem = &withheld.problem;
            let (axis, _) = shared_axis(name, std::slice::from_ref(&withheld))?;
            let own = problem.solve(0, 0)?;
            let (theta, at) = at_shared(problem, axis[0], fitted.value)?;
            let n = problem.observations.items.len();
            predictions.push(WithheldPrediction {
                name: withheld.name.clone(),
                value: fitted.value,
                interval: (fitted.lo, fitted.hi),
                // The shared value is not fitted here: one degree of freedom more.
                goodness: Goodness::new(at, n + 1 - theta.len()),
                own: own.goodness,
                own_value: own.estimates[axis[0]].value,
                residuals: problem.residuals_at(&theta)?,
            });
        }
        Ok(predictions)
    }
}

/// Place of the shared parameter in each member, and its range.
fn shared_axis(
    name: &str,
    members: &[&JointMember<'_>],
) -> Result<(Vec<usize>, (f64, f64)), CalibError> {
    let mut axes = Vec::new();
    let mut range = None;
    for m in members {
        let axis = m.problem.free.iter().position(|f| f.name == name);
        let axis = axis.ok_or(CalibError::NothingShared)?;
        let here = m.problem.free[axis].range;
        if *range.get_or_insert(here) != here {
            return Err(CalibError::NothingShared);
        }
        axes.push(axis);
    }
    Ok((axes, range.ok_or(CalibError::NothingShared)?))
}

/// Best parameters and chi-square with the shared one held at `value`.
fn at_shared(
    problem: &Problem<'_>,
    axis: usize,
    value: f64,
) -> Result<(Vec<f64>, f64), CalibError> {
    let mut start: Vec<f64> = problem.free.iter().map(|f| 0.5 * (f.range.0 + f.range.1)).collect();
    start[axis] = value;
    let steps: Vec<f64> = problem.free.iter().map(|f| 0.25 * (f.range.1 - f.range.0)).collect();
    let (theta, at) = refine(problem, start, &steps, Some(axis))?;
    Ok((theta, at.chi2()))
}

fn solve(name: &str, members: &[&JointMember<'_>]) -> Result<JointMatch, CalibError> {
    let (axes, _) = shared_axis(name, members)?;
    let mut profiled = Vec::new();
    for (m, axis) in members.iter().zip(axes) {
        m.problem.check()?;
        let grid = Grid::new(&m.problem)?;
        let profile = grid.profile(axis);
        profiled.push(Profiled { axis, grid, profile });
    }
    // The finest common axis: members with more free parameters have coarser ones.
    let values = profiled
        .iter()
        .map(|p| &p.grid.axes[p.axis])
        .min_by_key(|a| a.len())
        .ok_or(CalibError::NothingShared)?
        .clone();
    let on_values: Vec<Vec<f64>> = profiled
        .iter()
        .map(|p| values.iter().map(|v| interpolate(&p.grid.axes[p.axis], &p.profile, *v)).collect())
        .collect();
    let sum: Vec<f64> = (0..values.len()).map(|i| on_values.iter().map(|p| p[i]).sum()).collect();
    let (value, lowest) = vertex(&values, &sum);
    let mut tied = Vec::new();
    let (mut chi2, mut observations, mut free, mut strain) = (0.0, 0, 1, 0.0);
    for ((m, p), profile) in members.iter().zip(&profiled).zip(&on_values) {
        let (theta, own) = at_shared(&m.problem, p.axis, value)?;
        let (alone, best) = vertex(&values, profile);
        let here = interpolate(&values, profile, value) - best;
        chi2 += own;
        strain += here.max(0.0);
        observations += m.problem.observations.items.len();
        free += m.problem.free.len() - 1;
        tied.push(Tied {
            name: m.name.clone(),
            residuals: m.problem.residuals_at(&theta)?,
            theta,
            chi2: own,
            observations: m.problem.observations.items.len(),
            alone,
            strain: here.max(0.0),
        });
    }
    let goodness = Goodness::new(chi2, observations.saturating_sub(free));
    let inflation = goodness.inflation();
    let level = lowest + upper_quantile(LEVEL) * inflation;
    let (lo, hi) = crossings(&values, &sum, (value, lowest), level);
    let log: Vec<f64> = (0..values.len())
        .map(|i| {
            profiled
                .iter()
                .map(|p| {
                    let marginal = p.grid.log_marginal(p.axis, inflation);
                    interpolate(&p.grid.axes[p.axis], &marginal, values[i])
                })
                .sum()
        })
        .collect();
    Ok(JointMatch {
        name: name.to_owned(),
        value,
        lo,
        hi,
        marginal: Marginal::from_log(&values, &log),
        goodness,
        tie: Goodness::new(strain / inflation, members.len() - 1),
        members: tied,
    })
}

/// Linear interpolation on an ascending axis.
fn interpolate(axis: &[f64], values: &[f64], at: f64) -> f64 {
    let i = axis.partition_point(|a| *a < at).clamp(1, axis.len() - 1);
    let t = ((at - axis[i - 1]) / (axis[i] - axis[i - 1])).clamp(0.0, 1.0);
    values[i - 1] + t * (values[i] - values[i - 1])
}

/// Lowest point of sampled values, by the parabola through the lowest three.
fn vertex(axis: &[f64], values: &[f64]) -> (f64, f64) {
    let best = (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0);
    if best == 0 || best + 1 == values.len() {
        return (axis[best], values[best]);
    }
    let (a, b, c) = (values[best - 1], values[best], values[best + 1]);
    let bend = a - 2.0 * b + c;
    if !(bend > 0.0) {
        return (axis[best], b);
    }
    let t = 0.5 * (a - c) / bend;
    let step = axis[best + 1] - axis[best];
    (axis[best] + t * step, b - 0.25 * (a - c) * t)
}
