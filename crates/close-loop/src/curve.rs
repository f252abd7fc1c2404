//! Effects that change no motion: known exactly, or by filming the same motion again.

use calib::{CalibError, OperatingPoint, Predicted, Simulator};

use crate::emulator::Emulator;
use crate::filmed::Filmed;

/// How an effect changes the responses.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Added to one response (index in the order of `rig_schema::Response::ALL`).
    Shift(usize),
    /// Divides both coordinates of the centre of area: an error of the radius.
    Divide,
    /// By another camera.
    Filmed(Filmed),
}

/// A base model with one such effect; its parameters are the base's and the strength.
#[derive(Debug, Clone)]
pub struct Curve {
    /// The base model.
    pub base: Emulator,
    /// Name of the effect.
    pub name: String,
    /// Strength at which it is absent.
    pub null: f64,
    /// What it does.
    pub change: Change,
}

impl Curve {
    fn split<'t>(&self, theta: &'t [f64]) -> Result<(f64, &'t [f64]), CalibError> {
        let expected = self.base.axes().len() + 1;
        match theta.split_last() {
            Some((strength, base)) if theta.len() == expected => Ok((*strength, base)),
            _ => Err(CalibError::Parameters { expected, given: theta.len() }),
        }
    }

    /// Change the means at knot `k`.
    fn shift(&self, k: usize, strength: f64, four: &mut [f64; 4]) {
        match &self.change {
            Change::Shift(r) => four[*r] += strength - self.null,
            Change::Divide => four[2..].iter_mut().for_each(|v| *v /= strength / self.null),
            Change::Filmed(filmed) => filmed.shift(k, strength - self.null, four),
        }
    }
}

impl Simulator for Curve {
    fn parameters(&self) -> Vec<String> {
        let mut all = self.base.parameters();
        all.push(self.name.clone());
        all
    }

    fn speed_range_rpm(&self) -> (f64, f64) {
        self.base.speed_range_rpm()
    }

    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        let (strength, base) = self.split(theta)?;
        self.base.check(base, at)?;
        let mut local = self.base.moments(base);
        for (k, four) in local.at.iter_mut().enumerate() {
            self.shift(k, strength, &mut four.0);
            if let Change::Filmed(filmed) = &self.change {
                let variance = filmed.variance(k, strength - self.null);
                variance.iter().enumerate().for_each(|(r, own)| four.1[r][r] += own);
            }
        }
        Ok(self.base.spread(at, &local))
    }

    fn aside(&self, theta: &[f64]) -> Result<Option<f64>, CalibError> {
        // The motion is the base's.
        self.base.aside(self.split(theta)?.1)
    }

    fn expected(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Vec<f64>, CalibError> {
        let (strength, base) = self.split(theta)?;
        self.base.check(base, at)?;
        let mut knots = self.base.at_knots(base);
        for (k, four) in knots.iter_mut().enumerate() {
            self.shift(k, strength, four);
        }
        Ok(self.base.between(at, &knots))
    }
}
