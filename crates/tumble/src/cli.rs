//! Arguments.

mod closing;

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

pub(crate) use closing::CloseLoopArgs;

use clap::{Args, Parser, Subcommand, ValueEnum};
use rig_schema::ErrataLevel;

mod campaigns;

pub(crate) use campaigns::{DesignArgs, ExportArgs, OtherCode, RunArgs};

/// Calibrates simulations of rotating drums against measurements.
#[derive(Debug, Parser)]
#[command(name = "tumble", version, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// List the built-in cases, or write one to files, to start your own from.
    #[command(
        after_help = "Examples:\n  tumble cases\n  tumble cases demo --write my_drum       # the drum of `tumble close-loop`\n  tumble cases AZ4_Steel --write tablets"
    )]
    Cases(CasesArgs),
    /// Fit response surfaces to a table of simulated runs and show their diagnostics.
    #[command(
        after_help = "Examples:\n  tumble fit runs.csv\n  tumble fit AZ1_Plexi --saturating mu_pp=0.2"
    )]
    Fit(FitArgs),
    /// Match measured responses: friction with intervals, residuals, a report.
    #[command(
        after_help = "Examples:\n  tumble calibrate AZ4_Steel\n  tumble calibrate my_case.toml --out results\n  tumble calibrate AZ1_Plexi AZ2_Plexi AZ1_Steel AZ2_Steel   # one bead friction for all"
    )]
    Calibrate(CalibrateArgs),
    /// Find the residual that calibration leaves, name the effect behind it, add it, and report
    /// the error before and after.
    #[command(
        after_help = "Examples:\n  tumble close-loop                                  # a small embedded drum\n  tumble close-loop my_case.toml --budget 20min\n  tumble close-loop AZ1_Plexi                        # a table of given simulated responses"
    )]
    CloseLoop(CloseLoopArgs),
    /// Simulate a drum, film it, and measure the film like photographs.
    #[command(
        after_help = "Example:\n  tumble simulate AZ1_Plexi --speeds 17 --set friction.pp=0.5 --set exposure.seconds=0"
    )]
    Simulate(SimulateArgs),
    /// Print the table of runs of a plan.
    #[command(after_help = "Example:\n  tumble design plan.toml --out runs.csv")]
    Design(DesignArgs),
    /// Carry out every run of a plan; the same call goes on after any interruption.
    #[command(
        after_help = "Examples:\n  tumble run plan.toml --jobs 8\n  tumble run plan.toml --slurm\n  tumble run plan.toml --collect"
    )]
    Run(RunArgs),
    /// Write a deck and a data file with which another code runs the same drum.
    #[command(
        after_help = "Example:\n  tumble export AZ1_Plexi --to liggghts --speeds 17 --set friction.pp=0.5 --out deck\n  (cd deck && liggghts -in drum.lig)\n  tumble export AZ1_Plexi --to liggghts --speeds 17 --out deck --collect"
    )]
    Export(ExportArgs),
    /// Measure angle of repose and centre of area on photographs or simulated frames.
    #[command(
        after_help = "Example:\n  tumble measure photographs/17rpm --speed 17 --out measured"
    )]
    Measure(MeasureArgs),
    /// Write a page on which a person marks the bed of a powdery drum.
    #[command(after_help = "Example:\n  tumble roi photographs/17rpm/001.jpg")]
    Roi(RoiArgs),
    /// Film particle positions of any code through a camera.
    #[command(
        after_help = "Example:\n  tumble film positions.csv --drum-radius 0.125 --drum-length 0.15 --set exposure.seconds=0"
    )]
    Film(FilmArgs),
}

#[derive(Debug, Args)]
pub(crate) struct SimulateArgs {
    /// Rig or case file (TOML), or the name of a built-in case.
    pub(crate) rig: String,
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
    /// Simulate a coarse stand-in: a slice with periodic ends and larger beads.
    #[arg(long)]
    pub(crate) coarse: bool,
    /// Threads; they change no bit of the result.
    #[arg(long, default_value_t = 2)]
    pub(crate) threads: usize,
    /// Width of the frames, pixels.
    #[arg(long, default_value_t = 968, value_parser = width)]
    pub(crate) width: u32,
    /// Also write the positions of every frame.
    #[arg(long)]
    pub(crate) positions: bool,
    /// Also write particles and contacts of every frame as VTK XML, for ParaView, to this folder.
    #[arg(long, value_name = "DIR")]
    pub(crate) vtk: Option<PathBuf>,
    /// Also write an animated GIF of the frames of each speed.
    #[arg(long)]
    pub(crate) gif: bool,
    /// Go on from the checkpoint in the output folder.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Say what the run would take, and do nothing.
    #[arg(long)]
    pub(crate) dry_run: bool,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder for the results [default: tumble-out/RIG].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct MeasureArgs {
    /// Pictures (PNG, JPEG, TIFF, BMP) or folders of them.
    #[arg(required = true, value_name = "FRAMES")]
    pub(crate) frames: Vec<PathBuf>,
    /// Settings of the image chain (TOML); everything has a default.
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Region side-car that `tumble roi` made, for powdery drums.
    #[arg(long, value_name = "FILE")]
    pub(crate) roi: Option<PathBuf>,
    /// Rotation speed of the series, rpm: for the Froude number and the row of responses.csv.
    #[arg(long, value_name = "RPM")]
    pub(crate) speed: Option<f64>,
    /// Inner radius of the drum, m: for the Froude number.
    #[arg(long, value_name = "M", value_parser = length)]
    pub(crate) drum_radius: Option<f64>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder for overlays and results [default: tumble-out/measure].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct RoiArgs {
    /// The picture.
    pub(crate) image: PathBuf,
    /// Folder for the page [default: tumble-out/roi].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct FilmArgs {
    /// Positions (CSV `frame,x,y,z,radius`, metres; drum axis z through the origin, y up).
    pub(crate) positions: PathBuf,
    /// Inner radius of the drum, m.
    #[arg(long, value_name = "M", value_parser = length)]
    pub(crate) drum_radius: f64,
    /// Inner length of the drum, m.
    #[arg(long, value_name = "M", value_parser = length)]
    pub(crate) drum_length: f64,
    /// `PATH=VALUE`: set a parameter of the camera, for instance camera.roll_deg=1.
    #[arg(long = "set", value_name = "PATH=VALUE", value_parser = path_value)]
    pub(crate) settings: Vec<(String, f64)>,
    /// Width of a frame, pixels; the height follows at 3:2.
    #[arg(long, default_value_t = 1936, value_parser = width)]
    pub(crate) width: u32,
    /// Also write an animated GIF.
    #[arg(long)]
    pub(crate) gif: bool,
    /// Folder for the frames [default: tumble-out/film].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct CasesArgs {
    /// Built-in case to write, or `demo`.
    #[arg(requires = "write")]
    pub(crate) case: Option<String>,
    /// Folder to write the case and its tables to, as printed (errata are applied to built-in names alone).
    #[arg(long, value_name = "DIR", requires = "case")]
    pub(crate) write: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct FitArgs {
    /// Table of simulated responses (CSV), or the name of a built-in case.
    pub(crate) table: String,
    /// `FACTOR=M0`: use exp(-FACTOR/M0) instead of the factor's square.
    #[arg(long, value_name = "FACTOR=M0", value_parser = factor_scale)]
    pub(crate) saturating: Option<(String, f64)>,
    /// Drop terms that are not significant, keeping the hierarchy.
    #[arg(long)]
    pub(crate) eliminate: bool,
    /// Errata applied to a built-in table.
    #[arg(long, value_enum, default_value_t = Errata::Certain)]
    pub(crate) errata: Errata,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder for the report [default: tumble-out/NAME].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct CalibrateArgs {
    /// Case files (TOML) or names of built-in cases; several are also fitted together.
    #[arg(required = true, value_name = "CASE")]
    pub(crate) cases: Vec<String>,
    /// Errata applied to the tables of a built-in case.
    #[arg(long, value_enum, default_value_t = Errata::Certain)]
    pub(crate) errata: Errata,
    /// Draws of the parametric bootstrap, a million at most.
    #[arg(long, default_value_t = 1000, value_parser = draws)]
    pub(crate) bootstrap: usize,
    /// Seed of the bootstrap.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
    /// Folder for the results [default: tumble-out/CASE].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

/// Which doubtful cells of the built-in tables are mended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Errata {
    /// As printed.
    None,
    /// Those that follow from the printed numbers themselves.
    Certain,
    /// Also those with several independent signs.
    Likely,
}

impl From<Errata> for ErrataLevel {
    fn from(errata: Errata) -> Self {
        match errata {
            Errata::None => Self::None,
            Errata::Certain => Self::Certain,
            Errata::Likely => Self::Likely,
        }
    }
}

/// A number of some kind between two, ends included.
fn within<T: FromStr + PartialOrd + fmt::Display>(
    text: &str,
    kind: &str,
    (low, high): (T, T),
    unit: &str,
) -> Result<T, String> {
    let value = text.parse().ok().filter(|value| (&low..=&high).contains(&value));
    value.ok_or_else(|| format!("expected {kind} from {low} to {high} {unit}"))
}

/// A length of a drum.
fn length(text: &str) -> Result<f64, String> {
    within(text, "a number", (1e-4, 1e3), "m")
}

/// Draws of a bootstrap.
fn draws(text: &str) -> Result<usize, String> {
    within(text, "a whole number", (0, 1_000_000), "draws")
}

/// Widths of frames that can be read.
fn width(text: &str) -> Result<u32, String> {
    within(text, "a whole number", (32, 16_384), "pixels")
}

fn path_value(text: &str) -> Result<(String, f64), String> {
    let (path, value) =
        text.split_once('=').ok_or("expected PATH=VALUE, for instance camera.roll_deg=1")?;
    let value: f64 = value.parse().map_err(|_| format!("`{value}` is not a number"))?;
    Ok((path.to_owned(), value))
}

fn factor_scale(text: &str) -> Result<(String, f64), String> {
    let (factor, scale) =
        text.split_once('=').ok_or("expected FACTOR=M0, for instance mu_pp=0.2")?;
    let scale: f64 = scale.parse().map_err(|_| format!("`{scale}` is not a number"))?;
    if scale > 0.0 && scale.is_finite() {
        Ok((factor.to_owned(), scale))
    } else {
        Err(format!("{scale} is not above 0"))
    }
}
