//! Arguments of `tumble close-loop`.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct CloseLoopArgs {
    /// Case file (TOML) or name of a built-in case; without one a small embedded drum whose
    /// effect nobody declares.
    pub(crate) case: Option<String>,
    /// Most time that may be spent simulating, for instance 20min; pilot runs tell how many
    /// runs fit.
    #[arg(long, value_name = "TIME", value_parser = duration, conflicts_with = "runs")]
    pub(crate) budget: Option<Duration>,
    /// Most runs that may be simulated.
    #[arg(long, value_name = "N")]
    pub(crate) runs: Option<usize>,
    /// Simulations at a time, one thread each; they change no figure.
    #[arg(long, default_value_t = 2, value_parser = at_least::<1>)]
    pub(crate) jobs: usize,
    /// Most speeds that are simulated; others are interpolated.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = at_least::<2>)]
    pub(crate) speeds: usize,
    /// Speeds to predict by the confirmed models, rpm, for instance 20,60.
    #[arg(long, value_name = "RPM", value_delimiter = ',')]
    pub(crate) predict: Vec<f64>,
    /// Width of the frames, pixels.
    #[arg(long, default_value_t = 484, value_parser = super::width)]
    pub(crate) width: u32,
    /// Seed of designs, fillings and draws.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Draws of the bootstrap.
    #[arg(long, default_value_t = 499, value_parser = at_least::<99>)]
    pub(crate) bootstrap: usize,
    /// Folder in which runs are kept; cases may share one [default: OUT/cache].
    #[arg(long, value_name = "DIR")]
    pub(crate) cache: Option<PathBuf>,
    /// Folder for the results [default: tumble-out/CASE].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// A number that is not below `LEAST`.
fn at_least<const LEAST: usize>(text: &str) -> Result<usize, String> {
    let value: usize = text.parse().map_err(|_| format!("`{text}` is not a whole number"))?;
    if value >= LEAST { Ok(value) } else { Err(format!("{value} is below {LEAST}")) }
}

/// Seconds, or a number with s, min or h.
fn duration(text: &str) -> Result<Duration, String> {
    let text = text.trim();
    let split = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let factor = match unit {
        "" | "s" => 1.0,
        "min" | "m" => 60.0,
        "h" => 3600.0,
        _ => return Err(format!("`{unit}` is no unit of time: expected s, min or h")),
    };
    let value: f64 = number.trim().parse().map_err(|_| format!("`{number}` is not a number"))?;
    if value > 0.0 && value.is_finite() {
        Ok(Duration::from_secs_f64(value * factor))
    } else {
        Err(format!("{value} is not above 0"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        assert_eq!(duration("20min"), Ok(Duration::from_secs(1200)));
        assert_eq!(duration("90"), Ok(Duration::from_secs(90)));
        assert_eq!(duration("1.5 h"), Ok(Duration::from_secs(5400)));
        assert!(duration("20 apples").is_err() && duration("-3s").is_err());
    }
}
