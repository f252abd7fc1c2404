//! Calibration against closed forms and the published tables.

mod closed_form;
mod thesis;
