//! When a deck takes up a speed and writes its frames, in steps.

use drum_rig::GRAVITY;
use rig_schema::Rig;

use super::scene::Scene;
use crate::CampaignError;

/// Settling time in periods `sqrt(R/g)`: with a drag of one over it, nothing moves any more.
const SETTLING: f64 = 12.0;
/// Least time before the first frame of the first speed, in periods of sloshing.
const LEAD_PERIODS: f64 = 1.5;

/// When frames are written.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Turns at each speed before the first frame (at the first speed at least 1.5 periods of
    /// sloshing).
    pub approach_turns: f64,
    /// Time from one frame to the next, s; by default all frames of a speed span half a turn and at
    /// least 1.5 s, as those of the rig's own simulation do.
    pub interval_s: Option<f64>,
    /// Times of the frames, s after the drum took up each speed; these go before interval and
    /// number of frames.
    pub times_s: Vec<f64>,
}

impl Default for Schedule {
    /// One turn, frames as in the rig's own simulation.
    fn default() -> Self {
        Self { approach_turns: 1.0, interval_s: None, times_s: Vec::new() }
    }
}

/// One speed in steps.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stage {
    pub(super) speed_rpm: f64,
    /// rad/s.
    pub(super) omega: f64,
    /// Steps after the start of the stage at which a fading drag is halved and ends; none after the
    /// first speed.
    pub(super) damped: Option<[u64; 2]>,
    /// Steps after the start of the stage at which frames are written, ascending.
    pub(super) frames: Vec<u64>,
}

/// All speeds in steps.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stages {
    pub(super) dt: f64,
    pub(super) settling: u64,
    pub(super) stages: Vec<Stage>,
}

impl Schedule {
    pub(super) fn stages(
        &self,
        rig: &Rig,
        scene: &Scene,
        dt: f64,
    ) -> Result<Stages, CampaignError> {
        let refuse = |name, value, expected| Err(CampaignError::Option { name, value, expected });
        if !(self.approach_turns > 0.0 && self.approach_turns.is_finite()) {
            return refuse("approach_turns", self.approach_turns, "a finite number above 0");
        }
        if let Some(t) = self.interval_s.filter(|t| !(*t > 0.0 && t.is_finite())) {
            return refuse("interval_s", t, "a finite time above 0");
        }
        let steps = |seconds: f64| ((seconds / dt).round() as u64).max(1);
        let mut times: Vec<u64> = Vec::new();
        for &t in &self.times_s {
            if !(t > 0.0 && t.is_finite()) {
                return refuse("times_s", t, "finite times above 0");
            }
            times.push(steps(t));
        }
        times.sort_unstable();
        times.dedup();
        let period = (scene.radius / GRAVITY).sqrt();
        let sloshing = std::f64::consts::TAU * period;
        let mut speeds = rig.run.speeds_rpm.clone();
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        let stage = |(k, &speed_rpm): (usize, &f64)| {
            let omega = speed_rpm * scene.speed_scale * std::f64::consts::TAU / 60.0;
            let turn = std::f64::consts::TAU / omega;
            let lead = LEAD_PERIODS * sloshing;
            let approach = (self.approach_turns * turn).max(if k == 0 { lead } else { 0.0 });
            let span = (0.5 * turn).max(1.5);
            let frames = u64::from(rig.run.frames);
            let interval = steps(self.interval_s.unwrap_or(span / frames as f64));
            let even = || (0..frames).map(|n| steps(approach) + n * interval).collect();
            Stage {
                speed_rpm,
                omega,
                damped: (k == 0).then(|| [steps(0.5 * lead), steps(lead)]),
                frames: if times.is_empty() { even() } else { times.clone() },
            }
        };
        Ok(Stages {
            dt,
            settling: steps(SETTLING * period),
            stages: speeds.iter().enumerate().map(stage).collect(),
        })
    }
}

/// What happens within a stage after some steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mark {
    /// The drag is halved.
    HalfDrag,
    /// The drag ends.
    NoDrag,
    /// A frame is written.
    Frame,
}

impl Stage {
    /// What happens, with the steps to run before it.
    pub(super) fn marks(&self) -> Vec<(u64, Mark)> {
        let mut all: Vec<(u64, Mark)> = self.frames.iter().map(|s| (*s, Mark::Frame)).collect();
        if let Some([half, none]) = self.damped {
            all.extend([(half, Mark::HalfDrag), (none, Mark::NoDrag)]);
        }
        // The sort keeps the order of equals: a frame before a change of the drag.
        all.sort_by_key(|(step, _)| *step);
        let mut at = 0;
        for (step, _) in &mut all {
            let absolute = *step;
            *step -= at;
            at = absolute;
        }
        all
    }

    /// Steps of the whole stage.
    pub(super) fn steps(&self) -> u64 {
        self.marks().iter().map(|(steps, _)| steps).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_come_in_order_and_add_up() {
        let stage = Stage {
            speed_rpm: 17.0,
            omega: 1.78,
            damped: Some([50, 100]),
            frames: vec![70, 100, 130],
        };
        let marks = stage.marks();
        assert_eq!(
            marks,
            [
                (50, Mark::HalfDrag),
                (20, Mark::Frame),
                (30, Mark::Frame),
                (0, Mark::NoDrag),
                (30, Mark::Frame)
            ]
        );
        assert_eq!(stage.steps(), 130);
    }
}
