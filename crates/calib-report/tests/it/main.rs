//! Claims about the pictures and pages, held against the parsed documents.

mod awkward;
mod document;
mod legible;
mod map;
mod page;
mod snapshot;
