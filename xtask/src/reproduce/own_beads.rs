//! The photographs by drums with another number of beads than printed.

use std::fmt::Write as _;

use anyhow::Context;
use calib::{Study, root_mean_square};
use rig_schema::{Response, SimulatedTable};

use super::campaigns::{MORE, table};
use super::markdown;
use super::materials::Material;
use super::own::{CONFIGS, TABLE_8_WALL, own_study_of, own_table};

/// Factors on the printed number that are tried: beyond those that were simulated the line's own error grows.
const FACTORS: [f64; 4] = [1.0, 1.05, 1.1, 1.15];

/// Our runs with so many times the printed number of beads: the straight line through what [`MORE`] times as many and the
/// printed number show, at settings that have both.
fn with_beads(name: &str, factor: f64) -> anyhow::Result<SimulatedTable> {
    let (mut printed, more) = (own_table(name, false)?, own_table(name, true)?);
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

/// What each number of beads makes of the photographs, and one friction for all with the best ones.
pub(super) fn section() -> anyhow::Result<String> {
    let mut s = String::from(HEAD);
    let mut best: Vec<(Study, f64)> = Vec::new();
    for name in CONFIGS {
        let config = name.split('_').next().unwrap_or(name);
        if !crate::root().join("fixtures").join(table(config, true)).exists() {
            continue;
        }
        let mut own: Option<(f64, Study, f64)> = None;
        for factor in FACTORS {
            let (_, study) = own_study_of(name, TABLE_8_WALL, with_beads(name, factor)?)?;
            let m = study.problem().solve(0, 0)?;
            let friction = |path: &str| {
                let k = study.free.iter().position(|f| f.name == path);
                let e = k.and_then(|k| m.estimates.get(k));
                e.map_or_else(String::new, |e| {
                    let (lo, hi) = (markdown::open(e.lo), markdown::open(e.hi));
                    format!("{:.2} ({lo} to {hi})", e.value)
                })
            };
            let chi2 = m.goodness.chi2;
            let rmse = |r: Response| root_mean_square(&m.residuals, r).unwrap_or(f64::NAN);
            let rmse = Response::ALL.map(|r| format!("{:.2}", rmse(r)));
            let _ = writeln!(
                s,
                "| {name} | {factor} | {chi2:.0} ({}) | {} | {} | {} |",
                m.goodness.dof,
                rmse.join(", "),
                friction("friction.pp"),
                friction("friction.mantle")
            );
            if own.as_ref().is_none_or(|(least, ..)| chi2 < *least) {
                own = Some((chi2, study, factor));
            }
        }
        let (_, study, factor) = own.with_context(|| format!("{name}: no number of beads"))?;
        best.push((study, factor));
    }
    if best.len() == CONFIGS.len() {
        let numbers: Vec<String> =
            CONFIGS.iter().zip(&best).map(|(c, (_, f))| format!("{c} {f}")).collect();
        let studies: Vec<Study> = best.into_iter().map(|(study, _)| study).collect();
        let _ = writeln!(s, "\nThe best of each: {}.", numbers.join(", "));
        markdown::material(
            &mut s,
            &Material::of("By our own runs with these numbers of beads", &studies)?,
        );
    }
    Ok(s)
}

const HEAD: &str = "\n## With another number of beads\n\n\
    The same photographs by runs with the printed number of beads times a factor (a straight line through 1 and 1.15; walls from 0.4). The\n\
    circle's prior of 3.5 % R stays, so what a wrong circle explains is not counted for beads. Between the two numbers the surfaces are known best,\n\
    so chi-square is largest there; root mean squares compare better.\n\n\
    | configuration | factor | chi-square (dof) | rmse aor_lin, aor_mid (deg), cen_x, cen_y (% R) | friction.pp | friction.mantle |\n|---|---:|---|---|---|---|\n";
