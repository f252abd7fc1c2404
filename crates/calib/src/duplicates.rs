//! Tables and rows that were measured once and printed twice.
//!
//! Two simulated tables of the same design have independent packings, so equal runs differ by the
//! scatter of a run. If, after a constant shift is removed, they differ by far less, one is a copy
//! of the other (perhaps measured again on the same pictures). A single row is a copy if at least
//! two means and all standard deviations but those of a shifted response are equal to the digit.

use rig_schema::{Response, SimulatedTable};

use crate::Surrogate;

/// Two tables that agree better than independent runs can.
#[derive(Debug, Clone, PartialEq)]
pub struct DuplicateTable {
    /// First table.
    pub first: String,
    /// Second table.
    pub second: String,
    /// Median absolute difference over all responses, constant shift removed, in units of what
    /// independent runs would show.
    pub ratio: f64,
    /// Constant shift of each response, second minus first.
    pub shift: [f64; 4],
    /// Rows in which both angles agree within 0.06 deg, of the rows compared.
    pub equal_rows: (usize, usize),
}

/// Two rows of different tables that are equal to the digit.
#[derive(Debug, Clone, PartialEq)]
pub struct DuplicateRow {
    /// First table.
    pub first: String,
    /// Second table.
    pub second: String,
    /// Run, the same in both.
    pub run: u64,
    /// Printed numbers that are equal (of eight).
    pub equal: usize,
}

/// Ratio below which two tables are called copies: independent scatter gives about 1.
const COPY_RATIO: f64 = 0.3;

/// Equal printed numbers, of eight, above which a row is called a copy.
const COPY_CELLS: usize = 6;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::INFINITY)
}

/// Pairs of tables of which one is a copy; each comes with the surfaces fitted to it.
pub fn duplicate_tables(tables: &[(&SimulatedTable, &Surrogate)]) -> Vec<DuplicateTable> {
    let mut found = Vec::new();
    for (k, (a, fit_a)) in tables.iter().enumerate() {
        for (b, fit_b) in &tables[k + 1..] {
            let pairs: Vec<_> = a
                .rows
                .iter()
                .filter_map(|x| {
                    let y = b.rows.iter().find(|y| y.run == x.run)?;
                    (x.omega_rpm == y.omega_rpm && x.factors == y.factors).then_some((x, y))
                })
                .collect();
            if pairs.len() < 8 {
                continue;
            }
            let mut shift = [0.0; 4];
            let mut ratios = Vec::new();
            for r in Response::ALL {
                let d: Vec<f64> = pairs
                    .iter()
                    .filter_map(|(x, y)| Some(y.cells[r.index()]?.mean - x.cells[r.index()]?.mean))
                    .collect();
                shift[r.index()] = median(d.clone());
                let spread =
                    1.4826 * median(d.iter().map(|v| (v - shift[r.index()]).abs()).collect());
                let independent = fit_a.fit(r).rmse().hypot(fit_b.fit(r).rmse());
                ratios.push(spread / independent);
            }
            let ratio = ratios.iter().copied().fold(0.0, f64::max);
            let close =
                |r: Response, (x, y): &(&rig_schema::SimulatedRow, &rig_schema::SimulatedRow)| {
                    match (x.cells[r.index()], y.cells[r.index()]) {
                        (Some(p), Some(q)) => (p.mean - q.mean).abs() <= 0.06 + 1e-9,
                        _ => false,
                    }
                };
            if ratio < COPY_RATIO {
                let equal = pairs
                    .iter()
                    .filter(|p| close(Response::AorLin, p) && close(Response::AorMid, p))
                    .count();
                found.push(DuplicateTable {
                    first: a.file.clone(),
                    second: b.file.clone(),
                    ratio,
                    shift,
                    equal_rows: (equal, pairs.len()),
                });
            }
        }
    }
    found
}

/// Rows of different tables that are equal in at least six of their eight printed numbers.
pub fn duplicate_rows(tables: &[&SimulatedTable]) -> Vec<DuplicateRow> {
    let mut found = Vec::new();
    for (k, a) in tables.iter().enumerate() {
        for b in &tables[k + 1..] {
            for x in &a.rows {
                let Some(y) = b.rows.iter().find(|y| y.run == x.run) else { continue };
                let equal: usize = Response::ALL
                    .iter()
                    .filter_map(|r| Some((x.cells[r.index()]?, y.cells[r.index()]?)))
                    .map(|(p, q)| {
                        usize::from(p.mean == q.mean) + usize::from(p.sd.is_some() && p.sd == q.sd)
                    })
                    .sum();
                if equal >= COPY_CELLS {
                    found.push(DuplicateRow {
                        first: a.file.clone(),
                        second: b.file.clone(),
                        run: x.run,
                        equal,
                    });
                }
            }
        }
    }
    found
}
