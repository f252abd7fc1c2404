//! Files written whole or not at all.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;

use crate::input::InputError;

/// The folder to write to: as asked for, else `tumble-out/NAME`.
pub(crate) fn folder(asked: Option<&Path>, name: &str) -> anyhow::Result<PathBuf> {
    let folder = asked.map_or_else(|| Path::new("tumble-out").join(name), Path::to_path_buf);
    if folder.exists() && !folder.is_dir() {
        return Err(InputError::NotFolder { path: folder.display().to_string() }.into());
    }
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make the folder {}", folder.display()))?;
    Ok(folder)
}

/// Exit code of a program that was interrupted, as shells give it.
const INTERRUPTED: i32 = 130;

/// At Ctrl-C or a request to end: ask for a stop. `ask` says whether that had been asked for before; then the program ends at once,
/// and what is kept already is what there is.
pub(crate) fn on_interrupt(mut ask: impl FnMut() -> bool + Send + 'static) -> anyhow::Result<()> {
    ctrlc::set_handler(move || {
        if ask() {
            std::process::exit(INTERRUPTED);
        }
    })
    .context("cannot listen for Ctrl-C")
}

/// Whether files can be written there, before anything is computed for them.
pub(crate) fn check_writable(folder: &Path) -> anyhow::Result<()> {
    tempfile::tempfile_in(folder)
        .map(drop)
        .with_context(|| format!("cannot write to {}", folder.display()))
}

/// Remove what an earlier call has written to a folder and this one has not, by its name.
pub(crate) fn remove_stale(folder: &Path, stale: impl Fn(&str) -> bool) -> anyhow::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_name().to_str().is_some_and(&stale) {
            let path = entry.path();
            std::fs::remove_file(&path)
                .with_context(|| format!("cannot remove {}", path.display()))?;
        }
    }
    Ok(())
}

/// Write a file to a temporary name beside it and rename it: a reader sees the old file or the
/// new one, never a part.
pub(crate) fn write(folder: &Path, name: &str, text: &str) -> anyhow::Result<PathBuf> {
    write_bytes(folder, name, text.as_bytes())
}

/// As [`write()`], for bytes.
pub(crate) fn write_bytes(folder: &Path, name: &str, bytes: &[u8]) -> anyhow::Result<PathBuf> {
    let path = folder.join(name);
    let place = || format!("cannot write {}", path.display());
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        // As any new file: readable by whom the umask lets read it.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).with_context(place)?;
    file.write_all(bytes).with_context(place)?;
    file.as_file().sync_all().with_context(place)?;
    file.persist(&path).with_context(place)?;
    Ok(path)
}
