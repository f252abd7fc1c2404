//! What a run left: its responses, or why there are none.

use drum_rig::Sampled;
use drum_vision::SeriesReport;
use serde::{Deserialize, Serialize};

use crate::{CampaignError, Observed};

/// Version of the format of a result.
pub(crate) const FORMAT: u32 = 1;

/// One response at one speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seen {
    /// Mean over the frames.
    pub mean: f64,
    /// Standard deviation over the frames (not of the mean).
    pub sd: Option<f64>,
    /// Independent frames that the mean is worth.
    pub n_eff: Option<f64>,
    /// Autocorrelation from one frame to the next.
    pub lag_one: Option<f64>,
    /// Median standard uncertainty of a single frame.
    pub frame_sd: Option<f64>,
}

/// The four responses at one speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Responses {
    /// Angle of the line through the whole surface, degrees.
    pub aor_lin_deg: Seen,
    /// Angle of the line through its middle, degrees.
    pub aor_mid_deg: Seen,
    /// Centre of area towards the raised side, percent of the radius.
    pub cen_x_pct: Seen,
    /// Centre of area downwards, percent of the radius.
    pub cen_y_pct: Seen,
}

impl Responses {
    /// In the order of [`rig_schema::Response::ALL`].
    pub fn all(&self) -> [Seen; 4] {
        [self.aor_lin_deg, self.aor_mid_deg, self.cen_x_pct, self.cen_y_pct]
    }
}

/// What was seen and felt at one speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedResult {
    /// Speed of the schedule, rpm.
    pub omega_rpm: f64,
    /// Froude number.
    pub froude: f64,
    /// Time from which the motion counts as steady, s.
    pub steady_from_s: f64,
    /// Turns at this speed.
    pub revolutions: f64,
    /// Mean torque, N m.
    pub torque_n_m: f64,
    /// Mean direction of the centre of mass from the vertical, degrees.
    pub angle_of_centre_of_mass_deg: f64,
    /// Mean contacts of a particle with others.
    pub coordination: f64,
    /// The responses; `None` when no frame could be measured.
    pub responses: Option<Responses>,
    /// The same film read as pictures of EDEM are (angles from wall to wall, and from one fifth to
    /// four fifths), for comparison with tables made that way.
    #[serde(default)]
    pub responses_edem: Option<Responses>,
    /// Covariance of the four means; `None` with fewer than two frames.
    pub covariance: Option<[[f64; 4]; 4]>,
    /// Frames that were measured.
    pub n_frames: usize,
    /// Frames that were not, with the reason.
    pub rejected: Vec<String>,
}

/// A run that was carried out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Simulated {
    /// Number of particles.
    pub particles: usize,
    /// Time step, s.
    pub time_step_s: f64,
    /// Steps.
    pub steps: u64,
    /// One entry a speed, ascending.
    pub speeds: Vec<SpeedResult>,
}

/// Kind of a failure, which says whether trying again can help.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FailureClass {
    /// The rig cannot be simulated, or its motion has no steady state: it would fail again.
    Physics,
    /// Film or reader refused: it would fail again.
    Measuring,
    /// Reading or writing failed: tried again, at once and by the next call.
    Io,
    /// The checkpoint cannot be taken up: tried again by the next call.
    Checkpoint,
    /// A fault of the program: it would fail again.
    Fault,
}

impl FailureClass {
    /// Class of an error.
    pub fn of(error: &CampaignError) -> Self {
        match error {
            CampaignError::Io { .. }
            | CampaignError::Unwritable { .. }
            | CampaignError::Unreadable { .. } => Self::Io,
            CampaignError::Altered { .. }
            | CampaignError::Rig(
                drum_rig::Error::Checkpoint { .. } | drum_rig::Error::OtherRig { .. },
            ) => Self::Checkpoint,
            CampaignError::Film(_)
            | CampaignError::Vision(_)
            | CampaignError::Picture { .. }
            | CampaignError::Unseen { .. }
            | CampaignError::Parameter { .. } => Self::Measuring,
            CampaignError::Fault { .. } | CampaignError::Json { .. } => Self::Fault,
            CampaignError::Row { source, .. } => Self::of(source),
            _ => Self::Physics,
        }
    }

    /// Whether the next call tries again.
    pub fn passes(self) -> bool {
        matches!(self, Self::Io | Self::Checkpoint)
    }
}

impl std::fmt::Display for FailureClass {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Physics => "physics",
            Self::Measuring => "measuring",
            Self::Io => "reading or writing",
            Self::Checkpoint => "checkpoint",
            Self::Fault => "fault of the program",
        })
    }
}

/// Why a run has no responses.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Failure {
    /// Its kind.
    pub class: FailureClass,
    /// Words for people.
    pub reason: String,
    /// How often it was tried in a row.
    pub attempts: u32,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RowOutcome {
    /// With responses.
    Done(Simulated),
    /// Without.
    Failed(Failure),
}

/// What a run cost; it differs from one call to the next.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Effort {
    /// Wall time, s, over all sessions, as far as checkpoints remember.
    pub wall_s: f64,
    /// Sessions: one more than the times that a checkpoint was taken up.
    pub sessions: u32,
}

/// File of one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RowResult {
    /// Version of the format.
    pub format: u32,
    /// Version of the program.
    pub version: String,
    /// Number of the run.
    pub index: u64,
    /// Hash of its row.
    pub hash: String,
    /// Values of its factors by path.
    pub values: Vec<(String, f64)>,
    /// Seed.
    pub seed: u64,
    /// How it ended.
    pub outcome: RowOutcome,
    /// What it cost.
    pub effort: Effort,
}

/// The result of one speed from what was sampled and seen.
pub(crate) fn speed_result(steady: &Sampled, seen: &Observed, edem: &SeriesReport) -> SpeedResult {
    let finite = |x: f64| x.is_finite().then_some(x);
    let report = &seen.report;
    let one = |s: drum_vision::series::ResponseSummary| Seen {
        mean: s.mean,
        sd: s.sd.and_then(finite),
        n_eff: finite(s.n_eff),
        lag_one: finite(s.lag_one),
        frame_sd: finite(s.frame_sd),
    };
    let all = |report: &SeriesReport| {
        report.responses.map(|r| Responses {
            aor_lin_deg: one(r.aor_lin_deg),
            aor_mid_deg: one(r.aor_mid_deg),
            cen_x_pct: one(r.cen_x_pct),
            cen_y_pct: one(r.cen_y_pct),
        })
    };
    SpeedResult {
        omega_rpm: steady.speed_rpm,
        froude: steady.froude,
        steady_from_s: steady.steady_from_s,
        revolutions: steady.revolutions,
        torque_n_m: steady.torque.mean,
        angle_of_centre_of_mass_deg: steady.angle_deg.mean,
        coordination: steady.coordination.mean,
        responses: all(report),
        responses_edem: all(edem),
        covariance: report.covariance.filter(|c| c.iter().flatten().all(|v| v.is_finite())),
        n_frames: report.n_frames,
        rejected: report.rejected.iter().map(|r| format!("{}: {}", r.frame, r.reason)).collect(),
    }
}
