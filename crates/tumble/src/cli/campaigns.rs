//! Arguments of the commands that make many runs, or hand them to other codes.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{path_value, within};

/// A day, s.
const DAY_S: f64 = 86_400.0;

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// Plan file (TOML): a rig with `[factors]` and `[design]`.
    pub(crate) plan: PathBuf,
    /// Simulations at a time, one thread each; they change no bit of the results.
    #[arg(long, default_value_t = 2)]
    pub(crate) jobs: usize,
    /// Folder of the campaign [default: tumble-out/NAME].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Carry out this run alone, beside other processes that carry out others.
    #[arg(long, value_name = "N", conflicts_with_all = ["collect", "slurm", "parallel", "snakemake"])]
    pub(crate) index: Option<u64>,
    /// Only write responses.csv from what is done so far.
    #[arg(long, conflicts_with_all = ["slurm", "parallel", "snakemake"])]
    pub(crate) collect: bool,
    /// Try runs again that failed for good.
    #[arg(long)]
    pub(crate) retry_failed: bool,
    /// Simulate coarse stand-ins: slices with periodic ends and larger beads.
    #[arg(long)]
    pub(crate) coarse: bool,
    /// Width of the frames, pixels.
    #[arg(long, default_value_t = 968, value_parser = super::width)]
    pub(crate) width: u32,
    /// Seconds between two checkpoints of a run.
    #[arg(long, value_name = "S", default_value_t = 10.0, value_parser = seconds)]
    pub(crate) checkpoint_every: f64,
    /// Say what the runs would take, and do nothing.
    #[arg(long, conflicts_with_all = ["collect", "slurm", "parallel", "snakemake"])]
    pub(crate) dry_run: bool,
    /// Write a job array for Slurm instead of running.
    #[arg(long, conflicts_with_all = ["parallel", "snakemake"])]
    pub(crate) slurm: bool,
    /// Write a line for GNU parallel instead of running.
    #[arg(long, conflicts_with = "snakemake")]
    pub(crate) parallel: bool,
    /// Write a Snakefile instead of running.
    #[arg(long)]
    pub(crate) snakemake: bool,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct DesignArgs {
    /// Plan file (TOML): a rig with `[factors]` and `[design]`.
    pub(crate) plan: PathBuf,
    /// Simulate coarse stand-ins.
    #[arg(long)]
    pub(crate) coarse: bool,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the table to this file instead of printing it.
    #[arg(long, value_name = "CSV")]
    pub(crate) out: Option<PathBuf>,
}

/// Codes that a deck can be written for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum OtherCode {
    /// LIGGGHTS-PUBLIC 3.8.
    Liggghts,
    /// LAMMPS with the package GRANULAR.
    Lammps,
    /// YADE 2023.02.
    Yade,
}

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// Rig or case file (TOML), or the name of a built-in case.
    pub(crate) rig: String,
    /// Code to write for.
    #[arg(long, value_enum)]
    pub(crate) to: OtherCode,
    /// Rotation speeds, rpm, instead of the file's.
    #[arg(long, value_name = "RPM", value_delimiter = ',')]
    pub(crate) speeds: Vec<f64>,
    /// Frames at each speed, instead of the file's.
    #[arg(long)]
    pub(crate) frames: Option<u32>,
    /// Seed, instead of the file's.
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Take the parameters that `tumble close-loop` (closed_loop.json) or `tumble calibrate` (result.json) has found.
    #[arg(long, value_name = "JSON")]
    pub(crate) calibrated: Option<PathBuf>,
    /// `PATH=VALUE`: set a parameter, for instance friction.pp=0.3.
    #[arg(long = "set", value_name = "PATH=VALUE", value_parser = path_value)]
    pub(crate) settings: Vec<(String, f64)>,
    /// Write for a coarse stand-in.
    #[arg(long)]
    pub(crate) coarse: bool,
    /// Turns at each speed before the first frame.
    #[arg(long, default_value_t = 1.0, value_parser = turns)]
    pub(crate) approach_turns: f64,
    /// Seconds from one frame to the next [default: half a turn, 1.5 s at least, over the frames].
    #[arg(long, value_name = "S", value_parser = time)]
    pub(crate) interval: Option<f64>,
    /// Times of the frames, s after the drum took up each speed, instead of an interval.
    #[arg(long, value_name = "S", value_delimiter = ',', value_parser = time, conflicts_with_all = ["interval", "frames"])]
    pub(crate) times: Vec<f64>,
    /// Turn the dumps that the deck has written into tables of positions, and write no deck.
    #[arg(long)]
    pub(crate) collect: bool,
    /// Folder for the deck [default: tumble-out/RIG-CODE].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

fn turns(text: &str) -> Result<f64, String> {
    within(text, "a number", (0.0, 1000.0), "turns")
}

/// A time in a film.
fn time(text: &str) -> Result<f64, String> {
    within(text, "a number", (1e-6, DAY_S), "s")
}

/// A time between checkpoints: beyond a day one is none.
fn seconds(text: &str) -> Result<f64, String> {
    within(text, "a number", (0.0, DAY_S), "s")
}
