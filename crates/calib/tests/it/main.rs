//! Calibration against closed forms and the published tables.

mod attribution;
mod closed_form;
mod thesis;
