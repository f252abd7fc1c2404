//! Tables of measured and simulated responses (CSV).

use crate::document::nearest;
use crate::{Diagnostic, Response, SchemaError};

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

/// The first line from `line` on that is no comment and not empty: the reader counts from before
/// the comments that it skips.
fn past_comments(text: &str, line: usize) -> usize {
    let skipped = text
        .lines()
        .skip(line - 1)
        .take_while(|l| l.starts_with('#') || l.trim().is_empty())
        .count();
    line + skipped
}

struct Record {
    line: usize,
    fields: Vec<String>,
}

/// A CSV file with a header whose columns are all known.
struct Sheet<'t> {
    file: &'t str,
    text: &'t str,
    header_line: usize,
    columns: Vec<String>,
    records: Vec<Record>,
}

impl<'t> Sheet<'t> {
    fn parse(file: &'t str, text: &'t str, known: &[&str]) -> Result<Self, SchemaError> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .flexible(true)
            .has_headers(false)
            .from_reader(text.as_bytes());
        let mut sheet =
            Self { file, text, header_line: 1, columns: Vec::new(), records: Vec::new() };
        for record in reader.records() {
            let record = record.map_err(|e| {
                let line = e.position().map_or(1, |p| p.line() as usize);
                Diagnostic::at_line(
                    file,
                    text,
                    line,
                    e.to_string(),
                    "a line of comma-separated values",
                )
            })?;
            let line = past_comments(text, record.position().map_or(1, |p| p.line() as usize));
            let fields: Vec<String> = record.iter().map(str::to_owned).collect();
            if sheet.columns.is_empty() {
                sheet.header_line = line;
                sheet.columns = fields;
                sheet.check_header(known)?;
                continue;
            }
            if fields.len() != sheet.columns.len() {
                let wanted = sheet.columns.len();
                return Err(Diagnostic::at_line(
                    file,
                    text,
                    line,
                    format!("{} values in a row", fields.len()),
                    format!("{wanted}, one for each column of the header"),
                )
                .into());
            }
            sheet.records.push(Record { line, fields });
        }
        if sheet.records.is_empty() {
            return Err(SchemaError::Empty { file: file.to_owned() });
        }
        Ok(sheet)
    }

    fn check_header(&self, known: &[&str]) -> Result<(), SchemaError> {
        for (i, column) in self.columns.iter().enumerate() {
            if !known.contains(&column.as_str()) {
                return Err(self.header_fault(
                    format!("unknown column `{column}`"),
                    format!("nearest known column: `{}`", nearest(column, known)),
                ));
            }
            if self.columns[..i].contains(column) {
                return Err(self
                    .header_fault(format!("column `{column}` stands twice"), "each column once"));
            }
        }
        Ok(())
    }

    fn header_fault(&self, message: impl Into<String>, expected: impl Into<String>) -> SchemaError {
        Diagnostic::at_line(self.file, self.text, self.header_line, message, expected).into()
    }

    fn fault(
        &self,
        record: &Record,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> SchemaError {
        Diagnostic::at_line(self.file, self.text, record.line, message, expected).into()
    }

    fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c == name)
    }

    fn require(&self, name: &str) -> Result<(), SchemaError> {
        if self.column(name).is_some() {
            return Ok(());
        }
        Err(self.header_fault(format!("column `{name}` is missing"), format!("a column `{name}`")))
    }

    /// A mean and its standard deviation come together; at least one response is there.
    fn check_pairs(&self) -> Result<(), SchemaError> {
        for r in Response::ALL {
            let have = [self.column(r.column()), self.column(r.sd_column())];
            match have {
                [Some(_), None] => self.require(r.sd_column())?,
                [None, Some(_)] => self.require(r.column())?,
                _ => {}
            }
        }
        if Response::ALL.iter().all(|r| self.column(r.column()).is_none()) {
            return Err(self.header_fault(
                "no response in the table",
                "at least one of aor_lin_deg, aor_mid_deg, cen_x_pct, cen_y_pct",
            ));
        }
        Ok(())
    }

    /// A number, or `None` where the column is absent or the cell is empty.
    fn optional(&self, record: &Record, name: &str) -> Result<Option<f64>, SchemaError> {
        let Some(at) = self.column(name) else { return Ok(None) };
        let field = &record.fields[at];
        if field.is_empty() {
            return Ok(None);
        }
        match field.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            Ok(_) => Err(self.fault(
                record,
                format!("`{field}` in column `{name}` is not finite"),
                "a finite number, or nothing where it is not known",
            )),
            Err(_) => Err(self.fault(
                record,
                format!("`{field}` in column `{name}` is not a number"),
                "a number with a decimal point",
            )),
        }
    }

    fn number(&self, record: &Record, name: &str) -> Result<f64, SchemaError> {
        self.optional(record, name)?
            .ok_or_else(|| self.fault(record, format!("no value in column `{name}`"), "a number"))
    }

    fn positive(&self, record: &Record, name: &str) -> Result<f64, SchemaError> {
        let value = self.number(record, name)?;
        if value > 0.0 {
            return Ok(value);
        }
        Err(self.fault(
            record,
            format!("{value} in column `{name}` is not above 0"),
            "a number above 0",
        ))
    }

    fn optional_positive(&self, record: &Record, name: &str) -> Result<Option<f64>, SchemaError> {
        if self.optional(record, name)?.is_none() {
            return Ok(None);
        }
        self.positive(record, name).map(Some)
    }

    fn cells(&self, record: &Record) -> Result<[Option<Cell>; 4], SchemaError> {
        let mut cells = [None; 4];
        for r in Response::ALL {
            let Some(mean) = self.optional(record, r.column())? else { continue };
            let sd = self.optional(record, r.sd_column())?;
            if let Some(sd) = sd.filter(|s| *s < 0.0) {
                return Err(self.fault(
                    record,
                    format!("{sd} in column `{}` is negative", r.sd_column()),
                    "a standard deviation of 0 or more",
                ));
            }
            cells[r.index()] = Some(Cell { mean, sd });
        }
        Ok(cells)
    }
}
