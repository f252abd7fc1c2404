//! Dense covariances: factor, whiten, determinant.

use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, Par, Side};

use crate::CalibError;

/// A covariance S = L L' with its factor.
#[derive(Debug, Clone)]
pub(crate) struct Factored {
    lower: Mat<f64>,
    /// Natural logarithm of the determinant of S.
    pub(crate) log_det: f64,
}

impl Factored {
    /// Factor the symmetric matrix of `size` rows whose lower triangle is `entry(i, j)`, i >= j.
    pub(crate) fn new(
        what: &'static str,
        size: usize,
        entry: impl Fn(usize, usize) -> f64,
    ) -> Result<Self, CalibError> {
        let matrix =
            Mat::from_fn(size, size, |i, j| if i >= j { entry(i, j) } else { entry(j, i) });
        let fault = CalibError::Covariance { what, size };
        if (0..size).any(|i| !matrix[(i, i)].is_finite()) {
            return Err(fault);
        }
        let llt = matrix.llt(Side::Lower).map_err(|_| fault)?;
        let lower = llt.L().to_owned();
        let log_det = 2.0 * (0..size).map(|i| lower[(i, i)].ln()).sum::<f64>();
        Ok(Self { lower, log_det })
    }

    /// L, row-major, zeros above the diagonal.
    pub(crate) fn lower(&self) -> Vec<f64> {
        let n = self.lower.nrows();
        let at = |k: usize| if k % n <= k / n { self.lower[(k / n, k % n)] } else { 0.0 };
        (0..n * n).map(at).collect()
    }

    /// `L^-1 v`: a vector whose elements have unit variance and no correlation.
    pub(crate) fn whiten(&self, v: &[f64]) -> Vec<f64> {
        let mut rhs = Mat::from_fn(v.len(), 1, |i, _| v[i]);
        solve_lower_triangular_in_place(self.lower.as_ref(), rhs.as_mut(), Par::Seq);
        (0..v.len()).map(|i| rhs[(i, 0)]).collect()
    }
}

/// Sum of squares.
pub(crate) fn square(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whitening_gives_the_quadratic_form_and_the_determinant() {
        let s = [[4.0, 1.0], [1.0, 3.0]];
        let f = Factored::new("test", 2, |i, j| s[i][j]).expect("is positive definite");
        assert!((f.log_det - 11f64.ln()).abs() < 1e-14);
        // r' S^-1 r for r = (1, 2): (3 - 4 + 16) / 11.
        assert!((square(&f.whiten(&[1.0, 2.0])) - 15.0 / 11.0).abs() < 1e-14);
    }

    #[test]
    fn an_impossible_correlation_is_refused() {
        assert!(Factored::new("test", 2, |i, j| if i == j { 1.0 } else { 1.5 }).is_err());
        assert!(Factored::new("test", 1, |_, _| f64::NAN).is_err());
    }
}
