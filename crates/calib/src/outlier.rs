//! Cells of a table that do not fit their neighbours.
//!
//! Measured: each response is a smooth curve over speed. A cell is compared with what its four
//! neighbours say (a cubic through them), relative to the typical such difference of the series;
//! the worst is flagged, removed, and the rest compared again.
//!
//! Simulated: studentised deleted residual of the response surface beyond 4.

use rig_schema::{MeasuredTable, Response, SimulatedTable};

use crate::{CalibError, Surrogate};

/// Limit on a studentised deleted residual (the usual guide for response surfaces).
const DELETED_LIMIT: f64 = 4.0;

/// Limit on a cell's distance from its neighbours, in typical distances.
const NEIGHBOUR_LIMIT: f64 = 6.0;

/// Fewest speeds for which neighbours say anything.
const FEWEST_SPEEDS: usize = 7;

/// Another cell with exactly the same printed value: a sign of copying.
#[derive(Debug, Clone, PartialEq)]
pub struct Coincidence {
    /// Where the same value stands.
    pub place: String,
    /// The value.
    pub value: f64,
}

/// A measured mean that its neighbours do not bear out.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredOutlier {
    /// Speed, rpm.
    pub omega_rpm: f64,
    /// Response.
    pub response: Response,
    /// As in the table.
    pub value: f64,
    /// What the neighbours say.
    pub expected: f64,
    /// Distance in typical distances of the series.
    pub z: f64,
    /// Cells with the same value.
    pub coincidences: Vec<Coincidence>,
}

/// A simulated mean off its response surface.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedOutlier {
    /// Run.
    pub run: u64,
    /// Response.
    pub response: Response,
    /// As in the table.
    pub value: f64,
    /// What the surface through the other runs says.
    pub expected: f64,
    /// Studentised deleted residual.
    pub t: f64,
    /// Cells with the same value.
    pub coincidences: Vec<Coincidence>,
}

/// Outliers of a measured table.
pub fn measured_outliers(table: &MeasuredTable) -> Vec<MeasuredOutlier> {
    let mut found = Vec::new();
    for r in Response::ALL {
        let mut series: Vec<(f64, f64, f64)> = table
            .rows
            .iter()
            .filter_map(|row| {
                let cell = row.cells[r.index()]?;
                Some((row.omega_rpm, cell.mean, cell.sd.unwrap_or(0.0)))
            })
            .collect();
        while series.len() >= FEWEST_SPEEDS {
            let expected: Vec<f64> =
                (0..series.len()).map(|i| from_neighbours(&series, i)).collect();
            let distance: Vec<f64> =
                series.iter().zip(&expected).map(|(s, e)| (s.1 - e).abs()).collect();
            let typical = 1.4826 * median(&distance);
            let Some(worst) =
                (0..series.len()).max_by(|a, b| distance[*a].total_cmp(&distance[*b]))
            else {
                break;
            };
            let (omega_rpm, value, sd) = series[worst];
            // At the ends the neighbours lie on one side only: the extrapolation is worth less.
            let edge = if worst < 2 || worst + 2 >= series.len() { 3.0 } else { 1.0 };
            let floor = typical.max(0.5 * sd).max(0.01);
            let z = distance[worst] / (floor * edge);
            if z < NEIGHBOUR_LIMIT {
                break;
            }
            found.push(MeasuredOutlier {
                omega_rpm,
                response: r,
                value,
                expected: expected[worst],
                z,
                coincidences: measured_coincidences(table, omega_rpm, r, value),
            });
            series.remove(worst);
        }
    }
    found
}

/// Value at point `i` of the polynomial through its (up to) four nearest others.
fn from_neighbours(series: &[(f64, f64, f64)], i: usize) -> f64 {
    let first = i.saturating_sub(2).min(series.len() - 5);
    let near: Vec<usize> = (first..first + 5).filter(|k| *k != i).collect();
    let at = series[i].0;
    near.iter()
        .map(|a| {
            let weight: f64 = near
                .iter()
                .filter(|b| *b != a)
                .map(|b| (at - series[*b].0) / (series[*a].0 - series[*b].0))
                .product();
            weight * series[*a].1
        })
        .sum()
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

fn measured_coincidences(
    table: &MeasuredTable,
    omega_rpm: f64,
    response: Response,
    value: f64,
) -> Vec<Coincidence> {
    let mut found = Vec::new();
    let place = table.rows.iter().position(|row| row.omega_rpm == omega_rpm).unwrap_or(0);
    for (k, row) in table.rows.iter().enumerate().filter(|(k, _)| k.abs_diff(place) <= 1) {
        for r in Response::ALL {
            let same = row.cells[r.index()].is_some_and(|c| c.mean == value);
            if same && (k, r) != (place, response) {
                found.push(Coincidence { place: format!("{r} at {} rpm", row.omega_rpm), value });
            }
        }
    }
    found
}

/// Outliers of a simulated table against the surfaces fitted to it.
///
/// # Errors
/// [`CalibError`] if no surface can be fitted.
pub fn simulated_outliers(
    table: &SimulatedTable,
    surrogate: &Surrogate,
) -> Result<Vec<SimulatedOutlier>, CalibError> {
    let complete: Vec<usize> = (0..table.rows.len())
        .filter(|i| table.rows[*i].cells.iter().all(Option::is_some))
        .collect();
    let mut found = Vec::new();
    for r in Response::ALL {
        let fit = surrogate.fit(r);
        for (k, t) in fit.studentised_deleted_residuals().iter().enumerate() {
            let Some(t) = t.filter(|t| t.abs() > DELETED_LIMIT) else { continue };
            let row = &table.rows[complete[k]];
            let value = fit.response()[k];
            let left = fit.deleted_residuals()[k].unwrap_or(0.0);
            let mut coincidences = Vec::new();
            for other in table.rows.iter().filter(|o| o.run.abs_diff(row.run) <= 1) {
                for s in Response::ALL {
                    let same = other.cells[s.index()].is_some_and(|c| c.mean == value);
                    if same && (other.run, s) != (row.run, r) {
                        coincidences.push(Coincidence {
                            place: format!("{s} of run {}", other.run),
                            value,
                        });
                    }
                }
            }
            found.push(SimulatedOutlier {
                run: row.run,
                response: r,
                value,
                expected: value - left,
                t,
                coincidences,
            });
        }
    }
    found.sort_by(|a, b| b.t.abs().total_cmp(&a.t.abs()));
    Ok(found)
}
