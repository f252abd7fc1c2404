//! The photographs by drums with another number of beads than printed.

use std::fmt::Write as _;

use rig_schema::SimulatedTable;

use super::campaigns::{Kept, MORE};
use super::own::{
    CONFIGS, TABLE_8_WALL, basis, calibrated, configuration, own_study_of, own_table,
};

/// Factors on the printed number that are tried: beyond those that were simulated the line's own error grows.
const FACTORS: [f64; 4] = [1.0, 1.05, 1.1, 1.15];

/// Our runs with so many times the printed number of beads: the straight line through what [`MORE`] times as many and the
/// printed number show, at settings that have both.
fn with_beads(name: &str, factor: f64) -> anyhow::Result<SimulatedTable> {
    let (mut printed, more) = (own_table(name, Kept::Printed)?, own_table(name, Kept::Fuller)?);
    let part = (factor - 1.0) / (MORE - 1.0);
    printed.rows.retain_mut(|row| {
        let same = |r: &&rig_schema::SimulatedRow| {
            r.omega_rpm == row.omega_rpm && r.factors == row.factors
        };
        let Some(fuller) = more.rows.iter().find(same) else { return false };
        for (own, other) in row.cells.iter_mut().zip(&fuller.cells) {
            if let (Some(own), Some(other)) = (own, other) {
                own.mean += part * (other.mean - own.mean);
            }
        }
        true
    });
    anyhow::ensure!(!printed.rows.is_empty(), "{name}: no setting with both numbers of beads");
    Ok(printed)
}

/// What each number of beads makes of the photographs.
pub(super) fn section() -> anyhow::Result<String> {
    let mut s = String::from(HEAD);
    for name in CONFIGS {
        let file = Kept::Fuller.table(configuration(name));
        if !crate::root().join("fixtures").join(file).exists() {
            continue;
        }
        for factor in FACTORS {
            let (case, study) = own_study_of(name, TABLE_8_WALL, with_beads(name, factor)?)?;
            let c = calibrated(name, "Tumble, walls from 0.4", basis(&case), &study)?;
            let _ = writeln!(s, "| {name} | {factor} | {} |", c.cells());
        }
    }
    Ok(s)
}

const HEAD: &str = "\n## With another number of beads\n\n\
    The same photographs by runs with the printed number of beads times a factor (a straight line through 1 and 1.15; walls from 0.4). The\n\
    circle's prior of 3.5 % R stays, so what a wrong circle explains is not counted for beads. Between the two numbers the surfaces are known best,\n\
    so chi-square is largest there; root mean squares compare better.\n\n\
    | configuration | factor | chi-square (dof) | rmse aor_lin, aor_mid (deg), cen_x, cen_y (% R) | friction.pp | friction.mantle |\n|---|---:|---|---|---|---|\n";
