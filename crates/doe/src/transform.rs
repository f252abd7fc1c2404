//! Skewness of a response and the transforms that straighten it.
//!
//! A response skewed by more than twice the standard error of its skewness breaks the assumption
//! of equal, normal errors. To the right, a logarithm or a Box-Cox power pulls the tail in; to
//! the left (thesis Figure 36), the negative logarithm of the distance to an upper limit does.

use crate::error::DoeError;
use crate::fit::{Fit, centre};
use crate::least_squares::{Factored, dot};

/// A change of the response's scale.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Transform {
    /// y itself.
    Identity,
    /// ln y.
    Log,
    /// (y^lambda - 1) / lambda; the logarithm in the limit of lambda 0.
    BoxCox {
        /// The power.
        lambda: f64,
    },
    /// -ln(upper - y).
    NegativeLog {
        /// A limit above every response.
        upper: f64,
    },
}

impl Transform {
    /// The transformed responses.
    ///
    /// # Errors
    /// [`DoeError::TransformDomain`] where a response has no image.
    pub fn apply(&self, y: &[f64]) -> Result<Vec<f64>, DoeError> {
        let (transform, needs) = match self {
            Self::Identity => ("identity", "a finite number"),
            Self::Log => ("logarithm", "a positive number"),
            Self::BoxCox { .. } => ("Box-Cox power", "a positive number"),
            Self::NegativeLog { .. } => ("negative logarithm", "a number below the upper limit"),
        };
        let image = |(run, &value): (usize, &f64)| {
            let z = match *self {
                Self::Identity => value,
                Self::Log if value > 0.0 => value.ln(),
                Self::BoxCox { lambda } if value > 0.0 => box_cox_power(value, lambda),
                Self::NegativeLog { upper } if value < upper => -(upper - value).ln(),
                _ => f64::NAN,
            };
            if z.is_finite() {
                return Ok(z);
            }
            Err(DoeError::TransformDomain { run, value, transform, needs })
        };
        y.iter().enumerate().map(image).collect()
    }

    /// The response of a transformed value; none where no response has it.
    pub fn invert(&self, z: f64) -> Option<f64> {
        let y = match *self {
            Self::Identity => z,
            Self::Log => z.exp(),
            Self::BoxCox { lambda: 0.0 } => z.exp(),
            Self::BoxCox { lambda } => {
                let base = 1.0 + lambda * z;
                if base <= 0.0 {
                    return None;
                }
                base.powf(1.0 / lambda)
            }
            Self::NegativeLog { upper } => upper - (-z).exp(),
        };
        y.is_finite().then_some(y)
    }
}

fn box_cox_power(y: f64, lambda: f64) -> f64 {
    // expm1 keeps the digits near lambda 0, where the power tends to the logarithm.
    let log = y.ln();
    if lambda == 0.0 { log } else { (lambda * log).exp_m1() / lambda }
}

/// Skewness of a sample with its standard error under normality.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Skewness {
    /// Third standardised moment, adjusted for the sample size (G1).
    pub value: f64,
    /// Its standard deviation over normal samples of this size.
    pub standard_error: f64,
}

impl Skewness {
    /// Skewness of a sample; none for fewer than three values or without scatter.
    pub fn of(y: &[f64]) -> Option<Self> {
        let n = y.len() as f64;
        if y.len() < 3 {
            return None;
        }
        let mean = y.iter().sum::<f64>() / n;
        let moment = |k: i32| y.iter().map(|v| (v - mean).powi(k)).sum::<f64>() / n;
        let (second, third) = (moment(2), moment(3));
        let value = third / second.powf(1.5) * (n * (n - 1.0)).sqrt() / (n - 2.0);
        let standard_error = (6.0 * n * (n - 1.0) / ((n - 2.0) * (n + 1.0) * (n + 3.0))).sqrt();
        value.is_finite().then_some(Self { value, standard_error })
    }

    /// Whether it exceeds twice its standard error.
    pub fn is_pronounced(&self) -> bool {
        self.value.abs() > 2.0 * self.standard_error
    }

    /// The transform that takes a pronounced skewness out; none where it is not pronounced.
    ///
    /// To the right: the logarithm, if every response is positive. To the left: the negative
    /// logarithm with the upper limit that leaves no skewness.
    pub fn advice(&self, y: &[f64]) -> Option<Transform> {
        if !self.is_pronounced() {
            return None;
        }
        if self.value > 0.0 {
            return y.iter().all(|v| *v > 0.0).then_some(Transform::Log);
        }
        // The closer the limit to the largest response, the more its tail is drawn out: bisect
        // the distance, in the logarithm, between far too near and far too wide.
        let highest = y.iter().fold(f64::NEG_INFINITY, |m, v| m.max(*v));
        let range = highest - y.iter().fold(f64::INFINITY, |m, v| m.min(*v));
        let at = |log: f64| Transform::NegativeLog { upper: highest + range * log.exp2() };
        let skewness = |log: f64| Self::of(&at(log).apply(y).ok()?).map(|s| s.value);
        let (mut near, mut wide) = (-20.0, 10.0);
        if skewness(near)? < 0.0 {
            return None;
        }
        for _ in 0..60 {
            let middle = 0.5 * (near + wide);
            if skewness(middle)? > 0.0 { near = middle } else { wide = middle }
        }
        Some(at(wide))
    }
}

/// The power transform under which the residuals of a model are most nearly normal.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BoxCox {
    /// The power of largest likelihood, within -3 to 3.
    pub lambda: f64,
    /// Lower end of its 95 % interval, within the same bounds.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl BoxCox {
    /// Whether the interval holds 1: the response may stay as it is.
    pub fn allows_identity(&self) -> bool {
        self.low <= 1.0 && 1.0 <= self.high
    }

    /// The plainest transform in the interval: as it is, logarithm, a half power, or `lambda`.
    pub fn advice(&self) -> Transform {
        let plain = [1.0, 0.0, 0.5, -1.0, 2.0, -0.5];
        match plain.into_iter().find(|l| self.low <= *l && *l <= self.high) {
            Some(1.0) => Transform::Identity,
            Some(0.0) => Transform::Log,
            Some(lambda) => Transform::BoxCox { lambda },
            None => Transform::BoxCox { lambda: self.lambda },
        }
    }
}

/// Bounds of the powers that are looked at.
const POWERS: (f64, f64) = (-3.0, 3.0);
/// Half of the 95 % quantile of chi-square with one degree of freedom.
const LIKELIHOOD_DROP: f64 = 0.5 * 3.841_458_820_694_124;

impl Fit {
    /// Skewness of the response; none for fewer than three runs.
    pub fn response_skewness(&self) -> Option<Skewness> {
        Skewness::of(self.response())
    }

    /// The Box-Cox power by maximum likelihood of this model, with its 95 % interval.
    ///
    /// G. E. P. Box, D. R. Cox, J. R. Stat. Soc. B 26, 1964.
    ///
    /// # Errors
    /// [`DoeError::TransformDomain`] if a response is not positive.
    pub fn box_cox(&self) -> Result<BoxCox, DoeError> {
        Transform::Log.apply(self.response())?;
        let factored = Factored::new(&self.columns, &self.model.term_names())?;
        let n = self.runs() as f64;
        let mean_log = self.y.iter().map(|y| y.ln()).sum::<f64>() / n;
        let likelihood = |lambda: f64| {
            // Divided by the Jacobian's share of one run, squares of different powers compare.
            let shrink = ((1.0 - lambda) * mean_log).exp();
            let mut z: Vec<f64> =
                self.y.iter().map(|y| box_cox_power(*y, lambda) * shrink).collect();
            self.whitener.whiten(&mut z);
            let (_, left) = factored.project(&centre(&z, self.ones.as_deref()));
            -0.5 * n * dot(&left, &left).ln()
        };
        // A grid finds the highest of several peaks, golden section polishes it.
        let steps = 120;
        let at = |i: i32| POWERS.0 + (POWERS.1 - POWERS.0) * f64::from(i) / f64::from(steps);
        let peak = (0..=steps)
            .max_by(|a, b| likelihood(at(*a)).total_cmp(&likelihood(at(*b))))
            .expect("the grid is not empty");
        let lambda = golden_section(&likelihood, at((peak - 1).max(0)), at((peak + 1).min(steps)));
        let floor = likelihood(lambda) - LIKELIHOOD_DROP;
        let end = |mut outside: f64| {
            if likelihood(outside) >= floor {
                return outside;
            }
            let mut inside = lambda;
            for _ in 0..60 {
                let middle = 0.5 * (inside + outside);
                if likelihood(middle) >= floor { inside = middle } else { outside = middle }
            }
            inside
        };
        Ok(BoxCox { lambda, low: end(POWERS.0), high: end(POWERS.1) })
    }
}

fn golden_section(f: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..60 {
        let (a, b) = (high - ratio * (high - low), low + ratio * (high - low));
        if f(a) < f(b) { low = a } else { high = b }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Factor, Model, ModelTerms, Weighting, fit};

    #[test]
    fn every_transform_is_undone_by_its_inverse() {
        let y = [0.3, 1.0, 7.5];
        for t in [
            Transform::Identity,
            Transform::Log,
            Transform::BoxCox { lambda: 0.5 },
            Transform::BoxCox { lambda: -1.0 },
            Transform::NegativeLog { upper: 8.0 },
        ] {
            for (z, y) in t.apply(&y).unwrap().into_iter().zip(y) {
                // A logarithm and an exponential, a few roundings each.
                assert!((t.invert(z).unwrap() - y).abs() < 1.0e-13);
            }
        }
    }

    #[test]
    fn a_response_without_image_is_named() {
        let error = Transform::Log.apply(&[1.0, -2.0]).unwrap_err();
        assert_eq!(error.to_string(), "response -2 of run 1 has no logarithm: a positive number");
    }

    #[test]
    fn skewness_of_a_known_sample() {
        // {0, 0, 0, 0, 5}: mean 1, m2 = 4, m3 = 12, so g1 = 1.5 and G1 = 1.5 sqrt(20)/3.
        let s = Skewness::of(&[0.0, 0.0, 0.0, 0.0, 5.0]).unwrap();
        assert!((s.value - 1.5 * 20.0_f64.sqrt() / 3.0).abs() < 1.0e-14);
        assert!((s.standard_error - (120.0_f64 / (3.0 * 6.0 * 8.0)).sqrt()).abs() < 1.0e-14);
    }

    #[test]
    fn advice_removes_the_skewness_on_either_side() {
        let spread: Vec<f64> = (0..40).map(|i| f64::from(i) / 10.0 - 2.0).collect();
        let right: Vec<f64> = spread.iter().map(|z| z.exp()).collect();
        let left: Vec<f64> = spread.iter().map(|z| 30.0 - (-z).exp()).collect();
        for (y, log) in [(&right, true), (&left, false)] {
            let s = Skewness::of(y).unwrap();
            assert!(s.is_pronounced());
            let t = s.advice(y).unwrap();
            assert_eq!(t == Transform::Log, log);
            assert!(Skewness::of(&t.apply(y).unwrap()).unwrap().value.abs() < 1.0e-9);
        }
        assert!(Skewness::of(&spread).unwrap().advice(&spread).is_none());
    }

    #[test]
    fn box_cox_finds_the_power_that_made_the_response() {
        let x: Vec<[f64; 1]> = (0..40).map(|i| [f64::from(i) / 20.0 - 1.0]).collect();
        let noise = |i: usize| ((i * 7919 + 104_729) % 1000) as f64 / 2.0e4 - 0.025;
        let f = [Factor::uncoded("x").unwrap()];
        let model = Model::new(&f, &ModelTerms::linear(&f)).unwrap();
        let line: Vec<f64> = x.iter().enumerate().map(|(i, x)| 3.0 + x[0] + noise(i)).collect();
        for (power, lambda) in [(1.0, 1.0), (2.0, 0.5), (-1.0, -1.0)] {
            let y: Vec<f64> = line.iter().map(|z| z.powf(power)).collect();
            let b = fit(&model, &x, &y, Weighting::Ordinary).unwrap().box_cox().unwrap();
            assert!(b.low <= lambda && lambda <= b.high, "{b:?}");
            // The scatter of 1 % over a threefold range pins the power to about 0.1.
            assert!(b.high - b.low < 0.3, "{b:?}");
        }
    }
}
