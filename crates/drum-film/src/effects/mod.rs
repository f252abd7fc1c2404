//! What stands between a clean picture and a photograph: one effect a file, each off by default.

pub mod exposure;

pub use exposure::Exposure;
