//! By how much a stand-in is off: known where the whole rig was run, guessed elsewhere.

use crate::emulator::{Sample, distance_squared};
use crate::process::Shift;

/// Part of the difference by which it changes over a unit of the coordinates. Measured on the drum of the thesis
/// (beads twice as large and softer): from friction 0.3 to 0.5, 1.5 units, that of the whole line falls from 3.2, 5.0, 3.5 to
/// 2.2, 2.7, 2.1 deg at 10, 24 and 45 rpm.
const CHANGES: f64 = 0.25;

/// Distance of a run of the whole rig, coded units, at which it counts half as much as one at the point.
const HALF: f64 = 0.3;

/// A run of the whole rig.
#[derive(Debug, Clone)]
pub(crate) struct Whole {
    /// Paths of its effects.
    pub(crate) names: Vec<String>,
    /// What it showed, and at which free parameters and strengths.
    pub(crate) sample: Sample,
}

/// The whole rig less its stand-in at one point.
#[derive(Debug, Clone)]
pub(crate) struct Anchor {
    /// Point, in units of its axes.
    pub(crate) at: Vec<f64>,
    /// Mean difference by knot.
    pub(crate) mean: Vec<[f64; 4]>,
    /// Its covariance from the run.
    pub(crate) noise: Vec<[[f64; 4]; 4]>,
    /// The same from what the stand-in's model does not know, which neighbours share.
    pub(crate) unknown: Vec<[[f64; 4]; 4]>,
}

/// What is added to a stand-in at a point.
#[derive(Debug, Clone, Default)]
pub(crate) struct Off {
    /// Difference with its covariance, by knot; empty where nothing is known.
    pub(crate) shift: Vec<Shift>,
    /// Standard deviation, common to all speeds and responses in this proportion, of what lies away from all runs.
    pub(crate) unsure: Vec<[f64; 4]>,
}

/// The difference at a point (in units of its axes): the mean over all runs of the whole rig, near ones counting most. The
/// further away the nearest of them is, the less is known.
pub(crate) fn off(anchors: &[Anchor], z: &[f64]) -> Off {
    let Some(first) = anchors.first() else { return Off::default() };
    let apart = |a: &Anchor| distance_squared(&a.at, z);
    let weight = |a: &Anchor| 1.0 / (1.0 + apart(a) / (HALF * HALF));
    let all: f64 = anchors.iter().map(weight).sum();
    let mut shift = vec![([0.0; 4], [[0.0; 4]; 4]); first.mean.len()];
    for anchor in anchors {
        let w = weight(anchor) / all;
        for (k, (mean, covariance)) in shift.iter_mut().enumerate() {
            mean.iter_mut().zip(anchor.mean[k]).for_each(|(m, own)| *m += w * own);
            let own = anchor.noise[k].iter().flatten().zip(anchor.unknown[k].iter().flatten());
            for (c, (noise, unknown)) in covariance.iter_mut().flatten().zip(own) {
                *c += w * w * noise + w * unknown;
            }
        }
    }
    let nearest = anchors.iter().map(apart).fold(f64::INFINITY, f64::min).sqrt();
    let unsure = shift.iter().map(|(mean, _)| mean.map(|m| CHANGES * nearest * m)).collect();
    Off { shift, unsure }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emulator::{Axis, Emulator};
    use crate::scale::Scale;
    use calib::Simulator as _;

    /// One knot; responses fall by 10 a unit of the logarithm of friction.
    fn run(at: f64, up: f64) -> Sample {
        let noise = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * 1e-4));
        Sample {
            at: vec![at],
            mean: vec![std::array::from_fn(|r| 20.0 + 10.0 * at.ln() + r as f64 + up)],
            covariance: vec![noise],
            variance: vec![[1.5e-3; 4]],
            excess: vec![0.0],
        }
    }

    #[test]
    fn a_stand_in_is_shifted_by_its_difference_where_the_whole_was_run() {
        let axes = vec![Axis {
            path: "friction.pp".to_owned(),
            scale: Scale::Log,
            unit: 0.35,
            roughness: 1.0,
        }];
        let stand_ins: Vec<Sample> = (0..9).map(|k| run(0.2 + 0.05 * f64::from(k), 0.0)).collect();
        let model = Emulator::fit(axes, vec![0.4], vec![20.0.into()], &stand_ins).unwrap();
        // Two places, 1.5 and 2.5 above the stand-in there.
        let whole = |names: &[&str], sample: Sample| Whole {
            names: names.iter().map(|n| (*n).to_owned()).collect(),
            sample,
        };
        // A run with an effect that this model does not have tells it nothing.
        let mut other = run(0.3, 9.0);
        other.at.push(1.0);
        let wholes =
            [whole(&[], run(0.25, 1.5)), whole(&[], run(0.5, 2.5)), whole(&["a.b"], other)];
        let shifted = model.clone().anchored(&wholes);
        let own = |m: &Emulator, x: f64| m.at_knots(&[x])[0][0];
        // Half-way between them their mean; at one of them the other, two units away, counts a fortieth.
        let by = |x: f64| own(&shifted, x) - own(&model, x);
        assert!((by((0.25f64 * 0.5).sqrt()) - 2.0).abs() < 0.05, "{}", by(0.354));
        assert!((by(0.25) - 1.52).abs() < 0.05, "{}", by(0.25));
        let variance =
            |m: &Emulator, x: f64| m.predict(&[x], &[20.0.into()]).unwrap().covariance(0, 0);
        // Away from both a shift is unsure by a quarter for each unit.
        let unsure = variance(&shifted, 0.2) - variance(&model, 0.2);
        let units = (0.25f64 / 0.2).ln() / 0.35;
        assert!((unsure.sqrt() - 0.25 * units * by(0.2)).abs() < 0.03, "{unsure}");
        let at_one = variance(&shifted, 0.5) - variance(&model, 0.5);
        assert!(at_one < 0.2 * unsure, "{at_one} {unsure}");
    }
}
