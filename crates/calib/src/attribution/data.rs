//! Observations made ready for many fits: what in the covariance does not depend on the model.

use rig_schema::Response;

use super::CodeCovariance;
use crate::covariance::{Factored, square};
use crate::{CalibError, Nuisance, Observation, Observations, OperatingPoint, Predicted};

/// A change of the errors, for the stability of a verdict.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variation {
    /// Factor on the standard deviations of the frames.
    pub(super) frames: f64,
    /// Extra standard deviation, independent between points.
    pub(super) independent: f64,
    /// Extra standard deviation of one shift of each response at all speeds.
    pub(super) shared: f64,
}

impl Default for Variation {
    fn default() -> Self {
        Self { frames: 1.0, independent: 0.0, shared: 0.0 }
    }
}

/// Observations with the part of their covariance that no model changes.
#[derive(Clone)]
pub(super) struct Data {
    pub(super) items: Vec<Observation>,
    pub(super) points: Vec<OperatingPoint>,
    /// Element of a prediction at `points` that belongs to each item.
    place: Vec<usize>,
    /// Measured less the nuisances' prior means.
    pub(super) y: Vec<f64>,
    /// Frames, set-up and codes, row-major.
    noise: Vec<f64>,
    /// Change of each item for one prior standard deviation of each nuisance.
    pub(super) nuisance: Vec<Vec<f64>>,
    /// For each response its items by load and ascending speed.
    series: Vec<Vec<usize>>,
}

impl Data {
    pub(super) fn new(
        observations: &Observations,
        nuisances: &[Nuisance],
        code: Option<&CodeCovariance>,
        variation: Variation,
    ) -> Self {
        let items = observations.items.clone();
        let (points, place) = observations.places();
        let n = items.len();
        let slope = |m: &Nuisance, o: &Observation| m.slope(o.response, o.mean);
        let y = items
            .iter()
            .map(|o| {
                o.mean - nuisances.iter().map(|m| slope(m, o) * m.departure(m.mean)).sum::<f64>()
            })
            .collect();
        let mut noise = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                let (a, b) = (&items[i], &items[j]);
                let mut v = observations.covariance(i, j) * variation.frames * variation.frames;
                if let Some(code) = code {
                    v += code.covariance(
                        (a.omega_rpm, a.response.index()),
                        (b.omega_rpm, b.response.index()),
                    );
                }
                if i == j {
                    v += variation.independent * variation.independent;
                }
                if a.response == b.response {
                    v += variation.shared * variation.shared;
                }
                noise[i * n + j] = v;
            }
        }
        let nuisance =
            nuisances.iter().map(|m| items.iter().map(|o| slope(m, o) * m.sd).collect()).collect();
        let series = Response::ALL
            .iter()
            .map(|r| {
                let mut of: Vec<usize> = (0..n).filter(|i| items[*i].response == *r).collect();
                of.sort_by(|i, j| items[*i].at().total_cmp(&items[*j].at()));
                of
            })
            .collect();
        Self { items, points, place, y, noise, nuisance, series }
    }

    pub(super) fn len(&self) -> usize {
        self.items.len()
    }

    /// The same with other values.
    pub(super) fn with(&self, y: Vec<f64>) -> Self {
        Self { y, ..self.clone() }
    }

    /// The items' elements of a vector over (operating point, response).
    pub(super) fn pick(&self, mean: &[f64]) -> Vec<f64> {
        self.place.iter().map(|k| mean[*k]).collect()
    }

    /// Variance of measured minus simulated at an item, without the nuisances.
    pub(super) fn variance(&self, i: usize, predicted: &Predicted) -> f64 {
        self.noise[i * self.len() + i] + predicted.covariance(self.place[i], self.place[i])
    }

    /// Typical standard deviation of a response: median over its points of the noise alone.
    pub(super) fn typical_sd(&self, response: usize) -> f64 {
        let n = self.len();
        let mut sd: Vec<f64> =
            self.series[response].iter().map(|i| self.noise[i * n + i].sqrt()).collect();
        sd.sort_by(f64::total_cmp);
        sd.get(sd.len() / 2).copied().unwrap_or(1.0)
    }

    /// The whole covariance with a simulator's error and, if given, something more.
    pub(super) fn weight(
        &self,
        predicted: &Predicted,
        more: Option<&dyn Fn(usize, usize) -> f64>,
    ) -> Result<Weight, CalibError> {
        let n = self.len();
        let factored = Factored::new("the observations", n, |i, j| {
            let nuisance: f64 = self.nuisance.iter().map(|g| g[i] * g[j]).sum();
            self.noise[i * n + j]
                + nuisance
                + predicted.covariance(self.place[i], self.place[j])
                + more.map_or(0.0, |f| f(i, j))
        })?;
        Ok(Weight { n, lower: factored.lower(), log_det: factored.log_det })
    }

    /// Nuisances given a whitened residual, in prior standard deviations from their means, with
    /// the part of their variance that is left.
    pub(super) fn nuisance_posterior(&self, weight: &Weight, white: &[f64]) -> Vec<(f64, f64)> {
        self.nuisance
            .iter()
            .map(|g| {
                let w = weight.whiten(g);
                let gain = w.iter().zip(white).map(|(a, b)| a * b).sum();
                (gain, (1.0 - square(&w)).max(0.0))
            })
            .collect()
    }

    /// Lag-1 correlation over speed of whitened residuals, pooled over the responses, about 0.
    pub(super) fn lag1(&self, white: &[f64]) -> Option<f64> {
        let pairs: Vec<(f64, f64)> = self
            .series
            .iter()
            .flat_map(|of| of.windows(2))
            .filter(|w| self.items[w[0]].load == self.items[w[1]].load)
            .map(|w| (white[w[0]], white[w[1]]))
            .collect();
        let scale: f64 = pairs.iter().map(|(a, b)| 0.5 * (a * a + b * b)).sum();
        (scale > 0.0).then(|| pairs.iter().map(|(a, b)| a * b).sum::<f64>() / scale)
    }
}

/// Lower factor of a covariance, for whitening in plain loops.
#[derive(Debug, Clone)]
pub(super) struct Weight {
    n: usize,
    lower: Vec<f64>,
    pub(super) log_det: f64,
}

impl Weight {
    /// `L^-1 v`.
    pub(super) fn whiten(&self, v: &[f64]) -> Vec<f64> {
        let mut w = Vec::with_capacity(self.n);
        for (row, value) in self.lower.chunks_exact(self.n).zip(v) {
            let i = w.len();
            let known: f64 = row[..i].iter().zip(&w).map(|(l, x): (&f64, &f64)| l * x).sum();
            w.push((value - known) / row[i]);
        }
        w
    }

    /// Rows of `L` from `first` on, from that column on: the factor of the covariance of what follows, given all before, with
    /// its zeros.
    pub(super) fn given(&self, first: usize) -> Vec<&[f64]> {
        self.lower.chunks_exact(self.n).skip(first).map(|row| &row[first..]).collect()
    }

    /// Diagonal of the covariance.
    pub(super) fn variances(&self) -> Vec<f64> {
        self.lower.chunks_exact(self.n).map(|row| row.iter().map(|l| l * l).sum()).collect()
    }

    /// `L z`.
    pub(super) fn colour(&self, z: &[f64]) -> Vec<f64> {
        let rows = self.lower.chunks_exact(self.n);
        rows.map(|row| row.iter().zip(z).map(|(l, x)| l * x).sum()).collect()
    }
}
