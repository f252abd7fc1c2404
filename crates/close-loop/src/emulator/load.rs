//! The loads of a drum in a model.

use std::ops::Range;

use calib::{CalibError, OperatingPoint};

use super::Sample;
use crate::process::Process;

/// What is particular to one load of the drum: its fillings are others, and so is what more volume does.
#[derive(Debug, Clone)]
pub(super) struct OfLoad {
    /// Its knots among all.
    pub(super) at: Range<usize>,
    /// Their speeds, rpm.
    pub(super) speeds_rpm: Vec<f64>,
    pub(super) process: Process,
    /// Standard deviation of the volume of a measured filling, as a part of it.
    pub(super) volume_sd: f64,
    /// Fillings that the measured means are averages over.
    pub(super) fillings: f64,
}

/// Whether knots are in order, and their loads counted from 0.
pub(super) fn check_knots(knots: &[OperatingPoint]) -> Result<(), CalibError> {
    let before = |k: usize| k.checked_sub(1).map(|k| knots[k]);
    let follows = |(k, at): &(usize, &OperatingPoint)| match before(*k) {
        None => at.load == 0,
        Some(last) if last.load == at.load => last.omega_rpm < at.omega_rpm,
        Some(last) => last.load + 1 == at.load,
    };
    match knots.iter().enumerate().find(|k| !follows(k)) {
        Some((_, at)) => Err(CalibError::Knot { at: *at }),
        None => Ok(()),
    }
}

/// Whether runs tell something of every knot and load.
pub(super) fn check_runs(knots: &[OperatingPoint], samples: &[Sample]) -> Result<(), CalibError> {
    let loads = knots.last().map_or(0, |k| k.load + 1);
    for s in samples {
        let rows = [s.mean.len(), s.covariance.len(), s.variance.len()];
        if let Some(given) = rows.into_iter().find(|n| *n != knots.len()) {
            let what = "operating points of a run";
            return Err(CalibError::Lengths { what, expected: knots.len(), given });
        }
        if s.excess.len() != loads {
            let (what, given) = ("loads of a run", s.excess.len());
            return Err(CalibError::Lengths { what, expected: loads, given });
        }
    }
    Ok(())
}

/// Means of runs with one load, by its knots, and the excess of their volumes.
pub(super) fn of_load<'s>(
    samples: &'s [Sample],
    (load, at): (usize, &Range<usize>),
) -> (Vec<&'s [[f64; 4]]>, Vec<f64>) {
    let mean = samples.iter().map(|s| &s.mean[at.clone()]).collect();
    (mean, samples.iter().map(|s| s.excess[load]).collect())
}
