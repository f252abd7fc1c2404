//! The stages of closing a loop.

use std::collections::BTreeMap;

use calib::attribution::{Attribution, Candidate, Finding, Layer, PairModel, Settings, Verdict};
use calib::{CalibError, Problem};
use campaign::Laboratory;
use rig_schema::{Case, MeasuredTable, Rig};

use crate::anchors::Whole;
use crate::catalogue::Effect;
use crate::coded::{Coded, Model, decode};
use crate::confirm::{self, Fresh};
use crate::curve::{Change, Curve};
use crate::emulator::{Axis, Emulator, Sample};
use crate::error::CloseLoopError;
use crate::outcome::Outcome;
use crate::plan::{Effort, LoopSettings, Setup};
use crate::runs::{ByEffect, Runs, fill_box, rig_at, rig_with, sample};
use crate::scale::Scale;

/// Where a closed loop stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Stage {
    /// Runs over the whole range of the free parameters.
    Base,
    /// Runs about the calibrated point.
    Zoom,
    /// Fillings of the calibrated point.
    Replicates,
    /// The rig itself at the point of its stand-in.
    Full,
    /// Effects near the calibrated point.
    Probes,
    /// The same motions filmed by another camera.
    Filming,
    /// About the best points of the effects on the short list.
    Refine,
    /// Fresh runs.
    Confirm,
}

/// What is told after every run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Told {
    /// Stage.
    pub stage: Stage,
    /// Runs of it that are done.
    pub done: usize,
    /// Runs of it.
    pub of: usize,
    /// Runs so far.
    pub runs: usize,
    /// Processor time of the run that ended, s; `None` for one that was kept or failed.
    pub cost_s: Option<f64>,
}

/// What a loop simulates, as it is simulated.
#[derive(Debug, Clone)]
pub struct Pilot {
    /// The rig of every planned run, or what stands in for it.
    pub rig: Rig,
    /// What a stand-in is shifted to agree with, and how many runs of it are made beside those of the plan.
    pub whole: Option<(Rig, usize)>,
}

/// A loop to be closed.
#[derive(Debug, Clone, Copy)]
pub struct CloseLoop<'a> {
    /// Rig, free parameters, nuisances, held-out speeds.
    pub case: &'a Case,
    /// What was measured.
    pub measured: &'a MeasuredTable,
    /// Where simulations are made and kept.
    pub lab: &'a Laboratory,
    /// Runs and statistics.
    pub settings: &'a LoopSettings,
}

/// How often an answer that fresh runs refute is given up for another.
const RETRIES: usize = 5;

/// The same where every fresh run is of a rig whose cost a stand-in had to save.
const FEW_RETRIES: usize = 3;

/// Spacing of the points at which runs are made, coded units.
pub(crate) const GRID: f64 = 0.5;

/// Everything known so far.
pub(crate) struct State<'a> {
    pub(crate) setup: Setup,
    pub(crate) effort: Effort,
    pub(crate) runs: Runs<'a>,
    pub(crate) base: Vec<Sample>,
    pub(crate) effects: ByEffect,
    /// Runs of two effects together.
    pub(crate) pairs: BTreeMap<[String; 2], Vec<Sample>>,
    /// Points at which a drum with these effects could not be simulated.
    pub(crate) lost: BTreeMap<Vec<String>, Vec<Vec<f64>>>,
    curves: BTreeMap<String, Change>,
    pub(crate) theta: Vec<f64>,
    /// Runs of the whole rig that its stand-in is compared with.
    pub(crate) wholes: Vec<Whole>,
    modes: Vec<Vec<[f64; 4]>>,
    /// The base model by fresh runs, which every answer is compared with.
    pub(crate) before: Option<Fresh>,
}

impl CloseLoop<'_> {
    /// Runs at the middle of the free ranges, to see what they cost.
    ///
    /// # Errors
    /// Those of a case that cannot be simulated.
    pub fn pilot(&self) -> Result<Pilot, CloseLoopError> {
        let setup = Setup::new(self.case, self.measured, self.settings)?;
        let middle = setup.middle()?;
        let rig = setup.cast.everyday.of(&middle)?;
        let runs = setup.cast.whole_runs();
        let whole = setup.cast.whole.map(|w| w.of(&middle)).transpose()?;
        Ok(Pilot { rig, whole: whole.map(|w| (w, runs)) })
    }

    /// Runs of the plan, at most.
    ///
    /// # Errors
    /// As [`CloseLoop::pilot`]; [`CloseLoopError::Budget`] for too few runs.
    pub fn planned(&self) -> Result<usize, CloseLoopError> {
        let setup = Setup::new(self.case, self.measured, self.settings)?;
        let effects = simulated_effects(&setup);
        Ok(setup.effort(self.settings.runs, effects)?.total(effects))
    }

    /// Close the loop. What is simulated is kept in the laboratory: a second call goes through the
    /// same stages with what is there and gives the same figures.
    ///
    /// # Errors
    /// [`CloseLoopError`]; single runs that fail are in [`Outcome::failed`].
    pub fn run(&self, watch: &mut dyn FnMut(&Told)) -> Result<Outcome, CloseLoopError> {
        let (mut state, mut finding) = self.stages(watch)?;
        if finding.verdict != Verdict::None && state.setup.cast.fresh.is_some() {
            finding = self.ask_the_whole_rig(&mut state, &finding, watch)?;
        }
        let retries = if state.setup.cast.fresh.is_some() { FEW_RETRIES } else { RETRIES };
        let mut round = 0;
        loop {
            let (mut outcome, learned) = confirm::outcome(self, &mut state, finding, round, watch)?;
            // Fresh runs that refute an answer are the best that its model can learn from.
            let spare = self.spare(&state, 2);
            let learns = learned.iter().any(|l| state.can_learn(l));
            let tired = round == retries || spare == 0;
            if outcome.confirmed != Some(false) || tired || !learns {
                outcome.refuted = round;
                return Ok(outcome);
            }
            state.learn(learned);
            round += 1;
            finding = self.sharpen(&mut state, (2, 2), &self.settings.attribution, watch)?;
        }
    }

    /// What a stand-in seems to lack may be the stand-in's: run the whole rig at the best base point, shift the stand-in by
    /// what it is off there, and ask again.
    fn ask_the_whole_rig(
        &self,
        state: &mut State<'_>,
        finding: &Finding,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Finding, CloseLoopError> {
        let base = state.base_model()?;
        state.before = confirm::fresh(state, &base, &finding.base.theta, &[], 0, watch)?;
        let samples = state.before.as_ref().map_or_else(Vec::new, |b| b.samples.clone());
        state.learn(vec![(Vec::new(), samples)]);
        state.theta = state.best()?;
        let again = state.attribute(&self.settings.attribution)?;
        if again.verdict == Verdict::None {
            return Ok(again);
        }
        self.sharpen(state, (2, 2), &self.settings.attribution, watch)
    }

    /// Simulate what little is known of, single effects and then, where none will do, pairs, and ask again.
    /// Runs are kept back for so many models to be confirmed after either.
    fn sharpen(
        &self,
        state: &mut State<'_>,
        (singles, pairs): (usize, usize),
        settings: &Settings,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Finding, CloseLoopError> {
        // What is left after this is for answers that fresh runs refute: those are what models learn most from.
        let part =
            |spare: usize| if self.settings.runs.is_some() { spare.div_ceil(2) } else { spare };
        state.refine(part(self.spare(state, singles)), settings, watch)?;
        let finding = state.attribute(&self.settings.attribution)?;
        let spare = part(self.spare(state, pairs));
        if spare == 0 || !matches!(finding.verdict, Verdict::Pairs(_) | Verdict::Unknown) {
            return Ok(finding);
        }
        state.refine_pairs(spare, settings, watch)?;
        state.attribute(&self.settings.attribution)
    }

    /// Runs that can be spent on refining if so many models are to be confirmed after it.
    fn spare(&self, state: &State<'_>, models: usize) -> usize {
        let kept = state.runs.everyday + models * state.effort.confirm;
        match self.settings.runs {
            Some(most) => most.saturating_sub(kept),
            None => state.effort.refine * state.effort.short_list,
        }
    }

    /// Everything but the fresh runs: for studies of false alarms and of power.
    ///
    /// # Errors
    /// As [`CloseLoop::run`].
    pub fn find(&self, watch: &mut dyn FnMut(&Told)) -> Result<Finding, CloseLoopError> {
        Ok(self.stages(watch)?.1)
    }

    fn stages(&self, watch: &mut dyn FnMut(&Told)) -> Result<(State<'_>, Finding), CloseLoopError> {
        let setup = Setup::new(self.case, self.measured, self.settings)?;
        let effort = setup.effort(self.settings.runs, simulated_effects(&setup))?;
        let runs = Runs::new(self.lab, setup.cast, self.settings.seed);
        let mut state = State {
            setup,
            effort,
            runs,
            base: Vec::new(),
            effects: ByEffect::new(),
            pairs: BTreeMap::new(),
            lost: BTreeMap::new(),
            curves: BTreeMap::new(),
            theta: Vec::new(),
            wholes: Vec::new(),
            modes: Vec::new(),
            before: None,
        };
        state.calibrate(watch)?;
        state.probe(watch)?;
        let quick = Settings {
            bootstrap: self.settings.attribution.bootstrap.min(199),
            stability_bootstrap: 0,
            ..self.settings.attribution.clone()
        };
        let first = state.attribute(&quick)?;
        let finding = if first.gate.passes && first.gate.p_combined > 0.05 {
            state.attribute(&self.settings.attribution)?
        } else {
            self.sharpen(&mut state, (4, 3), &quick, watch)?
        };
        Ok((state, finding))
    }
}

/// Effects that need simulations of their own; an uncertain known takes two.
fn simulated_effects(setup: &Setup) -> usize {
    setup.catalogue.effects.iter().filter(|e| is_simulated(e)).count() + 2 * setup.simulated.len()
}

pub(crate) fn is_simulated(effect: &Effect) -> bool {
    matches!(effect.layer, Layer::Physics | Layer::Code)
}

impl State<'_> {
    /// Fillings of each model that fresh runs go through.
    pub(crate) fn fillings(&self) -> usize {
        self.setup.cast.fresh.unwrap_or(self.effort.confirm)
    }

    /// Find the free parameters at which the base model meets the data best.
    fn calibrate(&mut self, watch: &mut dyn FnMut(&Told)) -> Result<(), CloseLoopError> {
        let low: Vec<f64> = self.setup.free.iter().map(|f| f.range.0).collect();
        let high: Vec<f64> = self.setup.free.iter().map(|f| f.range.1).collect();
        let axes = self.setup.axes.clone();
        let seed = self.runs.filling(Stage::Base, usize::MAX >> 8);
        let points = fill_box(&axes, &low, &high, self.effort.base, seed);
        let asked = points.len();
        self.base_runs(Stage::Base, &points, 0, watch)?;
        if 2 * self.base.len() < asked {
            let first = self.runs.failed.first().map_or_else(String::new, |f| f.1.clone());
            return Err(CloseLoopError::Base { failed: asked - self.base.len(), asked, first });
        }
        self.theta = self.best()?;
        for round in 0..2 {
            self.anchor(round, watch)?;
            let (low, high) = self.around(&self.snap(&self.theta), 1.0);
            let seed = self.runs.filling(Stage::Zoom, (usize::MAX >> 8) - round);
            let points = fill_box(&axes, &low, &high, self.effort.zoom, seed);
            self.base_runs(Stage::Zoom, &points, round * self.effort.zoom, watch)?;
            self.theta = self.best()?;
        }
        self.anchor(2, watch)?;
        let points = vec![self.snap(&self.theta); self.effort.replicates];
        self.base_runs(Stage::Replicates, &points, 0, watch)?;
        self.count_frames_anew(&self.base_model()?);
        self.theta = self.best()?;
        Ok(())
    }

    /// What was measured swings as slowly as what is simulated, and as far: its frames count for fewer where
    /// simulations scatter by more than theirs show, and where its own show less than those of simulations.
    /// (A bed at the edge of surging may be quiet for as long as somebody looks.) The few large beads of a coarse
    /// stand-in scatter more than those of the rig, so that only their slowness counts.
    fn count_frames_anew(&mut self, base: &Emulator) {
        let coarse = self.setup.cast.everyday.coarse.is_some();
        let held_out = self.setup.held_out.as_mut();
        for set in std::iter::once(&mut self.setup.observations).chain(held_out) {
            for (item, n) in set.items.iter().zip(&mut set.n_eff) {
                let simulated = base.variance_of_frame(item.omega_rpm)[item.response.index()];
                let quiet = simulated / (item.sd * item.sd);
                let swings = base.swings(item.omega_rpm);
                *n /= if coarse { swings } else { swings * quiet.max(1.0) };
            }
        }
    }

    /// The nearest point of a grid of half units: runs are made there, so that loops on the same
    /// rig share them.
    pub(crate) fn snap(&self, theta: &[f64]) -> Vec<f64> {
        let each = self.setup.axes.iter().zip(&self.setup.free).zip(theta);
        each.map(|((a, f), x)| {
            let step = GRID * a.unit;
            let t = (a.scale.forth(*x) / step).round() * step;
            a.scale.back(t).clamp(f.range.0, f.range.1)
        })
        .collect()
    }

    /// Box of free parameters about a point, within their ranges.
    fn around(&self, at: &[f64], units: f64) -> (Vec<f64>, Vec<f64>) {
        let side = |sign: f64| {
            let each = self.setup.axes.iter().zip(&self.setup.free).zip(at);
            each.map(|((a, f), x)| {
                let moved = a.scale.back(a.scale.forth(*x) + sign * units * a.unit);
                moved.clamp(f.range.0, f.range.1)
            })
            .collect()
        };
        (side(-1.0), side(1.0))
    }

    fn base_runs(
        &mut self,
        stage: Stage,
        points: &[Vec<f64>],
        first: usize,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<(), CloseLoopError> {
        let mut rigs = Vec::new();
        for (k, point) in points.iter().enumerate() {
            let filling = self.runs.filling(stage, first + k);
            let rig = rig_at(&self.setup.rig, &self.setup.axes, point, filling)?;
            rigs.push((format!("{stage:?} at {point:.3?}"), rig));
        }
        for (run, point) in self.runs.all(stage, &rigs, watch)?.iter().zip(points) {
            if let Some(run) = run {
                self.base.push(sample(point.clone(), run));
            }
        }
        Ok(())
    }

    /// The middle of the free parameters' ranges, from which coordinates count.
    pub(crate) fn middle(&self) -> Vec<f64> {
        let each = self.setup.axes.iter().zip(&self.setup.free);
        each.map(|(a, f)| a.scale.back(0.5 * (a.scale.forth(f.range.0) + a.scale.forth(f.range.1))))
            .collect()
    }

    /// The base model.
    pub(crate) fn base_model(&self) -> Result<Emulator, CalibError> {
        let knots = self.setup.knots.clone();
        let axes = self.setup.axes.clone();
        let point = (!self.theta.is_empty()).then_some(&self.theta[..]);
        let model = Emulator::about(axes, self.middle(), knots, &self.base, point)?;
        Ok(self.dress(model))
    }

    pub(crate) fn dress(&self, model: Emulator) -> Emulator {
        model.with_modes(self.modes.clone()).anchored(&self.wholes)
    }

    fn problem<'m>(&self, base: &'m Emulator) -> Problem<'m> {
        Problem {
            observations: self.setup.observations.clone(),
            simulator: base,
            free: self.setup.free.clone(),
            nuisances: self.setup.nuisances.clone(),
        }
    }

    /// Best free parameters by the base model.
    fn best(&self) -> Result<Vec<f64>, CloseLoopError> {
        let base = self.base_model()?;
        let solved = self.problem(&base).solve(0, 0)?;
        Ok(solved.estimates.iter().map(|e| e.value).collect())
    }

    /// Simulate the whole rig at the present point, and shift its stand-in by what it is off there and
    /// wherever the whole rig has been simulated before.
    fn anchor(&mut self, round: usize, watch: &mut dyn FnMut(&Told)) -> Result<(), CloseLoopError> {
        let each = self.setup.cast.anchors[round];
        if self.setup.cast.whole.is_none() || each == 0 {
            return Ok(());
        }
        let mut rigs = Vec::new();
        for k in 0..each {
            let filling = self.runs.filling(Stage::Full, 8 * round + k);
            let rig = rig_at(&self.setup.rig, &self.setup.axes, &self.theta, filling)?;
            rigs.push((format!("the whole rig at {:.3?}", self.theta), rig));
        }
        for run in self.runs.all(Stage::Full, &rigs, watch)?.iter().flatten() {
            let sample = sample(self.theta.clone(), run);
            self.wholes.push(Whole { names: Vec::new(), sample });
        }
        if self.wholes.is_empty() {
            let first = self.runs.failed.last().map_or_else(String::new, |f| f.1.clone());
            return Err(CloseLoopError::Base { failed: each, asked: each, first });
        }
        self.theta = self.best()?;
        Ok(())
    }

    /// Simulate every effect at the calibrated point, and film it by every other camera.
    fn probe(&mut self, watch: &mut dyn FnMut(&Told)) -> Result<(), CloseLoopError> {
        let known: Vec<Effect> =
            self.setup.simulated.iter().filter_map(|n| self.known(n)).collect();
        let effects: Vec<Effect> = self.setup.catalogue.effects.clone();
        let each = self.effort.probes;
        let tried = effects.iter().filter(|e| is_simulated(e)).map(|e| (e, each));
        // An uncertain known is simulated to both sides.
        let of_known = known.iter().map(|e| (e, each.max(2)));
        let turns = |(e, each)| (0..each).map(move |k| (e, 1 - k % 2, k / 2));
        let wanted: Vec<(&Effect, usize, usize)> = tried.chain(of_known).flat_map(turns).collect();
        self.probes(&wanted, watch)?;
        // Where the stronger one of few could not be simulated, the weaker one says something too.
        let none = |e: &&Effect| !self.effects.contains_key(&e.path);
        let failed = effects.iter().filter(|e| is_simulated(e)).filter(none);
        let weaker: Vec<(&Effect, usize, usize)> = failed.map(|e| (e, 0, 0)).collect();
        if self.effort.probes == 1 && !weaker.is_empty() {
            self.probes(&weaker, watch)?;
        }
        for e in &effects {
            if is_simulated(e) && !self.effects.contains_key(&e.path) {
                let why = "none of its runs came out".to_owned();
                self.setup.catalogue.left_out.push((e.path.clone(), why));
            }
        }
        for e in effects.iter().filter(|e| e.layer == Layer::Camera) {
            if let Some(change) = self.film(e, watch)? {
                self.curves.insert(e.path.clone(), change);
            }
        }
        for e in effects.iter().filter(|e| e.layer == Layer::Measurement) {
            let change = match e.path.as_str() {
                "measure.bias_lin_deg" => Change::Shift(0),
                "measure.bias_mid_deg" => Change::Shift(1),
                "measure.offset_x_pct" => Change::Shift(2),
                "measure.offset_y_pct" => Change::Shift(3),
                "measure.scale" => Change::Divide,
                _ => match self.film(e, watch)? {
                    Some(change) => change,
                    None => continue,
                },
            };
            self.curves.insert(e.path.clone(), change);
        }
        let simulated = self.setup.simulated.clone();
        for (known, (path, mean, sd)) in known.iter().zip(&simulated) {
            self.modes.extend(self.mode(known, path, *mean, *sd)?);
        }
        Ok(())
    }

    /// Simulate effects at the calibrated point: which of their two strengths, and in which filling. The
    /// fillings are the same for every effect: nothing is gained by others.
    fn probes(
        &mut self,
        wanted: &[(&Effect, usize, usize)],
        watch: &mut dyn FnMut(&Told),
    ) -> Result<(), CloseLoopError> {
        let theta = self.snap(&self.theta);
        let mut rigs = Vec::new();
        for (e, which, k) in wanted {
            let filling = self.runs.filling(Stage::Probes, 2 * k + which);
            let (rig, axes) = (&self.setup.rig, &self.setup.axes);
            let strength = e.probes[*which];
            let with = rig_with(rig, axes, &theta, (e, strength), filling)?;
            rigs.push((format!("{} = {strength:.4}", e.path), with));
        }
        let runs = self.runs.all(Stage::Probes, &rigs, watch)?;
        for ((e, which, _), run) in wanted.iter().zip(&runs) {
            let mut at = theta.clone();
            at.push(e.probes[*which]);
            match run {
                Some(run) => {
                    self.effects.entry(e.path.clone()).or_default().push(sample(at, run));
                }
                None => self.lose(std::slice::from_ref(*e), at),
            }
        }
        Ok(())
    }

    /// An uncertain known as an effect that is simulated two standard deviations to either side.
    fn known(&self, (path, mean, sd): &(String, f64, f64)) -> Option<Effect> {
        let p = rig_schema::namespace::find(path)?;
        let inside = |x: f64| x.clamp(p.range.0, p.range.1);
        Some(Effect {
            path: path.clone(),
            layer: Layer::Physics,
            null: *mean,
            probes: [inside(mean - 2.0 * sd), inside(mean + 2.0 * sd)],
            range: p.range,
            scale: Scale::Linear,
            along: Vec::new(),
            needs: crate::catalogue::Needs::Nothing,
            prior: 1.0,
            exposed_by: String::new(),
            meaning: p.meaning.to_owned(),
        })
    }

    /// Change of all responses for one standard deviation of an uncertain known.
    fn mode(
        &self,
        effect: &Effect,
        path: &str,
        mean: f64,
        sd: f64,
    ) -> Result<Option<Vec<[f64; 4]>>, CloseLoopError> {
        let Some(samples) = self.effects.get(path) else { return Ok(None) };
        let at = |s: f64| {
            let mut at = self.theta.clone();
            at.push(s);
            at
        };
        let model = self.effect_model(&self.base_model()?, effect, samples)?;
        let (up, down) = (model.at_knots(&at(mean + sd)), model.at_knots(&at(mean - sd)));
        let half = |(u, d): (&[f64; 4], &[f64; 4])| std::array::from_fn(|r| 0.5 * (u[r] - d[r]));
        Ok(Some(up.iter().zip(&down).map(half).collect()))
    }

    /// Film the motions of the calibrated point again, with a camera effect.
    fn film(
        &mut self,
        effect: &Effect,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Option<Change>, CloseLoopError> {
        let count = self.effort.replicates.min(3);
        let unit = effect.probes[1] - effect.null;
        let strengths = [effect.null, effect.null - unit, effect.null + unit];
        let mut rigs = Vec::new();
        for strength in strengths {
            for k in 0..count {
                let filling = self.runs.filling(Stage::Replicates, k);
                let (rig, axes) = (&self.setup.rig, &self.setup.axes);
                // Where the replicates were made; the best point has moved a little since.
                let at = &self.base[self.base.len() - 1].at.clone();
                rigs.push((
                    format!("{} = {strength:.4}", effect.path),
                    rig_with(rig, axes, at, (effect, strength), filling)?,
                ));
            }
        }
        let runs = self.runs.all(Stage::Filming, &rigs, watch)?;
        let knots = self.setup.knots.len();
        let (mut first, mut second) = (vec![[0.0; 4]; knots], vec![[0.0; 4]; knots]);
        let mut slopes: Vec<Vec<[f64; 4]>> = Vec::new();
        for k in 0..count {
            let [Some(zero), Some(down), Some(up)] =
                [&runs[k], &runs[count + k], &runs[2 * count + k]]
            else {
                continue;
            };
            let mut own = vec![[0.0; 4]; knots];
            for i in 0..knots {
                for r in 0..4 {
                    let (z, d, u) =
                        (zero.speeds[i].mean[r], down.speeds[i].mean[r], up.speeds[i].mean[r]);
                    own[i][r] = 0.5 * (u - d);
                    first[i][r] += own[i][r];
                    second[i][r] += 0.5 * (u + d) - z;
                }
            }
            slopes.push(own);
        }
        if slopes.is_empty() {
            let why = "none of its films could be measured".to_owned();
            self.setup.catalogue.left_out.push((effect.path.clone(), why));
            return Ok(None);
        }
        let n = slopes.len() as f64;
        first.iter_mut().chain(&mut second).flatten().for_each(|v| *v /= n);
        let variance = (0..knots)
            .map(|i| {
                std::array::from_fn(|r| {
                    let spread: f64 = slopes.iter().map(|s| (s[i][r] - first[i][r]).powi(2)).sum();
                    // A film of the same motion is good to a hundredth of a degree.
                    1e-4 + if slopes.len() > 1 { spread / ((n - 1.0) * n) } else { 0.01 }
                })
            })
            .collect();
        Ok(Some(Change::Filmed { unit, first, second, variance }))
    }

    pub(crate) fn effect_axes(&self, effect: &Effect) -> Vec<Axis> {
        let mut axes = self.setup.axes.clone();
        let t = |x: f64| effect.scale.forth(x);
        let unit = (t(effect.probes[1]) - t(effect.null)).abs().max(f64::MIN_POSITIVE);
        axes.push(Axis { path: effect.path.clone(), scale: effect.scale, unit });
        axes
    }

    pub(crate) fn effect_model(
        &self,
        base: &Emulator,
        effect: &Effect,
        samples: &[Sample],
    ) -> Result<Emulator, CalibError> {
        let mut all: Vec<Sample> = self
            .base
            .iter()
            .map(|s| {
                let mut at = s.at.clone();
                at.push(effect.null);
                Sample { at, ..s.clone() }
            })
            .collect();
        all.extend_from_slice(samples);
        let mut origin = self.middle();
        origin.push(effect.null);
        Ok(self.dress(base.of_others(self.effect_axes(effect), origin, &all)?))
    }

    /// Every effect of the catalogue whose model can be made.
    pub(crate) fn models(&self, base: &Emulator) -> Result<Vec<(&Effect, Coded)>, CalibError> {
        let mut models = Vec::new();
        for effect in &self.setup.catalogue.effects {
            let model = if let Some(change) = self.curves.get(&effect.path) {
                Model::Curve(Curve {
                    base: base.clone(),
                    name: effect.path.clone(),
                    null: effect.null,
                    change: change.clone(),
                })
            } else if let Some(samples) = self.effects.get(&effect.path) {
                Model::Runs(self.effect_model(base, effect, samples)?)
            } else {
                continue;
            };
            models.push((effect, Coded::new(&[effect], model)));
        }
        Ok(models)
    }

    /// The question which effect the data call for.
    pub(crate) fn question<'m>(
        &self,
        base: &'m Emulator,
        models: &'m [(&Effect, Coded)],
        pairs: &'m [([String; 2], Coded)],
        settings: &Settings,
    ) -> Attribution<'m> {
        let pair_models = pairs
            .iter()
            .map(|(names, model)| PairModel { names: names.clone(), simulator: model })
            .collect();
        let candidates = models
            .iter()
            .map(|(effect, model)| Candidate {
                name: effect.path.clone(),
                simulator: model,
                null: 0.0,
                range: model.range(effect.range),
                strength_sd: effect.strength_sd().map(|sd| model.change(sd)),
                layer: effect.layer,
                prior: effect.prior,
                exposed_by: effect.exposed_by.clone(),
                meaning: effect.meaning.clone(),
            })
            .collect();
        Attribution {
            base: self.problem(base),
            candidates,
            pair_models,
            code_covariance: self.setup.codes.clone(),
            held_out: self.setup.held_out.clone(),
            experiments: Vec::new(),
            settings: settings.clone(),
        }
    }

    /// Ask which effect the data call for.
    fn attribute(&self, settings: &Settings) -> Result<Finding, CloseLoopError> {
        let base = self.base_model()?;
        let models = self.models(&base)?;
        let pairs = self.pair_models(&base)?;
        let mut finding = self.question(&base, &models, &pairs, settings).attribute()?;
        decode(&mut finding, &models);
        Ok(finding)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use calib::Simulator as _;

    /// One knot; responses fall by 10 a unit of the logarithm of friction.
    fn run(at: f64, up: f64) -> Sample {
        let noise = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * 1e-4));
        Sample {
            at: vec![at],
            mean: vec![std::array::from_fn(|r| 20.0 + 10.0 * at.ln() + r as f64 + up)],
            covariance: vec![noise],
            variance: vec![[1.5e-3; 4]],
        }
    }

    #[test]
    fn a_stand_in_is_shifted_by_its_difference_where_the_whole_was_run() {
        let axes = vec![Axis { path: "friction.pp".to_owned(), scale: Scale::Log, unit: 0.35 }];
        let stand_ins: Vec<Sample> = (0..9).map(|k| run(0.2 + 0.05 * f64::from(k), 0.0)).collect();
        let model = Emulator::fit(axes, vec![0.4], vec![20.0], &stand_ins).unwrap();
        // Two places, 1.5 and 2.5 above the stand-in there.
        let whole = |names: &[&str], sample: Sample| Whole {
            names: names.iter().map(|n| (*n).to_owned()).collect(),
            sample,
        };
        // A run with an effect that this model does not have tells it nothing.
        let mut other = run(0.3, 9.0);
        other.at.push(1.0);
        let wholes =
            [whole(&[], run(0.25, 1.5)), whole(&[], run(0.5, 2.5)), whole(&["a.b"], other)];
        let shifted = model.clone().anchored(&wholes);
        let own = |m: &Emulator, x: f64| m.at_knots(&[x])[0][0];
        // Half-way between them their mean; at one of them the other, two units away, counts a fortieth.
        let by = |x: f64| own(&shifted, x) - own(&model, x);
        assert!((by((0.25f64 * 0.5).sqrt()) - 2.0).abs() < 0.05, "{}", by(0.354));
        assert!((by(0.25) - 1.52).abs() < 0.05, "{}", by(0.25));
        let variance = |m: &Emulator, x: f64| m.predict(&[x], &[20.0]).unwrap().covariance(0, 0);
        // Away from both a shift is unsure by a quarter for each unit.
        let unsure = variance(&shifted, 0.2) - variance(&model, 0.2);
        let units = (0.25f64 / 0.2).ln() / 0.35;
        assert!((unsure.sqrt() - 0.25 * units * by(0.2)).abs() < 0.03, "{unsure}");
        let at_one = variance(&shifted, 0.5) - variance(&model, 0.5);
        assert!(at_one < 0.2 * unsure, "{at_one} {unsure}");
    }
}
