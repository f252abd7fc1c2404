//! Coefficients and residuals to full precision, however badly the columns are conditioned.
//!
//! QR in f64 loses as many digits as the condition number has, and those again where residuals
//! are large (NIST's Wampler5 keeps 6 of 15). Björck's iteration on the augmented system
//!
//! ```text
//! r + X b = y,   X' r = 0
//! ```
//!
//! finds what is missing in twice the precision and corrects it with the QR that is there:
//! f = y - r - X b, g = -X' r, then R db = Q'f - R^-T g, dr = f - Q (Q'f - R^-T g)
//! (Å. Björck, BIT 7, 1967, doi 10.1007/BF01939321). The columns themselves are powers of coded
//! factors in twice the precision; rounding them to f64 alone would cost Filip nine digits.

use crate::double_double::Double;
use crate::least_squares::{Factored, norm};

/// Corrections below this share of the response end the iteration.
const CONVERGED: f64 = 1.0e-22;
/// Each pass gains the digits that the conditioning leaves (five for Filip, the hardest of
/// NIST's problems): six passes are twice what it needs.
const MOST_PASSES: usize = 8;

/// Coefficients and residuals (y - X b) of the least-squares problem.
pub(crate) struct Solution {
    pub(crate) coefficients: Vec<f64>,
    pub(crate) residuals: Vec<f64>,
}

pub(crate) fn solve_refined(
    factored: &Factored,
    columns: &[Vec<Double>],
    y: &[Double],
) -> Solution {
    let (n, p) = (y.len(), columns.len());
    let mut b = vec![Double::default(); p];
    let mut r = vec![Double::default(); n];
    let enough = CONVERGED * norm(&y.iter().map(|v| v.hi).collect::<Vec<_>>());
    let mut last = f64::INFINITY;
    for _ in 0..MOST_PASSES {
        let mut f: Vec<Double> = y.iter().zip(&r).map(|(y, r)| *y - *r).collect();
        for (column, b) in columns.iter().zip(&b) {
            f.iter_mut().zip(column).for_each(|(f, x)| *f -= *x * *b);
        }
        let f: Vec<f64> = f.iter().map(|f| f.hi).collect();
        let across = |column: &Vec<Double>| {
            let sum = column.iter().zip(&r).fold(Double::default(), |s, (x, r)| s + *x * *r);
            -sum.hi
        };
        let h = factored.solve_transposed(&columns.iter().map(across).collect::<Vec<_>>());
        let (mut along, mut left) = factored.project(&f);
        along.iter_mut().zip(&h).for_each(|(a, h)| *a -= h);
        for (h, q) in h.iter().zip(&factored.q) {
            left.iter_mut().zip(q).for_each(|(l, q)| *l += h * q);
        }
        let size = norm(&along) + norm(&left);
        // No more progress: the columns are too close to dependent for another digit.
        if !size.is_finite() || size > 0.5 * last {
            break;
        }
        b.iter_mut().zip(factored.solve(&along)).for_each(|(b, d)| *b += Double::from(d));
        r.iter_mut().zip(&left).for_each(|(r, d)| *r += Double::from(*d));
        if size <= enough {
            break;
        }
        last = size;
    }
    Solution {
        coefficients: b.iter().map(|b| b.hi).collect(),
        residuals: r.iter().map(|r| r.hi).collect(),
    }
}
