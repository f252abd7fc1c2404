//! One number held against a reference.

use serde::Serialize;

/// A computed number, its reference, and whether they agree.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Case: set-up and parameters.
    pub case: String,
    /// What is compared, with its unit.
    pub quantity: String,
    /// Reference value.
    pub reference: f64,
    /// Value that `dem-core` gives.
    pub ours: f64,
    /// `|ours - reference|` over the scale named in the tolerance.
    pub deviation: f64,
    /// Largest deviation that passes.
    pub tolerance: f64,
    /// Why this tolerance, and what it is relative to.
    pub tolerance_reason: &'static str,
    /// Where the reference comes from.
    pub source: &'static str,
    /// Whether the deviation is within the tolerance.
    pub pass: bool,
}

/// What the checks of one group have in common.
#[derive(Debug, Clone, Copy)]
pub struct Held {
    /// Largest deviation that passes.
    pub tolerance: f64,
    /// Why this tolerance.
    pub reason: &'static str,
    /// Where the reference comes from.
    pub source: &'static str,
}

impl Held {
    /// Deviation relative to `scale`.
    pub fn of_scale(
        &self,
        case: impl Into<String>,
        quantity: impl Into<String>,
        reference: f64,
        ours: f64,
        scale: f64,
    ) -> Check {
        let deviation = (ours - reference).abs() / scale;
        Check {
            case: case.into(),
            quantity: quantity.into(),
            reference,
            ours,
            deviation,
            tolerance: self.tolerance,
            tolerance_reason: self.reason,
            source: self.source,
            // written so that a NaN fails
            pass: deviation <= self.tolerance,
        }
    }

    /// Deviation relative to the reference.
    pub fn relative(
        &self,
        case: impl Into<String>,
        quantity: impl Into<String>,
        reference: f64,
        ours: f64,
    ) -> Check {
        self.of_scale(case, quantity, reference, ours, reference.abs())
    }

    /// Deviation in the unit of the quantity.
    pub fn absolute(
        &self,
        case: impl Into<String>,
        quantity: impl Into<String>,
        reference: f64,
        ours: f64,
    ) -> Check {
        self.of_scale(case, quantity, reference, ours, 1.0)
    }

    /// A lower bound; the deviation is what is missing.
    pub fn at_least(
        &self,
        case: impl Into<String>,
        quantity: impl Into<String>,
        bound: f64,
        ours: f64,
    ) -> Check {
        let check = self.absolute(case, quantity, bound, ours);
        let deviation = if ours >= bound { 0.0 } else { check.deviation };
        Check { deviation, pass: deviation <= self.tolerance, ..check }
    }

    /// An upper bound; the deviation is the excess.
    pub fn at_most(
        &self,
        case: impl Into<String>,
        quantity: impl Into<String>,
        bound: f64,
        ours: f64,
    ) -> Check {
        let check = self.absolute(case, quantity, bound, ours);
        let deviation = if ours <= bound { 0.0 } else { check.deviation };
        Check { deviation, pass: deviation <= self.tolerance, ..check }
    }

    /// A statement that holds (1) or does not (0).
    pub fn fact(
        &self,
        case: impl Into<String>,
        quantity: impl Into<String>,
        expected: bool,
        found: bool,
    ) -> Check {
        self.absolute(case, quantity, f64::from(u8::from(expected)), f64::from(u8::from(found)))
    }
}
