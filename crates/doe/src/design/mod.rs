//! Plans: which settings to run, and in which order.

mod box_behnken;
mod central_composite;
mod full_factorial;
mod latin_hypercube;

pub use box_behnken::box_behnken;
pub use central_composite::{AxialDistance, central_composite};
pub use full_factorial::full_factorial;
pub use latin_hypercube::{LatinHypercube, latin_hypercube};

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;

use crate::error::DoeError;
use crate::factor::Factor;

/// A list of runs over named factors, with the order in which to do them.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Design {
    /// The factors, in the order of a point's values.
    pub factors: Vec<Factor>,
    /// One point a run, natural units, in standard order.
    pub points: Vec<Vec<f64>>,
    /// Indices of the runs in the order of execution; standard order until it is randomised.
    pub run_order: Vec<usize>,
}

impl Design {
    pub(crate) fn new(factors: &[Factor], points: Vec<Vec<f64>>) -> Self {
        let run_order = (0..points.len()).collect();
        Self { factors: factors.to_vec(), points, run_order }
    }

    pub(crate) fn from_coded(factors: &[Factor], coded: &[Vec<f64>]) -> Self {
        let natural = |row: &Vec<f64>| {
            row.iter().zip(factors).map(|(c, f)| tidy(f.decode(*c))).collect::<Vec<f64>>()
        };
        Self::new(factors, coded.iter().map(natural).collect())
    }

    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.points.len()
    }

    /// The points in coded units.
    pub fn coded(&self) -> Vec<Vec<f64>> {
        let code = |p: &Vec<f64>| p.iter().zip(&self.factors).map(|(x, f)| f.code(*x)).collect();
        self.points.iter().map(code).collect()
    }

    /// The same runs in random order, the same one for the same seed.
    ///
    /// Drift of a rig over a campaign then falls on all settings alike.
    #[must_use]
    pub fn randomised(mut self, seed: u64) -> Self {
        self.run_order = (0..self.points.len()).collect();
        self.run_order.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
        self
    }

    /// Every point this many times, all runs of the plan before any is repeated.
    ///
    /// # Errors
    /// [`DoeError::Design`] for no replicate at all.
    pub fn replicated(mut self, times: usize) -> Result<Self, DoeError> {
        if times == 0 {
            return Err(DoeError::Design {
                design: "replicated design",
                what: "number of replicates",
                got: times,
                expected: "at least 1",
            });
        }
        self.points = std::iter::repeat_n(self.points, times).flatten().collect();
        self.run_order = (0..self.points.len()).collect();
        Ok(self)
    }

    /// Adds runs at the centre of every factor.
    #[must_use]
    pub fn with_centre_points(mut self, count: usize) -> Self {
        let centre: Vec<f64> = self.factors.iter().map(|f| tidy(f.centre())).collect();
        self.points.extend(std::iter::repeat_n(centre, count));
        self.run_order = (0..self.points.len()).collect();
        self
    }

    /// Least distance between two runs in the unit cube of the factors; none for fewer than two.
    pub fn least_distance(&self) -> Option<f64> {
        let coded = self.coded();
        let mut least = f64::INFINITY;
        for (i, a) in coded.iter().enumerate() {
            for b in &coded[..i] {
                let squared: f64 = a.iter().zip(b).map(|(a, b)| (0.5 * (a - b)).powi(2)).sum();
                least = least.min(squared);
            }
        }
        least.is_finite().then(|| least.sqrt())
    }
}

/// A value rounded to 15 digits, so that 0.6 is written 0.6 and not 0.6000000000000001.
fn tidy(x: f64) -> f64 {
    format!("{x:.14e}").parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_random_order_is_a_permutation_that_the_seed_fixes() {
        let f = [Factor::new("a", 0.0, 1.0).unwrap(), Factor::new("b", 0.0, 1.0).unwrap()];
        let plan = full_factorial(&f, &[4, 5]).unwrap();
        let (one, again, other) =
            (plan.clone().randomised(7), plan.clone().randomised(7), plan.clone().randomised(8));
        assert_eq!(one, again);
        assert_ne!(one.run_order, other.run_order);
        let mut sorted = one.run_order;
        sorted.sort_unstable();
        assert_eq!(sorted, plan.run_order);
    }

    #[test]
    fn replicates_repeat_the_whole_plan() {
        let f = [Factor::new("a", 0.0, 1.0).unwrap()];
        let plan = full_factorial(&f, &[2]).unwrap().with_centre_points(1);
        let twice = plan.clone().replicated(2).unwrap();
        assert_eq!(twice.runs(), 6);
        assert_eq!(twice.points[3..], plan.points);
        assert!(matches!(plan.replicated(0), Err(DoeError::Design { .. })));
    }
}
