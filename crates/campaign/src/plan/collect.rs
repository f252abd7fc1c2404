//! The results of a campaign as one table of simulated responses.

use rig_schema::Response;

use super::campaign::{Campaign, RowState};
use super::design::SPEED;
use super::file;
use super::result::{Failure, RowOutcome, Simulated, SpeedResult};
use crate::CampaignError;

/// A run that the table lacks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    /// Number of the run.
    pub index: u64,
    /// Why it failed; `None` for a run that has not ended.
    pub failure: Option<Failure>,
}

/// The table of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Collected {
    /// The table, as [`rig_schema::SimulatedTable::parse`] reads it.
    pub text: String,
    /// Rows of the table.
    pub rows: usize,
    /// Runs that it lacks.
    pub missing: Vec<Missing>,
    /// Runs and speeds (rpm) at which no frame could be measured: their cells are empty.
    pub unmeasured: Vec<(u64, f64)>,
}

impl Campaign {
    /// The table of what is done so far.
    ///
    /// One row a run and speed. Its number in the column `run` is that of the run times the number of
    /// speeds plus the number of the speed, whatever else is missing.
    ///
    /// # Errors
    /// [`CampaignError::Altered`] for results that were changed.
    pub fn table(&self) -> Result<Collected, CampaignError> {
        let manifest = self.manifest();
        let varied: Vec<usize> =
            (0..manifest.factors().len()).filter(|&k| manifest.factors()[k] != SPEED).collect();
        let mut lines = Vec::new();
        let (mut missing, mut unmeasured) = (Vec::new(), Vec::new());
        for row in manifest.rows() {
            let done: Simulated = match self.state(row)? {
                RowState::Ended(result) => match result.outcome {
                    RowOutcome::Done(done) => done,
                    RowOutcome::Failed(failure) => {
                        missing.push(Missing { index: row.index, failure: Some(failure) });
                        continue;
                    }
                },
                RowState::Open | RowState::Begun => {
                    missing.push(Missing { index: row.index, failure: None });
                    continue;
                }
            };
            for (k, speed) in done.speeds.iter().enumerate() {
                let number = row.index * row.speeds_rpm.len() as u64 + k as u64;
                let mut cells = vec![number.to_string(), speed.omega_rpm.to_string()];
                cells.extend(varied.iter().map(|&f| row.values[f].to_string()));
                cells.extend(seen(speed));
                lines.push(cells.join(","));
                if speed.responses.is_none() {
                    unmeasured.push((row.index, speed.omega_rpm));
                }
            }
        }
        let mut text = format!(
            "# {}, tumble {}, manifest {}\n",
            manifest.name().replace(['\n', '\r'], " "),
            manifest.version(),
            &manifest.checksum()[..16]
        );
        for m in &missing {
            let why = match &m.failure {
                Some(f) => {
                    format!("failed ({}): {}", f.class, f.reason.replace(['\n', '\r'], " "))
                }
                None => "has no result yet".to_owned(),
            };
            text.push_str(&format!("# run {} is missing: it {why}\n", m.index));
        }
        let mut header = vec!["run".to_owned(), "omega_rpm".to_owned()];
        header.extend(varied.iter().map(|&f| manifest.factors()[f].clone()));
        for r in Response::ALL {
            header.extend([r.column().to_owned(), r.sd_column().to_owned()]);
        }
        header.extend(["n_frames".to_owned(), "n_eff".to_owned()]);
        text.push_str(&header.join(","));
        text.push('\n');
        for line in &lines {
            text.push_str(line);
            text.push('\n');
        }
        Ok(Collected { text, rows: lines.len(), missing, unmeasured })
    }

    /// Write the table of what is done so far to `responses.csv`.
    ///
    /// # Errors
    /// As [`Campaign::table`]; [`CampaignError::Io`].
    pub fn collect(&self) -> Result<Collected, CampaignError> {
        let collected = self.table()?;
        file::write_whole(&self.folder().join("responses.csv"), collected.text.as_bytes())?;
        Ok(collected)
    }
}

/// Means, standard deviations and numbers of frames of one speed.
fn seen(speed: &SpeedResult) -> Vec<String> {
    let Some(responses) = speed.responses else { return vec![String::new(); 10] };
    let number = |x: Option<f64>| x.map(|x| format!("{x:.6}")).unwrap_or_default();
    let all = responses.all();
    let mut cells: Vec<String> =
        all.iter().flat_map(|s| [number(Some(s.mean)), number(s.sd)]).collect();
    // The response whose frames are worth least speaks for all.
    let n_eff = all.iter().filter_map(|s| s.n_eff).fold(f64::INFINITY, f64::min);
    cells.push(speed.n_frames.to_string());
    cells.push(number(n_eff.is_finite().then_some(n_eff)));
    cells
}
