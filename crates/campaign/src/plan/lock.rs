//! Locks between processes, held by the operating system.
//!
//! A lock is one of the kernel's on an open file: it ends with the process that holds it, however that
//! ends, so none goes stale. On a shared folder it reaches as far as the file system carries locks
//! (NFS 4 does). The file itself stays and names its last holder.

use std::fs::{File, TryLockError};
use std::io::{Read, Seek, Write};
use std::path::Path;

use super::file::io;
use crate::CampaignError;

/// A lock that is held until it is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    file: File,
}

/// Whether others may hold the same lock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Share {
    /// Nobody else.
    Alone,
    /// Others that share it as well.
    Shared,
}

impl Lock {
    /// Take the lock of a file; `what` names what it guards.
    pub(crate) fn take(path: &Path, share: Share, what: &str) -> Result<Self, CampaignError> {
        let mut file = File::options()
            .create(true)
            .read(true)
            .write(true)
            .truncate(false)
            .open(path)
            .map_err(io("opening", path))?;
        let taken = match share {
            Share::Alone => file.try_lock(),
            Share::Shared => file.try_lock_shared(),
        };
        match taken {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut holder = String::new();
                // A holder that cannot be named is still one.
                let _ = file.read_to_string(&mut holder);
                let holder = match holder.trim() {
                    "" => "another process".to_owned(),
                    known => known.to_owned(),
                };
                return Err(CampaignError::Locked { what: what.to_owned(), holder });
            }
            Err(TryLockError::Error(e)) => return Err(io("locking", path)(e)),
        }
        let named = file
            .set_len(0)
            .and_then(|()| file.rewind())
            .and_then(|()| file.write_all(holder(share).as_bytes()));
        named.map_err(io("writing", path))?;
        Ok(Self { file })
    }
}

impl Drop for Lock {
    /// Unlocked by word, not by closing: a child that is just being started has the file open too.
    fn drop(&mut self) {
        // Closing it unlocks it as well.
        let _ = self.file.unlock();
    }
}

/// This process, for others to read.
fn holder(share: Share) -> String {
    let host = std::fs::read_to_string("/proc/sys/kernel/hostname")
        .ok()
        .or_else(|| std::env::var("HOSTNAME").ok())
        .or_else(|| std::env::var("COMPUTERNAME").ok())
        .unwrap_or_default();
    let host = match host.trim() {
        "" => "this host",
        name => name,
    };
    let alone = if share == Share::Shared { " (single runs, maybe with others)" } else { "" };
    format!("process {} on {host}{alone}", std::process::id())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_keeps_others_out_until_it_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.lock");
        let first = Lock::take(&path, Share::Alone, "the campaign").unwrap();
        let refused = Lock::take(&path, Share::Alone, "the campaign").unwrap_err();
        let shown = refused.to_string();
        assert!(matches!(refused, CampaignError::Locked { .. }));
        assert!(shown.contains(&format!("process {}", std::process::id())), "{shown}");
        assert!(Lock::take(&path, Share::Shared, "the campaign").is_err());
        drop(first);
        let shared = Lock::take(&path, Share::Shared, "the campaign").unwrap();
        let also = Lock::take(&path, Share::Shared, "the campaign").unwrap();
        assert!(Lock::take(&path, Share::Alone, "the campaign").is_err());
        drop((shared, also));
        Lock::take(&path, Share::Alone, "the campaign").unwrap();
    }
}
