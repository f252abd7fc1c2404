//! The schema against the published cases and tables.

mod cases;
mod errors;
