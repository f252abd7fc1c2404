//! One file a command.

mod budget;
pub(crate) mod calibrate;
pub(crate) mod cases;
pub(crate) mod close_loop;
pub(crate) mod design;
pub(crate) mod export;
pub(crate) mod film;
pub(crate) mod fit;
pub(crate) mod measure;
pub(crate) mod roi;
pub(crate) mod run;
pub(crate) mod simulate;
