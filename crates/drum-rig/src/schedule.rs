//! Step numbers of a run: windows, monitoring, frames.

use crate::options::Options;
use crate::script::Record;

/// Monitorings in one window of the stationarity test.
pub(crate) const WINDOW: usize = 128;
/// Periods of sloshing before the first window.
const LEAD_PERIODS: f64 = 1.5;
/// Turns of the drum before the first window: the bed rises to its angle.
const LEAD_TURNS: f64 = 0.125;
/// Monitorings between two tests.
pub(crate) const BETWEEN_TESTS: usize = WINDOW / 4;

/// Period, s, in which a bed swings to and fro in a drum of `radius` m: that of a pendulum as long.
pub(crate) fn sloshing_period(radius: f64) -> f64 {
    std::f64::consts::TAU * (radius / crate::GRAVITY).sqrt()
}

/// One speed in steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stage {
    pub(crate) speed_rpm: f64,
    /// rad/s.
    pub(crate) omega: f64,
    /// Steps between two monitorings.
    pub(crate) monitor: u64,
    /// Steps from frame to frame.
    pub(crate) frame: u64,
    /// Steps that an exposure lasts.
    pub(crate) exposure: u64,
    pub(crate) frames: usize,
    pub(crate) sub_frames: usize,
    /// Monitorings before the first window.
    pub(crate) lead: usize,
    /// Monitorings after which the approach is given up.
    pub(crate) patience: usize,
}

impl Stage {
    pub(crate) fn new(
        speed_rpm: f64,
        scale: f64,
        (dt, radius): (f64, f64),
        frames: u32,
        options: &Options,
    ) -> Self {
        let sloshing = sloshing_period(radius);
        let omega = speed_rpm * scale * std::f64::consts::TAU / 60.0;
        let turn = std::f64::consts::TAU / omega;
        let steps = |seconds: f64| ((seconds / dt).round() as u64).max(1);
        let window = (options.window_turns * turn).max(options.least_window_s.unwrap_or(sloshing));
        let monitor = steps(window / WINDOW as f64);
        let span = (0.5 * turn).max(1.5);
        let interval = options.frame_interval_s.unwrap_or(span / f64::from(frames));
        let exposure = if options.exposure_s > 0.0 { steps(options.exposure_s) } else { 0 };
        let lead = (LEAD_TURNS * turn).max(LEAD_PERIODS * sloshing);
        let longest = (options.longest_turns * turn).max(4.0 * window + lead);
        Self {
            speed_rpm,
            omega,
            monitor,
            frame: steps(interval).max(exposure),
            exposure,
            frames: frames as usize,
            sub_frames: options.sub_frames as usize,
            lead: (lead / dt / monitor as f64).ceil() as usize,
            patience: (longest / dt / monitor as f64).ceil() as usize,
        }
    }

    /// Steps from the start of this speed to instant `sub` of frame `number`, counted from the first
    /// after the lead: sub-frames stand in the middle of equal parts of the exposure.
    pub(crate) fn instant(&self, number: u64, sub: usize) -> u64 {
        let within = (sub as f64 + 0.5) / self.sub_frames as f64 * self.exposure as f64;
        self.opening(number) + within as u64
    }

    /// Steps from the start of this speed to the opening of the shutter for frame `number`.
    fn opening(&self, number: u64) -> u64 {
        self.lead as u64 * self.monitor + (number + 1) * self.frame - self.exposure
    }

    /// Step at which the next exposure of a record is due.
    pub(crate) fn due(&self, record: &Record) -> u64 {
        let (number, sub) = record.next_instant(self.sub_frames);
        record.begun + self.instant(number, sub)
    }

    /// Frames that began earlier than so many steps after the start of this speed.
    pub(crate) fn frames_begun_before(&self, steps: u64) -> u64 {
        steps.saturating_sub(self.opening(0)).div_ceil(self.frame)
    }

    /// Fewest steps that this speed takes: frames are taken within the windows as well.
    pub(crate) fn least_steps(&self) -> u64 {
        let windows = 2 * WINDOW as u64 * self.monitor;
        self.lead as u64 * self.monitor + windows.max(self.frames as u64 * self.frame)
    }
}
