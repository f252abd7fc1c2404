//! CSV files whose columns are all known, with the line of every error.

use crate::document::nearest;
use crate::table::Cell;
use crate::{Diagnostic, Response, SchemaError};

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

pub(crate) struct Record {
    pub(crate) line: usize,
    fields: Vec<String>,
}

/// A CSV file with a header whose columns are all known.
pub(crate) struct Sheet<'t> {
    file: &'t str,
    text: &'t str,
    header_line: usize,
    columns: Vec<String>,
    pub(crate) records: Vec<Record>,
}

impl<'t> Sheet<'t> {
    pub(crate) fn parse(file: &'t str, text: &'t str, known: &[&str]) -> Result<Self, SchemaError> {
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
            if column.contains([';', '\t']) {
                return Err(self.header_fault(
                    "columns are parted by semicolons or tabs",
                    "commas between columns, points in numbers",
                ));
            }
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

    pub(crate) fn fault(
        &self,
        record: &Record,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> SchemaError {
        self.fault_at(record.line, message, expected)
    }

    pub(crate) fn fault_at(
        &self,
        line: usize,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> SchemaError {
        Diagnostic::at_line(self.file, self.text, line, message, expected).into()
    }

    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c == name)
    }

    pub(crate) fn require(&self, name: &str) -> Result<(), SchemaError> {
        if self.column(name).is_some() {
            return Ok(());
        }
        Err(self.header_fault(format!("column `{name}` is missing"), format!("a column `{name}`")))
    }

    /// A mean and its standard deviation come together; at least one response is there.
    pub(crate) fn check_pairs(&self) -> Result<(), SchemaError> {
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
    pub(crate) fn optional(&self, record: &Record, name: &str) -> Result<Option<f64>, SchemaError> {
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

    pub(crate) fn number(&self, record: &Record, name: &str) -> Result<f64, SchemaError> {
        self.optional(record, name)?
            .ok_or_else(|| self.fault(record, format!("no value in column `{name}`"), "a number"))
    }

    pub(crate) fn positive(&self, record: &Record, name: &str) -> Result<f64, SchemaError> {
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

    pub(crate) fn optional_positive(
        &self,
        record: &Record,
        name: &str,
    ) -> Result<Option<f64>, SchemaError> {
        if self.optional(record, name)?.is_none() {
            return Ok(None);
        }
        self.positive(record, name).map(Some)
    }

    pub(crate) fn cells(&self, record: &Record) -> Result<[Option<Cell>; 4], SchemaError> {
        let mut cells = [None; 4];
        for r in Response::ALL {
            let Some(mean) = self.optional(record, r.column())? else { continue };
            let most = r.most();
            if mean.abs() > most {
                return Err(self.fault(
                    record,
                    format!("{mean} in column `{}` cannot be", r.column()),
                    format!("a number within -{most} to {most}"),
                ));
            }
            let sd = self.optional(record, r.sd_column())?;
            if let Some(sd) = sd.filter(|s| *s > most) {
                return Err(self.fault(
                    record,
                    format!("{sd} in column `{}` cannot be", r.sd_column()),
                    format!("a standard deviation of at most {most}"),
                ));
            }
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
