//! Doubtful cells of a printed table, applied on request.

use crate::{Diagnostic, MeasuredTable, Response, SchemaError, SimulatedTable, table::Cell};

/// How sure an erratum is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Tag {
    /// Follows from the printed numbers themselves.
    Certain,
    /// Several independent signs.
    Likely,
    /// One sign; never applied.
    Doubtful,
    /// A remark; never applied.
    Note,
}

/// What an erratum does to a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Action {
    /// Replace the cell by the suggested number.
    Replace,
    /// The cell's value is not known.
    Missing,
    /// Leave the row out of fits.
    Exclude,
    /// Nothing.
    Note,
}

/// Which errata are applied.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ErrataLevel {
    /// None: the tables as printed.
    None,
    /// Those that are certain.
    #[default]
    Certain,
    /// Those that are certain or likely.
    Likely,
}

/// One doubtful place.
#[derive(Debug, Clone, PartialEq)]
pub struct Erratum {
    /// File name of the table.
    pub file: String,
    /// Row: `omega=22` or `N17`.
    pub row: String,
    /// Column.
    pub column: String,
    /// Text as printed.
    pub printed: String,
    /// Suggested number, where there is one.
    pub suggested: Option<f64>,
    /// How sure it is.
    pub tag: Tag,
    /// What it does.
    pub action: Action,
    /// Why.
    pub reason: String,
}

/// A list of errata.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Errata {
    /// In the order of the file.
    pub items: Vec<Erratum>,
}

impl Errata {
    /// Read a list: columns `file,row,column,printed,suggested,tag,action,reason`.
    ///
    /// # Errors
    /// [`SchemaError::Invalid`] for a row that is not of this form.
    pub fn parse(file: &str, text: &str) -> Result<Self, SchemaError> {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
        let mut items = Vec::new();
        for record in reader.records() {
            let fault = |line: usize, message: String, expected: &str| -> SchemaError {
                Diagnostic::at_line(file, text, line, message, expected).into()
            };
            let record = record.map_err(|e| {
                fault(e.position().map_or(1, |p| p.line() as usize), e.to_string(), "eight values")
            })?;
            let line = record.position().map_or(1, |p| p.line() as usize);
            let field = |i: usize| record.get(i).unwrap_or_default().to_owned();
            let tag = match field(5).as_str() {
                "certain" => Tag::Certain,
                "likely" => Tag::Likely,
                "doubtful" => Tag::Doubtful,
                "note" => Tag::Note,
                other => {
                    return Err(fault(
                        line,
                        format!("unknown tag `{other}`"),
                        "certain, likely, doubtful or note",
                    ));
                }
            };
            let action = match field(6).as_str() {
                "replace" => Action::Replace,
                "missing" => Action::Missing,
                "exclude" => Action::Exclude,
                "note" => Action::Note,
                other => {
                    return Err(fault(
                        line,
                        format!("unknown action `{other}`"),
                        "replace, missing, exclude or note",
                    ));
                }
            };
            let suggested: Option<f64> = field(4).parse().ok();
            if action == Action::Replace && suggested.is_none() {
                return Err(fault(
                    line,
                    format!("`{}` replaces nothing", field(4)),
                    "a number to replace the cell by",
                ));
            }
            items.push(Erratum {
                file: field(0),
                row: field(1),
                column: field(2),
                printed: field(3),
                suggested,
                tag,
                action,
                reason: field(7),
            });
        }
        Ok(Self { items })
    }

    /// The errata that `level` applies to the table called `file`.
    pub fn applied<'e>(
        &'e self,
        file: &'e str,
        level: ErrataLevel,
    ) -> impl Iterator<Item = &'e Erratum> {
        self.items.iter().filter(move |e| {
            let sure = match level {
                ErrataLevel::None => false,
                ErrataLevel::Certain => e.tag == Tag::Certain,
                ErrataLevel::Likely => e.tag <= Tag::Likely,
            };
            sure && e.file == file && e.action != Action::Note
        })
    }

    /// Apply to a measured table; returns what was applied.
    ///
    /// # Errors
    /// [`SchemaError::Erratum`] for one that does not fit the table.
    pub fn apply_measured(
        &self,
        table: &mut MeasuredTable,
        level: ErrataLevel,
    ) -> Result<Vec<Erratum>, SchemaError> {
        let applied: Vec<Erratum> = self.applied(&table.file, level).cloned().collect();
        for e in &applied {
            let row = e
                .row
                .strip_prefix("omega=")
                .and_then(|s| s.parse::<f64>().ok())
                .and_then(|omega| table.rows.iter().position(|r| r.omega_rpm == omega));
            let Some(row) = row else { return Err(misfit(e, "no such row")) };
            if e.action == Action::Exclude {
                table.rows.remove(row);
            } else {
                correct(e, &mut table.rows[row].cells)?;
            }
        }
        Ok(applied)
    }

    /// Apply to a simulated table; returns what was applied.
    ///
    /// # Errors
    /// [`SchemaError::Erratum`] for one that does not fit the table.
    pub fn apply_simulated(
        &self,
        table: &mut SimulatedTable,
        level: ErrataLevel,
    ) -> Result<Vec<Erratum>, SchemaError> {
        let applied: Vec<Erratum> = self.applied(&table.file, level).cloned().collect();
        for e in &applied {
            let row = e
                .row
                .strip_prefix('N')
                .and_then(|s| s.parse::<u64>().ok())
                .and_then(|run| table.rows.iter().position(|r| r.run == run));
            let Some(row) = row else { return Err(misfit(e, "no such row")) };
            if e.action == Action::Exclude {
                table.rows.remove(row);
            } else {
                correct(e, &mut table.rows[row].cells)?;
            }
        }
        Ok(applied)
    }
}

fn misfit(e: &Erratum, problem: &str) -> SchemaError {
    SchemaError::Erratum {
        file: e.file.clone(),
        row: e.row.clone(),
        column: e.column.clone(),
        problem: problem.to_owned(),
    }
}

fn correct(e: &Erratum, cells: &mut [Option<Cell>; 4]) -> Result<(), SchemaError> {
    for r in Response::ALL {
        let Some(cell) = &mut cells[r.index()] else { continue };
        let printed: Option<f64> = e.printed.parse().ok();
        // A cell that was set right in the file already (a decimal comma) stays as it is.
        if e.column == r.column() {
            if let Some(printed) = printed.filter(|p| *p != cell.mean) {
                return Err(misfit(e, &format!("the table has {}, not {printed}", cell.mean)));
            }
            if let Some(suggested) = e.suggested {
                cell.mean = suggested;
            }
            return Ok(());
        }
        if e.column == r.sd_column() {
            if printed.is_some() && printed != cell.sd {
                return Err(misfit(e, &format!("the table has {:?}, not {}", cell.sd, e.printed)));
            }
            cell.sd = if e.action == Action::Missing { None } else { e.suggested };
            return Ok(());
        }
    }
    Err(misfit(e, "no such column"))
}
