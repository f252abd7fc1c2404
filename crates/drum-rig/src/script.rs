//! State of an experiment besides its world: what was done and what comes next.

use crate::codec::{Reader, Stored};
use crate::error::Error;
use crate::frame::{Exposure, Frame};

/// What a run is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The bed comes to rest in the standing drum.
    Settling,
    /// The drum turns; the motion is not known to be steady yet.
    Approaching,
    /// The motion is steady; the frames that are still missing are taken.
    Sampling,
    /// All speeds are done.
    Done,
}

/// Signals of one speed, by monitoring.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Series {
    pub(crate) torque: Vec<f64>,
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) z: Vec<f64>,
    pub(crate) angle_deg: Vec<f64>,
}

/// Everything measured at one speed.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Record {
    /// Step at which the drum took up the speed.
    pub(crate) begun: u64,
    /// Number of the first steady monitoring.
    pub(crate) steady: u64,
    /// Frames that were taken before those below and left out.
    pub(crate) left_out: u64,
    /// Step at which the last frame was complete.
    pub(crate) ended: u64,
    pub(crate) series: Series,
    pub(crate) frames: Vec<Frame>,
    pub(crate) coordination: Vec<f64>,
    pub(crate) wall_contacts: Vec<f64>,
}

impl Record {
    /// Frames that have all their exposures.
    pub(crate) fn complete(&self, sub_frames: usize) -> usize {
        let open = self.frames.last().is_some_and(|f| f.exposures.len() < sub_frames);
        self.frames.len() - usize::from(open)
    }

    /// Number of the frame that is exposed next, counted from the first taken, and of the exposure.
    pub(crate) fn next_instant(&self, sub_frames: usize) -> (u64, usize) {
        let complete = self.complete(sub_frames);
        let sub = self.frames.get(complete).map_or(0, |f| f.exposures.len());
        (self.left_out + complete as u64, sub)
    }

    /// Leave out the first `count` frames, or all.
    pub(crate) fn leave_out(&mut self, count: usize) {
        let count = count.min(self.frames.len());
        self.left_out += count as u64;
        self.frames.drain(..count);
        self.coordination.drain(..count);
        self.wall_contacts.drain(..count);
    }

    /// Forget what was begun after the first `count` frames.
    pub(crate) fn close_with(&mut self, count: usize) {
        self.frames.truncate(count);
        self.coordination.truncate(count);
        self.wall_contacts.truncate(count);
    }
}

/// Where the run stands.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Script {
    pub(crate) phase: Phase,
    /// Records of the speeds begun so far.
    pub(crate) records: Vec<Record>,
    /// Step at which the vibration (and the first turn) began.
    pub(crate) started: u64,
}

impl Script {
    pub(crate) fn new() -> Self {
        Self { phase: Phase::Settling, records: Vec::new(), started: 0 }
    }

    /// Number of the present speed.
    pub(crate) fn speed(&self) -> usize {
        self.records.len().saturating_sub(1)
    }
}

macro_rules! stored {
    ($type:ident { $($field:ident),+ }) => {
        impl Stored for $type {
            fn put(&self, out: &mut Vec<u8>) {
                $(self.$field.put(out);)+
            }
            fn take(input: &mut Reader<'_>) -> Result<Self, Error> {
                Ok(Self { $($field: Stored::take(input)?),+ })
            }
        }
    };
}

stored!(Series { torque, x, y, z, angle_deg });
stored!(Exposure { time_s, positions, orientations });
stored!(Frame { time_s, exposures });
stored!(Record { begun, steady, left_out, ended, series, frames, coordination, wall_contacts });
stored!(Script { phase, records, started });

const PHASES: [Phase; 4] = [Phase::Settling, Phase::Approaching, Phase::Sampling, Phase::Done];

impl Stored for Phase {
    fn put(&self, out: &mut Vec<u8>) {
        (*self as u64).put(out);
    }
    fn take(input: &mut Reader<'_>) -> Result<Self, Error> {
        let offset = input.offset();
        let number = u64::take(input)?;
        let phase = usize::try_from(number).ok().and_then(|n| PHASES.get(n).copied());
        phase.ok_or(Error::Checkpoint { what: "an unknown phase", offset })
    }
}
