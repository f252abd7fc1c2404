//! QR of a design matrix with a rank test that names what it refuses.
//!
//! Columns are scaled by powers of two (which costs no bit) to a length near one, then
//! factored X = Q R by faer's Householder reflections. |R_jj| is the part of column j that the
//! columns before it do not span; where it is below [`RANK_TOLERANCE`] of the column's length,
//! the column is aliased. An unchecked solve would return numbers of 1e14 there.

use faer::Mat;

use crate::error::{Alias, DoeError};

/// Part of a column that must be new for its coefficient to be estimable, relative to its
/// length. Rounding leaves about 1e-15 in a column that others span; the hardest of the NIST
/// problems (Filip, raw powers of x up to 10) has 1e-10.
pub(crate) const RANK_TOLERANCE: f64 = 1.0e-12;

/// Share of a combination below which a term is not named in an alias.
const NAMED_SHARE: f64 = 1.0e-7;

/// A factored design matrix of full rank, n rows, p columns.
#[derive(Debug, Clone)]
pub(crate) struct Factored {
    /// Orthonormal columns, p of n values.
    pub(crate) q: Vec<Vec<f64>>,
    /// R of the scaled columns, rows of the upper triangle from the diagonal on.
    r: Vec<Vec<f64>>,
    /// The power of two that each column was divided by.
    scale: Vec<f64>,
}

impl Factored {
    /// Factors the columns of a design matrix.
    ///
    /// # Errors
    /// [`DoeError::Aliased`] with every dependent column.
    pub(crate) fn new(columns: &[Vec<f64>], names: &[String]) -> Result<Self, DoeError> {
        let mut kept: Vec<usize> = (0..columns.len()).collect();
        let mut aliases = Vec::new();
        loop {
            let factored = Self::without_rank_test(columns, &kept);
            match factored.first_dependent(columns, &kept) {
                None if aliases.is_empty() => return Ok(factored),
                None => return Err(DoeError::Aliased { aliases }),
                Some(j) => {
                    aliases.push(factored.alias(j, &kept, names));
                    kept.remove(j);
                }
            }
        }
    }

    fn without_rank_test(columns: &[Vec<f64>], kept: &[usize]) -> Self {
        let n = columns.first().map_or(0, Vec::len);
        let scale: Vec<f64> = kept.iter().map(|&j| near_power_of_two(norm(&columns[j]))).collect();
        let x = Mat::from_fn(n, kept.len(), |i, j| columns[kept[j]][i] / scale[j]);
        let qr = x.qr();
        let (thin_q, thin_r) = (qr.compute_thin_Q(), qr.thin_R());
        let p = kept.len();
        let q = (0..p).map(|j| (0..n).map(|i| thin_q[(i, j)]).collect()).collect();
        let r = (0..p).map(|i| (i..p).map(|j| thin_r[(i, j)]).collect()).collect();
        Self { q, r, scale }
    }

    fn first_dependent(&self, columns: &[Vec<f64>], kept: &[usize]) -> Option<usize> {
        (0..kept.len()).find(|&j| {
            let length = norm(&columns[kept[j]]) / self.scale[j];
            let new_part = self.r[j][0].abs() > RANK_TOLERANCE * length;
            !new_part
        })
    }

    /// Column j as a combination of the columns before it: R[..j, ..j] a = R[..j, j].
    fn alias(&self, j: usize, kept: &[usize], names: &[String]) -> Alias {
        let mut a: Vec<f64> = (0..j).map(|i| self.r[i][j - i]).collect();
        for i in (0..j).rev() {
            let later: f64 = (i + 1..j).map(|k| self.r[i][k - i] * a[k]).sum();
            a[i] = (a[i] - later) / self.r[i][0];
        }
        let largest = a.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        let combination = (0..j)
            .filter(|&i| a[i].abs() > NAMED_SHARE * largest)
            .map(|i| (names[kept[i]].clone(), a[i] * self.scale[j] / self.scale[i]))
            .collect();
        Alias { term: names[kept[j]].clone(), combination }
    }

    /// Q'v, and what is left of v: the part that no column explains. Projected twice, since one
    /// pass leaves rounding of the size of v along the columns.
    pub(crate) fn project(&self, v: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut left = v.to_vec();
        let mut coordinates = vec![0.0; self.q.len()];
        for _ in 0..2 {
            for (z, q) in coordinates.iter_mut().zip(&self.q) {
                let along = dot(q, &left);
                left.iter_mut().zip(q).for_each(|(l, q)| *l -= along * q);
                *z += along;
            }
        }
        (coordinates, left)
    }

    /// b of R b = z, in the unscaled columns.
    pub(crate) fn solve(&self, z: &[f64]) -> Vec<f64> {
        let p = z.len();
        let mut b = z.to_vec();
        for i in (0..p).rev() {
            let later: f64 = (i + 1..p).map(|k| self.r[i][k - i] * b[k]).sum();
            b[i] = (b[i] - later) / self.r[i][0];
        }
        b.iter().zip(&self.scale).map(|(b, s)| b / s).collect()
    }

    /// h of R' h = g, in the unscaled columns.
    pub(crate) fn solve_transposed(&self, g: &[f64]) -> Vec<f64> {
        let mut h: Vec<f64> = g.iter().zip(&self.scale).map(|(g, s)| g / s).collect();
        for i in 0..h.len() {
            let earlier: f64 = (0..i).map(|k| self.r[k][i - k] * h[k]).sum();
            h[i] = (h[i] - earlier) / self.r[i][0];
        }
        h
    }

    /// Rows of R^-1 of the unscaled columns; (X'X)^-1 = R^-1 R^-T.
    pub(crate) fn r_inverse(&self) -> Vec<Vec<f64>> {
        let p = self.scale.len();
        let columns: Vec<Vec<f64>> = (0..p)
            .map(|k| self.solve(&(0..p).map(|i| f64::from(u8::from(i == k))).collect::<Vec<_>>()))
            .collect();
        (0..p).map(|i| columns.iter().map(|c| c[i]).collect()).collect()
    }
}

/// Ratio of the largest to the smallest singular value of the matrix with these columns.
pub(crate) fn condition_number(columns: &[Vec<f64>]) -> Result<f64, DoeError> {
    let n = columns.first().map_or(0, Vec::len);
    let x = Mat::from_fn(n, columns.len(), |i, j| columns[j][i]);
    let values = x
        .singular_values()
        .map_err(|_| DoeError::NoConvergence { what: "singular value decomposition" })?;
    let (largest, smallest) = values
        .iter()
        .fold((0.0_f64, f64::INFINITY), |(high, low), v| (high.max(v.abs()), low.min(v.abs())));
    Ok(largest / smallest)
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Length of a vector, without overflow of its squares.
pub(crate) fn norm(v: &[f64]) -> f64 {
    let largest = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    largest * v.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt()
}

fn near_power_of_two(length: f64) -> f64 {
    if length == 0.0 { 1.0 } else { length.log2().round().clamp(-1000.0, 1000.0).exp2() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aliases_are_named_with_their_combination() {
        let a = vec![1.0, 2.0, 3.0, 4.0];
        let b = vec![1.0, -1.0, 0.5, 2.0];
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 2.0 * a - b).collect();
        let names = ["a", "b", "c", "zero"].map(String::from);
        let error = Factored::new(&[a, b, sum, vec![0.0; 4]], &names).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the design cannot tell these terms apart: c = 2.0000 a - 1.0000 b; zero = 0 on every run"
        );
    }

    #[test]
    fn the_inverse_triangle_gives_the_inverse_of_the_normal_matrix() {
        // X'X = [[4, 10], [10, 30]], inverse [[1.5, -0.5], [-0.5, 0.2]].
        let columns = [vec![1.0; 4], vec![1.0, 2.0, 3.0, 4.0]];
        let f = Factored::new(&columns, &["1", "x"].map(String::from)).unwrap();
        let r = f.r_inverse();
        for (i, j, expected) in [(0, 0, 1.5), (0, 1, -0.5), (1, 1, 0.2)] {
            // A few roundings of order-2 triangular solves.
            assert!((dot(&r[i], &r[j]) - expected).abs() < 1.0e-14);
        }
    }
}
