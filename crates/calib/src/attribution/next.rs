//! Which experiment would best separate the effects that are left.
//!
//! What experiment e would measure under effect c is normal: mean the simulation at the fitted
//! parameters, covariance its errors and what the parameters leave open. The expected
//! information gain is the mutual information of c and the measurement, computed by drawing from
//! the mixture.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rig_schema::Response;

use super::data::{Data, Variation, Weight};
use super::linear::covariance;
use super::model::Model;
use super::ranking::Judged;
use super::{Candidate, Experiment, NextExperiment};
use crate::covariance::square;
use crate::{
    CalibError, FrameCorrelation, FreeParameter, Observation, Observations, OperatingPoint,
};

/// Draws for each expectation: its error is about 0.02 bit.
const DRAWS: usize = 2000;

struct Component {
    share: f64,
    mean: Vec<f64>,
    weight: Weight,
}

impl Component {
    fn log_density(&self, y: &[f64]) -> f64 {
        let residual: Vec<f64> = y.iter().zip(&self.mean).map(|(a, b)| a - b).collect();
        -0.5 * (square(&self.weight.whiten(&residual)) + self.weight.log_det)
    }
}

/// Expected gain of every experiment between the candidates given with their shares.
pub(super) fn rank(
    experiments: &[Experiment<'_>],
    candidates: &[Candidate<'_>],
    free: &[FreeParameter],
    class: &[(&Judged<'_>, f64)],
    seed: u64,
) -> Result<Vec<NextExperiment>, CalibError> {
    let mut list = Vec::new();
    for experiment in experiments {
        let mut components = Vec::new();
        let mut between = Vec::new();
        for (judged, share) in class {
            let candidate = &candidates[judged.of[0]];
            let given = experiment.simulators.iter().find(|(n, _)| *n == candidate.name);
            if let Some((name, simulator)) = given {
                let with = Candidate { simulator: *simulator, ..candidate.clone() };
                let model = Model::single(free, &with)?;
                components.push(component(experiment, &model, judged, *share)?);
                between.push(name.clone());
            }
        }
        if components.len() < 2 {
            continue;
        }
        let (gain_bits, most_bits) = information(&mut components, seed);
        let name = experiment.name.clone();
        list.push(NextExperiment { name, between, gain_bits, most_bits });
    }
    list.sort_by(|a, b| b.gain_bits.total_cmp(&a.gain_bits));
    Ok(list)
}

fn component(
    experiment: &Experiment<'_>,
    model: &Model<'_>,
    judged: &Judged<'_>,
    share: f64,
) -> Result<Component, CalibError> {
    let points = OperatingPoint::distinct(experiment.points.iter().copied());
    let theta = &judged.fit.theta;
    let predicted = model.predict(theta, &points)?;
    let mut items = Vec::new();
    let mut place = Vec::new();
    for (k, OperatingPoint { load, omega_rpm }) in points.iter().copied().enumerate() {
        for response in Response::ALL {
            let Some(sd) = experiment.sd[response.index()] else { continue };
            let own = 4 * k + response.index();
            let mean = predicted.mean[own];
            items.push(Observation { load, omega_rpm, response, mean, sd });
            place.push(own);
        }
    }
    let observations = Observations::new(items, 1.0, FrameCorrelation::default())?;
    let data = Data::new(&observations, &experiment.nuisances, None, Variation::default());
    let unit = model.unit(theta);
    let spread = covariance(&judged.fit.point.columns, 12.0).unwrap_or_default();
    let mut slopes: Vec<Vec<f64>> = Vec::new();
    for k in 0..unit.len() {
        let step = if unit[k] > 0.5 { -1e-4 } else { 1e-4 };
        let mut moved = unit.clone();
        moved[k] += step;
        let there = model.expected(&model.theta(&moved), &points)?;
        slopes.push(place.iter().map(|p| (there[*p] - predicted.mean[*p]) / step).collect());
    }
    let open = |i: usize, j: usize| {
        let row = |a: usize| (0..spread.len()).map(|b| spread[a][b] * slopes[b][j]).sum::<f64>();
        (0..spread.len()).map(|a| slopes[a][i] * row(a)).sum()
    };
    let weight = data.weight(&predicted, Some(&open))?;
    let mean = place.iter().map(|p| predicted.mean[*p]).collect();
    Ok(Component { share, mean, weight })
}

/// Mutual information and entropy of the shares, bits.
fn information(components: &mut [Component], seed: u64) -> (f64, f64) {
    let total: f64 = components.iter().map(|c| c.share).sum();
    components.iter_mut().for_each(|c| c.share /= total);
    let most: f64 = components.iter().map(|c| -c.share * c.share.max(1e-300).log2()).sum();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut sum = 0.0;
    for _ in 0..DRAWS {
        let mut u: f64 = rng.random();
        let pick = components.iter().position(|c| {
            u -= c.share;
            u <= 0.0
        });
        let of = &components[pick.unwrap_or(components.len() - 1)];
        let z: Vec<f64> = (0..of.mean.len()).map(|_| StandardNormal.sample(&mut rng)).collect();
        let noise = of.weight.colour(&z);
        let y: Vec<f64> = of.mean.iter().zip(&noise).map(|(m, e)| m + e).collect();
        let own = of.log_density(&y);
        let mixture: f64 =
            components.iter().map(|c| c.share * (c.log_density(&y) - own).exp()).sum();
        sum -= mixture.log2();
    }
    ((sum / DRAWS as f64).clamp(0.0, most), most)
}
