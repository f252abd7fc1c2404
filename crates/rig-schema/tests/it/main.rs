//! The schema against the published cases and tables, and the book against the schema.

mod book_files;
mod cases;
mod errors;
mod namespace_page;
