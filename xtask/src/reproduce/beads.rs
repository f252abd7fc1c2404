//! How many beads EDEM's pictures show: the drums of Table 8 with more beads than printed, by EDEM's laws.
//!
//! Between the printed number and [`MORE`] times as many every response is taken as a straight line. The number is
//! told by how the centre of area moves from setting to setting; what it does to the angles is a prediction.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use anyhow::Context;
use calib_report::Picture as _;
use calib_report::pictures::{
    AxisSpacing, ChartAxis, ChartPoint, ChartSeries, LineChart, SeriesStyle,
};

use super::campaigns::{Design, MORE, keep_fuller, simulate};
use super::dem::{Comparison, Setting, TARGET, by_setting, kept, key};

/// One setting: ours with the printed number, what more beads change, EDEM's.
struct Row {
    /// Frictions, thousandths: a drum, which goes through three speeds.
    drum: (i64, i64),
    omega_rpm: f64,
    ours: [f64; 4],
    change: [f64; 4],
    edem: [f64; 4],
}

/// Which numbers tell how many beads there are.
#[derive(Clone, Copy)]
struct Told {
    responses: &'static [usize],
    /// Whether each response may be off by a constant.
    shifted: bool,
}

const BY_CENTRE: Told = Told { responses: &[2, 3], shifted: false };
const BY_CHANGES: Told = Told { responses: &[2, 3], shifted: true };
const BY_ANGLES: Told = Told { responses: &[0, 1], shifted: false };

/// Part of the way from the printed number to [`MORE`] at which ours are closest to EDEM's.
fn part(rows: &[&Row], told: Told) -> f64 {
    let n = rows.len() as f64;
    let (mut cross, mut square) = (0.0, 0.0);
    for &r in told.responses {
        let mean = |of: &dyn Fn(&Row) -> f64| {
            if told.shifted { rows.iter().map(|s| of(s)).sum::<f64>() / n } else { 0.0 }
        };
        let (change, off) = (mean(&|s| s.change[r]), mean(&|s| s.ours[r] - s.edem[r]));
        for s in rows {
            let c = s.change[r] - change;
            cross -= c * (s.ours[r] - s.edem[r] - off);
            square += c * c;
        }
    }
    cross / square
}

/// Factor on the number of beads, with the standard error that leaving out drum after drum gives.
fn beads(rows: &[Row], told: Told) -> (f64, f64) {
    let factor = |rows: &[&Row]| 1.0 + (MORE - 1.0) * part(rows, told);
    let all: Vec<&Row> = rows.iter().collect();
    let mut by_drum: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    rows.iter().for_each(|r| *by_drum.entry(r.drum).or_default() += 1);
    let without: Vec<f64> = by_drum
        .keys()
        .map(|drum| factor(&all.iter().copied().filter(|r| r.drum != *drum).collect::<Vec<_>>()))
        .collect();
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    let spread: f64 = without.iter().map(|v| (v - mean).powi(2)).sum();
    (factor(&all), ((n - 1.0) / n * spread).sqrt())
}

/// Root mean square of ours less EDEM's with so many beads; the mean taken off or not.
fn rmse(rows: &[Row], factor: f64, r: usize, shifted: bool) -> (f64, f64) {
    let part = (factor - 1.0) / (MORE - 1.0);
    let off: Vec<f64> = rows.iter().map(|s| s.ours[r] + part * s.change[r] - s.edem[r]).collect();
    let n = off.len() as f64;
    let mean = off.iter().sum::<f64>() / n;
    let about = if shifted { mean } else { 0.0 };
    (mean, (off.iter().map(|d| (d - about).powi(2)).sum::<f64>() / n).sqrt())
}

fn rows(printed: &Comparison, more: &[Setting]) -> Vec<Row> {
    let of = |s: &Setting| key(s.omega_rpm, s.mu_wall, s.mu_pp);
    let by: BTreeMap<_, &Setting> = more.iter().map(|s| (of(s), s)).collect();
    let one = |s: &Setting| {
        let fuller = by.get(&of(s))?;
        let (_, wall, pp) = of(s);
        let change = std::array::from_fn(|r| fuller.ours[r] - s.ours[r]);
        let (ours, edem) = (s.ours, s.edem);
        Some(Row { drum: (wall, pp), omega_rpm: s.omega_rpm, ours, change, edem })
    };
    printed.settings.iter().filter_map(one).collect()
}

/// Simulate what is not there yet and write docs/src/own-dem-beads.md.
pub(crate) fn run(configs: &[String], jobs: usize) -> anyhow::Result<()> {
    let (_, all) = kept()?;
    let docs = crate::root().join("docs/src");
    let mut pictures = String::new();
    let mut told = String::from(
        "| table | by where the centre is | by how it moves from setting to setting | by the angles |\n|---|---|---|---|\n",
    );
    let mut outcome = String::from(
        "| table | response | ours less EDEM: printed | so many more | RMSE: printed | so many more | target |\n|---|---|---:|---:|---:|---:|---:|\n",
    );
    let mut speeds = String::from(
        "| table | rpm | aor_lin: printed | so many more | aor_mid: printed | so many more |\n|---|---:|---:|---:|---:|---:|\n",
    );
    for config in configs {
        let more = by_setting(&simulate(config, Design::Fuller, jobs)?);
        for wall in ["Plexi", "Steel"] {
            let name = format!("{config}_{wall}");
            let own = all.iter().find(|c| c.table == name && c.edem_laws);
            let own = own.with_context(|| {
                format!("{name} is not in docs/own-dem.json by EDEM's laws: --dem --edem-laws")
            })?;
            let fuller = super::dem::settings(&name, &more)?;
            let rows = rows(own, &fuller);
            let show = |t: Told| {
                let (factor, error) = beads(&rows, t);
                format!("{factor:.3} ({error:.3})")
            };
            let _ = writeln!(
                told,
                "| {name} | {} | {} | {} |",
                show(BY_CENTRE),
                show(BY_CHANGES),
                show(BY_ANGLES)
            );
            let (factor, _) = beads(&rows, BY_CHANGES);
            let file = format!("img/own-dem-beads-{}.svg", name.to_lowercase());
            crate::write_whole(&docs.join(&file), &picture(&name, &rows, factor))?;
            let _ = write!(pictures, "![{name}]({file})\n\n");
            for (r, response) in rig_schema::Response::ALL.iter().enumerate() {
                let (before, after) = (rmse(&rows, 1.0, r, r > 1), rmse(&rows, factor, r, r > 1));
                let _ = writeln!(
                    outcome,
                    "| {name} | {} | {:+.2} | {:+.2} | {:.2} | {:.2} | {:.1} |",
                    response.column(),
                    before.0,
                    after.0,
                    before.1,
                    after.1,
                    TARGET[r]
                );
            }
            let mut each: Vec<f64> = rows.iter().map(|r| r.omega_rpm).collect();
            each.sort_by(f64::total_cmp);
            each.dedup();
            for rpm in each {
                let part = (factor - 1.0) / (MORE - 1.0);
                let of = |r: usize, part: f64| {
                    let own: Vec<&Row> = rows.iter().filter(|s| s.omega_rpm == rpm).collect();
                    let off = |s: &&Row| s.ours[r] + part * s.change[r] - s.edem[r];
                    own.iter().map(off).sum::<f64>() / own.len() as f64
                };
                let _ = writeln!(
                    speeds,
                    "| {name} | {rpm} | {:+.2} | {:+.2} | {:+.2} | {:+.2} |",
                    of(0, 0.0),
                    of(0, part),
                    of(1, 0.0),
                    of(1, part)
                );
            }
        }
    }
    for config in configs {
        let _ = simulate(config, Design::OursFuller, jobs)?;
        keep_fuller(config)?;
    }
    let text = format!("{HEAD}{told}\n{OUTCOME}{outcome}\n{SPEEDS}{speeds}\n{PICTURES}{pictures}");
    crate::write_whole(&docs.join("own-dem-beads.md"), text.trim_end())?;
    println!("{text}");
    Ok(())
}

/// The middle line of every setting: EDEM's across, ours up.
fn picture(name: &str, rows: &[Row], factor: f64) -> String {
    let part = (factor - 1.0) / (MORE - 1.0);
    let of = |part: f64| -> Vec<ChartPoint> {
        let point = |s: &Row| ChartPoint::from((s.edem[1], s.ours[1] + part * s.change[1]));
        rows.iter().map(point).collect()
    };
    let edem = || rows.iter().map(|s| s.edem[1]);
    let ends = [edem().fold(f64::INFINITY, f64::min), edem().fold(f64::NEG_INFINITY, f64::max)];
    let series = |name: String, style: SeriesStyle, points: Vec<ChartPoint>| ChartSeries {
        name,
        style,
        points,
    };
    let axis = |label: &str| ChartAxis {
        label: label.to_owned(),
        range: None,
        spacing: AxisSpacing::Linear,
    };
    let chart = LineChart {
        title: format!("{name}: middle line at all settings of Table 8"),
        x: axis("EDEM, deg"),
        y: axis("ours by EDEM's laws, deg"),
        series: vec![
            series("equal".to_owned(), SeriesStyle::Line, ends.map(|v| (v, v).into()).to_vec()),
            series("printed number of beads".to_owned(), SeriesStyle::Points, of(0.0)),
            series(format!("{factor:.2} times as many"), SeriesStyle::Points, of(part)),
        ],
        ..LineChart::default()
    };
    chart.svg()
}

const PICTURES: &str = "## Setting by setting\n\n";

const HEAD: &str = "# How many beads EDEM's pictures show\n\n\
    `cargo xtask reproduce --dem --beads`. Our drums by EDEM's laws ([beside EDEM's tables](own-dem.md)) are simulated once more with 1.15\n\
    times the printed number of beads, and every response is taken as a straight line between the two numbers. How many beads the printed\n\
    tables call for is told in three ways: by where the centre of area is, by how it moves from setting to setting (what a\n\
    shifted reference circle cannot feign), and by the two angles, which have nothing to do with the circle. In brackets the standard error that leaving out drum after drum gives.\n\n\
    Factor on the printed number of beads:\n\n";
const OUTCOME: &str = "## What so many beads do\n\n\
    With the number that the centre's movements tell, at all settings of Table 8: no angle and no place of a circle was used to find it. RMSE of\n\
    the centre about its mean difference, of the angles not.\n\n";
const SPEEDS: &str = "## By speed\n\nMean of ours less EDEM's over all frictions, degrees.\n\n";

#[cfg(test)]
mod tests {
    use super::*;

    /// EDEM with so many more beads, in pictures that are off by a shift.
    fn drums(factor: f64, shift: f64) -> Vec<Row> {
        let row = |k: i64| {
            let x = k as f64;
            let ours = [20.0 + x, 21.0 + x, 25.0 - 0.1 * x, 50.0 - x];
            let change = [0.5, 1.0 + 0.1 * x, -1.0 - 0.05 * x, -3.0 - 0.2 * x];
            let part = (factor - 1.0) / (MORE - 1.0);
            let off = [0.0, 0.0, shift, shift];
            let edem = std::array::from_fn(|r| ours[r] + part * change[r] + off[r]);
            Row { drum: (k % 3, k / 3 % 3), omega_rpm: x, ours, change, edem }
        };
        (0..27).map(row).collect()
    }

    #[test]
    fn the_number_comes_back_and_a_shift_of_the_picture_is_told_from_it() {
        let exact = drums(1.12, 0.0);
        for told in [BY_CENTRE, BY_CHANGES, BY_ANGLES] {
            let (factor, error) = beads(&exact, told);
            assert!((factor - 1.12).abs() < 1e-9 && error < 1e-9, "{factor} {error}");
        }
        assert!(rmse(&exact, 1.12, 1, false).1 < 1e-9);
        let shifted = drums(1.12, 2.0);
        assert!((beads(&shifted, BY_CHANGES).0 - 1.12).abs() < 1e-9);
        // Two per cent of R are eight per cent of the beads where 15 % move the centre by some four.
        assert!((beads(&shifted, BY_CENTRE).0 - 1.12).abs() > 0.03);
    }
}
