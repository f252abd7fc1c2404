//! Everything that can be wrong with a file of this schema.

use crate::Diagnostic;

/// Error of reading a rig, plan, case or table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SchemaError {
    /// The file does not follow the schema.
    #[error("{0}")]
    Invalid(Box<Diagnostic>),
    /// A table has no rows of data.
    #[error("{file}: no rows of data; expected a header line and at least one row")]
    Empty {
        /// Name of the file.
        file: String,
    },
    /// An erratum speaks of a cell that the table does not have, or that reads otherwise.
    #[error("erratum for {file}, row {row}, column {column}: {problem}")]
    Erratum {
        /// Table that the erratum is for.
        file: String,
        /// Row as the erratum names it.
        row: String,
        /// Column.
        column: String,
        /// What does not fit.
        problem: String,
    },
}

impl From<Diagnostic> for SchemaError {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Invalid(Box::new(diagnostic))
    }
}
