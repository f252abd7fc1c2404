//! A folder with a manifest and what was made of it.

use std::path::{Path, PathBuf};

use super::file::{self, io};
use super::lock::{Lock, Share};
use super::manifest::{Manifest, Row};
use super::result::{FORMAT, RowOutcome, RowResult};
use crate::CampaignError;

/// Where a run stands.
#[derive(Debug, Clone, PartialEq)]
pub enum RowState {
    /// Nothing was done.
    Open,
    /// A checkpoint keeps what was done.
    Begun,
    /// There is a result: responses or a failure.
    Ended(Box<RowResult>),
}

/// A campaign: a manifest in a folder.
#[derive(Debug, Clone)]
pub struct Campaign {
    folder: PathBuf,
    manifest: Manifest,
}

impl Campaign {
    /// Begin a campaign in a folder, or take up the one of the same plan that is there.
    ///
    /// # Errors
    /// [`CampaignError::OtherPlan`] where another plan was frozen, [`CampaignError::Altered`],
    /// [`CampaignError::Io`] for a folder that cannot be written.
    pub fn begin(folder: &Path, manifest: Manifest) -> Result<Self, CampaignError> {
        for part in [folder.to_path_buf(), folder.join("rows"), folder.join("locks")] {
            std::fs::create_dir_all(&part).map_err(io("making the folder", &part))?;
        }
        let path = folder.join(MANIFEST);
        if path.exists() {
            let there = Manifest::read(&path)?;
            if let Some(difference) = manifest.differs_from(&there) {
                return Err(CampaignError::OtherPlan {
                    path: path.display().to_string(),
                    difference,
                });
            }
            return Ok(Self { folder: folder.to_path_buf(), manifest: there });
        }
        file::write_whole(&path, manifest.text()?.as_bytes())?;
        Ok(Self { folder: folder.to_path_buf(), manifest })
    }

    /// The campaign of a folder.
    ///
    /// # Errors
    /// [`CampaignError::NoManifest`], [`CampaignError::Altered`], [`CampaignError::Io`].
    pub fn open(folder: &Path) -> Result<Self, CampaignError> {
        let manifest = Manifest::read(&folder.join(MANIFEST))?;
        Ok(Self { folder: folder.to_path_buf(), manifest })
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Its manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Where a run stands.
    ///
    /// # Errors
    /// [`CampaignError::Altered`] for a result that was changed or belongs to another row.
    pub fn state(&self, row: &Row) -> Result<RowState, CampaignError> {
        let path = self.result_path(row);
        let Some(bytes) = file::read(&path)? else {
            let begun = self.checkpoint_path(row).exists();
            return Ok(if begun { RowState::Begun } else { RowState::Open });
        };
        let (result, _) = file::unseal::<RowResult>(&path, &bytes)?;
        if result.format != FORMAT || result.index != row.index || result.hash != row.hash {
            return Err(CampaignError::Altered {
                path: path.display().to_string(),
                problem: "the result of another run".to_owned(),
                remedy: "restore the file, or remove it and run again",
            });
        }
        Ok(RowState::Ended(Box::new(result)))
    }

    /// Whether a run is still to be done: without result, or with a failure that may pass.
    pub(crate) fn is_due(&self, row: &Row, retry_failed: bool) -> Result<bool, CampaignError> {
        Ok(match self.state(row)? {
            RowState::Ended(result) => match result.outcome {
                RowOutcome::Done(_) => false,
                RowOutcome::Failed(failure) => retry_failed || failure.class.passes(),
            },
            RowState::Open | RowState::Begun => true,
        })
    }

    pub(crate) fn write_result(&self, row: &Row, result: &RowResult) -> Result<(), CampaignError> {
        file::write_whole(&self.result_path(row), file::seal(result)?.as_bytes())
    }

    pub(crate) fn remove_checkpoint(&self, row: &Row) -> Result<(), CampaignError> {
        remove(&self.checkpoint_path(row))
    }

    pub(crate) fn rows_folder(&self) -> PathBuf {
        self.folder.join("rows")
    }

    fn result_path(&self, row: &Row) -> PathBuf {
        self.rows_folder().join(format!("{:04}.json", row.index))
    }

    pub(crate) fn checkpoint_path(&self, row: &Row) -> PathBuf {
        self.rows_folder().join(format!("{:04}.checkpoint", row.index))
    }

    /// Where the motion of runs that differ in camera or reader alone is kept, by the first of them.
    pub(crate) fn motion_path(&self, first: &Row) -> PathBuf {
        self.rows_folder().join(format!("{:04}.motion", first.index))
    }

    /// Forget a motion that no run needs any more.
    pub(crate) fn forget_motion(&self, runs: &[&Row]) -> Result<(), CampaignError> {
        let (Some(first), true) = (runs.first(), runs.len() > 1) else { return Ok(()) };
        for row in runs {
            if self.is_due(row, false)? {
                return Ok(());
            }
        }
        remove(&self.motion_path(first))
    }

    /// The lock of the whole campaign: alone for all runs, shared for single ones.
    pub(crate) fn lock(&self, share: Share) -> Result<Lock, CampaignError> {
        let what = format!("the campaign in {}", self.folder.display());
        Lock::take(&self.folder.join("locks").join("campaign.lock"), share, &what)
    }

    /// The lock of one run.
    pub(crate) fn lock_row(&self, row: &Row) -> Result<Lock, CampaignError> {
        let what = format!("run {} of the campaign in {}", row.index, self.folder.display());
        let path = self.folder.join("locks").join(format!("{:04}.lock", row.index));
        Lock::take(&path, Share::Alone, &what)
    }
}

/// Remove a file that need not be there.
fn remove(path: &Path) -> Result<(), CampaignError> {
    match std::fs::remove_file(path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(io("removing", path)(e)),
        _ => Ok(()),
    }
}

/// Name of a campaign's manifest.
const MANIFEST: &str = "manifest.json";
