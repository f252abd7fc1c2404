//! Files written whole or not at all, and texts with a checksum.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::CampaignError;

/// Ending of a file that is being written.
const PART: &str = "part";

/// Number of the next temporary name of this process.
static NEXT: AtomicU64 = AtomicU64::new(0);

/// An error of input or output with what was being done.
pub(crate) fn io(
    doing: &'static str,
    path: &Path,
) -> impl FnOnce(std::io::Error) -> CampaignError + use<> {
    let path = path.display().to_string();
    move |source| CampaignError::Io { doing, path, source }
}

/// Write a file beside its place and rename it: a reader sees the old one or the new one.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), CampaignError> {
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or("file");
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    let staged: PathBuf =
        path.with_file_name(format!(".{name}.{}.{number}.{PART}", std::process::id()));
    let written = File::create(&staged).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()?;
        std::fs::rename(&staged, path)
    });
    written.map_err(|source| {
        // What was staged is of no use; the error that matters is the first.
        let _ = std::fs::remove_file(&staged);
        io("writing", path)(source)
    })
}

/// Remove what a killed process left half-written in `folder`; nobody else may be writing there.
pub(crate) fn sweep(folder: &Path) -> Result<(), CampaignError> {
    for entry in std::fs::read_dir(folder).map_err(io("reading", folder))? {
        let path = entry.map_err(io("reading", folder))?.path();
        if path.extension().is_some_and(|e| e == PART) {
            std::fs::remove_file(&path).map_err(io("removing", &path))?;
        }
    }
    Ok(())
}

/// The bytes of a file, `None` where there is none.
pub(crate) fn read(path: &Path) -> Result<Option<Vec<u8>>, CampaignError> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(e) => Err(io("reading", path)(e)),
    }
}

/// A value with the hash of its compact JSON.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sealed<T> {
    checksum: String,
    content: T,
}

/// BLAKE3 of the compact JSON of a value.
pub(crate) fn checksum<T: Serialize>(content: &T) -> Result<String, CampaignError> {
    let text = serde_json::to_string(content)
        .map_err(|source| CampaignError::Json { what: "a file of a campaign", source })?;
    Ok(blake3::hash(text.as_bytes()).to_hex().to_string())
}

/// A value as JSON for people, with its checksum.
pub(crate) fn seal<T: Serialize>(content: &T) -> Result<String, CampaignError> {
    let sealed = Sealed { checksum: checksum(content)?, content };
    let mut text = serde_json::to_string_pretty(&sealed)
        .map_err(|source| CampaignError::Json { what: "a file of a campaign", source })?;
    text.push('\n');
    Ok(text)
}

/// The value of a sealed text, and its checksum.
pub(crate) fn unseal<T: Serialize + DeserializeOwned>(
    path: &Path,
    bytes: &[u8],
) -> Result<(T, String), CampaignError> {
    let altered = |problem: String| CampaignError::Altered {
        path: path.display().to_string(),
        problem,
        remedy: "restore the file, or remove it and run again",
    };
    let sealed: Sealed<T> = serde_json::from_slice(bytes).map_err(|e| altered(e.to_string()))?;
    let found = checksum(&sealed.content)?;
    if found != sealed.checksum {
        return Err(altered(format!(
            "its content has the checksum {}, it says {}",
            &found[..16],
            sealed.checksum.get(..16).unwrap_or(&sealed.checksum)
        )));
    }
    Ok((sealed.content, found))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sealed_text_comes_back_and_an_altered_one_does_not() {
        let path = Path::new("numbers.json");
        let numbers: Vec<f64> = vec![0.1, 1.0 / 3.0, 6.02e23, 5e-324];
        let text = seal(&numbers).unwrap();
        let (back, _) = unseal::<Vec<f64>>(path, text.as_bytes()).unwrap();
        assert!(back.iter().zip(&numbers).all(|(a, b)| a.to_bits() == b.to_bits()));
        let altered = text.replace("0.1", "0.2");
        let shown = unseal::<Vec<f64>>(path, altered.as_bytes()).unwrap_err().to_string();
        assert!(shown.contains("numbers.json") && shown.contains("checksum"), "{shown}");
        assert!(unseal::<Vec<f64>>(path, &text.as_bytes()[..20]).is_err());
    }

    #[test]
    fn a_file_is_replaced_whole_and_leftovers_are_swept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write_whole(&path, b"one").unwrap();
        write_whole(&path, b"two").unwrap();
        assert_eq!(read(&path).unwrap().as_deref(), Some(&b"two"[..]));
        std::fs::write(folder.path().join(".a.json.1.0.part"), b"tw").unwrap();
        sweep(folder.path()).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert_eq!(read(&folder.path().join("none")).unwrap(), None);
        let below_a_file = path.join("b.json");
        let shown = write_whole(&below_a_file, b"x").unwrap_err().to_string();
        assert!(shown.contains("a.json"), "{shown}");
    }
}
