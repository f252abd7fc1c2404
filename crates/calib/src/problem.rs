//! One matching problem: observations, simulator, free parameters, nuisances.

use crate::covariance::{Factored, square};
use crate::{CalibError, Nuisance, NuisanceEstimate, Observations, Simulator};

/// A parameter that is fitted within a range.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeParameter {
    /// Path.
    pub name: String,
    /// Lowest and highest value.
    pub range: (f64, f64),
}

/// Everything that a match needs.
pub struct Problem<'s> {
    /// What was measured.
    pub observations: Observations,
    /// What predicts it.
    pub simulator: &'s dyn Simulator,
    /// What is fitted; the order is that of the simulator's parameters.
    pub free: Vec<FreeParameter>,
    /// What is marginalised.
    pub nuisances: Vec<Nuisance>,
}

/// The likelihood at one point.
#[derive(Debug, Clone)]
pub(crate) struct Evaluation {
    /// The simulator's means, nuisances at their prior means.
    pub(crate) model: Vec<f64>,
    /// Covariance with everything marginalised.
    pub(crate) factored: Factored,
    /// Residual, whitened.
    pub(crate) white: Vec<f64>,
}

impl Evaluation {
    pub(crate) fn chi2(&self) -> f64 {
        square(&self.white)
    }

    /// Minus twice the logarithm of the likelihood, up to a constant.
    pub(crate) fn deviance(&self) -> f64 {
        self.chi2() + self.factored.log_det
    }
}

impl Problem<'_> {
    /// Check the problem once before it is solved.
    pub(crate) fn check(&self) -> Result<(), CalibError> {
        let expected = self.simulator.parameters().len();
        if expected != self.free.len() {
            return Err(CalibError::Parameters { expected, given: self.free.len() });
        }
        for f in &self.free {
            let (low, high) = f.range;
            if !(low < high && low.is_finite() && high.is_finite()) {
                return Err(CalibError::Range { name: f.name.clone(), low, high });
            }
        }
        if self.observations.items.is_empty() {
            let (low, high) = self.simulator.speed_range_rpm();
            return Err(CalibError::NoObservations { low, high });
        }
        Ok(())
    }

    /// Change of observation `i` for a unit change of a nuisance.
    fn slope(&self, nuisance: &Nuisance, i: usize) -> f64 {
        let o = &self.observations.items[i];
        nuisance.slope(o.response, o.mean)
    }

    /// The likelihood at `theta`.
    pub(crate) fn evaluate(&self, theta: &[f64]) -> Result<Evaluation, CalibError> {
        let items = &self.observations.items;
        let (points, place) = self.observations.places();
        let predicted = self.simulator.predict(theta, &points)?;
        let mut model = Vec::with_capacity(items.len());
        for (i, o) in items.iter().enumerate() {
            let shift: f64 =
                self.nuisances.iter().map(|n| self.slope(n, i) * n.departure(n.mean)).sum();
            let value = predicted.mean[place[i]] + shift;
            if !value.is_finite() {
                return Err(CalibError::NotFinite { at: o.at(), theta: theta.to_vec() });
            }
            model.push(value);
        }
        let factored = Factored::new("the observations", items.len(), |i, j| {
            let nuisance: f64 = self
                .nuisances
                .iter()
                .map(|n| self.slope(n, i) * self.slope(n, j) * n.sd * n.sd)
                .sum();
            self.observations.covariance(i, j) + predicted.covariance(place[i], place[j]) + nuisance
        })?;
        let residual: Vec<f64> = items.iter().zip(&model).map(|(o, m)| o.mean - m).collect();
        let white = factored.whiten(&residual);
        Ok(Evaluation { model, factored, white })
    }

    /// What the data say of the nuisances at a point (normal, so exact).
    pub(crate) fn nuisance_estimates(&self, at: &Evaluation) -> Vec<NuisanceEstimate> {
        self.nuisances
            .iter()
            .map(|n| {
                let slope: Vec<f64> =
                    (0..self.observations.items.len()).map(|i| self.slope(n, i)).collect();
                let white = at.factored.whiten(&slope);
                let gain: f64 = white.iter().zip(&at.white).map(|(a, b)| a * b).sum();
                let step = n.sd * n.sd * gain;
                let variance = n.sd * n.sd * (1.0 - n.sd * n.sd * square(&white));
                NuisanceEstimate {
                    name: n.name.clone(),
                    value: n.mean + step,
                    sd: variance.max(0.0).sqrt(),
                    pull: step / n.sd,
                }
            })
            .collect()
    }

    /// The model with the nuisances at their estimates: what residuals are shown against.
    pub(crate) fn adjusted_model(&self, at: &Evaluation) -> Vec<f64> {
        let mut model = at.model.clone();
        for (n, e) in self.nuisances.iter().zip(self.nuisance_estimates(at)) {
            for (i, m) in model.iter_mut().enumerate() {
                *m += self.slope(n, i) * (e.value - n.mean);
            }
        }
        model
    }
}
