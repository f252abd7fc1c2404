//! What a model says anywhere, from what it knows at its knots.

use calib::{CalibError, OperatingPoint, Predicted, Simulator};

use super::Emulator;
use crate::ignorance::BESIDE;
use crate::process::Local;
use crate::speeds::weights;

impl Emulator {
    /// Whether there is a value for each axis, and a load for each point.
    pub(crate) fn check(&self, theta: &[f64], points: &[OperatingPoint]) -> Result<(), CalibError> {
        if theta.len() != self.axes.len() {
            return Err(CalibError::Parameters { expected: self.axes.len(), given: theta.len() });
        }
        match points.iter().find(|p| p.load >= self.loads.len()) {
            Some(other) => Err(CalibError::Load { at: *other }),
            None => Ok(()),
        }
    }

    /// Between the knots of a load along a line, constant beyond them.
    pub(super) fn linear(&self, at: OperatingPoint, of: impl Fn(usize) -> f64) -> f64 {
        let (own, omega_rpm) = (&self.loads[at.load], at.omega_rpm);
        let knots = &own.speeds_rpm;
        let above = knots.partition_point(|k| *k < omega_rpm).min(knots.len() - 1);
        let below = above.saturating_sub(usize::from(knots[above] > omega_rpm));
        let apart = knots[above] - knots[below];
        let (a, b) = (of(own.at.start + below), of(own.at.start + above));
        if apart > 0.0 { a + (b - a) * (omega_rpm - knots[below]) / apart } else { a }
    }

    /// Weights of the knots at a point: those of its load.
    fn spline(&self, point: &OperatingPoint) -> Vec<f64> {
        let own = &self.loads[point.load];
        let mut all = vec![0.0; self.knots.len()];
        all[own.at.clone()].copy_from_slice(&weights(&own.speeds_rpm, point.omega_rpm));
        all
    }

    /// Means anywhere from those at the knots.
    pub(crate) fn between(&self, points: &[OperatingPoint], at: &[[f64; 4]]) -> Vec<f64> {
        let mut mean = Vec::with_capacity(4 * points.len());
        for point in points {
            // Nothing is between there.
            if let Some(k) = self.knots.iter().position(|knot| knot == point) {
                mean.extend(at[k]);
                continue;
            }
            let w = self.spline(point);
            mean.extend((0..4).map(|r| w.iter().zip(at).map(|(w, v)| w * v[r]).sum::<f64>()));
        }
        mean
    }

    /// Predictions anywhere from what is known at the knots.
    pub(crate) fn spread(&self, points: &[OperatingPoint], local: &Local) -> Predicted {
        let spline: Vec<Vec<f64>> = points.iter().map(|p| self.spline(p)).collect();
        let n = 4 * points.len();
        let means: Vec<[f64; 4]> = local.at.iter().map(|a| a.0).collect();
        let mean = self.between(points, &means);
        // What moves all speeds together: knowns, and fillings, of which the measured drum with a load is one.
        let there = |mode: &Vec<[f64; 4]>| -> Vec<[f64; 4]> {
            let value = |w: &Vec<f64>, r: usize| w.iter().zip(mode).map(|(w, m)| w * m[r]).sum();
            spline.iter().map(|w| std::array::from_fn(|r| value(w, r))).collect()
        };
        let load = |k: usize| &self.loads[self.knots[k].load];
        let of_means =
            |k: usize| local.fillings[self.knots[k].load].sd.map(|s| s / load(k).fillings.sqrt());
        let shift: Vec<[f64; 4]> = (0..self.knots.len()).map(of_means).collect();
        // How much solid the measured filling holds is known to a part.
        let of_volume = |(k, g): (usize, &[f64; 4])| g.map(|g| load(k).volume_sd * g);
        let volume: Vec<[f64; 4]> = local.of_volume.iter().enumerate().map(of_volume).collect();
        let unsure = Some(&local.unsure).filter(|u| !u.is_empty());
        let modes: Vec<Vec<[f64; 4]>> = self.modes.iter().chain(unsure).map(there).collect();
        let of_fillings = [&local.shared, &shift].map(there);
        let volume = there(&volume);
        // What the surface does not know, at each speed in independent parts.
        let parts = |w: &Vec<f64>| -> Vec<[f64; 4]> {
            let mut parts = vec![[0.0; 4]; self.knots.len()];
            for ((w, own), row) in w.iter().zip(&local.unknown).zip(&self.alongside) {
                for (part, factor) in parts.iter_mut().zip(row) {
                    part.iter_mut().zip(own).for_each(|(p, u)| *p += w * factor * u);
                }
            }
            parts
        };
        let unknown: Vec<Vec<[f64; 4]>> = spline.iter().map(parts).collect();
        let mut covariance = vec![0.0; n * n];
        for (a, pa) in points.iter().enumerate() {
            for (b, pb) in points.iter().enumerate().take(a + 1) {
                // Fillings of two loads have nothing to do with each other.
                let same = (pa.load == pb.load).then(|| &local.fillings[pa.load]);
                let mut block = [[0.0; 4]; 4];
                for (k, (_, own)) in local.at.iter().enumerate() {
                    let w = spline[a][k] * spline[b][k];
                    if w != 0.0 {
                        for (to, of) in block.iter_mut().flatten().zip(own.iter().flatten()) {
                            *to += w * of;
                        }
                    }
                }
                for (r, row) in block.iter_mut().enumerate() {
                    for (s, c) in row.iter_mut().enumerate() {
                        let both: f64 =
                            unknown[a].iter().zip(&unknown[b]).map(|(p, q)| p[r] * q[s]).sum();
                        *c += BESIDE[r][s] * both;
                    }
                    for own in &of_fillings {
                        let Some(shifts) = same else { break };
                        for (s, c) in row.iter_mut().enumerate() {
                            *c += shifts.together[r][s] * (own[a][r] * own[b][s]);
                        }
                    }
                    for mode in modes.iter().chain(same.map(|_| &volume)) {
                        for (s, c) in row.iter_mut().enumerate() {
                            *c += mode[a][r] * mode[b][s];
                        }
                    }
                }
                for r in 0..4 {
                    for s in 0..4 {
                        covariance[(4 * a + r) * n + 4 * b + s] = block[r][s];
                        covariance[(4 * b + s) * n + 4 * a + r] = block[r][s];
                    }
                }
            }
        }
        Predicted { mean, covariance }
    }
}

impl Simulator for Emulator {
    fn parameters(&self) -> Vec<String> {
        self.axes.iter().map(|a| a.path.clone()).collect()
    }

    fn speed_range_rpm(&self) -> (f64, f64) {
        let speeds = self.knots.iter().map(|k| k.omega_rpm);
        speeds.fold((f64::INFINITY, 0.0), |(low, high), s| (s.min(low), s.max(high)))
    }

    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        self.check(theta, at)?;
        Ok(self.spread(at, &self.moments(theta)))
    }

    fn aside(&self, theta: &[f64]) -> Result<Option<f64>, CalibError> {
        self.unrest.as_ref().map(|u| u.deviance(theta)).transpose()
    }

    fn expected(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Vec<f64>, CalibError> {
        self.check(theta, at)?;
        Ok(self.between(at, &self.at_knots(theta)))
    }
}
