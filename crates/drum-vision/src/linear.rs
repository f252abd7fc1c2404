//! Small symmetric linear systems.

/// Solves `A x = b` for a symmetric positive definite `A` by Cholesky's factors; `None` when it is not.
#[must_use]
pub(crate) fn solve_normal<const N: usize>(a: &[[f64; N]; N], b: &[f64; N]) -> Option<[f64; N]> {
    let mut l = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..=i {
            let products: f64 = l[i][..j].iter().zip(&l[j][..j]).map(|(p, q)| p * q).sum();
            let s = a[i][j] - products;
            if i == j {
                if !s.is_finite() || s <= 1e-12 * a[i][i].abs() {
                    return None;
                }
                l[i][i] = s.sqrt();
            } else {
                l[i][j] = s / l[j][j];
            }
        }
    }
    let mut x = *b;
    for i in 0..N {
        for k in 0..i {
            x[i] -= l[i][k] * x[k];
        }
        x[i] /= l[i][i];
    }
    for i in (0..N).rev() {
        for k in i + 1..N {
            x[i] -= l[k][i] * x[k];
        }
        x[i] /= l[i][i];
    }
    Some(x)
}

/// A banded symmetric positive definite matrix, lower band stored by rows: `band[i][d]` is entry `(i, i - d)`.
#[derive(Clone, Debug)]
pub(crate) struct Banded {
    width: usize,
    rows: Vec<Vec<f64>>,
}

impl Banded {
    /// A zero matrix of `n` rows with `width` sub-diagonals.
    pub(crate) fn zeros(n: usize, width: usize) -> Self {
        Self { width, rows: vec![vec![0.0; width + 1]; n] }
    }

    /// Adds to entry `(i, j)` of the lower triangle, `i >= j`.
    pub(crate) fn add(&mut self, i: usize, j: usize, v: f64) {
        self.rows[i][i - j] += v;
    }

    /// Replaces the matrix by its Cholesky factor; `None` when it is not positive definite.
    pub(crate) fn factor(mut self) -> Option<BandedFactor> {
        for i in 0..self.rows.len() {
            for j in i.saturating_sub(self.width)..=i {
                let mut s = self.rows[i][i - j];
                for k in i.saturating_sub(self.width).max(j.saturating_sub(self.width))..j {
                    s -= self.rows[i][i - k] * self.rows[j][j - k];
                }
                if i == j {
                    if !s.is_finite() || s <= 0.0 {
                        return None;
                    }
                    self.rows[i][0] = s.sqrt();
                } else {
                    self.rows[i][i - j] = s / self.rows[j][0];
                }
            }
        }
        Some(BandedFactor { width: self.width, rows: self.rows })
    }
}

/// The Cholesky factor of a [`Banded`] matrix.
#[derive(Clone, Debug)]
pub(crate) struct BandedFactor {
    width: usize,
    rows: Vec<Vec<f64>>,
}

impl BandedFactor {
    /// Solves for one right-hand side.
    pub(crate) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let n = self.rows.len();
        let mut x = b.to_vec();
        for i in 0..n {
            for k in i.saturating_sub(self.width)..i {
                x[i] -= self.rows[i][i - k] * x[k];
            }
            x[i] /= self.rows[i][0];
        }
        for i in (0..n).rev() {
            for k in i + 1..(i + self.width + 1).min(n) {
                x[i] -= self.rows[k][k - i] * x[k];
            }
            x[i] /= self.rows[i][0];
        }
        x
    }
}
