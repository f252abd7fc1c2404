//! `cargo xtask blind`: sealed cases, and how many of them closing the loop gets right.
//!
//! `make` simulates drums with an effect that the case file does not tell, by other fillings, a
//! finer step and a finer picture than any fit uses, and seals what it did. `score` closes the loop
//! on every case, writes its answer, and only then opens the truth. `nulls` counts false alarms on
//! many simulated drums that lack nothing.

mod codes;
mod drums;
mod elsewhere;
mod make;
mod matrix;
mod nulls;
mod score;
mod sealed;
mod thesis;

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// What to do with sealed cases.
#[derive(Args)]
pub(crate) struct Blind {
    #[command(subcommand)]
    task: Task,
    /// Folder of the cases.
    #[arg(long, global = true, default_value = "target/blind")]
    folder: PathBuf,
    /// Simulations at a time.
    #[arg(long, global = true, default_value_t = 2)]
    jobs: usize,
}

#[derive(Subcommand)]
enum Task {
    /// Simulate and seal.
    Make {
        /// Seed of everything.
        #[arg(long, default_value_t = 2026)]
        seed: u64,
        /// Only so many drums by Tumble, and half as many by LIGGGHTS.
        #[arg(long)]
        most: Option<usize>,
        /// Only cases whose name contains this, so that a study can be made in parts.
        #[arg(long)]
        only: Option<String>,
        #[command(flatten)]
        care: make::Care,
    },
    /// Close the loop on every case, then open the truth.
    Score {
        /// Most runs for each case.
        #[arg(long, default_value_t = 75)]
        runs: usize,
        /// Only cases whose name contains this.
        #[arg(long)]
        only: Option<String>,
        /// Print JSON.
        #[arg(long)]
        json: bool,
    },
    /// The thesis's twelve configurations with the tables of EDEM: docs/src/closing-the-thesis.md.
    Thesis,
    /// What the code itself changes: the same drums by Tumble, by Tumble at half the step, and by LIGGGHTS and LAMMPS.
    Codes {
        /// Fillings of each of three frictions.
        #[arg(long, default_value_t = 2)]
        fillings: u64,
    },
    /// False alarms on simulated drums that lack nothing.
    Nulls {
        /// Drums.
        #[arg(long, default_value_t = 200)]
        count: usize,
        /// Number of the first of them, so that a study can be made in parts: a drum is what its number says.
        #[arg(long, default_value_t = 0)]
        first: usize,
        /// Most runs for each.
        #[arg(long, default_value_t = 75)]
        runs: usize,
        /// LIGGGHTS runs the drums.
        #[arg(long)]
        liggghts: bool,
        #[command(flatten)]
        care: make::Care,
    },
}

/// Carry out a task.
pub(crate) fn run(blind: &Blind) -> anyhow::Result<()> {
    let folder = if blind.folder.is_absolute() {
        blind.folder.clone()
    } else {
        crate::root().join(&blind.folder)
    };
    match &blind.task {
        Task::Thesis => thesis::run(),
        Task::Codes { fillings } => codes::run(&folder, *fillings, blind.jobs),
        Task::Make { seed, most, only, care } => {
            make::run(&folder, *seed, *most, only.as_deref(), *care, blind.jobs)
        }
        Task::Score { runs, only, json } => {
            score::run(&folder, *runs, blind.jobs, only.as_deref(), *json)
        }
        Task::Nulls { count, first, runs, liggghts, care } => {
            let numbers = *first..first + count;
            nulls::run(&folder, numbers, *runs, *liggghts, *care, blind.jobs)
        }
    }
}
