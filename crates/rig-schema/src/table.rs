//! Tables of measured and simulated responses (CSV).

use crate::sheet::Sheet;
use crate::{Response, SchemaError};

/// One response at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Mean over the frames.
    pub mean: f64,
    /// Standard deviation over the frames (not of the mean), `None` where it is not known.
    pub sd: Option<f64>,
}

/// Measured responses at one speed.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredRow {
    /// Line in the file, from 1.
    pub line: usize,
    /// Rotation speed, rpm.
    pub omega_rpm: f64,
    /// The responses in the order of [`Response::ALL`]; `None` where one was not measured.
    pub cells: [Option<Cell>; 4],
    /// Number of frames, where given.
    pub n_frames: Option<f64>,
    /// Independent frames, where given.
    pub n_eff: Option<f64>,
    /// Covariance over the frames between two responses, where given (upper triangle).
    pub covariance: [[Option<f64>; 4]; 4],
}

/// Table of measured responses, one row a speed.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredTable {
    /// Name of the file.
    pub file: String,
    /// Rows in the order of speed.
    pub rows: Vec<MeasuredRow>,
    /// Responses that the table does not have.
    pub absent: Vec<Response>,
}

/// Simulated responses of one run.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedRow {
    /// Line in the file, from 1.
    pub line: usize,
    /// Number of the run.
    pub run: u64,
    /// Rotation speed, rpm.
    pub omega_rpm: f64,
    /// Values of the factors, in the order of [`SimulatedTable::factors`].
    pub factors: Vec<f64>,
    /// The responses in the order of [`Response::ALL`]; `None` where one was not measured.
    pub cells: [Option<Cell>; 4],
    /// Number of frames, where given.
    pub n_frames: Option<f64>,
    /// Independent frames, where given.
    pub n_eff: Option<f64>,
}

/// Table of simulated responses, one row a run.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedTable {
    /// Name of the file.
    pub file: String,
    /// Columns of the factors beside `omega_rpm`.
    pub factors: Vec<String>,
    /// Rows in the order of the file.
    pub rows: Vec<SimulatedRow>,
}

const COVARIANCES: [(&str, usize, usize); 6] = [
    ("cov_lin_mid", 0, 1),
    ("cov_lin_x", 0, 2),
    ("cov_lin_y", 0, 3),
    ("cov_mid_x", 1, 2),
    ("cov_mid_y", 1, 3),
    ("cov_x_y", 2, 3),
];

impl MeasuredTable {
    /// Read a table; `file` is its name for errors.
    ///
    /// # Errors
    /// [`SchemaError`] for a missing or unknown column, text where a number belongs, a number that
    /// is not finite, a negative standard deviation, a speed that stands twice, or no rows.
    pub fn parse(file: &str, text: &str) -> Result<Self, SchemaError> {
        let mut known: Vec<&str> = vec!["omega_rpm", "n_frames", "n_eff"];
        known.extend(Response::ALL.iter().flat_map(|r| [r.column(), r.sd_column()]));
        known.extend(COVARIANCES.iter().map(|c| c.0));
        let sheet = Sheet::parse(file, text, &known)?;
        sheet.require("omega_rpm")?;
        sheet.check_pairs()?;
        let mut rows: Vec<MeasuredRow> = Vec::new();
        for record in &sheet.records {
            let omega_rpm = sheet.positive(record, "omega_rpm")?;
            if let Some(before) = rows.iter().find(|r| r.omega_rpm == omega_rpm) {
                return Err(sheet.fault(
                    record,
                    format!("speed {omega_rpm} rpm stands twice"),
                    format!("one row a speed (the first is line {})", before.line),
                ));
            }
            let mut covariance = [[None; 4]; 4];
            for (name, i, j) in COVARIANCES {
                covariance[i][j] = sheet.optional(record, name)?;
            }
            rows.push(MeasuredRow {
                line: record.line,
                omega_rpm,
                cells: sheet.cells(record)?,
                n_frames: sheet.optional_positive(record, "n_frames")?,
                n_eff: sheet.optional_positive(record, "n_eff")?,
                covariance,
            });
        }
        rows.sort_by(|a, b| a.omega_rpm.total_cmp(&b.omega_rpm));
        let absent =
            Response::ALL.into_iter().filter(|r| sheet.column(r.column()).is_none()).collect();
        Ok(Self { file: file.to_owned(), rows, absent })
    }
}

impl SimulatedTable {
    /// Columns of the header that are neither `run`, `omega_rpm`, a response nor a number of
    /// frames: what a table without a case varies.
    pub fn factor_columns(text: &str) -> Vec<String> {
        let header = text.lines().find(|l| !l.starts_with('#') && !l.trim().is_empty());
        let own = |c: &str| {
            let response = |r: &Response| r.column() == c || r.sd_column() == c;
            ["run", "omega_rpm", "n_frames", "n_eff"].contains(&c)
                || Response::ALL.iter().any(response)
        };
        header
            .unwrap_or_default()
            .split(',')
            .map(str::trim)
            .filter(|c| !own(c))
            .map(str::to_owned)
            .collect()
    }

    /// Read a table whose factor columns are `factors` (beside `run` and `omega_rpm`).
    ///
    /// # Errors
    /// As [`MeasuredTable::parse`]; a run number that stands twice.
    pub fn parse(file: &str, text: &str, factors: &[&str]) -> Result<Self, SchemaError> {
        let mut known: Vec<&str> = vec!["run", "omega_rpm", "n_frames", "n_eff"];
        known.extend(factors);
        known.extend(Response::ALL.iter().flat_map(|r| [r.column(), r.sd_column()]));
        let sheet = Sheet::parse(file, text, &known)?;
        sheet.require("run")?;
        sheet.require("omega_rpm")?;
        for factor in factors {
            sheet.require(factor)?;
        }
        sheet.check_pairs()?;
        let mut rows: Vec<SimulatedRow> = Vec::new();
        for record in &sheet.records {
            let number = sheet.number(record, "run")?;
            if number < 0.0 || number.fract() != 0.0 {
                return Err(sheet.fault(
                    record,
                    format!("run {number} is no number of a run"),
                    "0, 1, 2, ...",
                ));
            }
            let run = number as u64;
            if let Some(before) = rows.iter().find(|r| r.run == run) {
                return Err(sheet.fault(
                    record,
                    format!("run {run} stands twice"),
                    format!("one row a run (the first is line {})", before.line),
                ));
            }
            rows.push(SimulatedRow {
                line: record.line,
                run,
                omega_rpm: sheet.positive(record, "omega_rpm")?,
                factors: factors
                    .iter()
                    .map(|f| sheet.number(record, f))
                    .collect::<Result<_, _>>()?,
                cells: sheet.cells(record)?,
                n_frames: sheet.optional_positive(record, "n_frames")?,
                n_eff: sheet.optional_positive(record, "n_eff")?,
            });
        }
        let factors = factors.iter().map(|f| (*f).to_owned()).collect();
        Ok(Self { file: file.to_owned(), factors, rows })
    }
}
