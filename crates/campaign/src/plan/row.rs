//! One run from its row to its result.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use drum_rig::{Experiment, Flow, Options, Outcome, Progress};
use rig_schema::Rig;

use super::checkpoint;
use super::manifest::{Manifest, Row};
use super::result::{Effort, Simulated, speed_result};
use crate::{CampaignError, Observatory};

/// A run and where its checkpoint lies.
pub(crate) struct RowRun<'a> {
    pub(crate) manifest: &'a Manifest,
    pub(crate) row: &'a Row,
    pub(crate) checkpoint: PathBuf,
    /// Where the motion is kept once it is simulated, for runs that differ in camera or reader alone.
    pub(crate) motion: Option<PathBuf>,
    pub(crate) every: Duration,
}

/// How a run was left.
#[derive(Debug)]
pub(crate) enum Left {
    /// Carried out.
    Done(Simulated, Effort),
    /// Stopped by the caller; the checkpoint keeps what was done.
    Stopped,
}

impl RowRun<'_> {
    /// Carry out the run, from its checkpoint where there is one.
    ///
    /// `progress` may stop it.
    pub(crate) fn carry_out(
        &self,
        mut progress: impl FnMut(&Progress) -> Flow,
    ) -> Result<Left, CampaignError> {
        let rig = self.manifest.rig(self.row)?;
        let observatory = Observatory::new(&rig, self.manifest.resolution())?;
        let options: Options = observatory.options(1);
        let (before, mut drum) = match checkpoint::read(&self.checkpoint)? {
            Some((effort, state)) => (effort, Experiment::resume(&rig, &options, &state)?),
            None => (Effort::default(), self.begin(&rig, &options)?),
        };
        let begun = Instant::now();
        let effort = || Effort {
            wall_s: before.wall_s + begun.elapsed().as_secs_f64(),
            sessions: before.sessions + 1,
        };
        let mut saved = Instant::now();
        let mut failed = None;
        let outcome = drum.run(|drum, p| {
            if saved.elapsed() >= self.every {
                saved = Instant::now();
                if let Err(e) = checkpoint::write(&self.checkpoint, effort(), &drum.checkpoint()) {
                    failed = Some(e);
                    return Flow::Stop;
                }
            }
            progress(p)
        })?;
        if let Some(error) = failed {
            return Err(error);
        }
        let state = drum.checkpoint();
        checkpoint::write(&self.checkpoint, effort(), &state)?;
        if outcome == Outcome::Stopped {
            return Ok(Left::Stopped);
        }
        if let Some(motion) = self.motion.as_ref().filter(|m| !m.exists()) {
            checkpoint::write(motion, effort(), &state)?;
        }
        let (particles, time_step_s) = (drum.grains().len(), drum.time_step());
        let steps = drum.progress().steps;
        let mut speeds = Vec::new();
        let mut unseen = None;
        for steady in &drum.into_sampled() {
            let (seen, edem) = observatory.observe_both(steady)?;
            let speed = speed_result(steady, &seen, &edem);
            unseen = unseen.or_else(|| speed.responses.is_none().then(|| seen.report.clone()));
            speeds.push(speed);
        }
        // A run of which nothing could be measured has failed.
        if let Some(report) = unseen.filter(|_| speeds.iter().all(|s| s.responses.is_none())) {
            return Err(CampaignError::Unseen {
                speed_rpm: speeds.first().map_or(f64::NAN, |s| s.omega_rpm),
                measured: report.n_frames,
                reason: report.rejected.first().map(|r| r.reason.clone()),
            });
        }
        Ok(Left::Done(Simulated { particles, time_step_s, steps, speeds }, effort()))
    }

    /// The motion that another run has made, or the drum at its beginning.
    fn begin(&self, rig: &Rig, options: &Options) -> Result<Experiment, CampaignError> {
        if let Some(motion) = &self.motion {
            // What cannot be read or belongs to another version is made anew: it is only a copy of what can be computed.
            let kept = checkpoint::read(motion).ok().flatten();
            let made = kept.and_then(|(_, state)| Experiment::resume(rig, options, &state).ok());
            if let Some(drum) = made {
                return Ok(drum);
            }
        }
        Ok(Experiment::new(rig, options)?)
    }
}
