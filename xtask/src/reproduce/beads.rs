//! How many beads EDEM's pictures show: the drums of Table 8 with more beads than printed, by EDEM's laws.
//!
//! Between the printed number and [`MORE`] times as many every response is taken as a straight line. The number is
//! told by how the centre of area moves from setting to setting; what it does to the angles is a prediction.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use calib_report::Picture as _;
use calib_report::pictures::{
    AxisSpacing, ChartAxis, ChartPoint, ChartSeries, LineChart, SeriesStyle,
};

use super::campaigns::{Design, Kept, MORE, keep, simulate};
use super::dem::{
    BySetting, Setting, TARGET, agreement, bias_at, by_edem_laws, by_setting, kept, speeds_of,
};

/// One setting: ours with the printed number beside EDEM's, and what more beads change.
struct Row {
    printed: Setting,
    change: [f64; 4],
}

impl Row {
    /// Frictions, thousandths: a drum, which goes through three speeds.
    fn drum(&self) -> (i64, i64) {
        let (_, wall, pp) = self.printed.key();
        (wall, pp)
    }

    /// Ours less EDEM's with the printed number.
    fn off(&self, r: usize) -> f64 {
        self.printed.ours[r] - self.printed.edem[r]
    }
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
        let (change, off) = (mean(&|s| s.change[r]), mean(&|s| s.off(r)));
        for s in rows {
            let c = s.change[r] - change;
            cross -= c * (s.off(r) - off);
            square += c * c;
        }
    }
    cross / square
}

/// Factor on the number of beads, with the standard error that leaving out drum after drum gives.
fn beads(rows: &[Row], told: Told) -> (f64, f64) {
    let factor = |rows: &[&Row]| 1.0 + (MORE - 1.0) * part(rows, told);
    let all: Vec<&Row> = rows.iter().collect();
    let drums: BTreeSet<(i64, i64)> = rows.iter().map(Row::drum).collect();
    let without: Vec<f64> = drums
        .iter()
        .map(|drum| factor(&all.iter().copied().filter(|r| r.drum() != *drum).collect::<Vec<_>>()))
        .collect();
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    let spread: f64 = without.iter().map(|v| (v - mean).powi(2)).sum();
    (factor(&all), ((n - 1.0) / n * spread).sqrt())
}

/// Ours with so many times the printed number, beside EDEM's.
fn with_beads(rows: &[Row], factor: f64) -> Vec<Setting> {
    let part = (factor - 1.0) / (MORE - 1.0);
    let one = |row: &Row| {
        let ours = std::array::from_fn(|r| row.printed.ours[r] + part * row.change[r]);
        Setting { ours, ..row.printed.clone() }
    };
    rows.iter().map(one).collect()
}

/// Factor on the printed number that `from` calls for in each of the three ways, if more beads do to it what they do from
/// `printed` to `more`.
pub(super) fn called_for(
    printed: &[Setting],
    more: &BySetting,
    from: &[Setting],
) -> [(f64, f64); 3] {
    let mut rows = rows(printed, more);
    rows.retain_mut(|row| {
        let own = from.iter().find(|s| s.key() == row.printed.key());
        own.is_some_and(|own| {
            row.printed = own.clone();
            true
        })
    });
    in_three_ways(&rows)
}

/// Factors by the place of the centre, by its movements, and by the angles.
fn in_three_ways(rows: &[Row]) -> [(f64, f64); 3] {
    [BY_CENTRE, BY_CHANGES, BY_ANGLES].map(|told| beads(rows, told))
}

/// Cells of a table that show them.
pub(super) fn cells(ways: [(f64, f64); 3]) -> String {
    ways.map(|(factor, error)| format!("{factor:.3} ({error:.3})")).join(" | ")
}

/// Settings that were simulated with both numbers.
fn rows(printed: &[Setting], more: &BySetting) -> Vec<Row> {
    let one = |printed: &Setting| {
        let fuller = more.get(&printed.key())?;
        let change = std::array::from_fn(|r| fuller.mean[r] - printed.ours[r]);
        Some(Row { printed: printed.clone(), change })
    };
    printed.iter().filter_map(one).collect()
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
        for own in by_edem_laws(&all, config)? {
            let name = &own.table;
            let rows = rows(&own.settings, &more);
            let ways = in_three_ways(&rows);
            let _ = writeln!(told, "| {name} | {} |", cells(ways));
            let [_, (factor, _), _] = ways;
            let so_many = with_beads(&rows, factor);
            let file = format!("img/own-dem-beads-{}.svg", name.to_lowercase());
            let more = format!("{factor:.2} times as many");
            let sets = [(&own.settings[..], "printed number of beads"), (&so_many[..], &more[..])];
            let picture = picture(name, &sets);
            crate::write_whole(&docs.join(&file), &picture)?;
            let _ = write!(pictures, "![{name}]({file})\n\n");
            for (r, response) in rig_schema::Response::ALL.iter().enumerate() {
                let (before, after) = (agreement(&own.settings, r), agreement(&so_many, r));
                let _ = writeln!(
                    outcome,
                    "| {name} | {} | {:+.2} | {:+.2} | {:.2} | {:.2} | {:.1} |",
                    response.column(),
                    before.bias,
                    after.bias,
                    before.rmse,
                    after.rmse,
                    TARGET[r]
                );
            }
            for rpm in speeds_of(&so_many) {
                let _ = writeln!(
                    speeds,
                    "| {name} | {rpm} | {:+.2} | {:+.2} | {:+.2} | {:+.2} |",
                    bias_at(&own.settings, rpm, 0),
                    bias_at(&so_many, rpm, 0),
                    bias_at(&own.settings, rpm, 1),
                    bias_at(&so_many, rpm, 1)
                );
            }
        }
    }
    for config in configs {
        let _ = simulate(config, Design::OursFuller, jobs)?;
        keep(config, Kept::Fuller)?;
    }
    let text = format!("{HEAD}{told}\n{OUTCOME}{outcome}\n{SPEEDS}{speeds}\n{PICTURES}{pictures}");
    crate::write_whole(&docs.join("own-dem-beads.md"), text.trim_end())?;
    println!("{text}");
    Ok(())
}

/// The middle line of every setting: EDEM's across, ours up.
pub(super) fn picture(name: &str, sets: &[(&[Setting], &str)]) -> String {
    let of = |all: &[Setting]| -> Vec<ChartPoint> {
        all.iter().map(|s| ChartPoint::from((s.edem[1], s.ours[1]))).collect()
    };
    let edem = || sets.iter().flat_map(|(all, _)| all.iter()).map(|s| s.edem[1]);
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
    let equal = ends.map(|v| (v, v).into()).to_vec();
    let equal = series("equal".to_owned(), SeriesStyle::Line, equal);
    let each =
        sets.iter().map(|(all, how)| series((*how).to_owned(), SeriesStyle::Points, of(all)));
    let chart = LineChart {
        title: format!("{name}: middle line at all settings of Table 8"),
        x: axis("EDEM, deg"),
        y: axis("ours by EDEM's laws, deg"),
        series: std::iter::once(equal).chain(each).collect(),
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
pub(super) const SPEEDS: &str =
    "## By speed\n\nMean of ours less EDEM's over all frictions, degrees.\n\n";

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
            let (mu_wall, mu_pp) = ((k % 3) as f64, (k / 3 % 3) as f64);
            let error = [0.1; 4];
            Row { printed: Setting { omega_rpm: x, mu_wall, mu_pp, ours, error, edem }, change }
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
        assert!(agreement(&with_beads(&exact, 1.12), 1).rmse < 1e-9);
        let shifted = drums(1.12, 2.0);
        assert!((beads(&shifted, BY_CHANGES).0 - 1.12).abs() < 1e-9);
        // Two per cent of R are eight per cent of the beads where 15 % move the centre by some four.
        assert!((beads(&shifted, BY_CENTRE).0 - 1.12).abs() > 0.03);
    }
}
