//! The binary as a user meets it.

mod bad_input;
mod calibrate;
mod campaigns;
mod pages;
mod pictures;
mod run;
