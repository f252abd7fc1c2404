//! Predictions and their intervals.

use crate::distribution::t_quantile_two_sided;
use crate::error::DoeError;

/// The response that a fit expects at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Prediction {
    /// Expected response.
    pub mean: f64,
    /// Variance of the expected response, from the errors of the coefficients.
    pub var_mean: f64,
    /// Variance of a new run of unit weight about `mean`: `var_mean` plus the residual variance.
    pub var_new: f64,
    /// Residual degrees of freedom of the fit.
    pub df: usize,
}

impl Prediction {
    /// Confidence interval of the expected response by Student's t.
    ///
    /// # Errors
    /// [`DoeError::Probability`] unless `0 < level < 1`.
    pub fn interval(&self, level: f64) -> Result<(f64, f64), DoeError> {
        self.around(self.var_mean, level)
    }

    /// Interval that holds a new run of unit weight, by Student's t.
    ///
    /// # Errors
    /// As [`Prediction::interval`].
    pub fn interval_new(&self, level: f64) -> Result<(f64, f64), DoeError> {
        self.around(self.var_new, level)
    }

    fn around(&self, variance: f64, level: f64) -> Result<(f64, f64), DoeError> {
        check_probability("level", level)?;
        let half = t_quantile_two_sided(level, self.df as f64) * variance.sqrt();
        Ok((self.mean - half, self.mean + half))
    }
}

pub(crate) fn check_probability(what: &'static str, value: f64) -> Result<(), DoeError> {
    if value > 0.0 && value < 1.0 { Ok(()) } else { Err(DoeError::Probability { what, value }) }
}
