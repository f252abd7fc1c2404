//! Tables: numbers to the right, units under the headings, flagged rows.

use maud::{Markup, html};

use super::rich;

/// Side to which a column is set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// Text.
    #[default]
    Left,
    /// Numbers; figures of equal width, so that equal decimals stand under each other.
    Right,
}

/// A column's head.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// Heading.
    pub heading: String,
    /// Unit, or empty.
    pub unit: String,
    /// Side.
    pub align: Align,
}

impl Column {
    /// A column of text.
    pub fn text(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), unit: String::new(), align: Align::Left }
    }

    /// A column of numbers with a unit (empty for none).
    pub fn number(heading: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { heading: heading.into(), unit: unit.into(), align: Align::Right }
    }
}

/// A row of cells as text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Cells, one a column; missing ones stay empty, surplus ones are not shown.
    pub cells: Vec<String>,
    /// Set apart as out of limits.
    pub flagged: bool,
    /// Set apart as the main result.
    pub strong: bool,
}

impl Row {
    /// A plain row.
    pub fn new(cells: Vec<String>) -> Self {
        Self { cells, ..Self::default() }
    }
}

/// A table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Caption.
    pub caption: String,
    /// Heads.
    pub columns: Vec<Column>,
    /// Rows.
    pub rows: Vec<Row>,
}

impl Table {
    pub(super) fn markup(&self) -> Markup {
        // A column that is empty in every row says nothing.
        let shown: Vec<usize> = (0..self.columns.len())
            .filter(|&c| self.rows.iter().any(|r| r.cells.get(c).is_some_and(|t| !t.is_empty())))
            .collect();
        html! {
            div.scroll tabindex="0" {
                table {
                    @if !self.caption.is_empty() { caption { (rich(&self.caption)) } }
                    @if shown.iter().any(|&c| !self.columns[c].heading.is_empty()) {
                    thead {
                        tr {
                            @for &c in &shown {
                                @let column = &self.columns[c];
                                th scope="col" class=[class(column.align)] {
                                    (rich(&column.heading))
                                    @if !column.unit.is_empty() {
                                        " " span.unit { "[" (rich(&column.unit)) "]" }
                                    }
                                }
                            }
                        }
                    }
                    }
                    tbody {
                        @for row in &self.rows {
                            tr class=[row_class(row)] {
                                @for &c in &shown {
                                    td class=[class(self.columns[c].align)] {
                                        @if let Some(text) = row.cells.get(c) { (rich(text)) }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn class(align: Align) -> Option<&'static str> {
    (align == Align::Right).then_some("number")
}

fn row_class(row: &Row) -> Option<&'static str> {
    match (row.flagged, row.strong) {
        (true, _) => Some("flagged"),
        (false, true) => Some("strong"),
        _ => None,
    }
}
