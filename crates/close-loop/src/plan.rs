//! What a case asks for, and how many runs go where.

use calib::attribution::{CodeCovariance, Settings as AttributionSettings};
use calib::{FrameCorrelation, FreeParameter, Nuisance, Observations, OperatingPoint};
use campaign::{CampaignError, drum_rig};
use rig_schema::{Layer, MeasuredTable, Rig, Simulator, namespace};

use crate::catalogue::{Catalogue, roughness};
use crate::codes::Codes;
use crate::driver::CloseLoop;
use crate::emulator::Axis;
use crate::error::CloseLoopError;
use crate::outcome::LoadOf;
use crate::runs::{Further, fill_box, loads, rig_at};
use crate::scale::Scale;
use crate::speeds::knots;
use crate::stand_in::{Cast, Fidelity};

/// Independent frames in a measured mean where neither the case nor the table says.
const DEFAULT_N_EFF: f64 = 15.0;

/// What was measured with one load, as the case tells it.
pub(crate) struct Measured<'a> {
    /// Path of its amount, and the amount.
    pub(crate) fill: (&'static str, f64),
    pub(crate) n_eff: Option<f64>,
    pub(crate) fillings: Option<u32>,
    pub(crate) table: &'a MeasuredTable,
}

/// How a loop is closed: what is no property of the case.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopSettings {
    /// Most runs that may be simulated; chosen by the number of effects where not given.
    pub runs: Option<usize>,
    /// Time that runs may take, s, kept ones counted as what they took: when it is spent nothing more is looked for, and what
    /// stands is confirmed. What no answer can do without is simulated in any case. `None` for no limit.
    pub time_s: Option<f64>,
    /// Most speeds that are simulated; others are interpolated.
    pub most_speeds: usize,
    /// Speeds to predict, rpm: the fresh runs go through them as well.
    pub predict: Vec<f64>,
    /// How near to the rig the simulations are.
    pub fidelity: Fidelity,
    /// Seed of designs and fillings.
    pub seed: u64,
    /// By how much codes differ that simulate the same.
    pub codes: Codes,
    /// Whether members of a class are simulated with half as much in the drum as well, to see whether that would tell them
    /// apart: some eighteen runs beside [`LoopSettings::runs`], of a drum half as full, if there is time.
    pub next: bool,
    /// Levels and sizes of the statistics.
    pub attribution: AttributionSettings,
}

/// Likelihood ratio within which an effect joins a class of fewer than three. By formulas, whose errors are as stated, the truth was in
/// 197 of 198 answers that asked for 20. Surfaces made of few runs say more than they know: in two sealed drums whose effect was in the catalogue
/// and was not named it stood 80 and 180 times behind the winner, with runs unspent.
const FEW_RATIO: f64 = 200.0;

impl Default for LoopSettings {
    fn default() -> Self {
        let attribution = AttributionSettings {
            bootstrap: 499,
            stability_bootstrap: 99,
            few_ratio: FEW_RATIO,
            ..AttributionSettings::default()
        };
        Self {
            runs: None,
            time_s: None,
            most_speeds: 6,
            predict: Vec::new(),
            fidelity: Fidelity::Case,
            seed: 1,
            codes: Codes::default(),
            next: true,
            attribution,
        }
    }
}

/// How many runs each stage makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Effort {
    /// Over the whole range of the free parameters.
    pub base: usize,
    /// About the calibrated point, in each of two rounds.
    pub zoom: usize,
    /// At the calibrated point.
    pub replicates: usize,
    /// For each effect that is simulated: one at the stronger of its two strengths, one at the weaker, and
    /// so on with other fillings.
    pub probes: usize,
    /// About the best point of each effect on the short list.
    pub refine: usize,
    /// Effects on the short list.
    pub short_list: usize,
    /// Fillings of each confirmed model; none where these are of the whole rig.
    pub confirm: usize,
}

impl Effort {
    /// No runs at all.
    pub(crate) fn nothing() -> Self {
        Self { base: 0, zoom: 0, replicates: 0, probes: 0, refine: 0, short_list: 0, confirm: 0 }
    }

    /// Runs that a plan takes at most, for `effects` that are simulated.
    pub fn total(self, effects: usize) -> usize {
        self.base
            + 2 * self.zoom
            + self.replicates
            + self.probes * effects
            + self.refine * self.short_list
            // The base, the winner and two more of its class; two more where an answer is refuted or
            // none fits.
            + 6 * self.confirm
    }

    /// The plan for a number of runs; where fresh runs are `of_whole` rigs, they are counted beside it.
    ///
    /// # Errors
    /// [`CloseLoopError::Budget`] if not even the smallest plan fits.
    pub fn of(
        runs: Option<usize>,
        free: usize,
        effects: usize,
        of_whole: bool,
    ) -> Result<Self, CloseLoopError> {
        let confirm = |fillings| if of_whole { 0 } else { fillings };
        let least = Self {
            base: 2 * free + 4,
            zoom: free + 3,
            replicates: 3,
            probes: 1,
            refine: free + 3,
            short_list: effects.min(2),
            confirm: confirm(2),
        };
        let usual = Self {
            base: 4 * free + 6,
            zoom: 2 * free + 3,
            replicates: 5,
            probes: 2,
            refine: 8 * free + 20,
            short_list: effects.min(4),
            confirm: confirm(3),
        };
        let Some(runs) = runs else { return Ok(usual) };
        let smallest = least.total(effects);
        if runs < smallest {
            return Err(CloseLoopError::Budget { runs, least: smallest, free, effects });
        }
        let mut plan = least;
        // What a run is best spent on next, over and over.
        let steps: [fn(&mut Self, usize); 7] = [
            |p, _| p.refine += 2,
            |p, e| p.short_list = (p.short_list + 1).min(e.min(5)),
            |p, _| p.replicates += 2,
            |p, _| p.probes += 1,
            |p, _| p.zoom += 2,
            |p, _| p.base += 2,
            |p, _| p.confirm += usize::from(p.confirm > 0),
        ];
        loop {
            let before = plan;
            for step in steps {
                let mut next = plan;
                step(&mut next, effects);
                // Runs are better spent where effects turn out to be promising than on all of them at a point that
                // is not theirs: what is left goes there.
                let few = next.base <= usual.base
                    && next.zoom <= usual.zoom + 3
                    && next.replicates <= usual.replicates + 4
                    && (next.probes == 1
                        || next.probes <= usual.probes && 6 * next.probes * effects <= runs);
                if next.total(effects) <= runs && next.confirm <= 6 && few {
                    plan = next;
                }
            }
            if plan == before || plan.refine > 10_000 {
                return Ok(plan);
            }
        }
    }
}

/// A case made ready.
#[derive(Debug, Clone)]
pub(crate) struct Setup {
    /// The rig, at the speeds to simulate.
    pub(crate) rig: Rig,
    /// What is simulated in its place.
    pub(crate) cast: Cast,
    pub(crate) free: Vec<FreeParameter>,
    pub(crate) axes: Vec<Axis>,
    /// Operating points that are simulated, in order.
    pub(crate) knots: Vec<OperatingPoint>,
    /// Loads of the drum, the rig's own first.
    pub(crate) loads: Vec<LoadOf>,
    /// Those beside the rig's own, as they are simulated.
    pub(crate) further: Vec<Further>,
    pub(crate) observations: Observations,
    pub(crate) held_out: Option<Observations>,
    pub(crate) nuisances: Vec<Nuisance>,
    /// Uncertain knowns that must be simulated: path, mean, standard deviation.
    pub(crate) simulated: Vec<(String, f64, f64)>,
    pub(crate) catalogue: Catalogue,
    /// Speeds to predict, rpm.
    pub(crate) predict: Vec<f64>,
    /// Whether the scatter of frames says something: where it is known of all means, and what is simulated is no
    /// stand-in of few large particles, which scatter more.
    pub(crate) scatter_tells: bool,
    /// By how much codes differ.
    pub(crate) codes: Option<CodeCovariance>,
    /// Whether they do is for the data to say.
    pub(crate) codes_may_agree: bool,
}

impl Setup {
    pub(crate) fn new(this: &CloseLoop<'_>) -> Result<Self, CloseLoopError> {
        let CloseLoop { case, settings, .. } = *this;
        let Simulator::Rig { coarse: stand_in } = case.simulator else {
            return Err(CloseLoopError::NoRig { case: case.rig.name.clone() });
        };
        if case.data.loads.len() != this.loads.len() {
            let (expected, given) = (case.data.loads.len(), this.loads.len());
            return Err(CloseLoopError::Loads { expected, given });
        }
        let simulated = |t: &Measured<'_>| {
            let all: Vec<f64> = t.table.rows.iter().map(|r| r.omega_rpm).collect();
            knots(&all, settings.most_speeds)
        };
        let speeds: Vec<Vec<f64>> = this.tables().map(|t| simulated(&t)).collect();
        let mut rig = case.rig.clone();
        rig.run.speeds_rpm.clone_from(&speeds[0]);
        // What is free need not have a value of its own.
        for f in case.free.iter().filter(|f| case.rig.settings.given(&f.path).is_none()) {
            let middle = Scale::of(&f.path, f.range.0).half_way(f.range.0, f.range.1);
            let refused = |_| CloseLoopError::Strength { path: f.path.clone(), value: middle };
            rig.settings.set(&f.path, middle).map_err(refused)?;
        }
        let further: Vec<Further> =
            case.data.loads.iter().cloned().zip(speeds[1..].iter().cloned()).collect();
        let cast = Cast::of(settings.fidelity, stand_in, &rig)?;
        let mut loads_of = Vec::new();
        for (t, own) in this.tables().zip(loads(&rig, &further)) {
            let (path, value) = t.fill;
            // A load that no case file told may be out of range.
            if own.settings.value(path) != Some(value) {
                return Err(CloseLoopError::Strength { path: path.to_owned(), value });
            }
            // Refused now rather than run by run.
            cast.everyday.of(&own)?;
            let volume_sd = drum_rig::solid_volume(&own).map_err(CampaignError::from)?.relative_sd;
            let fillings = t.fillings.unwrap_or(1).max(1);
            let speeds_rpm = own.run.speeds_rpm;
            loads_of.push(LoadOf { fill: t.fill, speeds_rpm, fillings, volume_sd });
        }
        let knots = loads_of
            .iter()
            .enumerate()
            .flat_map(|(load, own)| {
                own.speeds_rpm.iter().map(move |s| OperatingPoint { load, omega_rpm: *s })
            })
            .collect();
        let mut free = Vec::new();
        let mut axes = Vec::new();
        for f in &case.free {
            let physics = namespace::find(&f.path).is_some_and(|p| p.layer == Layer::Physics);
            if !physics {
                return Err(CloseLoopError::NotPhysics { path: f.path.clone() });
            }
            let scale = Scale::of(&f.path, f.range.0);
            free.push(FreeParameter { name: f.path.clone(), range: f.range });
            let unit = scale.unit(f.range);
            axes.push(Axis { path: f.path.clone(), scale, unit, roughness: roughness(&f.path) });
        }
        let mut nuisances = Vec::new();
        let mut simulated = Vec::new();
        for n in &case.nuisance {
            match Nuisance::from_path(&n.path, n.mean, n.sd) {
                Some(linear) => nuisances.push(linear),
                None if namespace::find(&n.path).is_some() => {
                    simulated.push((n.path.clone(), n.mean, n.sd));
                }
                None => return Err(CloseLoopError::Nuisance { path: n.path.clone() }),
            }
        }
        let (observations, held_out) = observed(this)?;
        let taken: Vec<String> = case
            .free
            .iter()
            .map(|f| f.path.clone())
            .chain(case.nuisance.iter().map(|n| n.path.clone()))
            .collect();
        let catalogue = Catalogue::of(&rig, &taken).chosen(&case.catalogue)?;
        let rows = || this.tables().flat_map(|t| &t.table.rows);
        let mut cells = rows().flat_map(|r| r.cells.iter().flatten());
        let scatter_tells =
            cast.everyday.coarse.is_none() && cells.all(|c| c.sd.is_some_and(|sd| sd > 0.0));
        Ok(Self {
            rig,
            scatter_tells,
            loads: loads_of,
            further,
            cast,
            free,
            axes,
            knots,
            observations,
            held_out: (!held_out.items.is_empty()).then_some(held_out),
            nuisances,
            simulated,
            catalogue,
            predict: settings.predict.clone(),
            codes: settings.codes.covariance(case.rig.drum.radius_m)?,
            codes_may_agree: settings.codes == Codes::Usual,
        })
    }

    /// How many runs go where.
    pub(crate) fn effort(
        &self,
        runs: Option<usize>,
        effects: usize,
    ) -> Result<Effort, CloseLoopError> {
        Effort::of(runs, self.free.len(), effects, self.cast.fresh.is_some())
    }

    /// Speeds of the fresh runs of the rig's own load: those of all others, and those to predict.
    pub(crate) fn speeds_of_fresh_runs(&self) -> Vec<f64> {
        let own = &self.loads[0].speeds_rpm;
        let mut all: Vec<f64> = own.iter().chain(&self.predict).copied().collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    /// Fillings that were measured, load by load.
    pub(crate) fn fillings(&self) -> Vec<u32> {
        self.loads.iter().map(|l| l.fillings).collect()
    }

    /// The same of the load of which there are most.
    pub(crate) fn most_fillings(&self) -> usize {
        self.fillings().into_iter().max().unwrap_or(1) as usize
    }

    /// The rig at the middle of the free ranges.
    pub(crate) fn middle(&self) -> Result<Rig, CloseLoopError> {
        let low: Vec<f64> = self.free.iter().map(|f| f.range.0).collect();
        let high: Vec<f64> = self.free.iter().map(|f| f.range.1).collect();
        let middle = fill_box(&self.axes, &low, &high, 1, 0);
        rig_at(&self.rig, &self.axes, &middle[0], 0)
    }
}

/// What was measured with all loads: what is fitted, and what is kept aside.
fn observed(this: &CloseLoop<'_>) -> Result<(Observations, Observations), CloseLoopError> {
    let range = (f64::NEG_INFINITY, f64::INFINITY);
    let mut all = Vec::new();
    for (load, t) in this.tables().enumerate() {
        let n_eff = t.n_eff.unwrap_or(DEFAULT_N_EFF);
        let frames = FrameCorrelation::default();
        let every = Observations::from_table(t.table, range, n_eff, frames)?.0.with_load(load);
        let rows = &t.table.rows;
        let kept_aside = |omega: f64| {
            let index = rows.iter().position(|r| r.omega_rpm == omega).unwrap_or(0);
            this.case.holds_out(index, rows.len(), omega)
        };
        let fitted = every.filter(|o| !kept_aside(o.omega_rpm));
        all.push((fitted, every.filter(|o| kept_aside(o.omega_rpm))));
    }
    let joined = all.into_iter().reduce(|a, b| (a.0.followed_by(&b.0), a.1.followed_by(&b.1)));
    joined.ok_or(CloseLoopError::Loads { expected: 1, given: 0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_keeps_to_its_runs_and_uses_them() {
        for effects in [3, 8, 16] {
            for free in [1, 2, 3] {
                let least = Effort::of(Some(1), free, effects, false).unwrap_err();
                let CloseLoopError::Budget { least, .. } = least else { panic!("{least}") };
                for runs in [least, least + 7, 90, 150, 400] {
                    let Ok(plan) = Effort::of(Some(runs), free, effects, false) else {
                        assert!(runs < least);
                        continue;
                    };
                    assert!(plan.total(effects) <= runs, "{plan:?}");
                    assert!(
                        plan.total(effects) + 2 * effects + 20 >= runs.min(300),
                        "{runs} {plan:?}"
                    );
                }
            }
        }
    }
}
