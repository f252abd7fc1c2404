//! State of an experiment besides its world: what was done and what comes next.

use crate::codec::{Reader, Stored};
use crate::error::Error;
use crate::frame::{Exposure, Frame};

/// What a run is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// The bed comes to rest in the standing drum.
    Settling,
    /// The drum turns; the motion is not steady yet.
    Approaching,
    /// Frames are taken.
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
    /// Step at which sampling began.
    pub(crate) sampling: u64,
    /// Step at which the last frame was complete.
    pub(crate) ended: u64,
    pub(crate) series: Series,
    pub(crate) frames: Vec<Frame>,
    pub(crate) coordination: Vec<f64>,
    pub(crate) wall_contacts: Vec<f64>,
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
stored!(Record { begun, steady, sampling, ended, series, frames, coordination, wall_contacts });
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
