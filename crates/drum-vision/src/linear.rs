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

/// Sub-diagonals of a [`Banded`] matrix: those of cubic splines.
const WIDTH: usize = 3;

/// A banded symmetric positive definite matrix, lower band stored by rows: `band[i][d]` is entry `(i, i - d)`.
#[derive(Clone, Debug)]
pub(crate) struct Banded {
    rows: Vec<[f64; WIDTH + 1]>,
}

impl Banded {
    /// A zero matrix of `n` rows with three sub-diagonals.
    pub(crate) fn zeros(n: usize) -> Self {
        Self { rows: vec![[0.0; WIDTH + 1]; n] }
    }

    /// Adds to entry `(i, j)` of the lower triangle, `i >= j`.
    pub(crate) fn add(&mut self, i: usize, j: usize, v: f64) {
        self.rows[i][i - j] += v;
    }

    /// Entry `(i, j)`, 0 outside of the band.
    pub(crate) fn at(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.max(j), i.min(j));
        if i - j > WIDTH { 0.0 } else { self.rows[i][i - j] }
    }

    /// Replaces the matrix by its Cholesky factor; `None` when it is not positive definite.
    pub(crate) fn factor(mut self) -> Option<BandedFactor> {
        for i in 0..self.rows.len() {
            for j in i.saturating_sub(WIDTH)..=i {
                let mut s = self.rows[i][i - j];
                for k in i.saturating_sub(WIDTH).max(j.saturating_sub(WIDTH))..j {
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
        Some(BandedFactor { rows: self.rows })
    }
}

/// The Cholesky factor of a [`Banded`] matrix.
#[derive(Clone, Debug)]
pub(crate) struct BandedFactor {
    rows: Vec<[f64; WIDTH + 1]>,
}

impl BandedFactor {
    /// Solves for one right-hand side, which becomes the solution.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let n = self.rows.len();
        for i in 0..n {
            for k in i.saturating_sub(WIDTH)..i {
                x[i] -= self.rows[i][i - k] * x[k];
            }
            x[i] /= self.rows[i][0];
        }
        for i in (0..n).rev() {
            for k in i + 1..(i + WIDTH + 1).min(n) {
                x[i] -= self.rows[k][k - i] * x[k];
            }
            x[i] /= self.rows[i][0];
        }
    }
}
