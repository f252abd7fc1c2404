//! The base model, the base with one effect, the base with two.

use super::{Candidate, PairModel};
use crate::{CalibError, FreeParameter, OperatingPoint, Predicted, Problem, Simulator};

#[derive(Clone, Copy)]
enum Kind<'s> {
    One(&'s dyn Simulator),
    /// Signatures add: base + (a - base) + (b - base).
    Two {
        base: &'s dyn Simulator,
        a: &'s dyn Simulator,
        b: &'s dyn Simulator,
    },
    /// Two effects simulated together; `turned` if the simulator takes the second strength first.
    Both {
        simulator: &'s dyn Simulator,
        turned: bool,
    },
}

/// A simulation with named, bounded parameters: frictions first, then strengths.
#[derive(Clone)]
pub(super) struct Model<'s> {
    pub(super) name: String,
    pub(super) parameters: Vec<String>,
    pub(super) ranges: Vec<(f64, f64)>,
    /// Strengths at which the effects are absent.
    pub(super) nulls: Vec<f64>,
    kind: Kind<'s>,
}

impl<'s> Model<'s> {
    pub(super) fn base(problem: &Problem<'s>) -> Result<Self, CalibError> {
        problem.check()?;
        Ok(Self {
            name: "the base model".to_owned(),
            parameters: problem.free.iter().map(|f| f.name.clone()).collect(),
            ranges: problem.free.iter().map(|f| f.range).collect(),
            nulls: Vec::new(),
            kind: Kind::One(problem.simulator),
        })
    }

    pub(super) fn single(
        free: &[FreeParameter],
        candidate: &Candidate<'s>,
    ) -> Result<Self, CalibError> {
        let fault = |fault: String| CalibError::Candidate { name: candidate.name.clone(), fault };
        let given = candidate.simulator.parameters();
        let mut parameters: Vec<String> = free.iter().map(|f| f.name.clone()).collect();
        if given.len() != free.len() + 1 || given[..free.len()] != parameters[..] {
            return Err(fault(format!(
                "its simulator takes ({}); expected ({}) followed by the strength",
                given.join(", "),
                parameters.join(", ")
            )));
        }
        let (low, high) = candidate.range;
        if !(low < high && low.is_finite() && high.is_finite()) {
            return Err(CalibError::Range { name: candidate.name.clone(), low, high });
        }
        if !(low..=high).contains(&candidate.null) {
            return Err(fault(format!(
                "absent at {}, which is outside its range {low} to {high}",
                candidate.null
            )));
        }
        if !(candidate.prior > 0.0 && candidate.prior.is_finite()) {
            return Err(fault(format!("prior weight {}; expected above 0", candidate.prior)));
        }
        parameters.push(candidate.name.clone());
        Ok(Self {
            name: candidate.name.clone(),
            parameters,
            ranges: free.iter().map(|f| f.range).chain([candidate.range]).collect(),
            nulls: vec![candidate.null],
            kind: Kind::One(candidate.simulator),
        })
    }

    pub(super) fn pair(
        problem: &Problem<'s>,
        a: &Candidate<'s>,
        b: &Candidate<'s>,
        together: &[PairModel<'s>],
    ) -> Result<Self, CalibError> {
        let mut model = Self::single(&problem.free, a)?;
        model.name = format!("{} + {}", a.name, b.name);
        model.parameters.push(b.name.clone());
        model.ranges.push(b.range);
        model.nulls.push(b.null);
        let own = together.iter().find_map(|p| {
            let [first, second] = &p.names;
            let turned = *first == b.name && *second == a.name;
            (turned || (*first == a.name && *second == b.name)).then_some((p.simulator, turned))
        });
        model.kind = match own {
            Some((simulator, turned)) => Kind::Both { simulator, turned },
            None => Kind::Two { base: problem.simulator, a: a.simulator, b: b.simulator },
        };
        Ok(model)
    }

    /// Whether it is one simulator's, not a sum of signatures.
    pub(super) fn is_whole(&self) -> bool {
        !matches!(self.kind, Kind::Two { .. })
    }

    pub(super) fn len(&self) -> usize {
        self.ranges.len()
    }

    /// Frictions, that is parameters that are no strengths.
    pub(super) fn frictions(&self) -> usize {
        self.ranges.len() - self.nulls.len()
    }

    /// Frictions with every effect absent.
    pub(super) fn absent(&self, frictions: &[f64]) -> Vec<f64> {
        frictions.iter().chain(&self.nulls).copied().collect()
    }

    /// Place within the ranges, 0 to 1.
    pub(super) fn unit(&self, theta: &[f64]) -> Vec<f64> {
        theta.iter().zip(&self.ranges).map(|(t, (l, h))| (t - l) / (h - l)).collect()
    }

    pub(super) fn theta(&self, unit: &[f64]) -> Vec<f64> {
        unit.iter().zip(&self.ranges).map(|(u, (l, h))| (l + u * (h - l)).clamp(*l, *h)).collect()
    }

    /// Starts for the strengths: absent, and half-way to each end of each range, in unit range.
    pub(super) fn strength_starts(&self) -> Vec<Vec<f64>> {
        let mut starts = vec![Vec::new()];
        for (null, (low, high)) in self.nulls.iter().zip(&self.ranges[self.frictions()..]) {
            let null = (null - low) / (high - low);
            let values = [null, 0.5 * null, 0.5 * (1.0 + null)];
            let mut next = Vec::new();
            for start in &starts {
                for (k, v) in values.iter().enumerate() {
                    if k == 0 || (v - null).abs() > 1e-9 {
                        next.push(start.iter().copied().chain([*v]).collect());
                    }
                }
            }
            starts = next;
        }
        starts
    }

    pub(super) fn predict(
        &self,
        theta: &[f64],
        at: &[OperatingPoint],
    ) -> Result<Predicted, CalibError> {
        let predicted = match self.kind {
            Kind::One(s) => s.predict(theta, at)?,
            Kind::Both { simulator, turned } => simulator.predict(&turn(theta, turned), at)?,
            Kind::Two { base, a, b } => {
                let (ta, tb) = self.split(theta);
                let mut p = a.predict(&ta, at)?;
                let q = b.predict(&tb, at)?;
                let without = base.expected(&theta[..self.frictions()], at)?;
                for ((m, n), w) in p.mean.iter_mut().zip(&q.mean).zip(&without) {
                    *m += n - w;
                }
                // Errors of the two surfaces, which share the base's: between one and both.
                for (c, d) in p.covariance.iter_mut().zip(&q.covariance) {
                    *c = 0.5 * (*c + d);
                }
                p
            }
        };
        self.checked(&predicted.mean, theta, at)?;
        Ok(predicted)
    }

    pub(super) fn expected(
        &self,
        theta: &[f64],
        at: &[OperatingPoint],
    ) -> Result<Vec<f64>, CalibError> {
        let mean = match self.kind {
            Kind::One(s) => s.expected(theta, at)?,
            Kind::Both { simulator, turned } => simulator.expected(&turn(theta, turned), at)?,
            Kind::Two { base, a, b } => {
                let (ta, tb) = self.split(theta);
                let mut mean = a.expected(&ta, at)?;
                let other = b.expected(&tb, at)?;
                let without = base.expected(&theta[..self.frictions()], at)?;
                for ((m, n), w) in mean.iter_mut().zip(&other).zip(&without) {
                    *m += n - w;
                }
                mean
            }
        };
        self.checked(&mean, theta, at)?;
        Ok(mean)
    }

    /// Deviance of what was measured besides the observations; none of signatures that are added.
    pub(super) fn aside(&self, theta: &[f64]) -> Result<Option<f64>, CalibError> {
        match self.kind {
            Kind::One(s) => s.aside(theta),
            Kind::Both { simulator, turned } => simulator.aside(&turn(theta, turned)),
            Kind::Two { .. } => Ok(None),
        }
    }

    fn split(&self, theta: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let d = self.frictions();
        (theta[..=d].to_vec(), theta[..d].iter().chain([&theta[d + 1]]).copied().collect())
    }

    fn checked(
        &self,
        mean: &[f64],
        theta: &[f64],
        at: &[OperatingPoint],
    ) -> Result<(), CalibError> {
        if mean.len() != 4 * at.len() {
            return Err(CalibError::Lengths {
                what: "responses from a simulator (four for each operating point)",
                expected: 4 * at.len(),
                given: mean.len(),
            });
        }
        match mean.iter().position(|v| !v.is_finite()) {
            Some(k) => Err(CalibError::NotFinite { at: at[k / 4], theta: theta.to_vec() }),
            None => Ok(()),
        }
    }
}

/// Parameters with the last two exchanged if so asked.
fn turn(theta: &[f64], turned: bool) -> Vec<f64> {
    let mut theta = theta.to_vec();
    if turned && theta.len() >= 2 {
        let n = theta.len();
        theta.swap(n - 2, n - 1);
    }
    theta
}
