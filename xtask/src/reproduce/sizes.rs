//! What the scatter of the beads' radii does that Table 6 prints, (3.0 +- 0.3) mm: the drums of Table 8 with it, by EDEM's
//! laws, beside EDEM's tables and those of beads of one size.

use std::fmt::Write as _;

use rig_schema::Response;

use super::beads::{SPEEDS, called_for, cells, picture};
use super::campaigns::{Design, simulate};
use super::dem::{
    BySetting, Setting, TARGET, agreement, bias_at, by_edem_laws, by_setting, kept, speeds_of,
};

/// Readings of what is printed.
const READINGS: [(Design, &str); 2] =
    [(Design::Limits, "limits"), (Design::Deviation, "standard deviation")];

/// Ours by one reading beside EDEM's.
struct Set {
    reading: &'static str,
    settings: Vec<Setting>,
}

/// The settings of a table that every reading has, by each of them, one size first.
fn sets(one_size: &[Setting], readings: &[(&'static str, BySetting)]) -> Vec<Set> {
    let everywhere = |s: &&Setting| readings.iter().all(|(_, of)| of.contains_key(&s.key()));
    let settings: Vec<Setting> = one_size.iter().filter(everywhere).cloned().collect();
    let by = |of: &BySetting| {
        let with = |s: &Setting| {
            let seen = of.get(&s.key())?;
            Some(Setting { ours: seen.mean, error: seen.error, ..s.clone() })
        };
        settings.iter().filter_map(with).collect()
    };
    let each = readings.iter().map(|(reading, of)| Set { reading, settings: by(of) });
    let others: Vec<Set> = each.collect();
    std::iter::once(Set { reading: "one size", settings }).chain(others).collect()
}

/// Columns of a table, one a reading.
fn columns(sets: &[Set], of: impl Fn(&[Setting]) -> String) -> String {
    let each: Vec<String> = sets.iter().map(|s| of(&s.settings)).collect();
    each.join(" | ")
}

/// Simulate what is not there yet and write docs/src/own-dem-sizes.md.
pub(crate) fn run(configs: &[String], jobs: usize) -> anyhow::Result<()> {
    let (_, all) = kept()?;
    let docs = crate::root().join("docs/src");
    let mut pictures = String::new();
    let (mut outcome, mut speeds) = (String::from(OUTCOME_HEAD), String::from(SPEEDS_HEAD));
    let mut told = String::from(TOLD_HEAD);
    for config in configs {
        let mut readings = Vec::new();
        for (design, reading) in READINGS {
            readings.push((reading, by_setting(&simulate(config, design, jobs)?)));
        }
        // What is kept; where nothing is, no factor is told.
        let more = by_setting(&simulate(config, Design::Fuller, 0)?);
        for own in by_edem_laws(&all, config)? {
            let name = &own.table;
            let sets = sets(&own.settings, &readings);
            let count = sets[0].settings.len();
            anyhow::ensure!(count > 2, "{name}: {count} settings in common");
            for set in &sets {
                let factors = called_for(&own.settings, &more, &set.settings);
                if factors.iter().all(|(f, _)| f.is_finite()) {
                    let _ = writeln!(told, "| {name} | {} | {} |", set.reading, cells(factors));
                }
            }
            let file = format!("img/own-dem-sizes-{}.svg", name.to_lowercase());
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
    let text = format!("{HEAD}{outcome}\n{SPEEDS}{speeds}\n{TOLD}{told}\n{PICTURES}{pictures}");
    crate::write_whole(&docs.join("own-dem-sizes.md"), text.trim_end())?;
    println!("{text}");
    Ok(())
}

const OUTCOME_HEAD: &str = "| table | response | ours less EDEM: one size | limits | standard deviation | RMSE: one size | limits | standard deviation | target |\n\
    |---|---|---:|---:|---:|---:|---:|---:|---:|\n";
const SPEEDS_HEAD: &str = "| table | rpm | aor_lin: one size | limits | standard deviation | aor_mid: one size | limits | standard deviation |\n\
    |---|---:|---:|---:|---:|---:|---:|---:|\n";
const TOLD_HEAD: &str = "| table | radii | by where the centre is | by how it moves from setting to setting | by the angles |\n\
    |---|---|---|---|---|\n";
const HEAD: &str = "# Beads of (3.0 \u{b1} 0.3) mm\n\n\
    `cargo xtask reproduce --dem --sizes`. Table 6, which lists what the simulations of the thesis need, prints the radius of the beads as\n\
    (3.0 \u{b1} 0.3) mm and does not say what the 0.3 is. The drums of Table 8 once more, with the printed number of beads and by EDEM's laws\n\
    ([beside EDEM's tables](own-dem.md)), in both readings: as limits between which every radius is as likely (standard deviation 5.8 %) and as a\n\
    standard deviation (10 %, a step of 60 us for 70, since the smallest beads ring faster); diameters are log-normal. Nothing else is changed, and\n\
    no figure of EDEM's tables enters. RMSE of the centre about its mean difference, of the angles not.\n\n";
const TOLD: &str = "## How many beads EDEM's tables call for\n\n\
    The factor on the printed number as [more beads](own-dem-beads.md) tell it, with what more beads of one size do.\n\n";
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
        let sets = sets(&one_size, &[("a", of(&[0, 1, 2], 2.0)), ("b", of(&[0, 2], 3.5))]);
        let speeds: Vec<_> = sets.iter().map(|s| speeds_of(&s.settings)).collect();
        assert_eq!(speeds, vec![vec![4.0, 30.0]; 3]);
        let bias = columns(&sets, |s| format!("{:.1}", agreement(s, 0).bias));
        assert_eq!(bias, "-2.0 | -1.0 | 0.5");
    }
}
