//! How what a surface does not know goes together over speeds and responses.
//!
//! An effect that does more than was thought does so at all speeds, and a bed that is steeper than was thought is so by both
//! lines. Measured on three drums of 560 beads (friction 0.3 and 0.45; with asphericity, rolling resistance, cohesion): 121
//! runs of thirteen effects, each predicted from those that are not near it, at six speeds of 15 to 70 rpm. What they missed,
//! less what runs scatter, correlates by 0.8 to 1.0 between speeds; of 24 numbers two directions hold nineteen
//! twentieths. The logarithm of the likelihood of the 80 misses of which the surface knew something is 197 with the numbers
//! below, -621 if every response at every speed is unknown by itself. What suits these misses best is 0.91, 0.72, -0.51, 0.62,
//! -0.52, 0.2 between responses and 0.84 and more between speeds: a little beyond the numbers here, since other drums may differ.
//!
//! With another load it is much the same: what 27 effects of the catalogue do to a drum of 353 beads and to one of 171 (frictions 0.3
//! and 0.45, five speeds) correlates by 0.92 to 0.95, where that of two speeds of one load correlates by 0.97 to 0.99.
//!
//! How much it is: less than surfaces say of themselves, and more at fast speeds, where effects do more. In three other drums of that
//! size (with cohesion of 6000 and 9000 J/m3; with rolling resistance and a wrong speed) 122 runs of effects were predicted
//! from those at least half a unit away, and in the third 23 runs of two effects from those of either alone. What suits
//! these misses best is 0.4 to 0.8 of the standard deviation, times the speed to a power of 0 to 0.25 (0.5 for two effects). The number here
//! is on the wide side: with 0.6 strengths found from four sets of some fifty runs scattered by more than they said, with 0.75 by less.

use calib::{CalibError, OperatingPoint};
use faer::{Mat, Side};

/// Correlation of the four responses: whole line, middle line, centre of area across and up.
pub(crate) const BESIDE: [[f64; 4]; 4] = [
    [1.0, 0.9, 0.75, -0.5],
    [0.9, 1.0, 0.65, -0.5],
    [0.75, 0.65, 1.0, 0.1],
    [-0.5, -0.5, 0.1, 1.0],
];

/// Correlation of speeds however far apart.
const ALL: f64 = 0.75;
/// What near ones have beyond that.
const NEAR: f64 = 0.22;
/// How near: standard deviation in the logarithm of the speed.
const LENGTH: f64 = 0.9;
/// Correlation of two loads over that of one.
const OTHER_LOAD: f64 = 0.85;

/// What surfaces miss over what they say that they do not know, at the middle of the speeds.
const LESS: f64 = 0.75;
/// Power of the speed with which that goes.
const FASTER: f64 = 0.25;

/// Lower factor of the covariance of what is not known at these points, in units of what surfaces say of themselves.
pub(crate) fn alongside(points: &[OperatingPoint]) -> Result<Vec<Vec<f64>>, CalibError> {
    let n = points.len();
    let speed = |i: usize| points[i].omega_rpm;
    let middle = (0..n).map(|i| speed(i).ln()).sum::<f64>() / n.max(1) as f64;
    let part = |i: usize| LESS * (FASTER * (speed(i).ln() - middle)).exp();
    let correlation = |i: usize, j: usize| {
        let apart = (speed(i) / speed(j)).ln() / LENGTH;
        let load = if points[i].load == points[j].load { 1.0 } else { OTHER_LOAD };
        if i == j { 1.0 } else { load * (ALL + NEAR * (-0.5 * apart * apart).exp()) }
    };
    let fault = |_| CalibError::Covariance { what: "speeds", size: n };
    let factor = Mat::from_fn(n, n, correlation).llt(Side::Lower).map_err(fault)?;
    Ok((0..n).map(|i| (0..=i).map(|j| part(i) * factor.L()[(i, j)]).collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emulator::{Axis, Emulator, Sample};
    use crate::process::Local;
    use crate::scale::Scale;

    /// Of nine drums with frictions from 0.3 to 0.46 whose angles go with the logarithm.
    fn model(speeds_rpm: [f64; 2], roughness: f64) -> Emulator {
        let noise = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * 1e-4));
        let run = |k: u32| {
            let at = 0.3 + 0.02 * f64::from(k);
            let mean = std::array::from_fn(|r| 20.0 + 10.0 * at.ln() + r as f64);
            let (mean, covariance) = (vec![mean; 2], vec![noise; 2]);
            let variance = vec![[1e-3; 4]; 2];
            Sample { at: vec![at], mean, covariance, variance, excess: vec![0.0] }
        };
        let runs: Vec<Sample> = (0..9).map(run).collect();
        let path = "friction.pp".to_owned();
        let axes = vec![Axis { path, scale: Scale::Log, unit: 0.35, roughness }];
        Emulator::fit(axes, vec![0.4], speeds_rpm.map(OperatingPoint::from).to_vec(), &runs)
            .unwrap()
    }

    #[test]
    fn a_surface_is_off_at_all_speeds_and_by_all_responses_alike() {
        let speeds = [20.0, 40.0];
        let model = model(speeds, 1.0);
        let mut there = model.moments(&[2.5]);
        // Five units away from all runs.
        assert!(there.unknown[0][0] > 1.0, "{:?}", there.unknown);
        let unknown = [[1.0, 2.0, 0.5, 1.5], [3.0, 1.0, 1.0, 0.1]];
        let of = |local: &Local| model.spread(&speeds.map(OperatingPoint::from), local);
        there.unknown = unknown.to_vec();
        let with = of(&there);
        there.unknown = vec![[0.0; 4]; 2];
        let without = of(&there);
        let between = ALL + NEAR * (-0.5 * (2f64.ln() / LENGTH).powi(2)).exp();
        // The speeds are a factor of the root of two from their middle.
        let part = [0.5f64.sqrt(), 2f64.sqrt()].map(|v| LESS * v.powf(FASTER));
        for i in 0..8 {
            for j in 0..8 {
                let ((k, r), (l, s)) = ((i / 4, i % 4), (j / 4, j % 4));
                let own = BESIDE[r][s] * part[k] * part[l] * if k == l { 1.0 } else { between };
                let added = with.covariance(i, j) - without.covariance(i, j);
                assert!((added - own * unknown[k][r] * unknown[l][s]).abs() < 1e-12, "{i} {j}");
            }
        }
    }

    #[test]
    fn what_bends_fast_is_known_less_far_from_runs_and_is_as_far_away() {
        let (even, rough) = (model([20.0, 40.0], 0.5), model([20.0, 40.0], 1.5));
        let unknown = |m: &Emulator| m.moments(&[0.8]).unknown[0][0];
        assert!(unknown(&even) < 0.5 * unknown(&rough), "{} {}", unknown(&even), unknown(&rough));
        // A factor of two is two units whatever happens between.
        for m in [even, rough] {
            assert!((m.apart(&[0.4], &[0.8]) - 2f64.ln() / 0.35).abs() < 1e-12);
        }
    }

    #[test]
    fn the_factor_gives_the_correlation_back() {
        let speeds = [15.0, 25.0, 35.0, 45.0, 55.0, 70.0, 70.5].map(OperatingPoint::from);
        let lower = alongside(&speeds).unwrap();
        let of = |i: usize, j: usize| -> f64 {
            lower[i].iter().zip(&lower[j]).map(|(a, b)| a * b).sum()
        };
        for i in 0..speeds.len() {
            assert!(lower[i][i] > 0.15 * of(i, i).sqrt(), "{lower:?}");
        }
        // More at fast speeds: (70 / 15)^0.5.
        assert!((of(5, 5) / of(0, 0) - 2.160).abs() < 1e-3, "{}", of(5, 5) / of(0, 0));
        // 15 and 70 rpm: 0.75 + 0.22 exp(-1.4648).
        let between = of(0, 5) / (of(0, 0) * of(5, 5)).sqrt();
        assert!((between - 0.8009).abs() < 1e-4, "{between}");
        assert_eq!(alongside(&[20.0.into()]).unwrap(), vec![vec![LESS]]);
    }

    #[test]
    fn responses_go_together_as_a_covariance_can() {
        // All leading minors above 0.
        let m = BESIDE;
        let two = |a: usize, b: usize, c: usize, d: usize| m[a][c] * m[b][d] - m[a][d] * m[b][c];
        let three =
            m[0][0] * two(1, 2, 1, 2) - m[0][1] * two(1, 2, 0, 2) + m[0][2] * two(1, 2, 0, 1);
        assert!(two(0, 1, 0, 1) > 0.0 && three > 0.0);
        let minor = |skip: usize| -> f64 {
            let c: Vec<usize> = (0..4).filter(|c| *c != skip).collect();
            m[1][c[0]] * two(2, 3, c[1], c[2]) - m[1][c[1]] * two(2, 3, c[0], c[2])
                + m[1][c[2]] * two(2, 3, c[0], c[1])
        };
        let four: f64 =
            (0..4).map(|c| if c % 2 == 0 { 1.0 } else { -1.0 } * m[0][c] * minor(c)).sum();
        assert!(four > 0.0, "{four}");
    }
}
