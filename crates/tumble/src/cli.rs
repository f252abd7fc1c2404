//! Arguments.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use rig_schema::ErrataLevel;

/// Calibrates simulations of rotating drums against measurements.
#[derive(Debug, Parser)]
#[command(name = "tumble", version, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// List the built-in cases.
    #[command(after_help = "Example:\n  tumble cases")]
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
}

#[derive(Debug, Args)]
pub(crate) struct CasesArgs {
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
    /// Draws of the parametric bootstrap.
    #[arg(long, default_value_t = 1000)]
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
