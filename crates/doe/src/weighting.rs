//! How far each run is trusted: equal, weighted, or with a full covariance.
//!
//! A covariance S = L L' of the runs' errors is removed by whitening: L^-1 y and L^-1 X have
//! errors of equal variance and no correlation, so that ordinary least squares on them is the
//! generalised least squares of y on X. Weights w are the diagonal case L = diag(w^-1/2).

use faer::{Mat, Side};

use crate::double_double::Double;
use crate::error::DoeError;

/// Relative asymmetry that a covariance may have from rounding.
const SYMMETRY_TOLERANCE: f64 = 1.0e-9;

/// What is known of the runs' errors, up to a common factor that the fit estimates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weighting<'a> {
    /// Equal variances, no correlation.
    Ordinary,
    /// One weight a run, inversely proportional to its variance.
    Weights(&'a [f64]),
    /// Covariance of the runs, n x n values; row-major or column-major, since it is symmetric.
    Covariance(&'a [f64]),
}

/// The factor L of the covariance, ready to be applied.
#[derive(Debug, Clone)]
pub(crate) enum Whitener {
    Identity,
    /// Square roots of the weights: the diagonal of L^-1.
    RootWeights(Vec<f64>),
    /// Rows of the lower triangle L.
    Lower(Vec<Vec<f64>>),
}

impl Whitener {
    pub(crate) fn new(weighting: Weighting<'_>, runs: usize) -> Result<Self, DoeError> {
        match weighting {
            Weighting::Ordinary => Ok(Self::Identity),
            Weighting::Weights(weights) => {
                check_length("weights", runs, weights.len())?;
                for (run, &weight) in weights.iter().enumerate() {
                    if !(weight > 0.0 && weight.is_finite()) {
                        return Err(DoeError::Weight { run, weight });
                    }
                }
                Ok(Self::RootWeights(weights.iter().map(|w| w.sqrt()).collect()))
            }
            Weighting::Covariance(covariance) => {
                check_length("covariance of the runs (n x n)", runs * runs, covariance.len())?;
                cholesky(covariance, runs).map(Self::Lower)
            }
        }
    }

    /// v <- L^-1 v
    pub(crate) fn whiten(&self, v: &mut [f64]) {
        match self {
            Self::Identity => {}
            Self::RootWeights(root) => v.iter_mut().zip(root).for_each(|(v, r)| *v *= r),
            Self::Lower(rows) => {
                for (i, row) in rows.iter().enumerate() {
                    let known: f64 = row[..i].iter().zip(&v[..i]).map(|(l, v)| l * v).sum();
                    v[i] = (v[i] - known) / row[i];
                }
            }
        }
    }

    /// v <- L^-1 v in twice the precision
    pub(crate) fn whiten_precisely(&self, v: &mut [Double]) {
        match self {
            Self::Identity => {}
            Self::RootWeights(root) => v.iter_mut().zip(root).for_each(|(v, r)| *v = *v * *r),
            Self::Lower(rows) => {
                for (i, row) in rows.iter().enumerate() {
                    let known = row[..i].iter().zip(&v[..i]);
                    let rest = known.fold(v[i], |rest, (l, v)| rest - *v * *l);
                    v[i] = rest / row[i];
                }
            }
        }
    }

    /// v <- L v, the inverse of whitening
    pub(crate) fn unwhiten(&self, v: &mut [f64]) {
        match self {
            Self::Identity => {}
            Self::RootWeights(root) => v.iter_mut().zip(root).for_each(|(v, r)| *v /= r),
            Self::Lower(rows) => {
                for (i, row) in rows.iter().enumerate().rev() {
                    v[i] = row[..=i].iter().zip(&v[..=i]).map(|(l, v)| l * v).sum();
                }
            }
        }
    }

    /// v <- L^-T v
    pub(crate) fn whiten_transposed(&self, v: &mut [f64]) {
        match self {
            Self::Identity | Self::RootWeights(_) => self.whiten(v),
            Self::Lower(rows) => {
                for i in (0..rows.len()).rev() {
                    v[i] /= rows[i][i];
                    for j in 0..i {
                        v[j] -= rows[i][j] * v[i];
                    }
                }
            }
        }
    }
}

pub(crate) fn check_length(what: &str, expected: usize, got: usize) -> Result<(), DoeError> {
    if expected == got {
        return Ok(());
    }
    Err(DoeError::Length { what: what.to_string(), expected, got })
}

fn cholesky(covariance: &[f64], n: usize) -> Result<Vec<Vec<f64>>, DoeError> {
    for row in 0..n {
        for column in 0..n {
            let (upper, lower) = (covariance[row * n + column], covariance[column * n + row]);
            if !upper.is_finite() {
                let what = format!("covariance of runs {row} and {column}");
                return Err(DoeError::NotFinite { what, value: upper });
            }
            if (upper - lower).abs() > SYMMETRY_TOLERANCE * upper.abs().max(lower.abs()) {
                return Err(DoeError::AsymmetricCovariance { row, column, upper, lower });
            }
        }
    }
    let matrix = Mat::from_fn(n, n, |i, j| covariance[i * n + j]);
    let llt = matrix.llt(Side::Lower).map_err(|_| DoeError::NotPositiveDefinite { runs: n })?;
    let lower = llt.L();
    let rows: Vec<Vec<f64>> = (0..n).map(|i| (0..=i).map(|j| lower[(i, j)]).collect()).collect();
    // A pivot that rounding alone can make is no variance: the matrix is singular.
    for (i, row) in rows.iter().enumerate() {
        let kept = row[i] * row[i] / covariance[i * n + i];
        if kept.is_nan() || kept <= n as f64 * f64::EPSILON {
            return Err(DoeError::NotPositiveDefinite { runs: n });
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitening_and_its_inverse_cancel() {
        let s = [4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0];
        for weighting in
            [Weighting::Ordinary, Weighting::Weights(&[1.0, 2.0, 0.5]), Weighting::Covariance(&s)]
        {
            let w = Whitener::new(weighting, 3).unwrap();
            let (start, mut v) = ([1.0, -2.0, 3.0], [1.0, -2.0, 3.0]);
            w.whiten(&mut v);
            w.unwhiten(&mut v);
            for (a, b) in v.iter().zip(start) {
                // Two triangular solves of order 3.
                assert!((a - b).abs() < 1.0e-14);
            }
        }
    }

    #[test]
    fn the_transposed_solve_completes_the_inverse_covariance() {
        // L^-T L^-1 S v = v
        let s = [4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0];
        let w = Whitener::new(Weighting::Covariance(&s), 3).unwrap();
        let v = [0.3, -1.0, 2.0];
        let mut u = [0, 1, 2].map(|i| (0..3).map(|j| s[3 * i + j] * v[j]).sum::<f64>());
        w.whiten(&mut u);
        w.whiten_transposed(&mut u);
        for (a, b) in u.iter().zip(v) {
            assert!((a - b).abs() < 1.0e-14);
        }
    }

    #[test]
    fn what_is_no_covariance_is_refused() {
        let indefinite = [1.0, 2.0, 2.0, 1.0];
        let singular = [1.0, 1.0, 1.0, 1.0];
        for s in [&indefinite, &singular] {
            assert_eq!(
                Whitener::new(Weighting::Covariance(s), 2).unwrap_err(),
                DoeError::NotPositiveDefinite { runs: 2 }
            );
        }
        let skew = [1.0, 0.2, 0.3, 1.0];
        assert!(matches!(
            Whitener::new(Weighting::Covariance(&skew), 2),
            Err(DoeError::AsymmetricCovariance { row: 0, column: 1, .. })
        ));
        assert!(matches!(
            Whitener::new(Weighting::Weights(&[1.0, -1.0]), 2),
            Err(DoeError::Weight { run: 1, .. })
        ));
        assert!(matches!(
            Whitener::new(Weighting::Weights(&[1.0]), 2),
            Err(DoeError::Length { expected: 2, got: 1, .. })
        ));
    }
}
