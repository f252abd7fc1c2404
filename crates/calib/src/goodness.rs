//! Goodness of fit against the chi-square distribution.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// Chi-square of a fit with its degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goodness {
    /// Squared whitened residual.
    pub chi2: f64,
    /// Observations less free parameters; nuisances have priors and count on neither side.
    pub dof: usize,
    /// Probability of a larger chi-square if the model is right.
    pub p: f64,
}

impl Goodness {
    /// Goodness of a chi-square.
    pub fn new(chi2: f64, dof: usize) -> Self {
        Self { chi2, dof, p: chi_square_p(chi2, dof) }
    }

    /// Factor on the variance that would make the fit acceptable, never below 1 (the square of
    /// the Birge ratio). Intervals of a misfitting model are widened by its root.
    pub fn inflation(&self) -> f64 {
        if self.dof == 0 { 1.0 } else { (self.chi2 / self.dof as f64).max(1.0) }
    }
}

/// Probability of a chi-square above `chi2` with `dof` degrees of freedom (1 for none).
///
/// ```
/// // The 5 % point for one degree of freedom is 1.96 squared.
/// assert!((calib::chi_square_p(1.959964_f64.powi(2), 1) - 0.05).abs() < 1e-7);
/// ```
pub fn chi_square_p(chi2: f64, dof: usize) -> f64 {
    if !(chi2 > 0.0) {
        return 1.0;
    }
    ChiSquared::new(dof as f64).map_or(1.0, |d| d.sf(chi2))
}

/// Probability of a chi-square above `chi2` with `dof` degrees of freedom where the size of all errors is itself known with
/// `errors_dof` only: Fisher's F (1 for none).
///
/// ```
/// // The 5 % point of F with 10 and 20 degrees of freedom is 2.3479 (tables of Pearson and Hartley).
/// assert!((calib::variance_ratio_p(23.479, 10, 20.0) - 0.05).abs() < 1e-5);
/// // With errors that are known that well the same misfit would be rarer.
/// assert!(calib::chi_square_p(23.479, 10) < 0.01);
/// ```
pub fn variance_ratio_p(chi2: f64, dof: usize, errors_dof: f64) -> f64 {
    if !(chi2 > 0.0) {
        return 1.0;
    }
    let dof = dof as f64;
    FisherSnedecor::new(dof, errors_dof).map_or(1.0, |f| f.sf(chi2 / dof))
}

/// Value that a chi-square of one degree of freedom exceeds with probability `1 - level`.
///
/// ```
/// assert!((calib::upper_quantile(0.95) - 3.841459).abs() < 1e-5);
/// ```
pub fn upper_quantile(level: f64) -> f64 {
    ChiSquared::new(1.0).map_or(f64::NAN, |d| d.inverse_cdf(level))
}
