//! Results as pages, tables and JSON.

pub(crate) mod calibration;
pub(crate) mod closing;
pub(crate) mod diagnostics;
pub(crate) mod json;

/// Three decimals, or a dash for an open end.
pub(crate) fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |v| format!("{v:.3}"))
}

/// An interval in brackets; an open end is said to be open.
pub(crate) fn interval(lo: Option<f64>, hi: Option<f64>) -> String {
    match (lo, hi) {
        (Some(lo), Some(hi)) => format!("{lo:.3} to {hi:.3}"),
        (Some(lo), None) => format!("above {lo:.3}"),
        (None, Some(hi)) => format!("below {hi:.3}"),
        (None, None) => "open on both sides".to_owned(),
    }
}
