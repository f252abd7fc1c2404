//! Tumble beside LAMMPS and LIGGGHTS: one scene, one file of positions, runs in turn.
//!
//! Each code is a process of its own. It reads the beads of a settled, turning drum (made by
//! Tumble, kept under `target/peers`), runs some steps to rebuild the history of its contacts,
//! then the timed steps. Wall time is that of the loop as the code itself reports it; processor
//! time is `loop time x (processor time / wall time of the process)`, which a machine that others
//! use distorts less.

pub(crate) mod code;
mod exchange;
mod log;
mod memory;
mod physics;
mod report;
mod scaling;
mod scene;
mod side_by_side;
mod spread;
mod tablets;
mod tuning;
mod worker;

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use dem_core::prelude::Kernels;
use scene::{Bead, Scene};

pub(crate) use memory::{MemoryWorker, run as run_memory_worker};
pub(crate) use worker::{Worker, run as run_worker};

/// Seed of the noise on the lattice.
const SEED: u64 = 1;

/// How Tumble computes.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Mode {
    /// Every operation rounded by itself: `Kernels::Fastest`.
    Exact,
    /// Products rounded with what they are added to: `Kernels::Fused`.
    Fused,
    /// The same with fast roots: `Kernels::FastRoots`.
    Roots,
}

impl Mode {
    fn kernels(self) -> Kernels {
        match self {
            Self::Exact => Kernels::Fastest,
            Self::Fused => Kernels::Fused,
            Self::Roots => Kernels::FastRoots,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Fused => "fused",
            Self::Roots => "roots",
        }
    }
}

/// Options of `cargo xtask peers`.
#[derive(Args)]
pub(crate) struct Peers {
    /// Print JSON instead of tables.
    #[arg(long)]
    json: bool,
    /// Rounds in which every code runs once.
    #[arg(long, default_value_t = 5)]
    repeats: usize,
    /// Timed steps of a run.
    #[arg(long, default_value_t = 4000)]
    steps: u64,
    /// Steps before, in which contacts get their history back.
    #[arg(long, default_value_t = 1000)]
    warm: u64,
    /// Steps in which the beads fall from the lattice and the drum turns, before all.
    #[arg(long, default_value_t = 14_000)]
    settle: u64,
    /// Beads; the drum grows along.
    #[arg(long, default_value_t = scene::AZ1_BEADS)]
    particles: usize,
    /// Timed steps of each run that tries a skin.
    #[arg(long, default_value_t = 2000)]
    tune_steps: u64,
    /// How Tumble computes; exact kernels run beside in any case.
    #[arg(long, value_enum, default_value_t = Mode::Roots)]
    kernels: Mode,
    /// Instead: Tumble's time against the number of beads.
    #[arg(long)]
    scaling: bool,
    /// With --scaling: numbers of beads.
    #[arg(long, value_delimiter = ',', default_values_t = [1000, 10_000, 100_000, 300_000])]
    sizes: Vec<usize>,
    /// With --scaling: the drum grows along its axis only, so that a bead has as many contacts in all of them.
    #[arg(long, requires = "scaling")]
    along: bool,
    /// Instead: Tumble's memory for a million beads.
    #[arg(long, conflicts_with = "scaling")]
    memory: bool,
    /// Instead: 5997 tablets of ten spheres, beside LIGGGHTS multisphere.
    #[arg(long, conflicts_with_all = ["scaling", "memory"])]
    tablets: bool,
}

/// Run what is asked for.
pub(crate) fn run(options: &Peers) -> anyhow::Result<()> {
    anyhow::ensure!(options.repeats > 0, "--repeats must be at least 1");
    anyhow::ensure!(options.steps >= 10, "--steps must be at least 10");
    anyhow::ensure!(options.particles >= 100, "--particles must be at least 100");
    if options.scaling {
        return scaling::run(options);
    }
    if options.memory {
        return memory::measure(options);
    }
    if options.tablets {
        return tablets::run(options);
    }
    side_by_side::run(options)
}

/// This program, to be started again as a worker.
///
/// A run lasts minutes, in which a build may put another program in the place of this one: then
/// `current_exe` names a file that is no more. The kernel's link leads to the very program that
/// runs, in the child as well, for as long as it runs.
fn own_program() -> anyhow::Result<PathBuf> {
    let link = PathBuf::from("/proc/self/exe");
    if link.exists() {
        return Ok(link);
    }
    std::env::current_exe().context("the system does not say where this program is")
}

/// Folder for scenes and for what runs leave.
fn folder() -> anyhow::Result<PathBuf> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../target")),
        PathBuf::from,
    );
    let folder = target.join("peers");
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make {}", folder.display()))?;
    folder.canonicalize().with_context(|| format!("no folder {}", folder.display()))
}

/// The settled scene: from `target/peers` when it is there, else made.
fn settled(scene: &Scene, steps: u64) -> anyhow::Result<(PathBuf, Vec<Bead>)> {
    // A drum that grew along its axis has the radius of AZ1's.
    let long = if *scene == Scene::along(scene.beads) { "long_" } else { "" };
    let path = folder()?.join(format!("scene_{long}{}_{SEED}_{steps}.data", scene.beads));
    if path.is_file() {
        let beads = exchange::read_data(&path)?;
        if beads.len() == scene.beads {
            return Ok((path, beads));
        }
    }
    eprintln!("{} beads settle and turn for {steps} steps", scene.beads);
    let beads = scene.settled(SEED, steps)?;
    exchange::write_data(&path, scene, &beads)?;
    Ok((path, beads))
}

/// Load of the machine over the last minute, where the system tells it.
fn load() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}

/// Processor and number of cores.
fn machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = text
        .lines()
        .find(|l| l.starts_with("model name"))
        .and_then(|l| l.split_once(':'))
        .map_or(std::env::consts::ARCH, |(_, name)| name.trim());
    let cores = std::thread::available_parallelism().map_or(0, |n| n.get());
    format!("{model}, {cores} cores")
}
