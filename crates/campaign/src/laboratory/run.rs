//! What one simulated experiment has shown.

use drum_vision::SeriesReport;
use rig_schema::Rig;
use serde::{Deserialize, Serialize};

use crate::{CampaignError, Footage, Observatory, Resolution};

/// The four responses at one speed, in the order of `rig_schema::Response::ALL`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpeedRow {
    /// Speed, rpm.
    pub omega_rpm: f64,
    /// Means over the frames, deg and percent of R.
    pub mean: [f64; 4],
    /// Standard deviations over the frames.
    pub sd: [f64; 4],
    /// Covariance of the four means: frames scatter, and follow each other.
    pub covariance: [[f64; 4]; 4],
    /// Independent frames in each mean.
    pub n_eff: [f64; 4],
    /// Measured frames.
    pub n_frames: usize,
    /// Frames that could not be measured.
    pub rejected: usize,
    /// Apparent fill.
    pub fill: Option<f64>,
    /// Time from taking up the speed to the steady state, s.
    pub approach_s: f64,
}

impl SpeedRow {
    /// What an observatory sees of one footage.
    pub(crate) fn seen(
        observatory: &Observatory,
        footage: &Footage,
    ) -> Result<Self, CampaignError> {
        let seen = observatory.observe_footage(footage)?;
        let row = Self::of(footage.speed_rpm, footage.approach_s, &seen.report);
        row.ok_or_else(|| CampaignError::Unseen {
            speed_rpm: footage.speed_rpm,
            measured: seen.report.n_frames,
            reason: seen.report.rejected.first().map(|r| r.reason.clone()),
        })
    }

    /// What a report says, if it has at least two frames.
    pub(crate) fn of(speed_rpm: f64, approach_s: f64, report: &SeriesReport) -> Option<Self> {
        let r = report.responses?;
        let each = [r.aor_lin_deg, r.aor_mid_deg, r.cen_x_pct, r.cen_y_pct];
        let mut sd = [0.0; 4];
        for (s, summary) in sd.iter_mut().zip(each) {
            *s = summary.sd?;
        }
        Some(Self {
            omega_rpm: speed_rpm,
            mean: each.map(|s| s.mean),
            sd,
            covariance: report.covariance?,
            n_eff: each.map(|s| s.n_eff),
            n_frames: report.n_frames,
            rejected: report.rejected.len(),
            fill: report.fill,
            approach_s,
        })
    }
}

/// One simulated experiment: all speeds of a rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Hash of everything that the row depends on.
    pub key: String,
    /// One row a speed, ascending.
    pub speeds: Vec<SpeedRow>,
    /// Steps that the simulation took.
    pub steps: u64,
    /// Particles.
    pub particles: usize,
    /// Processor time that simulating, filming and measuring took when it was done, s.
    pub cost_s: f64,
}

impl Run {
    /// What another code's motion looks like through the camera and the reader of a rig.
    ///
    /// # Errors
    /// Those of [`Observatory::observe_footage`]; [`CampaignError::Unseen`] for a speed at which fewer
    /// than two frames could be measured.
    pub fn of_footage(
        rig: &Rig,
        resolution: Resolution,
        speeds: &[Footage],
    ) -> Result<Self, CampaignError> {
        let observatory = Observatory::new(rig, resolution)?;
        let rows = speeds
            .iter()
            .map(|footage| SpeedRow::seen(&observatory, footage))
            .collect::<Result<_, _>>()?;
        let particles = speeds.first().map_or(0, |f| f.radii.len() / f.per_body.max(1) as usize);
        Ok(Self { key: String::new(), speeds: rows, steps: 0, particles, cost_s: 0.0 })
    }
}
