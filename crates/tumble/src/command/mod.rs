//! One file a command.

pub(crate) mod calibrate;
pub(crate) mod cases;
pub(crate) mod fit;
