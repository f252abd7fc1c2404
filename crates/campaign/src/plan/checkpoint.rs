//! Checkpoints of runs under way.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `tumbrun` and the version of the format |
//! | 8 | wall time so far, s (f64, little-endian) |
//! | 4 | sessions so far |
//! | | the experiment's own checkpoint, with its version and checksum |
//! | 32 | BLAKE3 of everything before |

use std::path::Path;

use super::file;
use super::result::Effort;
use crate::CampaignError;

const MAGIC: [u8; 8] = *b"tumbrun\x01";
const HEAD: usize = 20;
const SUM: usize = 32;

/// Write what an experiment and its effort are.
pub(crate) fn write(path: &Path, effort: Effort, experiment: &[u8]) -> Result<(), CampaignError> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend_from_slice(&effort.wall_s.to_le_bytes());
    bytes.extend_from_slice(&effort.sessions.to_le_bytes());
    bytes.extend_from_slice(experiment);
    let sum = blake3::hash(&bytes);
    bytes.extend_from_slice(sum.as_bytes());
    file::write_whole(path, &bytes)
}

/// Read a checkpoint, `None` where there is none.
pub(crate) fn read(path: &Path) -> Result<Option<(Effort, Vec<u8>)>, CampaignError> {
    let Some(bytes) = file::read(path)? else { return Ok(None) };
    let altered = |problem: &str| {
        Err(CampaignError::Altered {
            path: path.display().to_string(),
            problem: problem.to_owned(),
            remedy: "remove it, and the run starts anew",
        })
    };
    if bytes.len() < HEAD + SUM || bytes[..8] != MAGIC {
        return altered("no checkpoint of this version");
    }
    let (body, sum) = bytes.split_at(bytes.len() - SUM);
    if blake3::hash(body).as_bytes() != sum {
        return altered("a checksum that does not match");
    }
    let mut wall = [0; 8];
    wall.copy_from_slice(&body[8..16]);
    let mut sessions = [0; 4];
    sessions.copy_from_slice(&body[16..20]);
    let effort =
        Effort { wall_s: f64::from_le_bytes(wall), sessions: u32::from_le_bytes(sessions) };
    Ok(Some((effort, body[HEAD..].to_vec())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_comes_back_and_an_altered_one_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("0001.checkpoint");
        assert_eq!(read(&path).unwrap(), None);
        let effort = Effort { wall_s: 12.5, sessions: 2 };
        write(&path, effort, b"state").unwrap();
        assert_eq!(read(&path).unwrap(), Some((effort, b"state".to_vec())));
        let mut bytes = std::fs::read(&path).unwrap();
        for at in [0, 9, 21, bytes.len() - 1] {
            bytes[at] ^= 1;
            std::fs::write(&path, &bytes).unwrap();
            let shown = read(&path).unwrap_err().to_string();
            assert!(shown.contains("0001.checkpoint") && shown.contains("remove it"), "{shown}");
            bytes[at] ^= 1;
        }
        std::fs::write(&path, &bytes[..10]).unwrap();
        assert!(read(&path).is_err());
    }
}
