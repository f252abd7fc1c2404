//! House tasks: `ci`, `tidy`, `reproduce`, `validate`, `dosta`, `instructions`, `peers`, `scratch`.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command line prints")]

mod blind;
mod ci;
mod dosta;
mod instructions;
#[path = "../../crates/tumble/src/pages.rs"]
mod pages;
mod peers;
mod reproduce;
mod scratch;
mod tidy;
mod validate;

use std::process::ExitCode;

use anyhow::Context as _;
use clap::{Parser, Subcommand};

/// House tasks of the workspace.
#[derive(Parser)]
#[command(name = "xtask")]
struct Xtask {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Everything that must pass: format, tidiness, lints, tests, documentation, the main job.
    Ci,
    /// Layering, lengths of files, heads of modules, no path of a machine.
    Tidy,
    /// Everything that the thesis's tables allow: docs/reproduction.md and .json.
    Reproduce {
        /// Print the JSON.
        #[arg(long)]
        json: bool,
        /// Instead: the drums of the beads by our own simulation: docs/src/own-dem.md.
        #[arg(long)]
        dem: bool,
        /// Instead: one of these drums with one thing changed at a time: docs/src/own-dem-variants.md.
        #[arg(long, conflicts_with = "dem")]
        variants: bool,
        /// Instead: the measured beads calibrated by our own runs: docs/src/own-dem-calibration.md.
        #[arg(long, conflicts_with_all = ["dem", "variants"])]
        own: bool,
        /// With --dem: configurations.
        #[arg(requires = "dem", default_values_t = ["AZ1".to_owned(), "AZ2".to_owned()])]
        configurations: Vec<String>,
        /// With --dem: settings between those of Table 8, and walls down to 0.1, as well.
        #[arg(long, requires = "dem")]
        between: bool,
        /// With --dem: Table 8's settings by the laws that EDEM documents as well.
        #[arg(long, requires = "dem")]
        edem_laws: bool,
        /// With --dem: instead, how many beads EDEM's pictures show: docs/src/own-dem-beads.md.
        #[arg(long, requires = "dem", conflicts_with_all = ["between", "edem_laws"])]
        beads: bool,
        /// With --dem: instead, beads whose radii scatter as Table 6 prints: docs/src/own-dem-sizes.md.
        #[arg(long, requires = "dem", conflicts_with_all = ["between", "edem_laws", "beads"])]
        sizes: bool,
        /// With --dem: instead, a drum of 240 mm inside, 250 mm being its outside: docs/src/own-dem-tube.md.
        #[arg(long, requires = "dem", conflicts_with_all = ["between", "edem_laws", "beads", "sizes"])]
        tube: bool,
        /// With --dem and --variants: simulations at a time; with --dem, 0 compares what is kept.
        #[arg(long, default_value_t = 2)]
        jobs: usize,
    },
    /// Every case that dem-core must reproduce: docs/validation.md and its plots.
    Validate {
        /// Print the checks as JSON.
        #[arg(long)]
        json: bool,
    },
    /// A program outside the workspace that depends on dem-core alone: size, build time, a run.
    Scratch,
    /// The soft drum of Dosta et al. 2024 from a start file, in Tumble or LIGGGHTS.
    Dosta(dosta::Options),
    /// Instructions of the contact loop under valgrind, held against frozen counts.
    Instructions,
    /// Tumble beside LAMMPS and LIGGGHTS on the same drum; see docs/performance.md.
    Peers(peers::Peers),
    /// Sealed cases with effects that nobody declares: make them, score closing the loop on them.
    Blind(blind::Blind),
    /// One timed run of Tumble (started by `peers`).
    #[command(hide = true)]
    PeersWorker(peers::Worker),
    /// Memory of one run of Tumble (started by `peers --memory`).
    #[command(hide = true)]
    PeersMemoryWorker(peers::MemoryWorker),
}

/// Root of the workspace.
fn root() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Write a file whole or not at all.
fn write_whole(path: &std::path::Path, text: &str) -> anyhow::Result<()> {
    let named = |path: &std::path::Path| format!("cannot write {}", path.display());
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| named(folder))?;
    }
    let unfinished = path.with_extension("tmp");
    std::fs::write(&unfinished, text).with_context(|| named(&unfinished))?;
    std::fs::rename(&unfinished, path).with_context(|| named(path))
}

fn main() -> ExitCode {
    let done = match Xtask::parse().task {
        Task::Ci => ci::run(),
        Task::Tidy => tidy::run(),
        Task::Reproduce { own: true, .. } => reproduce::own::run(),
        Task::Reproduce { beads: true, configurations, jobs, .. } => {
            reproduce::beads::run(&configurations, jobs)
        }
        Task::Reproduce { sizes: true, configurations, jobs, .. } => {
            reproduce::sizes::run(&configurations, jobs)
        }
        Task::Reproduce { tube: true, configurations, jobs, .. } => {
            reproduce::tube::run(&configurations, jobs)
        }
        Task::Reproduce { dem: true, configurations, between, edem_laws, jobs, .. } => {
            let more = reproduce::dem::More { between, edem_laws };
            reproduce::dem::run(&configurations, more, jobs)
        }
        Task::Reproduce { variants: true, jobs, .. } => reproduce::variants::run(jobs),
        Task::Reproduce { json, .. } => reproduce::run(json),
        Task::Validate { json } => validate::run(json),
        Task::Scratch => scratch::run(),
        Task::Dosta(options) => dosta::run(&options),
        Task::Instructions => instructions::run(),
        Task::Peers(options) => {
            // As the program itself does; peers, which are started from here, have the same.
            pages::ask_for_large_ones();
            peers::run(&options)
        }
        Task::Blind(blind) => blind::run(&blind),
        Task::PeersWorker(work) => peers::run_worker(&work),
        Task::PeersMemoryWorker(work) => peers::run_memory_worker(&work),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
