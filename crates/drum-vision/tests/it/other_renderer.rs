//! The table of the independent frames: fixtures/film/independent/truth.csv.

use std::path::{Path, PathBuf};

pub(crate) struct Row {
    pub(crate) path: PathBuf,
    pub(crate) degraded: bool,
    pub(crate) truth: [f64; 4],
    pub(crate) circle: [f64; 3],
}

/// The table of the fixtures; `None` where they are not at hand.
pub(crate) fn rows() -> Option<Vec<Row>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/film/independent");
    let table = match std::fs::read_to_string(folder.join("truth.csv")) {
        Ok(table) => table,
        Err(e) => {
            eprintln!("skipped: {}: {e}", folder.display());
            return None;
        }
    };
    let rows = table
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let number = |k: usize| cells[k].parse::<f64>().unwrap();
            Row {
                path: folder.join(cells[0]),
                degraded: cells[1] == "degraded",
                truth: [number(3), number(4), number(5), number(6)],
                circle: [number(8), number(9), number(10)],
            }
        })
        .collect();
    Some(rows)
}
