//! Smoothing by cubic B-splines with a penalty on bending, robust against outliers.
//!
//! P-splines (P. H. C. Eilers, B. D. Marx, Stat. Sci. 11 (1996) 89): equally spaced cubic B-splines, squared second
//! differences of their coefficients times `lambda`; `lambda` by generalised cross-validation over a
//! grid of powers of ten; outliers by biweights (Tukey, c = 4.685). Ends that bend strongly are loosened.

mod ends;

use crate::linear::{Banded, BandedFactor};
use ends::Task;

/// A cubic spline over an interval, continued linearly beyond its ends.
#[derive(Clone, Debug)]
pub struct Spline {
    from: f64,
    piece: f64,
    coefficients: Vec<f64>,
}

/// A smoothed curve with what was left over.
#[derive(Clone, Debug)]
pub struct Smoothed {
    /// The curve.
    pub spline: Spline,
    /// Weight of each point, 0 for an outlier, at most 1.
    pub weights: Vec<f64>,
    /// Data less curve.
    pub residuals: Vec<f64>,
    /// Robust scatter of the residuals.
    pub scatter: f64,
    /// What a looser curve would add at the left and at the right end (in full, whether or not the curve was loosened there).
    pub turns: [Spline; 2],
}

impl Spline {
    fn locate(&self, x: f64) -> (usize, [f64; 4]) {
        let pieces = self.coefficients.len() - 3;
        let t = ((x - self.from) / self.piece).clamp(0.0, pieces as f64);
        let k = (t as usize).min(pieces - 1);
        let t = t - k as f64;
        let s = 1.0 - t;
        let basis = [
            s * s * s / 6.0,
            (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
            (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
            t * t * t / 6.0,
        ];
        (k, basis)
    }

    /// First and last abscissa.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        (self.from, self.from + self.piece * (self.coefficients.len() - 3) as f64)
    }

    /// Value; beyond the range the tangent at the end goes on.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        let (lo, hi) = self.range();
        let inside = x.clamp(lo, hi);
        let (k, basis) = self.locate(inside);
        let value: f64 = (0..4).map(|d| basis[d] * self.coefficients[k + d]).sum();
        value + if inside == x { 0.0 } else { (x - inside) * self.slope(inside) }
    }

    /// First derivative within the range; beyond it that of the nearer end.
    #[must_use]
    pub fn slope(&self, x: f64) -> f64 {
        let (lo, hi) = self.range();
        let pieces = self.coefficients.len() - 3;
        let t = (x.clamp(lo, hi) - lo) / self.piece;
        let k = (t as usize).min(pieces - 1);
        let t = t - k as f64;
        let s = 1.0 - t;
        let d = [
            -0.5 * s * s,
            0.5 * (3.0 * t * t - 4.0 * t),
            0.5 * (1.0 + 2.0 * t - 3.0 * t * t),
            0.5 * t * t,
        ];
        (0..4).map(|j| d[j] * self.coefficients[k + j]).sum::<f64>() / self.piece
    }
}

/// Smooths points sorted by `x` with `pieces` cubic pieces; `None` when they are too few or all at one place.
#[must_use]
pub fn smooth(x: &[f64], y: &[f64], pieces: usize) -> Option<Smoothed> {
    smooth_weighted(x, y, &vec![true; x.len()], pieces)
}

/// The same with some points left out from the start (`accepted` false): they get weight 0.
#[must_use]
pub fn smooth_weighted(x: &[f64], y: &[f64], accepted: &[bool], pieces: usize) -> Option<Smoothed> {
    let (n, blank, rows) = basis_rows(x, y, pieces)?;
    let size = blank.coefficients.len();
    let weights: Vec<f64> = accepted.iter().map(|&a| f64::from(u8::from(a))).collect();
    if weights.iter().sum::<f64>() < 8.0 {
        return None;
    }
    let mut task = Task {
        rows: &rows,
        y,
        accepted,
        spline: blank,
        weights,
        residuals: vec![0.0; n],
        scatter: 0.0,
    };
    let mut lambda = None;
    for round in 0..8 {
        // The smoothness is chosen twice: at first, and when outliers have lost their weight.
        if round == 0 || round == 4 {
            lambda = choose_lambda(&rows, y, &task.weights, size);
        }
        task.step(Stiffness::even(lambda?), false)?;
    }
    let turns = ends::loosen(&mut task, lambda?)?;
    let Task { spline, weights, residuals, scatter, .. } = task;
    Some(Smoothed { spline, weights, residuals, scatter, turns })
}

/// Which points lie near a stiff curve of few pieces that minimises the sum of moduli of the residuals.
///
/// A bump that covers up to a quarter of the range does not pull such a curve. Points farther from it than
/// 5 robust standard deviations and than `least` are left out; where that would be more than `share` of them,
/// the data have no such curve and every point is kept.
#[must_use]
pub fn near_stiff_curve(x: &[f64], y: &[f64], pieces: usize, least: f64, share: f64) -> Vec<bool> {
    let keep_all = vec![true; x.len()];
    let Some((n, mut spline, rows)) = basis_rows(x, y, pieces) else {
        return keep_all;
    };
    let size = spline.coefficients.len();
    let mut weights = vec![1.0; n];
    let mut residuals = vec![0.0; n];
    let mut scatter = 0.0;
    for _ in 0..40 {
        let stiffness = Stiffness::even(1e-4 * weights.iter().sum::<f64>() / size as f64);
        let Some(c) = fit(&rows, y, &weights, size, stiffness) else {
            return keep_all;
        };
        spline.coefficients = c;
        scatter = fill_residuals(&rows, y, &spline, &[], &mut residuals);
        let floor = (0.2 * scatter).max(1e-3);
        for (w, r) in weights.iter_mut().zip(&residuals) {
            *w = 1.0 / r.abs().max(floor);
        }
    }
    let limit = (5.0 * scatter).max(least);
    let near: Vec<bool> = residuals.iter().map(|r| r.abs() <= limit).collect();
    let dropped = near.iter().filter(|&&k| !k).count();
    if dropped as f64 > share * n as f64 { keep_all } else { near }
}

type Rows = Vec<(usize, [f64; 4])>;

fn basis_rows(x: &[f64], y: &[f64], pieces: usize) -> Option<(usize, Spline, Rows)> {
    let n = x.len();
    if n < 8 || n != y.len() {
        return None;
    }
    let (from, to) = (x[0], x[n - 1]);
    if to - from <= 0.0 || !(to - from).is_finite() {
        return None;
    }
    let pieces = pieces.clamp(2, (n / 3).max(2));
    let piece = (to - from) / pieces as f64;
    let blank = Spline { from, piece, coefficients: vec![0.0; pieces + 3] };
    let rows = x.iter().map(|&v| blank.locate(v)).collect();
    Some((n, blank, rows))
}

/// Residuals of all points; returns the robust scatter of those with weight (of all when no weights are given).
fn fill_residuals(
    rows: &[(usize, [f64; 4])],
    y: &[f64],
    spline: &Spline,
    weights: &[f64],
    residuals: &mut [f64],
) -> f64 {
    for ((r, (k, basis)), v) in residuals.iter_mut().zip(rows).zip(y) {
        *r = v - (0..4).map(|d| basis[d] * spline.coefficients[k + d]).sum::<f64>();
    }
    let held: Vec<f64> =
        residuals.iter().zip(weights).filter(|(_, w)| **w > 0.0).map(|(r, _)| *r).collect();
    let used = if held.len() >= 8 { &held } else { &*residuals };
    1.4826 * crate::drum::circle_fit::median_modulus(used)
}

/// Penalty on bending: `lambda`, times a factor at either end.
#[derive(Clone, Copy, Debug)]
struct Stiffness {
    lambda: f64,
    ends: [f64; 2],
}

impl Stiffness {
    fn even(lambda: f64) -> Self {
        Self { lambda, ends: [1.0; 2] }
    }
}

/// What weighted points ask for: the normal equations without any penalty.
struct Normal {
    matrix: Banded,
    right: Vec<f64>,
}

impl Normal {
    fn of(rows: &[(usize, [f64; 4])], y: &[f64], weights: &[f64], size: usize) -> Self {
        let mut matrix = Banded::zeros(size);
        let mut right = vec![0.0; size];
        for (((k, basis), &v), &w) in rows.iter().zip(y).zip(weights) {
            for i in 0..4 {
                right[k + i] += w * basis[i] * v;
                for j in 0..=i {
                    matrix.add(k + i, k + j, w * basis[i] * basis[j]);
                }
            }
        }
        Self { matrix, right }
    }

    /// Coefficients under a penalty, and the factor of the matrix with it.
    fn solve(&self, stiffness: Stiffness) -> Option<(Vec<f64>, BandedFactor)> {
        let size = self.right.len();
        let mut a = self.matrix.clone();
        for k in 0..size - 2 {
            let d = [1.0, -2.0, 1.0];
            let lambda = stiffness.lambda * ends::looseness(stiffness.ends, k, size - 2);
            for i in 0..3 {
                for j in 0..=i {
                    a.add(k + i, k + j, lambda * d[i] * d[j]);
                }
            }
        }
        for k in 0..size {
            a.add(k, k, 1e-9);
        }
        let factor = a.factor()?;
        let mut c = self.right.clone();
        factor.solve(&mut c);
        Some((c, factor))
    }

    /// Degrees of freedom: the trace of `A^-1 B^T W B`, column by column.
    fn freedom(&self, factor: &BandedFactor) -> f64 {
        let size = self.right.len();
        let mut column = vec![0.0; size];
        (0..size)
            .map(|c| {
                column.iter_mut().enumerate().for_each(|(r, v)| *v = self.matrix.at(r, c));
                factor.solve(&mut column);
                column[c]
            })
            .sum()
    }
}

fn fit(
    rows: &[(usize, [f64; 4])],
    y: &[f64],
    weights: &[f64],
    size: usize,
    stiffness: Stiffness,
) -> Option<Vec<f64>> {
    Some(Normal::of(rows, y, weights, size).solve(stiffness)?.0)
}

fn choose_lambda(
    rows: &[(usize, [f64; 4])],
    y: &[f64],
    weights: &[f64],
    size: usize,
) -> Option<f64> {
    let n: f64 = weights.iter().sum();
    let normal = Normal::of(rows, y, weights, size);
    let mut best: Option<(f64, f64)> = None;
    for power in -2..=5 {
        let lambda = 10f64.powi(power) * n / size as f64 * 0.1;
        let (c, factor) = normal.solve(Stiffness::even(lambda))?;
        let mut misfit = 0.0;
        for (((k, basis), &v), &w) in rows.iter().zip(y).zip(weights) {
            let r = v - (0..4).map(|d| basis[d] * c[k + d]).sum::<f64>();
            misfit += w * r * r;
        }
        let gcv = misfit / (n - normal.freedom(&factor)).max(1.0).powi(2);
        if best.is_none_or(|(g, _)| gcv < g) {
            best = Some((gcv, lambda));
        }
    }
    best.map(|b| b.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_with_spots_comes_back() {
        let x: Vec<f64> = (0..200).map(f64::from).collect();
        let truth = |x: f64| 3.0 + 0.2 * x - 2e-3 * x * x + 5e-6 * x * x * x;
        let y: Vec<f64> = x
            .iter()
            .map(|&v| truth(v) + if (60.0..75.0).contains(&v) { 12.0 } else { 0.0 })
            .collect();
        let s = smooth(&x, &y, 20).unwrap();
        // The spot carries no weight; what is left is the penalty's pull on a curve without noise.
        for &v in &[5.0, 65.0, 120.0, 198.0] {
            assert!((s.spline.value(v) - truth(v)).abs() < 0.05, "{v}: {}", s.spline.value(v));
        }
        let h = 1e-4;
        let slope = (s.spline.value(40.0 + h) - s.spline.value(40.0 - h)) / (2.0 * h);
        assert!((s.spline.slope(40.0) - slope).abs() < 1e-6);
    }

    #[test]
    fn an_end_that_levels_off_is_followed() {
        // A straight rise of 1 that levels off within the last tenth, with a ripple of 0.1: a bend of 45 deg.
        let x: Vec<f64> = (0..600).map(f64::from).collect();
        let truth = |x: f64| if x < 540.0 { x } else { x - (x - 540.0).powi(2) / 120.0 };
        let y: Vec<f64> = x.iter().map(|&v| truth(v) + 0.1 * (2.1 * v).sin()).collect();
        let s = smooth(&x, &y, 20).unwrap();
        let error = |v: f64| s.spline.value(v) - truth(v);
        assert!(error(599.0).abs() < 0.4, "{}", error(599.0));
        assert!(error(300.0).abs() < 0.1 && error(0.0).abs() < 0.1);
        // The straight end needs no turn.
        assert!(s.turns[0].value(0.0).abs() < 0.1, "{}", s.turns[0].value(0.0));
    }
}
