//! Box-Behnken design: second-order plans of three levels that avoid the corners.
//!
//! Blocks of two or three factors run through a two-level factorial while the others stay at
//! their centre. The blocks form a balanced design: every two factors for 3 to 5 factors, six
//! triples for 6, the seven lines of the Fano plane for 7 (G. E. P. Box, D. W. Behnken,
//! Technometrics 2, 1960).

use super::Design;
use crate::error::DoeError;
use crate::factor::{Factor, check_factors};

/// Triples of six factors: each factor in three of them, each pair in at least one.
const SIX: [[usize; 3]; 6] = [[0, 1, 3], [1, 2, 4], [2, 3, 5], [0, 3, 4], [1, 4, 5], [0, 2, 5]];
/// The Fano plane: each pair of seven factors in exactly one triple.
const SEVEN: [[usize; 3]; 7] =
    [[3, 4, 5], [0, 5, 6], [1, 4, 6], [0, 1, 3], [2, 3, 6], [0, 2, 4], [1, 2, 5]];

/// A Box-Behnken plan of 3 to 7 factors: 12, 24, 40, 48 or 56 runs, and `centres` at the centre.
///
/// ```
/// use doe::{Factor, design::box_behnken};
/// let f = [Factor::uncoded("a")?, Factor::uncoded("b")?, Factor::uncoded("c")?];
/// assert_eq!(box_behnken(&f, 3)?.runs(), 12 + 3);
/// # Ok::<(), doe::DoeError>(())
/// ```
///
/// # Errors
/// Invalid factors, or fewer than 3 or more than 7 of them.
pub fn box_behnken(factors: &[Factor], centres: usize) -> Result<Design, DoeError> {
    check_factors(factors)?;
    let k = factors.len();
    let blocks: Vec<Vec<usize>> = match k {
        3..=5 => (0..k).flat_map(|i| (i + 1..k).map(move |j| vec![i, j])).collect(),
        6 => SIX.iter().map(|b| b.to_vec()).collect(),
        7 => SEVEN.iter().map(|b| b.to_vec()).collect(),
        _ => {
            return Err(DoeError::Design {
                design: "Box-Behnken",
                what: "number of factors",
                got: k,
                expected: "from 3 to 7",
            });
        }
    };
    let mut coded = Vec::new();
    for block in &blocks {
        for run in 0..1_usize << block.len() {
            let mut point = vec![0.0; k];
            for (bit, &j) in block.iter().enumerate() {
                point[j] = if run >> bit & 1 == 1 { 1.0 } else { -1.0 };
            }
            coded.push(point);
        }
    }
    Ok(Design::from_coded(factors, &coded).with_centre_points(centres))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Model, ModelTerms, Weighting, fit};

    #[test]
    fn plans_have_their_published_sizes_and_estimate_every_quadratic_term() {
        for (k, runs) in [(3, 12), (4, 24), (5, 40), (6, 48), (7, 56)] {
            let f: Vec<Factor> =
                (0..k).map(|i| Factor::uncoded(format!("x{i}")).unwrap()).collect();
            let plan = box_behnken(&f, 3).unwrap();
            assert_eq!(plan.runs(), runs + 3);
            let model = Model::new(&f, &ModelTerms::quadratic(&f)).unwrap();
            let y: Vec<f64> = (0..plan.runs()).map(|i| ((i * 37) % 11) as f64).collect();
            assert!(fit(&model, &plan.points, &y, Weighting::Ordinary).is_ok());
            // Balanced: every factor is off its centre equally often.
            let used = |j: usize| plan.points.iter().filter(|p| p[j] != 0.0).count();
            assert!((1..k).all(|j| used(j) == used(0)));
        }
    }
}
