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
//! (Å. Björck, BIT 7, 1967). The columns themselves are powers of coded
//! factors in twice the precision; rounding them to f64 alone would cost Filip nine digits.

use crate::double_double::Double;
use crate::least_squares::{Factored, norm};

/// Corrections below this share of the response end the iteration.
const CONVERGED: f64 = 1.0e-22;
/// Each pass gains the digits that the conditioning leaves, about six for Filip in raw powers,
/// the hardest of NIST's problems: four passes reach [`CONVERGED`] there, two elsewhere.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_recovered_under_noise_that_buries_it() {
        // y = 1 + x + ... + x^5 plus 1e7 times a pattern made orthogonal to the columns in exact
        // integers (differences of order six of a delta): QR alone keeps 6 digits of the ones.
        let pattern = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
        let columns: Vec<Vec<Double>> =
            (0..6).map(|k| (0..7).map(|x| Double::from(f64::from(x).powi(k))).collect()).collect();
        let y: Vec<Double> = (0..7)
            .map(|x| {
                (0..6).map(|k| f64::from(x).powi(k)).sum::<f64>() + 1.0e7 * pattern[x as usize]
            })
            .map(Double::from)
            .collect();
        let plain: Vec<Vec<f64>> =
            columns.iter().map(|c| c.iter().map(|v| v.hi).collect()).collect();
        let names: Vec<String> = (0..6).map(|k| format!("x^{k}")).collect();
        let factored = Factored::new(&plain, &names).expect("powers at seven points");
        let solution = solve_refined(&factored, &columns, &y);
        for b in solution.coefficients {
            // One rounding of the last correction.
            assert!((b - 1.0).abs() < 1.0e-14, "{b}");
        }
        for (e, p) in solution.residuals.iter().zip(pattern) {
            assert!((e / (1.0e7 * p) - 1.0).abs() < 1.0e-15);
        }
    }
}
