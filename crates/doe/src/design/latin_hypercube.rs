//! Latin hypercube, spread out by exchanges.
//!
//! Each factor's range is cut into as many equal slices as there are runs, and each slice holds
//! one run. Among these plans, the one is sought that keeps runs apart: least
//! phi = (sum over pairs d^-16)^(1/16), which for so high a power is close to the inverse of the
//! least distance (M. D. Morris, T. J. Mitchell, J. Stat. Plan. Inference 43, 1995,
//! doi 10.1016/0378-3758(94)00035-T). Two runs exchange their slices in one factor at a time.
//! Instead of annealing's Boltzmann rule an exchange is taken if phi grows by no more than a
//! threshold that shrinks to nothing: threshold accepting needs no exponential, so that one seed
//! gives the same plan on every platform.

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::Design;
use crate::error::DoeError;
use crate::factor::{Factor, check_factors};

/// Relative growth of phi that is accepted at the start.
const FIRST_THRESHOLD: f64 = 0.1;

/// How a Latin hypercube is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LatinHypercube {
    /// Number of runs, at least 2.
    pub runs: usize,
    /// Seed: the same one gives the same plan.
    pub seed: u64,
    /// Exchanges that are tried; 0 leaves the random start.
    pub exchanges: usize,
}

impl LatinHypercube {
    /// A plan of this many runs with 20 000 exchanges.
    pub fn new(runs: usize, seed: u64) -> Self {
        Self { runs, seed, exchanges: 20_000 }
    }
}

/// A Latin hypercube of points in the middle of their slices, spread out by exchanges.
///
/// ```
/// use doe::{Factor, design::{LatinHypercube, latin_hypercube}};
/// let factors = [Factor::new("speed_rpm", 4.0, 30.0)?, Factor::new("friction", 0.1, 0.9)?];
/// let plan = latin_hypercube(&factors, &LatinHypercube::new(12, 1))?;
/// assert_eq!(plan.runs(), 12);
/// // Twelve runs at random keep about 0.1 of the unit square's side apart.
/// assert!(plan.least_distance().unwrap() > 0.2);
/// # Ok::<(), doe::DoeError>(())
/// ```
///
/// # Errors
/// Invalid factors, fewer than 2 or more than 10 000 runs.
pub fn latin_hypercube(factors: &[Factor], how: &LatinHypercube) -> Result<Design, DoeError> {
    check_factors(factors)?;
    if !(2..=10_000).contains(&how.runs) {
        return Err(DoeError::Design {
            design: "Latin hypercube",
            what: "number of runs",
            got: how.runs,
            expected: "from 2 to 10 000",
        });
    }
    let mut random = ChaCha8Rng::seed_from_u64(how.seed);
    let (n, k) = (how.runs, factors.len());
    // slices[j][i]: slice of factor j that run i lies in.
    let slices: Vec<Vec<usize>> = (0..k)
        .map(|_| {
            let mut column: Vec<usize> = (0..n).collect();
            column.shuffle(&mut random);
            column
        })
        .collect();
    let best = spread(slices, how.exchanges, &mut random);
    let coded: Vec<Vec<f64>> = (0..n)
        .map(|i| (0..k).map(|j| (2 * best[j][i] + 1) as f64 / n as f64 - 1.0).collect())
        .collect();
    Ok(Design::from_coded(factors, &coded))
}

/// Exchanges slices until the budget is spent; returns the best plan seen.
fn spread(mut slices: Vec<Vec<usize>>, budget: usize, random: &mut ChaCha8Rng) -> Vec<Vec<usize>> {
    let n = slices[0].len();
    // Squared distances in slices are whole numbers: no rounding accumulates over exchanges.
    let mut squared = vec![vec![0_i64; n]; n];
    for column in &slices {
        for (row, a) in squared.iter_mut().zip(column) {
            row.iter_mut().zip(column).for_each(|(d, b)| *d += gap(*a, *b));
        }
    }
    let mut current: f64 =
        (0..n).map(|i| squared[i][..i].iter().map(|d| closeness(*d)).sum::<f64>()).sum();
    let (mut best, mut best_sum) = (slices.clone(), current);
    for step in 0..budget {
        let j = random.random_range(0..slices.len());
        let a = random.random_range(0..n);
        let b = (a + random.random_range(1..n)) % n;
        let (at_a, at_b) = (slices[j][a], slices[j][b]);
        let mut change = 0.0;
        for i in (0..n).filter(|i| *i != a && *i != b) {
            let moved = gap(at_b, slices[j][i]) - gap(at_a, slices[j][i]);
            change += closeness(squared[a][i] + moved) - closeness(squared[a][i]);
            change += closeness(squared[b][i] - moved) - closeness(squared[b][i]);
        }
        // phi is the 16th root of the sum: for small thresholds, 16 times the growth.
        let left = 1.0 - step as f64 / budget as f64;
        let allowed = 1.0 + 16.0 * FIRST_THRESHOLD * left * left * left;
        if current + change > allowed * current {
            continue;
        }
        for i in (0..n).filter(|i| *i != a && *i != b) {
            let moved = gap(at_b, slices[j][i]) - gap(at_a, slices[j][i]);
            squared[a][i] += moved;
            squared[i][a] += moved;
            squared[b][i] -= moved;
            squared[i][b] -= moved;
        }
        slices[j].swap(a, b);
        current += change;
        if current < best_sum {
            best_sum = current;
            best.clone_from(&slices);
        }
    }
    best
}

fn gap(a: usize, b: usize) -> i64 {
    let d = a as i64 - b as i64;
    d * d
}

/// d^-16 of a squared distance, by multiplication.
fn closeness(squared: i64) -> f64 {
    let inverse = 1.0 / squared as f64;
    let fourth = inverse * inverse;
    let eighth = fourth * fourth;
    eighth * eighth
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factors(k: usize) -> Vec<Factor> {
        (0..k).map(|i| Factor::new(format!("x{i}"), 0.0, 1.0).unwrap()).collect()
    }

    #[test]
    fn every_slice_of_every_factor_holds_one_run() {
        let n = 23;
        let plan = latin_hypercube(&factors(4), &LatinHypercube::new(n, 3)).unwrap();
        for j in 0..4 {
            let mut slices: Vec<usize> =
                plan.points.iter().map(|p| (p[j] * n as f64) as usize).collect();
            slices.sort_unstable();
            assert_eq!(slices, (0..n).collect::<Vec<_>>());
        }
    }

    #[test]
    fn exchanges_spread_the_runs() {
        for (n, k) in [(10, 2), (20, 3), (30, 6)] {
            let how = LatinHypercube::new(n, 11);
            let start =
                latin_hypercube(&factors(k), &LatinHypercube { exchanges: 0, ..how }).unwrap();
            let spread = latin_hypercube(&factors(k), &how).unwrap();
            let (before, after) =
                (start.least_distance().unwrap(), spread.least_distance().unwrap());
            assert!(after > 1.3 * before, "{n} runs, {k} factors: {before} to {after}");
        }
    }

    #[test]
    fn small_plans_reach_the_largest_possible_least_distance() {
        // Known by trying every permutation.
        for n in [5_usize, 6, 7] {
            let optimum = exhaustive_maximin(n);
            let plan = latin_hypercube(&factors(2), &LatinHypercube::new(n, 1)).unwrap();
            let reached = plan.least_distance().unwrap() * n as f64;
            assert!((reached * reached - optimum as f64).abs() < 1.0e-9, "{n}");
        }
    }

    /// Largest least squared distance over all two-factor plans of n runs.
    fn exhaustive_maximin(n: usize) -> i64 {
        fn extend(column: &mut Vec<usize>, n: usize, least: i64, best: &mut i64) {
            if least <= *best {
                return;
            }
            if column.len() == n {
                *best = least;
                return;
            }
            for slice in 0..n {
                if column.contains(&slice) {
                    continue;
                }
                let row = column.len();
                let near = column.iter().enumerate().map(|(i, s)| gap(i, row) + gap(*s, slice));
                let least = near.min().unwrap_or(i64::MAX).min(least);
                column.push(slice);
                extend(column, n, least, best);
                column.pop();
            }
        }
        let mut best = 0;
        extend(&mut vec![], n, i64::MAX, &mut best);
        best
    }

    #[test]
    fn a_seed_fixes_the_plan() {
        let one = latin_hypercube(&factors(3), &LatinHypercube::new(15, 5)).unwrap();
        let again = latin_hypercube(&factors(3), &LatinHypercube::new(15, 5)).unwrap();
        let other = latin_hypercube(&factors(3), &LatinHypercube::new(15, 6)).unwrap();
        assert_eq!(one, again);
        assert_ne!(one, other);
    }

    #[test]
    fn one_run_is_refused() {
        let error = latin_hypercube(&factors(2), &LatinHypercube::new(1, 0)).unwrap_err();
        assert!(matches!(error, DoeError::Design { got: 1, .. }));
    }
}
