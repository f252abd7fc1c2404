//! From points to the columns of a design matrix, with every number tested.

use crate::double_double::Double;
use crate::error::DoeError;
use crate::model::Model;
use crate::weighting::check_length;

/// Sizes of a column's or the response's largest value between which squares keep their digits.
const MAGNITUDES: (f64, f64) = (1.0e-140, 1.0e140);

/// Tests what can be tested before a model meets its data.
pub(crate) fn check_data(model: &Model, points: &[Vec<f64>], y: &[f64]) -> Result<(), DoeError> {
    if y.is_empty() {
        return Err(DoeError::Empty { what: "runs" });
    }
    check_length("points of the runs", y.len(), points.len())?;
    for (run, point) in points.iter().enumerate() {
        model.check_point(point).map_err(|error| match error {
            DoeError::Length { what, expected, got } => {
                DoeError::Length { what: format!("{what} (run {run})"), expected, got }
            }
            DoeError::NotFinite { what, value } => {
                DoeError::NotFinite { what: format!("{what} of run {run}"), value }
            }
            other => other,
        })?;
    }
    if let Some(run) = y.iter().position(|v| !v.is_finite()) {
        return Err(DoeError::NotFinite { what: format!("response of run {run}"), value: y[run] });
    }
    if y.len() <= model.terms().len() {
        return Err(DoeError::TooFewRuns { runs: y.len(), terms: model.terms().len() });
    }
    Ok(())
}

/// Columns of the design matrix, in twice the precision.
pub(crate) fn design_columns(
    model: &Model,
    points: &[Vec<f64>],
) -> Result<Vec<Vec<Double>>, DoeError> {
    let mut columns = vec![Vec::with_capacity(points.len()); model.terms().len()];
    for (run, point) in points.iter().enumerate() {
        for (value, term) in model.row(point).into_iter().zip(model.terms()) {
            if !value.is_finite() {
                let what = format!("term `{term}` of run {run}");
                return Err(DoeError::NotFinite { what, value });
            }
        }
        for (column, value) in columns.iter_mut().zip(model.precise_row(point)) {
            column.push(value);
        }
    }
    Ok(columns)
}

/// Refuses values whose squares would overflow, or vanish, in sums.
pub(crate) fn check_magnitude(what: impl Fn() -> String, values: &[f64]) -> Result<(), DoeError> {
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    // NaN comes from products that overflowed in twice the precision.
    let fits = largest == 0.0 || (MAGNITUDES.0..=MAGNITUDES.1).contains(&largest);
    if fits && !values.iter().any(|v| v.is_nan()) {
        return Ok(());
    }
    Err(DoeError::Magnitude { what: what(), value: largest })
}

/// The columns rounded to working precision.
pub(crate) fn leading(columns: &[Vec<Double>]) -> Vec<Vec<f64>> {
    columns.iter().map(|column| column.iter().map(|v| v.hi).collect()).collect()
}
