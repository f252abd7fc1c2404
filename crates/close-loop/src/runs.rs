//! From points to samples, through the laboratory.

use std::collections::BTreeMap;

use calib::OperatingPoint;
use campaign::{CampaignError, Laboratory, Run, SpeedRow, drum_rig};
use rand::{Rng as _, RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rig_schema::{Load, Rig};

use crate::catalogue::{Effect, set};
use crate::clock::Clock;
use crate::driver::{Stage, Told};
use crate::emulator::{Axis, Sample, distance_squared};
use crate::error::CloseLoopError;
use crate::stand_in::{Cast, StandIn};

/// A run, which turns every load of the drum, and what is known of its fillings.
#[derive(Clone, Default)]
pub(crate) struct Made {
    /// What was seen where, in order.
    pub(crate) rows: Vec<(OperatingPoint, SpeedRow)>,
    /// By how much more solid it held than is expected of the rig, load by load, as a part of that.
    pub(crate) excess: Vec<f64>,
    cost_s: f64,
    steps: u64,
}

impl Made {
    /// Take in the run of the next load.
    fn join(&mut self, run: Run, excess: f64) {
        let load = self.excess.len();
        let at = |row: SpeedRow| (OperatingPoint { load, omega_rpm: row.omega_rpm }, row);
        self.rows.extend(run.speeds.into_iter().map(at));
        self.excess.push(excess);
        self.cost_s += run.cost_s;
        self.steps += run.steps;
    }
}

/// A load beside the rig's own, and the speeds at which it is simulated.
pub(crate) type Further = (Load, Vec<f64>);

/// Everything simulated so far, and what failed.
pub(crate) struct Runs<'a> {
    pub(crate) lab: &'a Laboratory,
    pub(crate) cast: Cast,
    /// Loads beside the rig's own.
    further: Vec<Further>,
    pub(crate) seed: u64,
    /// Runs asked for, kept ones included.
    pub(crate) made: usize,
    /// Those of them that are not of a whole rig in place of its stand-in.
    pub(crate) everyday: usize,
    pub(crate) cost_s: f64,
    /// What runs have taken, and what they take.
    pub(crate) clock: Clock,
    pub(crate) steps: u64,
    /// Rigs that failed: what they were, and why.
    pub(crate) failed: Vec<(String, String)>,
}

impl<'a> Runs<'a> {
    pub(crate) fn new(
        lab: &'a Laboratory,
        (cast, further): (Cast, Vec<Further>),
        seed: u64,
    ) -> Self {
        let clock = Clock::new(lab.jobs());
        let failed = Vec::new();
        Self {
            lab,
            cast,
            further,
            seed,
            made: 0,
            everyday: 0,
            cost_s: 0.0,
            clock,
            steps: 0,
            failed,
        }
    }

    /// Seed of a filling: the same for the same stage and number.
    pub(crate) fn filling(&self, stage: Stage, number: usize) -> u64 {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        random.set_stream(1 + stage as u64);
        random.set_word_pos(4 * number as u128);
        // Whole numbers that a rig file can hold.
        random.next_u64() >> 12
    }

    /// Seed of the `nth` filling with these effects at a point: the same in every loop on the same rig, so that they share
    /// what they run, and another one at every point, so that no two points share what a filling happens to be like.
    pub(crate) fn filling_at(&self, effects: &[Effect], at: &[f64], nth: usize) -> u64 {
        let mut seed = self.seed;
        let mut stir = |word: u64| {
            let mixed = ChaCha8Rng::seed_from_u64(seed ^ word).next_u64();
            seed = mixed.rotate_left(23) ^ word;
        };
        effects.iter().flat_map(|e| e.path.bytes()).for_each(|b| stir(u64::from(b)));
        at.iter().for_each(|x| stir(x.to_bits()));
        stir(nth as u64);
        ChaCha8Rng::seed_from_u64(seed).next_u64() >> 12
    }

    /// Run rigs with all loads; a rig that fails is noted under its label and gives `None`.
    pub(crate) fn all(
        &mut self,
        stage: Stage,
        rigs: &[(String, Rig)],
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Vec<Option<Made>>, CloseLoopError> {
        let whole = matches!(stage, Stage::Full | Stage::Confirm) && self.cast.whole.is_some();
        let stand_in = if whole { self.cast.whole } else { Some(self.cast.everyday) };
        let stand_in = stand_in.unwrap_or(StandIn::NONE);
        // A stand-in that cannot be described is a run that failed.
        let describe = |rig: &Rig| -> Result<Vec<Rig>, drum_rig::Error> {
            loads(rig, &self.further).iter().map(|own| stand_in.of(own)).collect()
        };
        let described: Vec<_> = rigs.iter().map(|(_, rig)| describe(rig)).collect();
        let list: Vec<Rig> = described.iter().flatten().flatten().cloned().collect();
        let each = 1 + self.further.len();
        let (mut ended, of) = (0, list.len() / each);
        let made = self.made;
        // Filming a motion again is no run.
        let counts = usize::from(stage != Stage::Filming);
        watch(&Told { stage, done: 0, of, runs: made, cost_s: None });
        let results = self.lab.run(&list, |d| {
            ended += 1;
            let done = ended / each;
            let cost_s = d.run.ok().filter(|_| !d.kept).map(|r| r.cost_s);
            watch(&Told { stage, done, of, runs: made + counts * done, cost_s });
        });
        self.made += counts * of;
        self.everyday += if whole { 0 } else { counts * of };
        if stage != Stage::Filming {
            let cost = |all: &[Result<Run, CampaignError>]| {
                let costs = all.iter().flatten().map(|run| run.cost_s);
                (costs.clone().count() > 0).then(|| costs.sum::<f64>())
            };
            let costs: Vec<f64> = results.chunks(each).filter_map(cost).collect();
            self.clock.tell(whole, &costs);
        }
        let mut runs = Vec::new();
        let mut results = results.into_iter();
        for (own, (label, _)) in described.into_iter().zip(rigs) {
            let result = match own {
                // One result for each rig that was described.
                Ok(own) => {
                    let all: Vec<_> = results.by_ref().take(each).collect();
                    joined(&own, all)
                }
                Err(e) => Err(e.into()),
            };
            match result {
                Ok(made) => {
                    self.cost_s += made.cost_s;
                    self.steps += made.steps;
                    runs.push(Some(made));
                }
                Err(CampaignError::Stopped) => return Err(CloseLoopError::Stopped),
                Err(e @ (CampaignError::Unwritable { .. } | CampaignError::Unreadable { .. })) => {
                    return Err(e.into());
                }
                Err(e) => {
                    self.failed.push((label.clone(), chain(&e)));
                    runs.push(None);
                }
            }
        }
        Ok(runs)
    }
}

/// The rig with each of its loads: its own at its own speeds, the further ones at theirs.
pub(crate) fn loads(rig: &Rig, further: &[Further]) -> Vec<Rig> {
    let with = |(load, speeds_rpm): &Further| {
        let mut own = load.of(rig);
        own.run.speeds_rpm.clone_from(speeds_rpm);
        own
    };
    std::iter::once(rig.clone()).chain(further.iter().map(with)).collect()
}

/// Runs of all loads as one.
fn joined(rigs: &[Rig], results: Vec<Result<Run, CampaignError>>) -> Result<Made, CampaignError> {
    if results.len() < rigs.len() {
        return Err(CampaignError::Stopped);
    }
    let mut made = Made::default();
    for (rig, run) in rigs.iter().zip(results) {
        made.join(run?, drum_rig::solid_volume(rig)?.excess());
    }
    Ok(made)
}

/// An error with its causes.
fn chain(e: &dyn std::error::Error) -> String {
    let mut text = e.to_string();
    let mut cause = e.source();
    while let Some(c) = cause {
        text = format!("{text}: {c}");
        cause = c.source();
    }
    text
}

/// The rig at values of the free parameters, with a seed.
pub(crate) fn rig_at(
    rig: &Rig,
    axes: &[Axis],
    theta: &[f64],
    seed: u64,
) -> Result<Rig, CloseLoopError> {
    let mut at = rig.clone();
    for (axis, value) in axes.iter().zip(theta) {
        set(&mut at, &axis.path, *value)?;
    }
    at.run.seed = seed;
    Ok(at)
}

/// The rig with an effect as well.
pub(crate) fn rig_with(
    rig: &Rig,
    axes: &[Axis],
    theta: &[f64],
    (effect, strength): (&Effect, f64),
    seed: u64,
) -> Result<Rig, CloseLoopError> {
    effect.apply(&rig_at(rig, axes, theta, seed)?, strength)
}

/// The rig with any number of effects, and what it is called.
pub(crate) fn rig_with_all(
    rig: &Rig,
    axes: &[Axis],
    theta: &[f64],
    effects: &[(Effect, f64)],
    seed: u64,
) -> Result<(String, Rig), CloseLoopError> {
    let mut with = rig_at(rig, axes, theta, seed)?;
    let mut named = Vec::new();
    for (effect, strength) in effects {
        with = effect.apply(&with, *strength)?;
        named.push(format!("{} = {strength:.4}", effect.path));
    }
    Ok((named.join(", "), with))
}

/// What a run showed, at a point.
pub(crate) fn sample(at: Vec<f64>, made: &Made) -> Sample {
    let rows = || made.rows.iter().map(|(_, row)| row);
    Sample {
        at,
        mean: rows().map(|s| s.mean).collect(),
        covariance: rows().map(|s| s.covariance).collect(),
        variance: rows().map(|s| s.sd.map(|sd| sd * sd)).collect(),
        excess: made.excess.clone(),
    }
}

/// Points that fill a box in the coordinates of the axes: a randomised Latin hypercube, the best
/// of several by its least distance.
pub(crate) fn fill_box(
    axes: &[Axis],
    low: &[f64],
    high: &[f64],
    count: usize,
    seed: u64,
) -> Vec<Vec<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut best: (f64, Vec<Vec<f64>>) = (-1.0, Vec::new());
    for _ in 0..40 {
        let mut columns = Vec::new();
        for _ in axes {
            let mut order: Vec<usize> = (0..count).collect();
            for i in (1..count).rev() {
                order.swap(i, random.random_range(0..=i));
            }
            let cells = order.iter().map(|k| (*k as f64 + 0.5) / count as f64);
            columns.push(cells.collect::<Vec<f64>>());
        }
        let points: Vec<Vec<f64>> =
            (0..count).map(|i| columns.iter().map(|c| c[i]).collect()).collect();
        let mut least = f64::INFINITY;
        for i in 0..count {
            for j in 0..i {
                least = least.min(distance_squared(&points[i], &points[j]));
            }
        }
        if least > best.0 {
            best = (least, points);
        }
    }
    let place = |u: &f64, k: usize| {
        let (a, b) = (axes[k].scale.forth(low[k]), axes[k].scale.forth(high[k]));
        axes[k].scale.back(a + u * (b - a)).clamp(low[k], high[k])
    };
    best.1.iter().map(|p| p.iter().enumerate().map(|(k, u)| place(u, k)).collect()).collect()
}

/// Samples of each effect by its path.
pub(crate) type ByEffect = BTreeMap<String, Vec<Sample>>;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stand_in::Fidelity;
    use campaign::Sampling;

    const RIG: &str = r#"
name = "fillings"
drum = { radius_m = 0.03, length_m = 0.02, mantle = "glass", end_plates = "glass", ends = "periodic" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
fill.count = 20
run = { speeds_rpm = [50.0] }
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 1e5 }
"#;

    #[test]
    fn a_filling_is_that_of_its_place_in_every_loop() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
        let rig = Rig::parse("fillings.toml", RIG).unwrap();
        let cast = Cast::of(Fidelity::Case, false, &rig).unwrap();
        let runs = |seed| Runs::new(&lab, (cast, Vec::new()), seed);
        let (a, b) = ([Effect::bare("a")], [Effect::bare("b")]);
        let both = [Effect::bare("a"), Effect::bare("b")];
        let one = runs(1).filling_at(&a, &[0.3, 1.0], 0);
        assert_eq!(one, runs(1).filling_at(&a, &[0.3, 1.0], 0));
        let mut all = vec![
            one,
            runs(2).filling_at(&a, &[0.3, 1.0], 0),
            runs(1).filling_at(&b, &[0.3, 1.0], 0),
            runs(1).filling_at(&both, &[0.3, 1.0], 0),
            runs(1).filling_at(&a, &[1.0, 0.3], 0),
            runs(1).filling_at(&a, &[0.3], 0),
            runs(1).filling(Stage::Refine, 0),
        ];
        all.extend((1..50).map(|nth| runs(1).filling_at(&a, &[0.3, 1.0], nth)));
        // What a rig file holds exactly.
        assert!(all.iter().all(|s| *s < 1 << 53));
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}
