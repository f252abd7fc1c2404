//! Means of correlated series, and the test whether a motion is stationary.
//!
//! `error = sd sqrt(tau/n)`, `tau = 1 + 2 sum rho_k` up to the first lag `k >= 5 tau`
//!
//! - `rho_k` autocorrelation at lag k; `tau` integrated autocorrelation time in samples; `n` samples
//!
//! Reference: A. D. Sokal, in *Functional Integration* (1997), section 3 (the self-consistent
//! window). A motion is stationary when slope and bend over two consecutive windows, each over its
//! standard error, are below two when added in squares. The slope is the difference of the windows;
//! the bend, outer against inner halves, shows at the turning point of a slow swing. A drift within a window lengthens `tau`, but less than it moves the mean: a
//! straight drift over both windows lies four standard errors apart whatever its slope.

/// Mean of a series, with its scatter and error.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Mean {
    /// Mean.
    pub mean: f64,
    /// Standard deviation of single values.
    pub sd: f64,
    /// Standard error of the mean, autocorrelation included.
    pub error: f64,
    /// Number of independent values that the series is worth.
    pub effective: f64,
}

/// Mean of a series taken at equal intervals.
///
/// ```
/// // A slow wave, a hundred samples long: far fewer independent values than samples.
/// let m = drum_rig::mean_of(&(0..100).map(|k| (f64::from(k) / 16.0).sin()).collect::<Vec<_>>());
/// assert!(m.effective < 10.0 && (m.sd - 0.7).abs() < 0.1);
/// ```
pub fn mean_of(series: &[f64]) -> Mean {
    let n = series.len();
    if n == 0 {
        return Mean { mean: f64::NAN, sd: f64::NAN, error: f64::NAN, effective: 0.0 };
    }
    let count = n as f64;
    let mean = series.iter().sum::<f64>() / count;
    let covariance = |lag: usize| {
        let pairs = series.iter().zip(&series[lag..]);
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / count
    };
    let variance = covariance(0);
    if n < 2 || !(variance > 0.0) {
        return Mean { mean, sd: 0.0, error: 0.0, effective: count };
    }
    let mut tau = 1.0;
    for lag in 1..n {
        tau += 2.0 * covariance(lag) / variance;
        if lag as f64 >= 5.0 * tau {
            break;
        }
    }
    // A series cannot be worth more than its samples, nor less than one value.
    let tau = tau.clamp(1.0, count);
    let sd = (variance * count / (count - 1.0)).sqrt();
    Mean { mean, sd, error: sd * (tau / count).sqrt(), effective: count / tau }
}

/// A signal of the stationarity test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Signal {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    /// Difference below which two means count as equal whatever their errors.
    pub(crate) floor: f64,
}

/// How two windows compare.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Comparison {
    pub(crate) signal: Signal,
    pub(crate) before: f64,
    pub(crate) after: f64,
    pub(crate) sigmas: f64,
}

/// Standard errors by which means may differ.
const SIGMAS: f64 = 2.0;

impl Comparison {
    /// The last `2 window` values of a series, halved.
    pub(crate) fn of(signal: Signal, series: &[f64], window: usize) -> Self {
        let tail = &series[series.len() - 2 * window..];
        let (a, b) = (mean_of(&tail[..window]), mean_of(&tail[window..]));
        let error = a.error.hypot(b.error);
        let over_error = |d: f64| if d.abs() <= signal.floor { 0.0 } else { (d / error).abs() };
        let slope = over_error(b.mean - a.mean);
        let half = |k: usize| {
            let part = &tail[k * window / 2..(k + 1) * window / 2];
            part.iter().sum::<f64>() / part.len() as f64
        };
        // Halves have twice the variance of windows, and four of them are halved: the same error.
        let bend = over_error(0.5 * (half(0) + half(3)) - 0.5 * (half(1) + half(2)));
        Self { signal, before: a.mean, after: b.mean, sigmas: slope.hypot(bend) }
    }

    pub(crate) fn is_stationary(&self) -> bool {
        self.sigmas <= SIGMAS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    const SIGNAL: Signal = Signal { name: "x", unit: "1", floor: 0.0 };

    /// `x' = a x + noise`: `tau = (1 + a)/(1 - a)`.
    fn autoregressive(a: f64, n: usize, seed: u64) -> Vec<f64> {
        let mut r = ChaCha8Rng::seed_from_u64(seed);
        let mut x = 0.0;
        (0..n)
            .map(|_| {
                x = a * x + r.random_range(-1.0..1.0);
                x
            })
            .collect()
    }

    #[test]
    fn the_error_of_a_correlated_series_is_that_of_its_effective_number() {
        let n = 40_000;
        let m = mean_of(&autoregressive(0.9, n, 1));
        // tau = 19; its own relative error is sqrt(2 (2 W + 1)/n) = 0.1 with W = 5 tau.
        assert!((n as f64 / m.effective / 19.0 - 1.0).abs() < 0.3, "{}", m.effective);
    }

    #[test]
    fn errors_cover_the_true_mean_as_often_as_they_should() {
        let covered = (0..400)
            .filter(|&seed| {
                let m = mean_of(&autoregressive(0.8, 600, seed));
                m.mean.abs() < 2.0 * m.error
            })
            .count();
        // 95 % of 400 is 380; short series underestimate tau a little, and 4 sd of the count are 17.
        assert!(covered > 350, "{covered}");
    }

    #[test]
    fn a_drift_is_not_stationary_however_slow_and_a_level_mostly_is() {
        for slope in [1e-6, 1.0, 1e6] {
            let x: Vec<f64> = (0..400).map(|k| slope * f64::from(k)).collect();
            assert!(!Comparison::of(SIGNAL, &x, 200).is_stationary());
        }
        let level = (0..100)
            .filter(|&s| Comparison::of(SIGNAL, &autoregressive(0.8, 1000, s), 500).is_stationary())
            .count();
        // Two squares of unit variance exceed 4 in 13.5 % of cases; 3 sd of the count are 10.
        assert!(level > 72, "{level}");
    }

    #[test]
    fn the_turning_point_of_a_slow_swing_is_not_stationary() {
        // Two windows are a sixth of a period, anywhere in it.
        for phase in 0..40 {
            let x: Vec<f64> =
                (0..256).map(|k| (f64::from(k) / 256.0 + 0.157 * f64::from(phase)).sin()).collect();
            let c = Comparison::of(SIGNAL, &x, 128);
            assert!(!c.is_stationary(), "{phase}: {}", c.sigmas);
        }
    }

    #[test]
    fn a_constant_has_no_error_and_no_series_no_mean() {
        assert_eq!(mean_of(&[2.0; 5]), Mean { mean: 2.0, sd: 0.0, error: 0.0, effective: 5.0 });
        assert!(mean_of(&[]).mean.is_nan());
    }
}
