//! How a run is carried out: what is no property of the rig.

use crate::error::Error;

/// Options of a run; `Options::default()` serves most.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Threads; they change no bit of the result.
    pub threads: usize,
    /// Exposure time of one frame, s: its sub-frames spread over it.
    pub exposure_s: f64,
    /// Positions taken within the exposure of one frame.
    pub sub_frames: u32,
    /// Time from one frame to the next, s; by default such that all frames of a speed span half a
    /// turn and at least 1.5 s. Never less than the exposure.
    pub frame_interval_s: Option<f64>,
    /// Length of a window of the stationarity test, turns of the drum (at least a quarter).
    pub window_turns: f64,
    /// Least length of a window, s; by default the period `2 pi sqrt(R/g)` in which a bed swings.
    pub least_window_s: Option<f64>,
    /// Turns at one speed after which a motion that is not stationary is given up.
    pub longest_turns: f64,
    /// Bytes of the STL file that `drum.liner` names, in metres, axis along z, centred.
    pub liner_stl: Option<Vec<u8>>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            threads: 1,
            exposure_s: 0.0,
            sub_frames: 1,
            frame_interval_s: None,
            window_turns: 0.25,
            least_window_s: None,
            longest_turns: 8.0,
            liner_stl: None,
        }
    }
}

impl Options {
    /// Refuse what no run can be made of.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let refuse = |name, value, expected| Err(Error::Option { name, value, expected });
        if self.threads == 0 {
            return refuse("threads", 0.0, "at least 1");
        }
        if self.sub_frames == 0 {
            return refuse("sub_frames", 0.0, "at least 1");
        }
        if !(self.exposure_s >= 0.0 && self.exposure_s.is_finite()) {
            return refuse("exposure_s", self.exposure_s, "a finite time, 0 or more");
        }
        if let Some(t) = self.frame_interval_s
            && !(t > 0.0 && t.is_finite())
        {
            return refuse("frame_interval_s", t, "a finite time above 0");
        }
        if !(self.window_turns >= 0.25 && self.window_turns.is_finite()) {
            return refuse("window_turns", self.window_turns, "at least 0.25");
        }
        if let Some(t) = self.least_window_s
            && !(t > 0.0 && t.is_finite())
        {
            return refuse("least_window_s", t, "a finite time above 0");
        }
        if !(self.longest_turns >= 3.0 * self.window_turns && self.longest_turns.is_finite()) {
            return refuse("longest_turns", self.longest_turns, "at least three windows");
        }
        Ok(())
    }

    /// What a checkpoint depends on, as text; threads are left out.
    pub(crate) fn identity(&self) -> String {
        let one = Self { threads: 1, liner_stl: None, ..self.clone() };
        let liner = self.liner_stl.as_deref().map(blake3::hash);
        format!("{one:?} {liner:?}")
    }
}
