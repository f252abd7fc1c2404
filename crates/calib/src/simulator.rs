//! A simulation as calibration sees it.

use crate::{CalibError, OperatingPoint};

/// Responses that a simulator expects, with the covariance of its own error.
///
/// Element `4 k + r` is response `r` (in the order of `rig_schema::Response::ALL`) at operating point `k`.
#[derive(Debug, Clone, PartialEq)]
pub struct Predicted {
    /// Expected responses, deg and percent of R; length 4 x operating points.
    pub mean: Vec<f64>,
    /// Covariance of the simulator's error, row-major, (4 x operating points) squared.
    pub covariance: Vec<f64>,
}

impl Predicted {
    /// Covariance between two elements.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        self.covariance[i * self.mean.len() + j]
    }
}

/// Parameters to responses with covariance.
///
/// ```
/// use calib::{CalibError, OperatingPoint, Predicted, Simulator};
/// /// A bed whose angle is the arc tangent of its friction, known to 0.1 deg.
/// struct Wedge;
/// impl Simulator for Wedge {
///     fn parameters(&self) -> Vec<String> {
///         vec!["friction.pp".to_owned()]
///     }
///     fn speed_range_rpm(&self) -> (f64, f64) {
///         (1.0, 10.0)
///     }
///     fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
///         let angle = theta[0].atan().to_degrees();
///         let mean = at.iter().flat_map(|_| [angle, angle, 30.0, 50.0]).collect();
///         let n = 4 * at.len();
///         let covariance = (0..n * n).map(|k| if k % (n + 1) == 0 { 0.01 } else { 0.0 }).collect();
///         Ok(Predicted { mean, covariance })
///     }
/// }
/// let angle = Wedge.predict(&[0.5], &[4.0.into()])?.mean[0];
/// assert!((angle - 26.565).abs() < 1e-3);
/// # Ok::<(), CalibError>(())
/// ```
pub trait Simulator {
    /// Paths of the parameters in the order of `theta`.
    fn parameters(&self) -> Vec<String>;
    /// Speeds within which predictions hold, rpm.
    fn speed_range_rpm(&self) -> (f64, f64);
    /// Responses at `theta` for each operating point.
    ///
    /// # Errors
    /// [`CalibError`] if the parameters do not fit or a response is not finite.
    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError>;

    /// Responses without their covariance, for searches that hold it.
    ///
    /// Worth overriding where the covariance is most of the work; must equal the mean of
    /// [`Simulator::predict`].
    ///
    /// # Errors
    /// As [`Simulator::predict`].
    fn expected(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Vec<f64>, CalibError> {
        self.predict(theta, at).map(|p| p.mean)
    }

    /// Deviance (-2 log likelihood) at `theta` of what was measured besides the observations, such as how far
    /// single frames scatter: it ranks effects, but is no part of any fit or test. `None` where there is nothing.
    ///
    /// # Errors
    /// As [`Simulator::predict`].
    fn aside(&self, theta: &[f64]) -> Result<Option<f64>, CalibError> {
        let _ = theta;
        Ok(None)
    }
}
