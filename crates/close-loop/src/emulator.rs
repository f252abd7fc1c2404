//! What simulations say near a point: a quadratic with stated ignorance of what it leaves out.
//!
//! Around a centre each response at each speed is a quadratic in coded coordinates, fitted to all
//! runs at hand by Bayesian regression: the coefficients have normal priors wide against what
//! drums show, and each run carries its own sampling error and a remainder that grows with the
//! distance from the centre, so that far runs guide but do not bend the fit. The covariance of a
//! prediction is that of the coefficients and of the remainder; what runs scatter beyond their
//! frames (another filling of the drum) is found from the residuals and counted once more for the
//! measured drum, which is one filling too.

use calib::{CalibError, Predicted, Simulator};
use faer::linalg::solvers::Solve as _;
use faer::{Mat, Side};

use crate::scale::Scale;
use crate::speeds::weights;

/// Prior standard deviation of a slope, deg or percent of R for one coded unit.
const SLOPE: f64 = 6.0;
/// Of a curvature.
const CURVATURE: f64 = 2.0;
/// Of a product of two coordinates.
const PRODUCT: f64 = 1.5;
/// Remainder of the quadratic at one coded unit from the centre.
const REMAINDER: f64 = 0.25;
/// Distance from which the remainder grows in proportion only.
const FAR: f64 = 1.5;

/// Shift of the four responses at one speed, with its covariance.
pub type Shift = ([f64; 4], [[f64; 4]; 4]);

/// One coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Path of the parameter.
    pub path: String,
    /// Its coordinate.
    pub scale: Scale,
    /// Change of the coordinate that counts as one.
    pub unit: f64,
}

/// What one run showed.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Values of all axes.
    pub at: Vec<f64>,
    /// Responses at each knot.
    pub mean: Vec<[f64; 4]>,
    /// Their covariance from the frames.
    pub covariance: Vec<[[f64; 4]; 4]>,
}

/// A local model of the simulator.
#[derive(Debug, Clone)]
pub struct Emulator {
    axes: Vec<Axis>,
    centre: Vec<f64>,
    knots: Vec<f64>,
    /// Coefficients and their covariance, by knot and response.
    fits: Vec<[Coefficients; 4]>,
    /// Mean covariance of one run from its frames, by knot.
    frames: Vec<[[f64; 4]; 4]>,
    inflation: f64,
    /// Uncertain knowns that were simulated: change of (knot, response) for one standard deviation.
    modes: Vec<Vec<[f64; 4]>>,
    /// Added to every prediction, with its covariance, by knot.
    bias: Vec<Shift>,
}

#[derive(Debug, Clone)]
struct Coefficients {
    beta: Vec<f64>,
    covariance: Mat<f64>,
}

impl Emulator {
    /// Fit a model about `centre` (a value for each axis) to runs at `knots` rpm.
    ///
    /// # Errors
    /// [`CalibError::TooFewRuns`] with fewer than two runs, [`CalibError::Covariance`] if the
    /// regression has no solution.
    pub fn fit(
        axes: Vec<Axis>,
        centre: Vec<f64>,
        knots: Vec<f64>,
        samples: &[Sample],
    ) -> Result<Self, CalibError> {
        if samples.len() < 2 {
            return Err(CalibError::TooFewRuns { runs: samples.len(), terms: 1, needed: 2 });
        }
        let coded: Vec<Vec<f64>> = samples.iter().map(|s| code(&axes, &centre, &s.at)).collect();
        let rows: Vec<Vec<f64>> = coded.iter().map(|z| terms(z)).collect();
        let remainder: Vec<f64> = coded.iter().map(|z| remainder(z).powi(2)).collect();
        let frames: Vec<[[f64; 4]; 4]> = (0..knots.len())
            .map(|k| {
                let mut mean = [[0.0; 4]; 4];
                for s in samples {
                    for (r, row) in mean.iter_mut().enumerate() {
                        for (c, m) in row.iter_mut().enumerate() {
                            *m += s.covariance[k][r][c] / samples.len() as f64;
                        }
                    }
                }
                mean
            })
            .collect();
        let mut inflation = 1.0;
        let mut fits = Vec::new();
        for _ in 0..4 {
            fits.clear();
            let (mut chi2, mut dof) = (0.0, 0.0);
            for (k, frame) in frames.iter().enumerate() {
                let mut four = Vec::with_capacity(4);
                for (r, own) in frame.iter().enumerate() {
                    let noise: Vec<f64> =
                        remainder.iter().map(|m| inflation * own[r].max(1e-8) + m).collect();
                    let y: Vec<f64> = samples.iter().map(|s| s.mean[k][r]).collect();
                    let fit = regress(&rows, &y, &noise, axes.len())?;
                    for (i, row) in rows.iter().enumerate() {
                        let leverage = quadratic(&fit.covariance, row) / noise[i];
                        // Only runs near the centre tell of the scatter.
                        let share = own[r] / (own[r] + remainder[i]);
                        let e = y[i] - dot(&fit.beta, row);
                        chi2 += share * e * e / own[r].max(1e-8);
                        dof += share * (1.0 - leverage).max(0.0);
                    }
                    four.push(fit);
                }
                let four: [Coefficients; 4] = four
                    .try_into()
                    .map_err(|_| CalibError::Covariance { what: "a regression", size: 4 })?;
                fits.push(four);
            }
            if dof > 1.0 {
                inflation = (chi2 / dof).clamp(1.0, 50.0);
            }
        }
        let bias = vec![([0.0; 4], [[0.0; 4]; 4]); knots.len()];
        Ok(Self { axes, centre, knots, fits, frames, inflation, modes: Vec::new(), bias })
    }

    /// Add what a stand-in is off by: the difference at each knot with its covariance.
    #[must_use]
    pub fn with_bias(mut self, bias: Vec<Shift>) -> Self {
        self.bias = bias;
        self
    }

    /// Covariance of one run from its frames, by knot.
    pub fn frames(&self) -> &[[[f64; 4]; 4]] {
        &self.frames
    }

    /// Add uncertain knowns that were simulated: for each, the change of every (knot, response)
    /// for one standard deviation of its prior.
    #[must_use]
    pub fn with_modes(mut self, modes: Vec<Vec<[f64; 4]>>) -> Self {
        self.modes = modes;
        self
    }

    /// By how much runs scatter beyond their frames, as a factor on the variance.
    pub fn inflation(&self) -> f64 {
        self.inflation
    }

    /// The axes.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Speeds that were simulated, rpm.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// Distance of a point from the centre, coded units.
    pub fn distance(&self, at: &[f64]) -> f64 {
        code(&self.axes, &self.centre, at).iter().map(|z| z * z).sum::<f64>().sqrt()
    }

    /// Means at the knots.
    pub fn at_knots(&self, at: &[f64]) -> Vec<[f64; 4]> {
        let row = terms(&code(&self.axes, &self.centre, at));
        let each = self.fits.iter().zip(&self.bias);
        each.map(|(four, b)| std::array::from_fn(|r| dot(&four[r].beta, &row) + b.0[r])).collect()
    }

    /// Means and variances at the knots, without modes, bias included.
    pub(crate) fn moments(&self, at: &[f64]) -> Vec<[(f64, f64); 4]> {
        let z = code(&self.axes, &self.centre, at);
        let row = terms(&z);
        let beyond = remainder(&z).powi(2);
        self.fits
            .iter()
            .zip(&self.bias)
            .map(|(four, bias)| {
                std::array::from_fn(|r| {
                    let f = &four[r];
                    let variance = quadratic(&f.covariance, &row) + beyond + bias.1[r][r];
                    (dot(&f.beta, &row) + bias.0[r], variance)
                })
            })
            .collect()
    }

    /// Predictions at any speeds from means and variances at the knots.
    pub(crate) fn spread(&self, speeds_rpm: &[f64], at: &[[(f64, f64); 4]]) -> Predicted {
        assemble(&self.knots, speeds_rpm, at, &self.frames, self.inflation, &self.modes)
    }
}

impl Simulator for Emulator {
    fn parameters(&self) -> Vec<String> {
        self.axes.iter().map(|a| a.path.clone()).collect()
    }

    fn speed_range_rpm(&self) -> (f64, f64) {
        let last = self.knots.len() - 1;
        (self.knots[0], self.knots[last])
    }

    fn predict(&self, theta: &[f64], speeds_rpm: &[f64]) -> Result<Predicted, CalibError> {
        if theta.len() != self.axes.len() {
            return Err(CalibError::Parameters { expected: self.axes.len(), given: theta.len() });
        }
        Ok(self.spread(speeds_rpm, &self.moments(theta)))
    }
}

/// Predictions at any speeds from means and variances at the knots.
fn assemble(
    knots: &[f64],
    speeds: &[f64],
    at: &[[(f64, f64); 4]],
    frames: &[[[f64; 4]; 4]],
    inflation: f64,
    modes: &[Vec<[f64; 4]>],
) -> Predicted {
    let spline: Vec<Vec<f64>> = speeds.iter().map(|s| weights(knots, *s)).collect();
    let n = 4 * speeds.len();
    let mut mean = vec![0.0; n];
    for (a, w) in spline.iter().enumerate() {
        for r in 0..4 {
            mean[4 * a + r] = w.iter().zip(at).map(|(w, v)| w * v[r].0).sum();
        }
    }
    let mut covariance = vec![0.0; n * n];
    for a in 0..speeds.len() {
        for b in 0..=a {
            for (k, frame) in frames.iter().enumerate() {
                let w = spline[a][k] * spline[b][k];
                if w == 0.0 {
                    continue;
                }
                for r in 0..4 {
                    for s in 0..4 {
                        let sd = (frame[r][r] * frame[s][s]).sqrt();
                        let correlation = if sd > 0.0 { frame[r][s] / sd } else { 0.0 };
                        let mut c = correlation * (at[k][r].1 * at[k][s].1).sqrt();
                        if a == b {
                            // The measured drum is one filling of many.
                            c += (inflation - 1.0) * frame[r][s];
                        }
                        covariance[(4 * a + r) * n + 4 * b + s] += w * c;
                    }
                }
            }
            for mode in modes {
                let value = |i: usize, r: usize| -> f64 {
                    spline[i].iter().zip(mode).map(|(w, m)| w * m[r]).sum()
                };
                for r in 0..4 {
                    for s in 0..4 {
                        covariance[(4 * a + r) * n + 4 * b + s] += value(a, r) * value(b, s);
                    }
                }
            }
            for r in 0..4 {
                for s in 0..4 {
                    covariance[(4 * b + s) * n + 4 * a + r] =
                        covariance[(4 * a + r) * n + 4 * b + s];
                }
            }
        }
    }
    Predicted { mean, covariance }
}

fn code(axes: &[Axis], centre: &[f64], at: &[f64]) -> Vec<f64> {
    axes.iter()
        .zip(centre)
        .zip(at)
        .map(|((a, c), x)| (a.scale.forth(*x) - a.scale.forth(*c)) / a.unit)
        .collect()
}

/// 1, coordinates, squares, products.
fn terms(z: &[f64]) -> Vec<f64> {
    let mut row = vec![1.0];
    row.extend(z);
    row.extend(z.iter().map(|z| z * z));
    for i in 0..z.len() {
        row.extend((0..i).map(|j| z[i] * z[j]));
    }
    row
}

fn remainder(z: &[f64]) -> f64 {
    let rho = z.iter().map(|z| z * z).sum::<f64>().sqrt();
    REMAINDER * rho.powi(3) / (1.0 + (rho / FAR).powi(2))
}

fn regress(
    rows: &[Vec<f64>],
    y: &[f64],
    noise: &[f64],
    axes: usize,
) -> Result<Coefficients, CalibError> {
    let p = rows[0].len();
    let prior = |i: usize| match i {
        0 => 1e3,
        i if i <= axes => SLOPE,
        i if i <= 2 * axes => CURVATURE,
        _ => PRODUCT,
    };
    // About the mean, so that the wide prior of the constant is harmless.
    let middle = y.iter().sum::<f64>() / y.len() as f64;
    let normal = Mat::from_fn(p, p, |i, j| {
        let data: f64 = rows.iter().zip(noise).map(|(x, v)| x[i] * x[j] / v).sum();
        data + if i == j { prior(i).powi(-2) } else { 0.0 }
    });
    let right = Mat::from_fn(p, 1, |i, _| {
        rows.iter().zip(noise).zip(y).map(|((x, v), y)| x[i] * (y - middle) / v).sum::<f64>()
    });
    let fault = CalibError::Covariance { what: "a local regression", size: p };
    if (0..p).any(|i| !normal[(i, i)].is_finite() || !right[(i, 0)].is_finite()) {
        return Err(fault);
    }
    let llt = normal.llt(Side::Lower).map_err(|_| fault)?;
    let solved = llt.solve(&right);
    let covariance = llt.solve(Mat::<f64>::identity(p, p));
    let mut beta: Vec<f64> = (0..p).map(|i| solved[(i, 0)]).collect();
    beta[0] += middle;
    Ok(Coefficients { beta, covariance })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn quadratic(m: &Mat<f64>, x: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (i, a) in x.iter().enumerate() {
        for (j, b) in x.iter().enumerate() {
            sum += a * b * m[(i, j)];
        }
    }
    sum.max(0.0)
}
