//! The free parameters at which the base model meets the data best.

use calib::{CalibError, Problem};

use crate::driver::{GRID, Stage, State, Told};
use crate::emulator::Emulator;
use crate::error::CloseLoopError;
use crate::runs::{fill_box, rig_at, sample};
use crate::unrest::Unrest;

/// Independent frames that the variance of simulated frames counts for beside that of measured ones.
const AS_FRAMES: f64 = 20.0;

impl State<'_> {
    /// Fillings of each model that fresh runs go through.
    pub(crate) fn fillings(&self) -> usize {
        self.setup.cast.fresh.unwrap_or(self.effort.confirm)
    }

    /// Find the free parameters at which the base model meets the data best.
    pub(crate) fn calibrate(&mut self, watch: &mut dyn FnMut(&Told)) -> Result<(), CloseLoopError> {
        let low: Vec<f64> = self.setup.free.iter().map(|f| f.range.0).collect();
        let high: Vec<f64> = self.setup.free.iter().map(|f| f.range.1).collect();
        let axes = self.setup.axes.clone();
        let seed = self.runs.filling(Stage::Base, usize::MAX >> 8);
        let points = fill_box(&axes, &low, &high, self.effort.base, seed);
        let asked = points.len();
        self.base_runs(Stage::Base, &points, 0, watch)?;
        if 2 * self.base.len() < asked {
            let first = self.runs.failed.first().map_or_else(String::new, |f| f.1.clone());
            return Err(CloseLoopError::Base { failed: asked - self.base.len(), asked, first });
        }
        self.theta = self.best()?;
        for round in 0..2 {
            self.anchor(round, watch)?;
            let (low, high) = self.around(&self.snap(&self.theta), 1.0);
            let seed = self.runs.filling(Stage::Zoom, (usize::MAX >> 8) - round);
            let points = fill_box(&axes, &low, &high, self.effort.zoom, seed);
            self.base_runs(Stage::Zoom, &points, round * self.effort.zoom, watch)?;
            self.theta = self.best()?;
        }
        self.anchor(2, watch)?;
        let points = vec![self.snap(&self.theta); self.effort.replicates];
        self.base_runs(Stage::Replicates, &points, 0, watch)?;
        self.count_frames_anew(&self.base_model()?);
        self.theta = self.best()?;
        Ok(())
    }

    /// What was measured swings as slowly as what is simulated, and as far: its frames count for fewer where
    /// simulations scatter by more than theirs show, and where its own show less than those of simulations.
    /// (A bed at the edge of surging may be quiet for as long as somebody looks.) The few large beads of a coarse
    /// stand-in scatter more than those of the rig, so that only their slowness counts.
    fn count_frames_anew(&mut self, base: &Emulator) {
        let coarse = self.setup.cast.everyday.coarse.is_some();
        let held_out = self.setup.held_out.as_mut();
        for set in std::iter::once(&mut self.setup.observations).chain(held_out) {
            for (item, n) in set.items.iter().zip(&mut set.n_eff) {
                let simulated = base.variance_of_frame(item.at())[item.response.index()];
                *n /= base.swings(item.at()).max(1.0);
                if !coarse {
                    *n /= louder(*n, simulated / (item.sd * item.sd));
                }
            }
        }
    }

    /// The nearest point of a grid of half units: runs are made there, so that loops on the same
    /// rig share them.
    pub(crate) fn snap(&self, theta: &[f64]) -> Vec<f64> {
        let each = self.setup.axes.iter().zip(&self.setup.free).zip(theta);
        each.map(|((a, f), x)| {
            let step = GRID * a.unit;
            let t = (a.scale.forth(*x) / step).round() * step;
            a.scale.back(t).clamp(f.range.0, f.range.1)
        })
        .collect()
    }

    /// Box of free parameters about a point, within their ranges.
    fn around(&self, at: &[f64], units: f64) -> (Vec<f64>, Vec<f64>) {
        let side = |sign: f64| {
            let each = self.setup.axes.iter().zip(&self.setup.free).zip(at);
            each.map(|((a, f), x)| {
                let moved = a.scale.back(a.scale.forth(*x) + sign * units * a.unit);
                moved.clamp(f.range.0, f.range.1)
            })
            .collect()
        };
        (side(-1.0), side(1.0))
    }

    fn base_runs(
        &mut self,
        stage: Stage,
        points: &[Vec<f64>],
        first: usize,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<(), CloseLoopError> {
        let mut rigs = Vec::new();
        for (k, point) in points.iter().enumerate() {
            let filling = self.runs.filling(stage, first + k);
            let rig = rig_at(&self.setup.rig, &self.setup.axes, point, filling)?;
            rigs.push((format!("{stage:?} at {point:.3?}"), rig));
        }
        for (run, point) in self.runs.all(stage, &rigs, watch)?.iter().zip(points) {
            if let Some(run) = run {
                self.base.push(sample(point.clone(), run));
            }
        }
        Ok(())
    }

    /// The middle of the free parameters' ranges, from which coordinates count.
    pub(crate) fn middle(&self) -> Vec<f64> {
        let each = self.setup.axes.iter().zip(&self.setup.free);
        each.map(|(a, f)| a.scale.half_way(f.range.0, f.range.1)).collect()
    }

    /// The base model.
    pub(crate) fn base_model(&self) -> Result<Emulator, CalibError> {
        let knots = self.setup.knots.clone();
        let axes = self.setup.axes.clone();
        let point = (!self.theta.is_empty()).then_some(&self.theta[..]);
        let place = (axes.clone(), self.middle(), knots.clone());
        let model = self.dress(Emulator::about(axes, self.middle(), knots, &self.base, point)?);
        if !self.setup.scatter_tells {
            return Ok(model);
        }
        let fillings = self.setup.fillings();
        let told = (&self.setup.observations, &fillings[..]);
        Ok(model.with_unrest(Unrest::about(place, &self.base, point, told)?))
    }

    pub(crate) fn dress(&self, model: Emulator) -> Emulator {
        let volume_sd: Vec<f64> = self.setup.loads.iter().map(|l| l.volume_sd).collect();
        let model = model.with_modes(self.modes.clone()).with_volume_sd(&volume_sd);
        model.with_fillings(&self.setup.fillings()).anchored(&self.wholes)
    }

    pub(crate) fn problem<'m>(&self, base: &'m Emulator) -> Problem<'m> {
        Problem {
            observations: self.setup.observations.clone(),
            simulator: base,
            free: self.setup.free.clone(),
            nuisances: self.setup.nuisances.clone(),
        }
    }

    /// Best free parameters by the base model.
    pub(crate) fn best(&self) -> Result<Vec<f64>, CloseLoopError> {
        let base = self.base_model()?;
        let solved = self.problem(&base).solve(0, 0)?;
        Ok(solved.estimates.iter().map(|e| e.value).collect())
    }
}

/// Variance of one frame over the measured one, given that of simulations over the measured one: these count for as much as some
/// frames, since few frames are quiet by chance and many are not.
fn louder(frames: f64, simulated: f64) -> f64 {
    1.0 + (simulated - 1.0).max(0.0) * AS_FRAMES / (frames + AS_FRAMES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_frames_are_believed_that_a_bed_is_quiet() {
        assert_eq!(louder(100.0, 0.7), 1.0);
        assert!((louder(5.0, 3.0) - 2.6).abs() < 1e-12);
        assert!((louder(80.0, 1.5) - 1.1).abs() < 1e-12);
    }
}
