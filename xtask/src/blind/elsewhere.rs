//! Drums that another code runs, by an exported deck.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::Context;
use close_loop::campaign::export::{Code, Schedule, deck, dump_name, positions};
use close_loop::campaign::{Footage, Run};
use close_loop::rig_schema::Rig;

use super::make::{INTERVAL_S, RESOLUTION};
use crate::peers::code::locate;

/// A code that is installed.
#[derive(Debug, Clone)]
pub(crate) struct Other {
    /// Which one.
    pub(crate) code: Code,
    program: PathBuf,
}

impl Other {
    /// Where `code` is, by the environment or among the programs.
    pub(crate) fn locate(code: Code) -> Result<Self, String> {
        let program = match code {
            Code::Liggghts => locate("TUMBLE_LIGGGHTS", "liggghts"),
            Code::Lammps => locate("TUMBLE_LAMMPS", "lmp"),
            Code::Yade => Err("decks for YADE are not run here".into()),
        }?;
        Ok(Self { code, program })
    }
}

/// The same for all fillings of a drum, each in a folder of its own within `folder`.
pub(crate) fn run_all(other: &Other, rigs: &[Rig], folder: &Path) -> anyhow::Result<Vec<Run>> {
    let numbered = rigs.iter().enumerate();
    numbered.map(|(k, rig)| run(other, rig, &folder.join(k.to_string()))).collect()
}

/// Let another code run a rig in `folder` and look at it as at every drum. What is there already is not
/// run again.
pub(crate) fn run(other: &Other, rig: &Rig, folder: &Path) -> anyhow::Result<Run> {
    let done = folder.join("done");
    if !done.exists() {
        std::fs::create_dir_all(folder)?;
        let how =
            Schedule { approach_turns: 1.0, interval_s: Some(INTERVAL_S), ..Schedule::default() };
        for file in deck(rig, other.code, &how)? {
            std::fs::write(folder.join(&file.name), &file.text)?;
        }
        let screen = std::fs::File::create(folder.join("screen.log"))?;
        let status = Command::new(&other.program)
            .current_dir(folder)
            .args(["-in", other.code.script(), "-log", "none"])
            .env("OMP_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .stderr(screen.try_clone()?)
            .stdout(screen)
            .status()
            .with_context(|| format!("cannot start {}", other.program.display()))?;
        anyhow::ensure!(
            status.success(),
            "{} failed ({status}): {}",
            other.code.name(),
            folder.display()
        );
        std::fs::write(&done, "")?;
    }
    let mut footages = Vec::new();
    for &rpm in &rig.run.speeds_rpm {
        let path = folder.join(dump_name(rpm));
        let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        let name = path.display().to_string();
        footages.push(Footage::of_positions(rpm, &name, &positions(&name, &text)?)?);
    }
    Ok(Run::of_footage(rig, RESOLUTION, &footages)?)
}
