//! From a drum's circle to the bed's free surface.

pub mod boundary;
pub mod columns;
pub mod edge;
pub mod prepare;
pub(crate) mod reflex;
pub mod region;
pub mod split;
