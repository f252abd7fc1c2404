//! Files of the two-level cache: each is written under another name and renamed.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::CampaignError;

/// A folder of kept motions and rows.
#[derive(Debug, Clone)]
pub(crate) struct Store {
    root: PathBuf,
}

impl Store {
    /// Open a folder, making it if need be.
    pub(crate) fn open(root: &Path) -> Result<Self, CampaignError> {
        for level in ["motions", "responses"] {
            let path = root.join(level);
            std::fs::create_dir_all(&path).map_err(|e| unwritable(&path, e))?;
        }
        Ok(Self { root: root.to_owned() })
    }

    pub(crate) fn motion(&self, key: &blake3::Hash) -> PathBuf {
        self.root.join("motions").join(format!("{}.footage", &key.to_hex()[..32]))
    }

    pub(crate) fn row(&self, key: &blake3::Hash) -> PathBuf {
        self.root.join("responses").join(format!("{}.json", &key.to_hex()[..32]))
    }

    /// Bytes of a file, `None` if it is not there.
    pub(crate) fn read(&self, path: &Path) -> Result<Option<Vec<u8>>, CampaignError> {
        match std::fs::read(path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(e) => {
                Err(CampaignError::Unreadable { path: path.display().to_string(), source: e })
            }
        }
    }

    /// Write a file whole or not at all.
    pub(crate) fn write(&self, path: &Path, bytes: &[u8]) -> Result<(), CampaignError> {
        let parent = path.parent().unwrap_or(&self.root);
        let save = || -> std::io::Result<()> {
            let mut file = tempfile::NamedTempFile::new_in(parent)?;
            file.write_all(bytes)?;
            file.as_file().sync_all()?;
            file.persist(path)?;
            Ok(())
        };
        save().map_err(|e| unwritable(path, e))
    }
}

fn unwritable(path: &Path, source: std::io::Error) -> CampaignError {
    CampaignError::Unwritable { path: path.display().to_string(), source }
}
