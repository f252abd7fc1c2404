//! Instants of a run as a series in time.

use std::path::{Path, PathBuf};

use drum_rig::Experiment;

use super::{Encoding, contacts, particles};
use crate::CampaignError;
use crate::plan::file;

/// One instant of a series.
#[derive(Debug, Clone, PartialEq)]
struct Instant {
    time_s: f64,
    file: String,
}

/// A folder of `.vtu` files, two an instant, with `particles.pvd` and `contacts.pvd`.
///
/// Both `.pvd` files are written anew after each instant, so that what is there can be looked at while a run
/// goes on.
#[derive(Debug)]
pub struct Series {
    folder: PathBuf,
    encoding: Encoding,
    instants: [Vec<Instant>; 2],
}

/// The two kinds of file.
const KINDS: [&str; 2] = ["particles", "contacts"];

impl Series {
    /// A new series in a folder.
    ///
    /// # Errors
    /// [`CampaignError::Io`] for a folder that cannot be made.
    pub fn begin(folder: &Path, encoding: Encoding) -> Result<Self, CampaignError> {
        std::fs::create_dir_all(folder).map_err(file::io("making the folder", folder))?;
        Ok(Self { folder: folder.to_path_buf(), encoding, instants: [Vec::new(), Vec::new()] })
    }

    /// The series that an interrupted run has begun, to go on with.
    ///
    /// # Errors
    /// As [`Series::begin`]; [`CampaignError::Altered`] for a `.pvd` file that this did not write.
    pub fn go_on(folder: &Path, encoding: Encoding) -> Result<Self, CampaignError> {
        let mut series = Self::begin(folder, encoding)?;
        for (kind, instants) in KINDS.iter().zip(&mut series.instants) {
            let path = folder.join(format!("{kind}.pvd"));
            let Some(bytes) = file::read(&path)? else { continue };
            let text = String::from_utf8_lossy(&bytes);
            let found = text.lines().filter(|l| l.starts_with("<DataSet ")).map(|line| {
                let value = |key: &str| line.split_once(key)?.1.split('"').next();
                let time_s = value("timestep=\"")?.parse().ok()?;
                Some(Instant { time_s, file: value("file=\"")?.to_owned() })
            });
            *instants = found.collect::<Option<_>>().ok_or_else(|| CampaignError::Altered {
                path: path.display().to_string(),
                problem: "a line that is no instant".to_owned(),
                remedy: "remove it, and the series starts anew",
            })?;
        }
        Ok(series)
    }

    /// Write the particles and contacts of an experiment as it stands.
    ///
    /// # Errors
    /// [`CampaignError::Io`].
    pub fn write(&mut self, drum: &Experiment) -> Result<(), CampaignError> {
        let step = drum.progress().steps;
        let texts = [particles(drum, self.encoding), contacts(drum, self.encoding)];
        for ((kind, text), instants) in KINDS.iter().zip(&texts).zip(&mut self.instants) {
            let name = format!("{kind}_{step:010}.vtu");
            file::write_whole(&self.folder.join(&name), text.as_bytes())?;
            // A run that goes on from an older checkpoint comes by the same instants again.
            instants.retain(|i| i.file != name);
            instants.push(Instant { time_s: drum.time(), file: name });
            instants.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
            list(&self.folder, kind, instants)?;
        }
        Ok(())
    }

    /// Keep the instants at these times, s, and remove the files of all others: a motion shows only
    /// later from when on it was steady.
    ///
    /// # Errors
    /// [`CampaignError::Io`].
    pub fn keep_only(&mut self, times_s: &[f64]) -> Result<(), CampaignError> {
        for (kind, instants) in KINDS.iter().zip(&mut self.instants) {
            let others = instants.extract_if(.., |i| !times_s.contains(&i.time_s));
            let others: Vec<Instant> = others.collect();
            list(&self.folder, kind, instants)?;
            for other in others {
                let path = self.folder.join(&other.file);
                std::fs::remove_file(&path).map_err(file::io("removing", &path))?;
            }
        }
        Ok(())
    }
}

/// Write the `.pvd` file of one kind.
fn list(folder: &Path, kind: &str, instants: &[Instant]) -> Result<(), CampaignError> {
    file::write_whole(&folder.join(format!("{kind}.pvd")), collection(instants).as_bytes())
}

/// The text of a `.pvd` file.
fn collection(instants: &[Instant]) -> String {
    let mut out = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<Collection>\n",
    );
    for i in instants {
        out.push_str(&format!("<DataSet timestep=\"{}\" file=\"{}\"/>\n", i.time_s, i.file));
    }
    out.push_str("</Collection>\n</VTKFile>\n");
    out
}
