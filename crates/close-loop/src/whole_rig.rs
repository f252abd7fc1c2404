//! Runs of the whole rig beside its stand-in.

use calib::attribution::{Finding, Verdict};

use crate::anchors::Whole;
use crate::confirm;
use crate::driver::{CloseLoop, Stage, State, Told};
use crate::error::CloseLoopError;
use crate::refine::FORLORN;
use crate::runs::{rig_at, sample};

/// Effects that are run in the whole rig before one is named.
const RIVALS: usize = 3;

/// Deviance by which they may be behind the best one.
const RIVAL: f64 = 20.0;

/// Round of their fillings, which no fresh run has.
const HEARD: usize = 100;

impl CloseLoop<'_> {
    /// What a stand-in seems to lack may be the stand-in's: run the whole rig at the best base point, shift the stand-in by
    /// what it is off there, and ask again.
    pub(crate) fn ask_the_whole_rig(
        &self,
        state: &mut State<'_>,
        finding: &Finding,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Finding, CloseLoopError> {
        let base = state.base_model()?;
        state.before = confirm::fresh(state, &base, &finding.base.theta, &[], 0, watch)?;
        let samples = state.before.as_ref().map_or_else(Vec::new, |b| b.samples.clone());
        state.learn(vec![(Vec::new(), samples)]);
        state.theta = state.best()?;
        let again = state.attribute(&self.settings.attribution)?;
        if again.verdict == Verdict::None {
            return Ok(again);
        }
        self.sharpen(state, (2, 2), &self.settings.attribution, watch)
    }

    /// By how much a stand-in is off with an effect differs from effect to effect: run the whole rig with those that come
    /// closest, so that none is named, or passed over, for what the stand-in adds to it.
    pub(crate) fn hear_rivals(
        &self,
        state: &mut State<'_>,
        finding: &Finding,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Finding, CloseLoopError> {
        let base = state.base_model()?;
        let best = finding.ranked.iter().map(|r| r.fit.deviance).fold(f64::INFINITY, f64::min);
        let close = finding
            .ranked
            .iter()
            .filter(|r| r.fit.deviance <= best + RIVAL && r.fit.p > FORLORN && !r.at_bound);
        let simulated = close.filter(|r| state.effects.contains_key(&r.name));
        let rivals: Vec<_> = simulated.take(RIVALS).collect();
        let mut heard = Vec::new();
        for rival in rivals {
            if !state.has_time(2) {
                break;
            }
            let Some((strength, theta)) = rival.fit.theta.split_last() else { continue };
            let name = std::slice::from_ref(&rival.name);
            let with = confirm::effects_at(state, name, &[*strength]);
            let fresh = confirm::fresh(state, &base, theta, &with, HEARD, watch)?;
            heard.push((name.to_vec(), fresh.map_or_else(Vec::new, |f| f.samples)));
        }
        state.learn(heard);
        self.sharpen(state, (2, 2), &self.settings.attribution, watch)
    }
}

impl State<'_> {
    /// Simulate the whole rig at the present point, and shift its stand-in by what it is off there and
    /// wherever the whole rig has been simulated before.
    pub(crate) fn anchor(
        &mut self,
        round: usize,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<(), CloseLoopError> {
        let each = self.setup.cast.anchors[round];
        if self.setup.cast.whole.is_none() || each == 0 {
            return Ok(());
        }
        let mut rigs = Vec::new();
        for k in 0..each {
            let filling = self.runs.filling(Stage::Full, 8 * round + k);
            let rig = rig_at(&self.setup.rig, &self.setup.axes, &self.theta, filling)?;
            rigs.push((format!("the whole rig at {:.3?}", self.theta), rig));
        }
        for run in self.runs.all(Stage::Full, &rigs, watch)?.iter().flatten() {
            let sample = sample(self.theta.clone(), run);
            self.wholes.push(Whole { names: Vec::new(), sample });
        }
        if self.wholes.is_empty() {
            let first = self.runs.failed.last().map_or_else(String::new, |f| f.1.clone());
            return Err(CloseLoopError::Base { failed: each, asked: each, first });
        }
        self.theta = self.best()?;
        Ok(())
    }
}
