//! What a figure of the thesis may mean: the drums of Table 8 by EDEM's laws with other readings of it, beside EDEM's tables and the
//! reading that all other pages take.

use std::fmt::Write as _;

use rig_schema::Response;

use super::beads::{SPEEDS, called_for, cells, picture};
use super::campaigns::{Design, simulate};
use super::dem::{
    BySetting, Setting, TARGET, agreement, bias_at, by_edem_laws, by_setting, kept, speeds_of,
};

/// A figure with its readings, and the page that compares them.
pub(super) struct Printed {
    /// Name of the page and its pictures.
    pub(super) name: &'static str,
    /// What the other pages read.
    pub(super) usual: &'static str,
    pub(super) readings: &'static [(Design, &'static str)],
    /// What stands above the tables.
    pub(super) head: &'static str,
}

/// Ours by one reading beside EDEM's.
struct Set {
    reading: &'static str,
    settings: Vec<Setting>,
}

/// The settings of a table that every reading has, by each of them, the usual one first.
fn sets(
    (usual, own): (&'static str, &[Setting]),
    readings: &[(&'static str, BySetting)],
) -> Vec<Set> {
    let everywhere = |s: &&Setting| readings.iter().all(|(_, of)| of.contains_key(&s.key()));
    let settings: Vec<Setting> = own.iter().filter(everywhere).cloned().collect();
    let by = |of: &BySetting| {
        let with = |s: &Setting| {
            let seen = of.get(&s.key())?;
            Some(Setting { ours: seen.mean, error: seen.error, ..s.clone() })
        };
        settings.iter().filter_map(with).collect()
    };
    let each = readings.iter().map(|(reading, of)| Set { reading, settings: by(of) });
    let others: Vec<Set> = each.collect();
    std::iter::once(Set { reading: usual, settings }).chain(others).collect()
}

/// Columns of a table, one a reading.
fn columns(sets: &[Set], of: impl Fn(&[Setting]) -> String) -> String {
    let each: Vec<String> = sets.iter().map(|s| of(&s.settings)).collect();
    each.join(" | ")
}

/// Simulate what is not there yet and write the page.
pub(super) fn run(printed: &Printed, configs: &[String], jobs: usize) -> anyhow::Result<()> {
    let (_, all) = kept()?;
    let docs = crate::root().join("docs/src");
    let mut pictures = String::new();
    let names = std::iter::once(printed.usual).chain(printed.readings.iter().map(|r| r.1));
    let names = names.collect::<Vec<_>>().join(" | ");
    let rules = "---:|".repeat(1 + printed.readings.len());
    let mut outcome = format!(
        "| table | response | ours less EDEM: {names} | RMSE: {names} | target |\n|---|---|{rules}{rules}---:|\n"
    );
    let mut speeds = format!(
        "| table | rpm | aor_lin: {names} | aor_mid: {names} |\n|---|---:|{rules}{rules}\n"
    );
    let mut told = String::new();
    for config in configs {
        let mut readings = Vec::new();
        for (design, reading) in printed.readings {
            readings.push((*reading, by_setting(&simulate(config, *design, jobs)?)));
        }
        // What is kept; where nothing is, no factor is told.
        let more = by_setting(&simulate(config, Design::Fuller, 0)?);
        for own in by_edem_laws(&all, config)? {
            let name = &own.table;
            let sets = sets((printed.usual, &own.settings), &readings);
            let count = sets[0].settings.len();
            anyhow::ensure!(count > 2, "{name}: {count} settings in common");
            for set in &sets {
                let factors = called_for(&own.settings, &more, &set.settings);
                if factors.iter().all(|(f, _)| f.is_finite()) {
                    let _ = writeln!(told, "| {name} | {} | {} |", set.reading, cells(factors));
                }
            }
            let file = format!("img/{}-{}.svg", printed.name, name.to_lowercase());
            let shown: Vec<_> = sets.iter().map(|s| (&s.settings[..], s.reading)).collect();
            crate::write_whole(&docs.join(&file), &picture(name, &shown))?;
            let _ = write!(pictures, "![{name}]({file})\n\n");
            for (r, response) in Response::ALL.iter().enumerate() {
                let bias = columns(&sets, |s| format!("{:+.2}", agreement(s, r).bias));
                let rmse = columns(&sets, |s| format!("{:.2}", agreement(s, r).rmse));
                let (response, target) = (response.column(), TARGET[r]);
                let _ =
                    writeln!(outcome, "| {name} | {response} | {bias} | {rmse} | {target:.1} |");
            }
            for rpm in speeds_of(&sets[0].settings) {
                let bias = |r| columns(&sets, |s| format!("{:+.2}", bias_at(s, rpm, r)));
                let _ = writeln!(speeds, "| {name} | {rpm} | {} | {} |", bias(0), bias(1));
            }
        }
    }
    if !told.is_empty() {
        told = format!("{TOLD}{told}\n");
    }
    let head = printed.head;
    let text = format!("{head}{outcome}\n{SPEEDS}{speeds}\n{told}{PICTURES}{pictures}");
    crate::write_whole(&docs.join(format!("{}.md", printed.name)), text.trim_end())?;
    println!("{text}");
    Ok(())
}

const TOLD: &str = "## How many beads EDEM's tables call for\n\n\
    The factor on the printed number as [more beads](own-dem-beads.md) tell it, with what more beads do in the usual reading.\n\n\
    | table | reading | by where the centre is | by how it moves from setting to setting | by the angles |\n\
    |---|---|---|---|---|\n";
const PICTURES: &str = "## Setting by setting\n\n";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::campaigns::Reading;

    #[test]
    fn only_settings_that_every_reading_has_are_compared() {
        let setting = |omega_rpm: f64| Setting {
            omega_rpm,
            mu_wall: 0.4,
            mu_pp: 0.5,
            ours: [1.0; 4],
            error: [0.1; 4],
            edem: [3.0; 4],
        };
        let one_size = [4.0, 17.0, 30.0].map(setting);
        let seen = |mean: f64| Reading { mean: [mean; 4], sd: [0.0; 4], error: [0.2; 4] };
        let of = |omegas: &[usize], mean: f64| -> BySetting {
            omegas.iter().map(|k| (one_size[*k].key(), seen(mean))).collect()
        };
        let sets =
            sets(("usual", &one_size), &[("a", of(&[0, 1, 2], 2.0)), ("b", of(&[0, 2], 3.5))]);
        let speeds: Vec<_> = sets.iter().map(|s| speeds_of(&s.settings)).collect();
        assert_eq!(speeds, vec![vec![4.0, 30.0]; 3]);
        let bias = columns(&sets, |s| format!("{:.1}", agreement(s, 0).bias));
        assert_eq!(bias, "-2.0 | -1.0 | 0.5");
    }
}
