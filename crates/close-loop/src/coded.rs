//! Models of effects whose strength is a coordinate.

use calib::attribution::{Finding, Strength};
use calib::{CalibError, OperatingPoint, Predicted, Simulator};

use crate::catalogue::Effect;
use crate::curve::Curve;
use crate::emulator::Emulator;
use crate::scale::Scale;

/// What a model is made of.
pub(crate) enum Model {
    /// Its own runs.
    Runs(Emulator),
    /// The base's runs, and a change that needs none.
    Curve(Curve),
}

impl Model {
    fn simulator(&self) -> &dyn Simulator {
        match self {
            Self::Runs(m) => m,
            Self::Curve(m) => m,
        }
    }
}

/// The coordinate of an effect: 0 where it is absent, and about linear in the responses.
#[derive(Debug, Clone, Copy)]
struct Coordinate {
    scale: Scale,
    null: f64,
    unit: f64,
}

impl Coordinate {
    fn of(effect: &Effect) -> Self {
        let unit = effect.scale.forth(effect.probes[1]) - effect.scale.forth(effect.null);
        let unit = if unit.abs() > 0.0 { unit } else { 1.0 };
        Self { scale: effect.scale, null: effect.null, unit }
    }

    fn strength(self, v: f64) -> f64 {
        if v == 0.0 {
            return self.null;
        }
        self.scale.back(self.scale.forth(self.null) + v * self.unit)
    }
}

/// A simulator whose last parameters, one for each of its effects, are coordinates.
pub(crate) struct Coded {
    pub(crate) inner: Model,
    effects: Vec<Coordinate>,
}

impl Coded {
    pub(crate) fn new(effects: &[&Effect], inner: Model) -> Self {
        Self { inner, effects: effects.iter().map(|e| Coordinate::of(e)).collect() }
    }

    /// Strength of the first effect.
    pub(crate) fn strength(&self, v: f64) -> f64 {
        self.effects[0].strength(v)
    }

    /// A strength with its interval from coordinates to values.
    fn profile(&self, of: Strength) -> Strength {
        let [lo, hi] = [of.lo, of.hi].map(|end| end.map(|v| self.strength(v)));
        let (lo, hi) = if self.effects[0].unit < 0.0 { (hi, lo) } else { (lo, hi) };
        Strength { value: self.strength(of.value), lo, hi }
    }

    /// Parameters with strengths in place of coordinates.
    pub(crate) fn decoded(&self, theta: &[f64]) -> Vec<f64> {
        let mut at = theta.to_vec();
        let first = at.len().saturating_sub(self.effects.len());
        for (v, e) in at[first..].iter_mut().zip(&self.effects) {
            *v = e.strength(*v);
        }
        at
    }

    /// A small change of the first strength about "absent", as a coordinate.
    pub(crate) fn change(&self, by: f64) -> f64 {
        let own = self.effects[0];
        ((own.scale.forth(own.null + by) - own.scale.forth(own.null)) / own.unit).abs()
    }

    pub(crate) fn range(&self, (low, high): (f64, f64)) -> (f64, f64) {
        let own = self.effects[0];
        let code = |s: f64| (own.scale.forth(s) - own.scale.forth(own.null)) / own.unit;
        let (a, b) = (code(low), code(high));
        (a.min(b), a.max(b))
    }
}

impl Simulator for Coded {
    fn parameters(&self) -> Vec<String> {
        self.inner.simulator().parameters()
    }

    fn speed_range_rpm(&self) -> (f64, f64) {
        self.inner.simulator().speed_range_rpm()
    }

    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        self.inner.simulator().predict(&self.decoded(theta), at)
    }

    fn aside(&self, theta: &[f64]) -> Result<Option<f64>, CalibError> {
        self.inner.simulator().aside(&self.decoded(theta))
    }

    fn expected(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Vec<f64>, CalibError> {
        self.inner.simulator().expected(&self.decoded(theta), at)
    }
}

/// Strengths of a finding from coordinates to values.
pub(crate) fn decode(finding: &mut Finding, models: &[(&Effect, Coded)]) {
    let model = |name: &str| models.iter().find(|(e, _)| e.path == name).map(|(_, m)| m);
    for r in &mut finding.ranked {
        let Some(m) = model(&r.name) else { continue };
        r.strength = m.profile(r.strength);
        if let Some(v) = r.fit.theta.last_mut() {
            *v = m.strength(*v);
        }
        // A curvature in another coordinate is no standard deviation.
        if let Some(sd) = r.fit.sd.last_mut() {
            *sd = None;
        }
    }
    for p in &mut finding.pairs {
        for (name, s) in p.names.iter().zip(&mut p.strengths) {
            if let Some(m) = model(name) {
                *s = m.profile(*s);
            }
        }
    }
    for d in &mut finding.detectable {
        if let Some(m) = model(&d.name) {
            d.towards = m.strength(d.towards);
            d.strength = d.strength.map(|s| m.strength(s));
        }
    }
}
