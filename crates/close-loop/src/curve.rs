//! Effects that change no motion: known exactly, or by filming the same motion again.

use calib::{CalibError, Predicted, Simulator};

use crate::emulator::Emulator;

/// How an effect changes the responses.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Added to one response (index in the order of `rig_schema::Response::ALL`).
    Shift(usize),
    /// Divides both coordinates of the centre of area: an error of the radius.
    Divide,
    /// Change at each knot for one unit of strength and for its square, with the variance of the
    /// first.
    Filmed {
        /// Strength over this is the unit.
        unit: f64,
        /// Change for one unit.
        first: Vec<[f64; 4]>,
        /// Change for its square.
        second: Vec<[f64; 4]>,
        /// Variance of `first`.
        variance: Vec<[f64; 4]>,
    },
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

impl Simulator for Curve {
    fn parameters(&self) -> Vec<String> {
        let mut all = self.base.parameters();
        all.push(self.name.clone());
        all
    }

    fn speed_range_rpm(&self) -> (f64, f64) {
        self.base.speed_range_rpm()
    }

    fn predict(&self, theta: &[f64], speeds_rpm: &[f64]) -> Result<Predicted, CalibError> {
        let expected = self.base.axes().len() + 1;
        let Some((strength, base)) = theta.split_last().filter(|_| theta.len() == expected) else {
            return Err(CalibError::Parameters { expected, given: theta.len() });
        };
        let mut at = self.base.moments(base);
        for (k, four) in at.iter_mut().enumerate() {
            match &self.change {
                Change::Shift(r) => four[*r].0 += strength - self.null,
                Change::Divide => {
                    for value in &mut four[2..] {
                        value.0 /= strength / self.null;
                    }
                }
                Change::Filmed { unit, first, second, variance } => {
                    let v = (strength - self.null) / unit;
                    for (r, value) in four.iter_mut().enumerate() {
                        value.0 += v * first[k][r] + v * v * second[k][r];
                        value.1 += v * v * variance[k][r];
                    }
                }
            }
        }
        Ok(self.base.spread(speeds_rpm, &at))
    }
}
