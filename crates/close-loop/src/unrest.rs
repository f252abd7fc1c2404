//! How far single frames scatter.
//!
//! A bed of larger or cohesive particles moves by larger lumps than another whose means are the same. Standard deviations
//! of frames are known of every run and of what was measured, so their logarithms are one more thing that a model has to
//! explain. They are continued between runs as the responses are.

use std::sync::Arc;

use calib::{CalibError, Observations, OperatingPoint, Simulator as _};
use faer::linalg::solvers::Solve as _;
use faer::{Mat, Side};

use crate::emulator::{Axis, Emulator, Sample};

/// Units of the regression, whose priors are those of degrees, for one of the logarithm.
const SCALE: f64 = 5.0;

/// Standard deviations of what the logarithm differs by for reasons of reading or of the code: of all values together, of those of
/// a response, of each.
const BESIDES: [f64; 3] = [0.1, 0.07, 0.05];

/// Variance of the logarithm of a standard deviation times the number of independent frames. It would be a half of normal
/// frames, but squares of what swings swing more slowly.
const OF_FRAMES: f64 = 1.0;

/// Least standard deviation that is told from none, deg or percent of R: a bed that turns as one body shows about that.
const QUIET: f64 = 1e-3;

/// What was measured.
#[derive(Debug, Clone, PartialEq)]
struct Told {
    points: Vec<OperatingPoint>,
    /// Place of each value among predictions at the points.
    place: Vec<usize>,
    value: Vec<f64>,
    /// Covariance, row-major, of frames and of what is not modelled.
    noise: Vec<f64>,
}

/// A model of the scatter of frames beside one of their means.
#[derive(Debug, Clone)]
pub(crate) struct Unrest {
    model: Emulator,
    told: Arc<Told>,
}

/// Covariance of two logarithms of the same frames, by the covariance of the means and the number of independent frames of each.
/// Numbers are raised to two one by one: of the two together the matrix need not be positive definite.
fn of_frames(
    own: impl Fn(usize, usize) -> f64,
    frames: impl Fn(usize) -> f64,
    (a, b): (usize, usize),
) -> f64 {
    let together = || own(a, b).powi(2) / (own(a, a) * own(b, b)).max(f64::MIN_POSITIVE);
    let rho = if a == b { 1.0 } else { together().min(0.95) };
    SCALE * SCALE * OF_FRAMES * rho / (frames(a).max(2.0) * frames(b).max(2.0)).sqrt()
}

/// A run whose outputs are the logarithms.
fn logarithms(run: &Sample) -> Sample {
    let knots = || run.variance.iter().zip(&run.covariance);
    let value = |variance: f64| SCALE * variance.sqrt().max(QUIET).ln();
    let mean = run.variance.iter().map(|four| four.map(value)).collect();
    let covariance: Vec<[[f64; 4]; 4]> = knots()
        .map(|(variance, own)| {
            let frames = |r: usize| variance[r] / own[r][r].max(f64::MIN_POSITIVE);
            std::array::from_fn(|r| {
                std::array::from_fn(|s| of_frames(|r, s| own[r][s], frames, (r, s)))
            })
        })
        .collect();
    let variance = covariance.iter().map(|c| std::array::from_fn(|r| c[r][r])).collect();
    let excess = vec![0.0; run.excess.len()];
    Sample { at: run.at.clone(), mean, covariance, variance, excess }
}

impl Told {
    fn of(observations: &Observations) -> Self {
        let (points, place) = observations.places();
        let items = &observations.items;
        let value = items.iter().map(|o| SCALE * o.sd.max(QUIET).ln()).collect();
        let n = items.len();
        let mut noise = vec![0.0; n * n];
        let [all, response, each] = BESIDES.map(|sd| (SCALE * sd).powi(2));
        for i in 0..n {
            for j in 0..n {
                let (a, b) = (&items[i], &items[j]);
                let mut v = all;
                if a.response == b.response {
                    v += response;
                }
                if a.at() == b.at() {
                    let own = |i, j| observations.covariance(i, j);
                    v += of_frames(own, |k| observations.n_eff[k], (i, j));
                }
                if i == j {
                    v += each;
                }
                noise[i * n + j] = v;
            }
        }
        Self { points, place, value, noise }
    }
}

impl Unrest {
    /// Of the base model, for use about a point.
    pub(crate) fn about(
        (axes, origin, knots): (Vec<Axis>, Vec<f64>, Vec<OperatingPoint>),
        samples: &[Sample],
        point: Option<&[f64]>,
        (observations, fillings): (&Observations, &[u32]),
    ) -> Result<Self, CalibError> {
        let runs: Vec<Sample> = samples.iter().map(logarithms).collect();
        let model = Emulator::about(axes, origin, knots, &runs, point)?.with_fillings(fillings);
        Ok(Self { model, told: Arc::new(Told::of(observations)) })
    }

    /// The same with other runs.
    pub(crate) fn of_others(
        &self,
        axes: Vec<Axis>,
        origin: Vec<f64>,
        samples: &[Sample],
    ) -> Result<Self, CalibError> {
        let runs: Vec<Sample> = samples.iter().map(logarithms).collect();
        let model = self.model.of_others(axes, origin, &runs)?;
        Ok(Self { model, told: Arc::clone(&self.told) })
    }

    /// Deviance of what was measured from what is expected at a point.
    pub(crate) fn deviance(&self, theta: &[f64]) -> Result<f64, CalibError> {
        let told = &self.told;
        let predicted = self.model.predict(theta, &told.points)?;
        let n = told.place.len();
        let covariance = Mat::from_fn(n, n, |i, j| {
            told.noise[i * n + j] + predicted.covariance(told.place[i], told.place[j])
        });
        let fault = CalibError::Covariance { what: "the scatter of frames", size: n };
        let factor = covariance.llt(Side::Lower).map_err(|_| fault)?;
        let residual = Mat::from_fn(n, 1, |i, _| told.value[i] - predicted.mean[told.place[i]]);
        let solved = factor.solve(&residual);
        let chi2: f64 = (0..n).map(|i| residual[(i, 0)] * solved[(i, 0)]).sum();
        let lower = factor.L();
        let log_det: f64 = (0..n).map(|i| 2.0 * lower[(i, i)].ln()).sum();
        Ok(chi2 + log_det)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::Scale;
    use calib::FrameCorrelation;
    use rig_schema::MeasuredTable;

    const FRAMES: f64 = 60.0;

    /// A bed whose frames scatter by less the higher its friction.
    fn scatter(friction: f64) -> f64 {
        0.5 / friction
    }

    fn measured(sd: f64) -> Observations {
        let mut text = "omega_rpm,aor_lin_deg,aor_lin_sd,aor_mid_deg,aor_mid_sd,n_eff".to_owned();
        for omega in [20, 40, 60] {
            text += &format!("\n{omega},30,{sd},31,{sd},{FRAMES}");
        }
        let table = MeasuredTable::parse("measured.csv", &text).unwrap();
        let range = (f64::NEG_INFINITY, f64::INFINITY);
        Observations::from_table(&table, range, FRAMES, FrameCorrelation::default()).unwrap().0
    }

    /// Twelve runs of such a bed beside what was measured of it.
    fn unrest(observations: &Observations) -> Unrest {
        let run = |k: u32| {
            let friction = 0.25 + 0.05 * f64::from(k);
            let variance = scatter(friction).powi(2);
            let own = std::array::from_fn(|r| {
                std::array::from_fn(|s| variance / FRAMES * if r == s { 1.0 } else { 0.5 })
            });
            Sample {
                at: vec![friction],
                mean: vec![[30.0; 4]; 3],
                covariance: vec![own; 3],
                variance: vec![[variance; 4]; 3],
                excess: vec![0.0],
            }
        };
        let runs: Vec<Sample> = (0..12).map(run).collect();
        let path = "friction.pp".to_owned();
        let axes = vec![Axis { path, scale: Scale::Log, unit: 0.35, roughness: 1.0 }];
        let place = (axes, vec![0.5], [20.0, 40.0, 60.0].map(OperatingPoint::from).to_vec());
        Unrest::about(place, &runs, None, (observations, &[1])).unwrap()
    }

    #[test]
    fn a_response_that_swings_so_slowly_that_its_frames_count_for_none_leaves_the_others_as_they_are()
     {
        let mut observations = measured(scatter(0.4));
        let usual = unrest(&observations).deviance(&[0.4]).unwrap();
        // The whole lines alone; the middle lines, which go with them, keep their sixty frames.
        let whole = |k: &usize| observations.items[*k].response == observations.items[0].response;
        let slow: Vec<usize> = (0..observations.items.len()).filter(whole).collect();
        slow.iter().for_each(|k| observations.n_eff[*k] = 0.01);
        let swinging = unrest(&observations).deviance(&[0.4]).unwrap();
        // Chi-square is near none in both; a variance of 25 / 2 for 25 / 60 adds its logarithm, 3.4, to each of three.
        assert!((5.0..10.5).contains(&(swinging - usual)), "{usual} {swinging}");
    }

    #[test]
    fn frames_tell_the_friction_at_which_they_scatter_as_measured() {
        let at = |sd: f64, friction: f64| unrest(&measured(sd)).deviance(&[friction]).unwrap();
        // Twice the friction halves the scatter: against 0.1 that all may be off by together, 0.07 of each response and what sixty frames
        // leave, 0.69 is five standard deviations.
        let (right, wrong) = (at(scatter(0.4), 0.4), at(scatter(0.4), 0.8));
        assert!((20.0..60.0).contains(&(wrong - right)), "{right} {wrong}");
        // A tenth more is within what reading may do.
        let near = at(scatter(0.4), 0.44);
        assert!((near - right).abs() < 1.5, "{right} {near}");
    }
}
