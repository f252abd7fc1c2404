//! The thesis's simulations by Tumble's own solver, beside its printed tables.
//!
//! Nine drums a configuration, each through the three speeds of Table 8. The printed tables were made with
//! EDEM and read from its pictures, so the film is read by that definition of the angles.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::Context;
use rig_schema::{ErrataLevel, Response, SimulatedTable};
use serde::{Deserialize, Serialize};

use super::campaigns::{Design, Kept, OwnRow, Reading, keep, simulate};
use super::tables;

/// Largest root mean square error aimed at, deg, deg, % R, % R.
pub(super) const TARGET: [f64; 4] = [1.0, 1.5, 1.0, 1.0];

/// One setting, simulated here and by EDEM.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Setting {
    pub(super) omega_rpm: f64,
    pub(super) mu_wall: f64,
    pub(super) mu_pp: f64,
    pub(super) ours: [f64; 4],
    /// Standard errors of our means.
    pub(super) error: [f64; 4],
    pub(super) edem: [f64; 4],
}

impl Setting {
    pub(super) fn key(&self) -> Key {
        key(self.omega_rpm, self.mu_wall, self.mu_pp)
    }
}

/// How one response agrees over all settings.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Agreement {
    /// Mean of ours less EDEM's.
    pub(super) bias: f64,
    /// Root mean square of ours less EDEM's, the mean taken off for the centroid.
    pub(super) rmse: f64,
    /// The same with the mean taken off for the angles as well.
    rmse_free: f64,
    /// Rank correlation (Spearman).
    rank: f64,
    /// Median standard error of our means.
    error: f64,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Comparison {
    pub(super) table: String,
    /// Whether ours were simulated by the laws that EDEM documents.
    pub(super) edem_laws: bool,
    pub(super) settings: Vec<Setting>,
    agreement: [Agreement; 4],
}

pub(super) type Key = (i64, i64, i64);

/// Readings by setting.
pub(super) type BySetting = BTreeMap<Key, Reading>;

fn key(omega: f64, wall: f64, pp: f64) -> Key {
    let k = |x: f64| (1e3 * x).round() as i64;
    (k(omega), k(wall), k(pp))
}

/// What is simulated besides Table 8.
#[derive(Debug, Clone, Copy)]
pub(crate) struct More {
    /// [`Design::Between`].
    pub(crate) between: bool,
    /// [`Design::EdemLaws`].
    pub(crate) edem_laws: bool,
}

/// Simulate what is not there yet, compare, and write docs/src/own-dem.md, docs/own-dem.json and the tables
/// of responses; configurations that are not asked for stay as they were last written.
pub(crate) fn run(configs: &[String], more: More, jobs: usize) -> anyhow::Result<()> {
    let docs = crate::root().join("docs");
    let (kept, mut all) = kept()?;
    for config in configs {
        let ours = by_setting(&simulate(config, Design::Table8, jobs)?);
        keep(config, Kept::Printed)?;
        let mut sets = vec![(false, ours)];
        if more.edem_laws {
            sets.push((true, by_setting(&simulate(config, Design::EdemLaws, jobs)?)));
        }
        for wall in ["Plexi", "Steel"] {
            let name = format!("{config}_{wall}");
            let (_, _, edem) = tables(&name, ErrataLevel::Likely)?;
            for (edem_laws, set) in &sets {
                let compared = compare(&name, *edem_laws, set, &edem)?;
                all.retain(|c| c.table != name || c.edem_laws != *edem_laws);
                all.push(compared);
            }
        }
        all.sort_by(|a, b| (&a.table, a.edem_laws).cmp(&(&b.table, b.edem_laws)));
        crate::write_whole(&docs.join("src/own-dem.md"), &page(&all))?;
        crate::write_whole(&kept, &serde_json::to_string_pretty(&all)?)?;
        if more.between {
            simulate(config, Design::Between, jobs)?;
            keep(config, Kept::Printed)?;
        }
    }
    println!("{}", summary(all.iter().filter(|c| !c.edem_laws)));
    println!("{}", summary(all.iter().filter(|c| c.edem_laws)));
    Ok(())
}

pub(super) fn by_setting(rows: &[OwnRow]) -> BySetting {
    rows.iter().map(|r| (key(r.omega_rpm, r.mu_wall, r.mu_pp), r.edem)).collect()
}

/// What was compared last, and where it is kept.
pub(super) fn kept() -> anyhow::Result<(PathBuf, Vec<Comparison>)> {
    let path = crate::root().join("docs/own-dem.json");
    let all = match std::fs::read_to_string(&path) {
        Ok(text) => serde_json::from_str(&text).with_context(|| path.display().to_string())?,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(e) => return Err(e).with_context(|| path.display().to_string()),
    };
    Ok((path, all))
}

fn compare(
    name: &str,
    edem_laws: bool,
    ours: &BySetting,
    edem: &SimulatedTable,
) -> anyhow::Result<Comparison> {
    let at = |factor: &str| {
        let k = edem.factors.iter().position(|f| f == factor);
        k.with_context(|| format!("{name} has no column {factor}"))
    };
    let (wall, pp) = (at("mu_wall")?, at("mu_pp")?);
    let mut settings = Vec::new();
    for row in &edem.rows {
        let (mu_wall, mu_pp) = (row.factors[wall], row.factors[pp]);
        let Some(seen) = ours.get(&key(row.omega_rpm, mu_wall, mu_pp)) else { continue };
        let four = row.cells.map(|c| c.map_or(f64::NAN, |c| c.mean));
        let omega_rpm = row.omega_rpm;
        settings.push(Setting {
            omega_rpm,
            mu_wall,
            mu_pp,
            ours: seen.mean,
            error: seen.error,
            edem: four,
        });
    }
    anyhow::ensure!(settings.len() > 2, "{name}: {} settings in common", settings.len());
    let agreement = std::array::from_fn(|r| agreement(&settings, r));
    Ok(Comparison { table: name.to_owned(), edem_laws, settings, agreement })
}

pub(super) fn agreement(settings: &[Setting], r: usize) -> Agreement {
    let pairs: Vec<(f64, f64)> = settings
        .iter()
        .map(|s| (s.ours[r], s.edem[r]))
        .filter(|(a, b)| a.is_finite() && b.is_finite())
        .collect();
    let n = pairs.len() as f64;
    let bias = pairs.iter().map(|(a, b)| a - b).sum::<f64>() / n;
    let about = |c: f64| (pairs.iter().map(|(a, b)| (a - b - c).powi(2)).sum::<f64>() / n).sqrt();
    let (ours, theirs): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    let (a, b) = (ranks(&ours), ranks(&theirs));
    let middle = 0.5 * (n - 1.0);
    let sum = |f: &dyn Fn(usize) -> f64| (0..pairs.len()).map(f).sum::<f64>();
    let cross = sum(&|i| (a[i] - middle) * (b[i] - middle));
    let spread = sum(&|i| (a[i] - middle).powi(2)) * sum(&|i| (b[i] - middle).powi(2));
    let mut errors: Vec<f64> = settings.iter().map(|s| s.error[r]).collect();
    errors.sort_by(f64::total_cmp);
    Agreement {
        bias,
        rmse: about(if r < 2 { 0.0 } else { bias }),
        rmse_free: about(bias),
        rank: cross / spread.sqrt(),
        error: errors[errors.len() / 2],
    }
}

/// Both tables of a configuration as they were compared by EDEM's laws.
pub(super) fn by_edem_laws<'a>(
    all: &'a [Comparison],
    config: &str,
) -> anyhow::Result<[&'a Comparison; 2]> {
    let find = |wall: &str| {
        let name = format!("{config}_{wall}");
        let own = all.iter().find(|c| c.table == name && c.edem_laws);
        own.with_context(|| {
            format!("{name} is not in docs/own-dem.json by EDEM's laws: --dem --edem-laws")
        })
    };
    Ok([find("Plexi")?, find("Steel")?])
}

/// Mean of ours less EDEM's at one speed.
pub(super) fn bias_at(settings: &[Setting], omega_rpm: f64, r: usize) -> f64 {
    let own: Vec<Setting> = settings.iter().filter(|s| s.omega_rpm == omega_rpm).cloned().collect();
    agreement(&own, r).bias
}

/// Speeds of settings, rpm, each once and in order.
pub(super) fn speeds_of(settings: &[Setting]) -> Vec<f64> {
    let mut each: Vec<f64> = settings.iter().map(|s| s.omega_rpm).collect();
    each.sort_by(f64::total_cmp);
    each.dedup();
    each
}

/// Ranks, ties sharing their mean.
fn ranks(x: &[f64]) -> Vec<f64> {
    x.iter()
        .map(|v| {
            let below = x.iter().filter(|w| *w < v).count() as f64;
            let same = x.iter().filter(|w| *w == v).count() as f64;
            below + 0.5 * (same - 1.0)
        })
        .collect()
}

fn summary<'a>(all: impl Iterator<Item = &'a Comparison>) -> String {
    let mut text = String::from(
        "| table | response | settings | ours less EDEM | RMSE | RMSE, mean free | target | rank correlation | our standard error |\n|---|---|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for c in all {
        for ((r, a), target) in Response::ALL.iter().zip(&c.agreement).zip(TARGET) {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {:+.2} | {:.2} | {:.2} | {target:.1} | {:.3} | {:.2} |",
                c.table,
                r.column(),
                c.settings.len(),
                a.bias,
                a.rmse,
                a.rmse_free,
                a.rank,
                a.error
            );
        }
    }
    text
}

fn page(all: &[Comparison]) -> String {
    let mut text = String::from(
        "# The thesis's drums by our own simulation\n\n\
         `cargo xtask reproduce --dem` simulates the settings of Table 8 for the beads (configurations AZ1 and AZ2) with the constants of\n\
         Tables 5 to 7 and reads the film by EDEM's definition of the angles (from wall to wall; from one fifth to four fifths), beside\n\
         the printed tables of EDEM. No figure of these tables enters the simulation. The centroids of EDEM carry an unknown shift a table:\n\
         their RMSE is about the mean difference; that of the angles is not.\n\n",
    );
    text.push_str(&summary(all.iter().filter(|c| !c.edem_laws)));
    if all.iter().any(|c| c.edem_laws) {
        text.push_str(
            "\n## By the laws that EDEM documents\n\n\
             The same settings by the laws of EDEM's manual: the tangential spring as a whole with the stiffness of the moment, rolling torque\n\
             against each bead's own spin instead of the relative one (`--edem-laws`). Nothing else is changed.\n\n",
        );
        text.push_str(&summary(all.iter().filter(|c| c.edem_laws)));
    }
    for c in all {
        let _ = write!(
            text,
            "\n## {}{}\n\nOurs (standard error) and EDEM's, degrees and % of R.\n\n| rpm | mu_wall | mu_pp | aor_lin | EDEM | aor_mid | EDEM | cen_x | EDEM | cen_y | EDEM |\n|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
            c.table,
            if c.edem_laws { " by EDEM's laws" } else { "" }
        );
        for s in &c.settings {
            let _ = write!(text, "| {} | {} | {} |", s.omega_rpm, s.mu_wall, s.mu_pp);
            for r in 0..4 {
                let _ = write!(text, " {:.2} ({:.2}) | {:.2} |", s.ours[r], s.error[r], s.edem[r]);
            }
            text.push('\n');
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_shift_is_bias_and_no_scatter() {
        let setting = |k: f64| Setting {
            omega_rpm: k,
            mu_wall: 0.4,
            mu_pp: 0.1,
            ours: [k + 1.0; 4],
            error: [0.1; 4],
            edem: [k; 4],
        };
        let settings: Vec<_> = [4.0, 17.0, 30.0].map(setting).to_vec();
        let [lin, .., y] = [0, 1, 2, 3].map(|r| agreement(&settings, r));
        assert!((lin.bias - 1.0).abs() < 1e-12 && (lin.rmse - 1.0).abs() < 1e-12);
        assert!(y.rmse < 1e-12 && (y.rank - 1.0).abs() < 1e-12);
    }
}
