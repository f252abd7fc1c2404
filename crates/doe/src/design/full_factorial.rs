//! Full factorial: every combination of levels.

use super::{Design, tidy};
use crate::error::DoeError;
use crate::factor::{Factor, check_factors};

/// Most runs that a plan may have: beyond it a typing error is likelier than an intention.
const MOST_RUNS: usize = 1_000_000;

/// Every combination of equally spaced levels, the first factor changing fastest.
///
/// `levels` holds the number of levels of each factor, at least 2, the ends being `low` and
/// `high`. Centre points and replicates are added by [`Design::with_centre_points`] and
/// [`Design::replicated`].
///
/// ```
/// use doe::{Factor, design::full_factorial};
/// // The plan of the thesis: 27 combinations, the centre twice more.
/// let factors = [
///     Factor::new("omega_rpm", 4.0, 30.0)?,
///     Factor::new("mu_wall", 0.4, 0.8)?,
///     Factor::new("mu_pp", 0.1, 0.9)?,
/// ];
/// let plan = full_factorial(&factors, &[3, 3, 3])?.with_centre_points(2);
/// assert_eq!(plan.runs(), 29);
/// assert_eq!(plan.points[3], [4.0, 0.6, 0.1]);
/// assert_eq!(plan.points[28], [17.0, 0.6, 0.5]);
/// # Ok::<(), doe::DoeError>(())
/// ```
///
/// # Errors
/// Invalid factors, a number of levels for each factor that is missing or below 2, or more than
/// a million runs.
pub fn full_factorial(factors: &[Factor], levels: &[usize]) -> Result<Design, DoeError> {
    check_factors(factors)?;
    if levels.len() != factors.len() {
        return Err(DoeError::Length {
            what: "levels of the factors".to_string(),
            expected: factors.len(),
            got: levels.len(),
        });
    }
    let refuse = |what, got, expected| {
        Err(DoeError::Design { design: "full factorial", what, got, expected })
    };
    if let Some(&few) = levels.iter().find(|l| **l < 2) {
        return refuse("number of levels", few, "at least 2");
    }
    let runs = levels.iter().fold(1_usize, |runs, l| runs.saturating_mul(*l));
    if runs > MOST_RUNS {
        return refuse("number of runs", runs, "at most a million");
    }
    let values: Vec<Vec<f64>> = factors
        .iter()
        .zip(levels)
        .map(|(f, &count)| (0..count).map(|i| level(f, i, count)).collect())
        .collect();
    let point = |run: usize| {
        let mut rest = run;
        let setting = |v: &Vec<f64>| {
            let x = v[rest % v.len()];
            rest /= v.len();
            x
        };
        values.iter().map(setting).collect()
    };
    Ok(Design::new(factors, (0..runs).map(point).collect()))
}

fn level(factor: &Factor, index: usize, count: usize) -> f64 {
    if index == 0 {
        return factor.low;
    }
    if index == count - 1 {
        return factor.high;
    }
    let share = index as f64 / (count - 1) as f64;
    tidy(factor.low + share * (factor.high - factor.low))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_combination_occurs_once() {
        let f = ["a", "b", "c"].map(|n| Factor::new(n, -1.0, 1.0).unwrap());
        let plan = full_factorial(&f, &[2, 3, 4]).unwrap();
        assert_eq!(plan.runs(), 24);
        let mut points = plan.points.clone();
        points.sort_by(|a, b| a.partial_cmp(b).unwrap());
        points.dedup();
        assert_eq!(points.len(), 24);
    }

    #[test]
    fn columns_of_the_coded_plan_are_orthogonal() {
        let f = ["a", "b", "c"].map(|n| Factor::new(n, 2.0, 5.0).unwrap());
        let coded = full_factorial(&f, &[3, 3, 2]).unwrap().coded();
        for i in 0..3 {
            for j in 0..i {
                let product: f64 = coded.iter().map(|c| c[i] * c[j]).sum();
                // 18 products of coded levels, each exact to rounding.
                assert!(product.abs() < 1.0e-13);
            }
        }
    }

    #[test]
    fn impossible_plans_are_refused() {
        let f = [Factor::new("a", 0.0, 1.0).unwrap()];
        assert!(matches!(full_factorial(&f, &[1]), Err(DoeError::Design { got: 1, .. })));
        assert!(matches!(full_factorial(&f, &[2, 2]), Err(DoeError::Length { .. })));
        assert!(matches!(full_factorial(&[], &[]), Err(DoeError::Empty { .. })));
        assert!(matches!(full_factorial(&f, &[usize::MAX]), Err(DoeError::Design { .. })));
    }
}
