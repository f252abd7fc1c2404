//! Parametric bootstrap of the goodness of fit.
//!
//! Data are drawn from the fitted model with its full covariance, refitted over the grid, and
//! their chi-squares compared with that of the measured data: the comparison holds where the
//! number of degrees of freedom is doubtful (bounds, flat directions).

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::covariance::square;
use crate::problem::Evaluation;

/// Chi-squares of refitted draws.
#[derive(Debug, Clone, PartialEq)]
pub struct Bootstrap {
    /// Draws.
    pub draws: usize,
    /// Mean chi-square of the refitted draws.
    pub mean: f64,
    /// Part of the draws whose chi-square is at least the measured one.
    pub p: f64,
    /// Seed.
    pub seed: u64,
}

impl Bootstrap {
    pub(crate) fn draw(best: &Evaluation, models: &[Vec<f64>], draws: usize, seed: u64) -> Self {
        // Whitened distance of every grid point's model from the fitted one.
        let offsets: Vec<Vec<f64>> = models
            .iter()
            .map(|m| {
                let d: Vec<f64> = m.iter().zip(&best.model).map(|(a, b)| a - b).collect();
                best.factored.whiten(&d)
            })
            .collect();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let measured = best.chi2();
        let (mut sum, mut above) = (0.0, 0);
        for _ in 0..draws {
            let z: Vec<f64> =
                (0..best.model.len()).map(|_| StandardNormal.sample(&mut rng)).collect();
            let chi2 = offsets
                .iter()
                .map(|o| o.iter().zip(&z).map(|(a, b)| (b - a) * (b - a)).sum::<f64>())
                .fold(square(&z), f64::min);
            sum += chi2;
            above += usize::from(chi2 >= measured);
        }
        Self { draws, mean: sum / draws as f64, p: above as f64 / draws as f64, seed }
    }
}
