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
    /// Coded point.
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

/// The difference at a coded point: the mean over all runs of the whole rig, near ones counting most. The further away the nearest of
/// them is, the less is known.
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
