//! The soft drum of Dosta et al. 2024: frozen counts of Tumble and LIGGGHTS.

use std::path::Path;

use anyhow::{Context, ensure};
use calib_report::Picture as _;
use calib_report::pictures::{ChartAxis, ChartPoint, ChartSeries, LineChart, SeriesStyle};
use dem_validation::Held;

use super::{Picture, Section};
use crate::dosta::counts::{Moment, QUADRANTS, parse};

/// Name of the section.
pub(crate) const NAME: &str = "bulk_dosta";

/// The section and what is to be said before its plots.
pub(crate) struct Bulk {
    pub(crate) section: Section,
    pub(crate) notes: String,
}

const NOTES: &str = "\
Drum of 0.1 m radius and 60 mm length, 2 rad/s; 30 000 spheres of 2 mm (M1: 2 MPa, 2500 kg/m3) and \
8000 of 4 mm (M2: 1 MPa, 2000 kg/m3) in steel, 5 s (Dosta et al., Comput. Phys. Commun. 296 (2024) 109066, \
soft variant). Both species start side by side (M1 at +x) and at rest in a packing that Tumble settled \
from a seed; quadrants are signs of x and z, gravity along -z, turning about +y.\n\n\
The tables under `fixtures/validation/dosta` are frozen; `cargo xtask dosta --freeze` with `--seed N --shear incremental`, `--seed 1` and \
`--seed 1 --liggghts` writes them anew (deck: `benches/peers/dosta.lig`, \
LIGGGHTS-PUBLIC 3.8). What is the same in both codes: moduli mixed as 1/E* = sum of (1 - nu^2)/E, Hertz \
with its attractive tail kept (LIGGGHTS' default), shear damping, no rolling friction, end plates that \
turn. LIGGGHTS' `tangential history` multiplies the whole displacement by the present stiffness, as our \
compatibility law `MindlinTotalSpring` does: start 1 ran with that law, and starts 1 to 3 with the incremental \
Mindlin, whose scatter between starts is the measure of differences. What differs still: LIGGGHTS damps with the velocity of the middle of the step, \
takes |F_n| with its tail as Coulomb's load, adds shear damping outside Coulomb's limit, and sees the \
mantle as a plane in Hertz's law.\n\n\
The step is 5e-5 s, 0.26 of the Rayleigh time, not the published 1e-4 s (0.53): at 1e-4 s a bed at rest is \
kept in motion by the step itself in both codes (mean spin after 0.3 s without turning: LIGGGHTS 9.7 rad/s, \
Tumble 27 rad/s; at 5e-5 s 0.1 rad/s in both and falling).\n\n";

fn read(root: &Path, name: &str) -> anyhow::Result<Vec<Moment>> {
    let path = crate::dosta::frozen(root).join(format!("{name}.csv"));
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    parse(&text).with_context(|| path.display().to_string())
}

/// Counts of one species in one quadrant against time.
fn series(moments: &[Moment], species: usize, quadrant: usize) -> Vec<f64> {
    moments.iter().map(|m| f64::from(m.counts[species][quadrant])).collect()
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let n = values.len() as f64;
    values.sum::<f64>() / n
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    mean(a.iter().zip(b).map(|(a, b)| (a - b).powi(2))).sqrt()
}

/// Compare the frozen tables.
pub(crate) fn section(root: &Path) -> anyhow::Result<Bulk> {
    let seed = |seed: u32| read(root, &format!("tumble-incremental-{seed}"));
    let seeds = [seed(1)?, seed(2)?, seed(3)?];
    let like = read(root, "tumble-1")?;
    let peer = read(root, "liggghts-1")?;
    for table in seeds.iter().chain([&like, &peer]) {
        let same = table.iter().zip(&peer).all(|(a, b)| (a.time - b.time).abs() < 1e-9);
        ensure!(table.len() == peer.len() && same, "tables of counts differ in their times");
    }
    ensure!(like[0].counts == peer[0].counts, "Tumble and LIGGGHTS have different starts");
    let mut section = Section {
        name: NAME,
        title: "Rotating drum of two species (Dosta et al. 2024, soft)",
        checks: Vec::new(),
        pictures: Vec::new(),
    };
    for (species, name) in ["M1", "M2"].into_iter().enumerate() {
        let [one, two, three] = &seeds;
        let starts: [&[Moment]; 3] = [one, two, three];
        let runs = [("total spring", &like, SAME_LAW), ("incremental", one, OTHER_LAW)];
        for (law, run, held) in runs {
            let case = format!("{name}, start 1, {law}");
            counts(run, &peer, species, &case, held, &mut section);
        }
        for (law, run, _) in runs {
            let case = format!("{name}, start 1, {law}");
            scatter(starts, run, &peer, species, &case, &mut section);
        }
        section.pictures.push(picture(&like, &seeds, &peer, species, name));
    }
    Ok(Bulk { section, notes: NOTES.to_owned() })
}

/// A count at one moment, by the law that LIGGGHTS has.
const SAME_LAW: Held = Held {
    tolerance: 0.03,
    reason: "relative to the species' number of spheres; single paths diverge, counts must not",
    source: "LIGGGHTS-PUBLIC 3.8 from the same start file",
};

/// A count at one moment, by another law.
const OTHER_LAW: Held = Held {
    tolerance: 0.05,
    reason: "relative to the species' number of spheres; LIGGGHTS has another tangential law",
    source: SAME_LAW.source,
};

/// Counts of one run beside those of the peer.
fn counts(
    run: &[Moment],
    peer: &[Moment],
    species: usize,
    case: &str,
    held: Held,
    section: &mut Section,
) {
    const MEAN: Held = Held {
        tolerance: 0.03,
        reason: "relative to the count; quadrants that hold 5 % of the species or more",
        source: SAME_LAW.source,
    };
    let total: f64 = f64::from(peer[0].counts[species].iter().sum::<u32>());
    for (quadrant, place) in QUADRANTS.into_iter().enumerate() {
        let (ours, theirs) = (series(run, species, quadrant), series(peer, species, quadrant));
        let apart = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).enumerate();
        let (worst, _) = apart.fold((0, -1.0), |w, (k, d)| if d > w.1 { (k, d) } else { w });
        section.checks.push(held.of_scale(
            case,
            format!("count in {place} at {:.2} s, where it differs most", peer[worst].time),
            theirs[worst],
            ours[worst],
            total,
        ));
    }
    for (quadrant, place) in QUADRANTS.into_iter().enumerate() {
        let ours = mean(series(run, species, quadrant).into_iter());
        let theirs = mean(series(peer, species, quadrant).into_iter());
        if theirs >= 0.05 * total {
            let quantity = format!("count in {place}, mean of 5 s");
            section.checks.push(MEAN.relative(case, quantity, theirs, ours));
        }
    }
}

/// The difference to the peer beside that between starts.
fn scatter(
    starts: [&[Moment]; 3],
    run: &[Moment],
    peer: &[Moment],
    species: usize,
    case: &str,
    section: &mut Section,
) {
    const SCATTER: Held = Held {
        tolerance: 0.5,
        reason: "a bound of 1, with half of it for what three starts tell of a scatter: their own three \
                 differences are up to 1.9 times apart",
        source: "Tumble, incremental, from three starts",
    };
    for (quadrant, place) in QUADRANTS.into_iter().enumerate() {
        let of = |table: &[Moment]| series(table, species, quadrant);
        let [a, b, c] = starts.map(of);
        let between_starts = rms(&a, &b).max(rms(&a, &c)).max(rms(&b, &c));
        // A quadrant that stays empty.
        if between_starts == 0.0 {
            continue;
        }
        section.checks.push(SCATTER.at_most(
            case,
            format!(
                "difference of the counts in {place} to LIGGGHTS over the largest between two of three \
                 starts (root mean squares over 5 s; the latter {between_starts:.0} spheres)"
            ),
            1.0,
            rms(&of(run), &of(peer)) / between_starts,
        ));
    }
}

fn picture(
    like: &[Moment],
    seeds: &[Vec<Moment>],
    peer: &[Moment],
    species: usize,
    name: &str,
) -> Picture {
    let mut chart = LineChart {
        title: format!("{name}: spheres in each quadrant"),
        x: ChartAxis::new("time (s)"),
        y: ChartAxis::new("spheres"),
        ..LineChart::default()
    };
    for (quadrant, place) in QUADRANTS.into_iter().enumerate() {
        let own = std::iter::once(series(like, species, quadrant));
        let all: Vec<Vec<f64>> =
            own.chain(seeds.iter().map(|s| series(s, species, quadrant))).collect();
        let line = like.iter().enumerate().map(|(k, m)| {
            let now = || all.iter().map(|s| s[k]);
            let interval =
                (now().fold(f64::INFINITY, f64::min), now().fold(f64::NEG_INFINITY, f64::max));
            ChartPoint { x: m.time, y: all[0][k], interval: Some(interval) }
        });
        chart.series.push(ChartSeries {
            name: format!("{place}, Tumble"),
            style: SeriesStyle::Line,
            points: line.collect(),
        });
    }
    for (quadrant, place) in QUADRANTS.into_iter().enumerate() {
        let points = peer
            .iter()
            .step_by(5)
            .map(|m| ChartPoint::from((m.time, f64::from(m.counts[species][quadrant]))));
        chart.series.push(ChartSeries {
            name: format!("{place}, LIGGGHTS"),
            style: SeriesStyle::Points,
            points: points.collect(),
        });
    }
    Picture {
        file: format!("dosta-{}.svg", name.to_lowercase()),
        title: format!("Species {name} in each quadrant against time"),
        caption: format!(
            "Lines: Tumble from start 1 with the whole displacement as spring, with the range of {} \
             runs with the incremental law as a band; points: LIGGGHTS from start 1.",
            seeds.len()
        ),
        svg: chart.svg(),
    }
}
