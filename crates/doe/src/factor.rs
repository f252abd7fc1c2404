//! Factors and their coding: what a plan varies, and between which values.
//!
//! Coding maps the range of a factor onto -1..1 from its middle, `c = (x - mid) / half`. A
//! coefficient of a coded factor is then the change of the response from the centre of the
//! plan to its high level, which makes coefficients of different factors comparable and the
//! columns of a design matrix nearly orthogonal.

use crate::error::DoeError;

/// A quantity that a plan varies between two levels.
///
/// ```
/// let speed = doe::Factor::new("omega_rpm", 4.0, 30.0)?;
/// assert_eq!(speed.code(17.0), 0.0);
/// assert_eq!(speed.code(30.0), 1.0);
/// assert_eq!(speed.decode(-1.0), 4.0);
/// # Ok::<(), doe::DoeError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Factor {
    /// Name, as it appears in terms, tables and reports; the unit belongs in it.
    pub name: String,
    /// Value that is coded as -1, natural unit.
    pub low: f64,
    /// Value that is coded as 1, natural unit.
    pub high: f64,
}

impl Factor {
    /// A factor between two values.
    ///
    /// # Errors
    /// [`DoeError::FactorRange`] unless both are finite and `low < high`;
    /// [`DoeError::FactorName`] if the name is empty or could be misread in a term's name.
    pub fn new(name: impl Into<String>, low: f64, high: f64) -> Result<Self, DoeError> {
        let factor = Self { name: name.into(), low, high };
        factor.check()?;
        Ok(factor)
    }

    /// A factor whose coded value is its natural value, for models in natural units.
    ///
    /// # Errors
    /// [`DoeError::FactorName`] as for [`Factor::new`].
    pub fn uncoded(name: impl Into<String>) -> Result<Self, DoeError> {
        Self::new(name, -1.0, 1.0)
    }

    /// Tests what [`Factor::new`] tests; the fields are public, so a value may be invalid.
    ///
    /// # Errors
    /// As [`Factor::new`].
    pub fn check(&self) -> Result<(), DoeError> {
        if self.name.is_empty() || self.name.contains(['*', '^', '(', ')', '/']) {
            return Err(DoeError::FactorName { name: self.name.clone() });
        }
        let ordered = self.low < self.high && (self.high - self.low).is_finite();
        if !ordered {
            return Err(DoeError::FactorRange {
                name: self.name.clone(),
                low: self.low,
                high: self.high,
            });
        }
        Ok(())
    }

    /// Middle of the range, natural unit.
    pub fn centre(&self) -> f64 {
        self.low + 0.5 * (self.high - self.low)
    }

    /// Half of the range, natural unit.
    pub fn half_range(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// Coded value of a natural one: -1 at `low`, 0 in the middle, 1 at `high`.
    pub fn code(&self, x: f64) -> f64 {
        (x - self.centre()) / self.half_range()
    }

    /// Natural value of a coded one.
    pub fn decode(&self, coded: f64) -> f64 {
        self.centre() + coded * self.half_range()
    }
}

/// Tests every factor and that no two share a name.
pub(crate) fn check_factors(factors: &[Factor]) -> Result<(), DoeError> {
    if factors.is_empty() {
        return Err(DoeError::Empty { what: "factors" });
    }
    for (i, factor) in factors.iter().enumerate() {
        factor.check()?;
        if factors[..i].iter().any(|other| other.name == factor.name) {
            return Err(DoeError::DuplicateFactor { name: factor.name.clone() });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decoding_undoes_coding() {
        let f = Factor::new("mu_pp", 0.1, 0.9).unwrap();
        for x in [0.1, 0.25, 0.5, 0.9, 1.3] {
            // One rounding each way, relative to the half range.
            assert!((f.decode(f.code(x)) - x).abs() < 4.0 * f64::EPSILON);
        }
    }

    #[test]
    fn an_uncoded_factor_keeps_every_bit() {
        let f = Factor::uncoded("x").unwrap();
        for x in [0.1, -8.781464495, 1.0e15, 3.0e-7] {
            assert_eq!(f.code(x), x);
        }
    }

    #[test]
    fn a_range_that_is_no_interval_is_refused() {
        for (low, high) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert!(matches!(Factor::new("x", low, high), Err(DoeError::FactorRange { .. })));
        }
        assert!(matches!(Factor::new("a*b", 0.0, 1.0), Err(DoeError::FactorName { .. })));
    }
}
