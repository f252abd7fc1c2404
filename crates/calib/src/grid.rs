//! The likelihood on a grid of the free parameters: profiles, marginals, refinement.

use crate::problem::{Evaluation, Problem};
use crate::{CalibError, FreeParameter};

/// Most free parameters that a grid holds.
pub(crate) const MOST_FREE: usize = 3;

/// Points along the first, second and third axis for 1, 2 and 3 free parameters.
const POINTS: [&[usize]; MOST_FREE] = [&[161], &[81, 21], &[41, 15, 15]];

/// Deviance (minus twice the log likelihood) on a grid.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    /// Values along each axis.
    pub(crate) axes: Vec<Vec<f64>>,
    /// Deviance, last axis fastest.
    pub(crate) deviance: Vec<f64>,
    /// The model's means at each point.
    pub(crate) model: Vec<Vec<f64>>,
}

/// Marginal posterior of one parameter (uniform prior over its range).
#[derive(Debug, Clone, PartialEq)]
pub struct Marginal {
    /// Values.
    pub values: Vec<f64>,
    /// Density at each value, integrating to 1.
    pub density: Vec<f64>,
    /// Posterior mean.
    pub mean: f64,
    /// Shortest interval of whole grid steps that holds 95 %.
    pub interval: (f64, f64),
}

impl Grid {
    pub(crate) fn new(problem: &Problem<'_>) -> Result<Self, CalibError> {
        let free = &problem.free;
        let points = POINTS
            .get(free.len().wrapping_sub(1))
            .ok_or(CalibError::TooManyFree { count: free.len(), most: MOST_FREE })?;
        let axes: Vec<Vec<f64>> = free.iter().zip(*points).map(|(f, n)| axis(f, *n)).collect();
        let size = axes.iter().map(Vec::len).product();
        let mut grid = Self { axes, deviance: Vec::with_capacity(size), model: Vec::new() };
        for k in 0..size {
            let at = problem.evaluate(&grid.point(k))?;
            grid.deviance.push(at.deviance());
            grid.model.push(at.model);
        }
        Ok(grid)
    }

    /// Parameters of point `k`.
    pub(crate) fn point(&self, mut k: usize) -> Vec<f64> {
        let mut theta = vec![0.0; self.axes.len()];
        for (value, axis) in theta.iter_mut().zip(&self.axes).rev() {
            *value = axis[k % axis.len()];
            k /= axis.len();
        }
        theta
    }

    fn index_along(&self, k: usize, axis: usize) -> usize {
        let stride: usize = self.axes[axis + 1..].iter().map(Vec::len).product();
        (k / stride) % self.axes[axis].len()
    }

    pub(crate) fn best(&self) -> usize {
        (0..self.deviance.len())
            .min_by(|a, b| self.deviance[*a].total_cmp(&self.deviance[*b]))
            .unwrap_or(0)
    }

    /// Lowest deviance for each value along `axis`.
    pub(crate) fn profile(&self, axis: usize) -> Vec<f64> {
        let mut profile = vec![f64::INFINITY; self.axes[axis].len()];
        for (k, d) in self.deviance.iter().enumerate() {
            let i = self.index_along(k, axis);
            profile[i] = profile[i].min(*d);
        }
        profile
    }

    /// `ln` of the likelihood summed over the other axes, for each value along `axis`; the
    /// deviance is divided by `scale`.
    pub(crate) fn log_marginal(&self, axis: usize, scale: f64) -> Vec<f64> {
        let lowest = self.deviance[self.best()];
        let mut sum = vec![0.0; self.axes[axis].len()];
        for (k, d) in self.deviance.iter().enumerate() {
            sum[self.index_along(k, axis)] += (-0.5 * (d - lowest) / scale).exp();
        }
        sum.iter().map(|s| s.ln()).collect()
    }
}

fn axis(free: &FreeParameter, points: usize) -> Vec<f64> {
    let (low, high) = free.range;
    (0..points).map(|i| low + (high - low) * i as f64 / (points - 1) as f64).collect()
}

impl Marginal {
    pub(crate) fn from_log(values: &[f64], log_density: &[f64]) -> Self {
        let top = log_density.iter().copied().fold(f64::MIN, f64::max);
        let mut density: Vec<f64> = log_density.iter().map(|l| (l - top).exp()).collect();
        let step = (values[values.len() - 1] - values[0]) / (values.len() - 1) as f64;
        let area: f64 = density.windows(2).map(|w| 0.5 * (w[0] + w[1]) * step).sum();
        density.iter_mut().for_each(|d| *d /= area);
        let total: f64 = density.iter().sum();
        let mean = values.iter().zip(&density).map(|(v, d)| v * d).sum::<f64>() / total;
        // Shortest window of grid values that holds 95 % of the mass; of equal ones the fullest.
        let mut best = (values.len(), 0.0, 0, values.len() - 1);
        let (mut mass, mut first) = (0.0, 0);
        for last in 0..values.len() {
            mass += density[last];
            while first < last && mass - density[first] >= 0.95 * total {
                mass -= density[first];
                first += 1;
            }
            let length = last - first;
            let better = length < best.0 || (length == best.0 && mass > best.1);
            if mass >= 0.95 * total && better {
                best = (length, mass, first, last);
            }
        }
        let interval = (values[best.2], values[best.3]);
        Self { values: values.to_vec(), density, mean, interval }
    }
}

/// Follow the deviance down from `start` by a pattern search whose steps halve, within the
/// ranges; axes in `fixed` keep their value.
pub(crate) fn refine(
    problem: &Problem<'_>,
    start: Vec<f64>,
    steps: &[f64],
    fixed: Option<usize>,
) -> Result<(Vec<f64>, Evaluation), CalibError> {
    let mut best = problem.evaluate(&start)?;
    let mut theta = start;
    let mut steps = steps.to_vec();
    for _ in 0..14 {
        let mut improved = true;
        while improved {
            improved = false;
            for axis in (0..theta.len()).filter(|a| Some(*a) != fixed) {
                for sign in [-1.0, 1.0] {
                    let (low, high) = problem.free[axis].range;
                    let mut trial = theta.clone();
                    trial[axis] = (trial[axis] + sign * steps[axis]).clamp(low, high);
                    if trial[axis] == theta[axis] {
                        continue;
                    }
                    let at = problem.evaluate(&trial)?;
                    if at.deviance() < best.deviance() - 1e-12 {
                        (theta, best, improved) = (trial, at, true);
                    }
                }
            }
        }
        steps.iter_mut().for_each(|s| *s *= 0.5);
    }
    Ok((theta, best))
}

/// Where a profile first exceeds `level` on either side of its lowest value, by linear
/// interpolation; `None` where it never does.
pub(crate) fn crossings(
    values: &[f64],
    profile: &[f64],
    best: (f64, f64),
    level: f64,
) -> (Option<f64>, Option<f64>) {
    let cross = |inside: (f64, f64), outside: (f64, f64)| {
        let t = (level - inside.1) / (outside.1 - inside.1);
        inside.0 + t * (outside.0 - inside.0)
    };
    let mut low = None;
    let mut inside = best;
    for i in (0..values.len()).rev().filter(|i| values[*i] < best.0) {
        let here = (values[i], profile[i]);
        if here.1 > level {
            low = Some(cross(inside, here));
            break;
        }
        inside = here;
    }
    let mut high = None;
    let mut inside = best;
    for i in (0..values.len()).filter(|i| values[*i] > best.0) {
        let here = (values[i], profile[i]);
        if here.1 > level {
            high = Some(cross(inside, here));
            break;
        }
        inside = here;
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_of_a_parabola_lie_where_algebra_says() {
        let values: Vec<f64> = (0..=100).map(|i| f64::from(i) / 100.0).collect();
        let profile: Vec<f64> = values.iter().map(|v| (v - 0.3) * (v - 0.3) * 400.0).collect();
        let (low, high) = crossings(&values, &profile, (0.3, 0.0), 4.0);
        // 400 d^2 = 4 at d = 0.1; a linear step over 0.01 is off by at most 1e-3.
        assert!((low.expect("is bounded") - 0.2).abs() < 1e-3);
        assert!((high.expect("is bounded") - 0.4).abs() < 1e-3);
        let (low, _) = crossings(&values, &profile, (0.3, 0.0), 40.0);
        assert_eq!(low, None);
    }

    #[test]
    fn a_normal_marginal_has_its_mean_and_interval() {
        let values: Vec<f64> = (0..=200).map(|i| f64::from(i) / 200.0).collect();
        let log: Vec<f64> = values.iter().map(|v| -0.5 * ((v - 0.5) / 0.05).powi(2)).collect();
        let m = Marginal::from_log(&values, &log);
        assert!((m.mean - 0.5).abs() < 1e-9);
        // +-1.96 sd = 0.402 to 0.598, to within a grid step of 0.005 on either side.
        assert!(
            (m.interval.0 - 0.402).abs() < 0.006 && (m.interval.1 - 0.598).abs() < 0.006,
            "{:?}",
            m.interval
        );
    }
}
