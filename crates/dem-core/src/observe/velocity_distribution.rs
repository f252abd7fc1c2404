//! Distribution of speeds against the curve of Yang et al.
//!
//! `P(v*) = a exp(-b ln(v*/v0)^2)` (thesis eq. 36), `v* = |v| / v_wall`. Yang, Yu, McElroy & Bao,
//! Powder Technol. 188 (2008) 170, doi:10.1016/j.powtec.2008.04.081. The curve is a parabola in
//! `ln P` against `ln v*`, so it is fitted by weighted linear least squares; `v0` is left free.

use super::{Observer, View};
use crate::particles::ParticleId;

/// Speeds of all particles over a reference speed, in bins of equal width in `ln v*`.
#[derive(Debug, Clone, PartialEq)]
pub struct VelocityDistribution {
    every: u64,
    wall_speed: f64,
    least: f64,
    width: f64,
    counts: Vec<u64>,
    looks: u64,
    sum: f64,
}

/// The fitted curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogNormalFit {
    /// Height of the peak.
    pub a: f64,
    /// Narrowness.
    pub b: f64,
    /// Place of the peak.
    pub v0: f64,
    /// Coefficient of determination of `ln P`.
    pub r_squared: f64,
}

impl VelocityDistribution {
    /// Look every `every` steps; speeds count in units of `wall_speed` (m/s), in `bins` bins of
    /// `ln v*` from `least` to `most`.
    pub fn new(every: u64, wall_speed: f64, least: f64, most: f64, bins: usize) -> Self {
        let width = (most / least).ln() / bins as f64;
        Self { every, wall_speed, least, width, counts: vec![0; bins], looks: 0, sum: 0.0 }
    }

    /// Mean of `v*` over particles and looks.
    pub fn mean(&self) -> f64 {
        self.sum / self.counts.iter().sum::<u64>().max(1) as f64
    }

    /// Probability density in `v*`: pairs of `v*` and `P`.
    pub fn density(&self) -> Vec<(f64, f64)> {
        let total = self.counts.iter().sum::<u64>().max(1) as f64;
        let edge = |k: usize| self.least * (self.width * k as f64).exp();
        (self.counts.iter().enumerate())
            .map(|(k, &c)| {
                let (low, high) = (edge(k), edge(k + 1));
                ((low * high).sqrt(), c as f64 / total / (high - low))
            })
            .collect()
    }

    /// Fit the curve to the bins that hold something; `None` for fewer than four of them or for
    /// points that do not bend downwards.
    pub fn fit(&self) -> Option<LogNormalFit> {
        let points: Vec<(f64, f64, f64)> = (self.density().into_iter().zip(&self.counts))
            .filter(|(_, c)| **c > 0)
            .map(|((v, p), &c)| (v.ln(), p.ln(), c as f64))
            .collect();
        if points.len() < 4 {
            return None;
        }
        // ln P = c0 + c1 x + c2 x^2, weighted by counts (the variance of ln P is 1/count).
        let weight: f64 = points.iter().map(|p| p.2).sum();
        let centre = points.iter().map(|p| p.0 * p.2).sum::<f64>() / weight;
        let moment = |n: i32| -> f64 {
            points.iter().map(|p| p.2 * (p.0 - centre).powi(n)).sum::<f64>() / weight
        };
        let value = |n: i32| -> f64 {
            points.iter().map(|p| p.2 * p.1 * (p.0 - centre).powi(n)).sum::<f64>() / weight
        };
        let (m2, m3, m4) = (moment(2), moment(3), moment(4));
        let (y0, y1, y2) = (value(0), value(1), value(2));
        let matrix = glam::DMat3::from_cols(
            glam::DVec3::new(1.0, 0.0, m2),
            glam::DVec3::new(0.0, m2, m3),
            glam::DVec3::new(m2, m3, m4),
        );
        if matrix.determinant().abs() < f64::MIN_POSITIVE {
            return None;
        }
        let c = matrix.inverse() * glam::DVec3::new(y0, y1, y2);
        if c.z >= 0.0 {
            return None;
        }
        let (b, shift) = (-c.z, -c.y / (2.0 * c.z));
        let line = |x: f64| c.x + c.y * (x - centre) + c.z * (x - centre).powi(2);
        let residual: f64 = points.iter().map(|p| p.2 * (p.1 - line(p.0)).powi(2)).sum();
        let spread: f64 = points.iter().map(|p| p.2 * (p.1 - y0).powi(2)).sum();
        Some(LogNormalFit {
            a: (c.x - 0.25 * c.y * c.y / c.z).exp(),
            b,
            v0: (centre + shift).exp(),
            r_squared: 1.0 - residual / spread.max(f64::MIN_POSITIVE),
        })
    }
}

impl Observer for VelocityDistribution {
    fn every(&self) -> u64 {
        self.every
    }

    fn observe(&mut self, world: &dyn View) {
        for id in (0..world.particle_count() as u32).map(ParticleId) {
            let v = world.velocity(id).length() / self.wall_speed;
            self.add(v);
        }
        self.looks += 1;
    }
}

impl VelocityDistribution {
    fn add(&mut self, v: f64) {
        let bin = (v / self.least).ln() / self.width;
        if bin >= 0.0 && (bin as usize) < self.counts.len() {
            self.counts[bin as usize] += 1;
            self.sum += v;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_finds_the_parameters_of_a_curve_that_it_is_given() {
        let mut d = VelocityDistribution::new(1, 1.0, 0.05, 20.0, 60);
        let (b, v0) = (1.5, 0.8f64);
        // Counts proportional to the curve times the width of each bin.
        for k in 0..60 {
            let (low, high) =
                (0.05 * (d.width * k as f64).exp(), 0.05 * (d.width * (k + 1) as f64).exp());
            let v: f64 = (low * high).sqrt();
            d.counts[k] = (1e6 * (high - low) * (-b * (v / v0).ln().powi(2)).exp()).round() as u64;
        }
        let fit = d.fit().unwrap();
        // Rounding of the counts: a few in 1e5.
        assert!((fit.b - b).abs() < 1e-3 && (fit.v0 - v0).abs() < 1e-3, "{fit:?}");
        assert!(fit.r_squared > 0.9999);
    }
}
