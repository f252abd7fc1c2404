//! The stages of closing a loop.

use std::collections::BTreeMap;

use calib::attribution::{Finding, Layer, Settings, Verdict};
use campaign::Laboratory;
use rig_schema::{Case, Load, MeasuredTable, Rig};

use crate::anchors::Whole;
use crate::catalogue::Effect;
use crate::confirm::{self, CONFIRMED_MEMBERS, Fresh};
use crate::curve::Change;
use crate::emulator::Sample;
use crate::error::CloseLoopError;
use crate::fillings;
use crate::outcome::Outcome;
use crate::outlook::{LUCK, MORE_LUCK};
use crate::plan::{Effort, LoopSettings, Measured, Setup};
use crate::runs::{ByEffect, Runs, loads};
use crate::stand_in::StandIn;

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
    /// What would tell the members of a class apart.
    Next,
    /// Drums that are said to be seen by a finding of nothing. (It stands last since fillings are numbered by stages.)
    Prove,
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
    /// The rig of every planned run, or what stands in for it, with each of its loads.
    pub rigs: Vec<Rig>,
    /// What a stand-in is shifted to agree with, and how many runs of it are made beside those of the plan.
    pub whole: Option<(Vec<Rig>, usize)>,
}

/// A loop to be closed.
#[derive(Debug, Clone, Copy)]
pub struct CloseLoop<'a> {
    /// Rig, free parameters, nuisances, held-out speeds.
    pub case: &'a Case,
    /// What was measured with the rig's own load.
    pub measured: &'a MeasuredTable,
    /// What was measured with the case's other loads, one table for each.
    pub loads: &'a [MeasuredTable],
    /// Where simulations are made and kept.
    pub lab: &'a Laboratory,
    /// Runs and statistics.
    pub settings: &'a LoopSettings,
}

/// Probability of the gate by first runs above which nothing more is looked for. What friction absorbs best leaves
/// little at the calibrated point and is far from it, where nobody has looked yet.
const OPEN: f64 = 0.5;

/// Probability of the fresh runs of an answer below which it is asked again with them: a right name may have a
/// strength that they know better.
const BARELY: f64 = 0.05;

/// How often a question is asked again with the fresh runs of its answer.
const RETRIES: usize = 5;

/// Fresh runs after all others.
pub(crate) const LAST_ROUND: usize = RETRIES + 2;

/// The same where every fresh run is of a rig whose cost a stand-in had to save.
const FEW_RETRIES: usize = 3;

/// Spacing of the points at which runs are made, coded units.
pub(crate) const GRID: f64 = 0.5;

/// Everything known so far.
pub(crate) struct State<'a> {
    pub(crate) setup: Setup,
    pub(crate) effort: Effort,
    /// Runs that may be made.
    pub(crate) most: usize,
    /// Time that runs may take, s.
    time_s: Option<f64>,
    /// Whether something was left out for want of time.
    pub(crate) cut_short: bool,
    /// By how much chi-square may fall short at places that nobody has looked at.
    pub(crate) luck: f64,
    /// Answers that fresh runs refuted.
    pub(crate) refuted: usize,
    pub(crate) runs: Runs<'a>,
    pub(crate) base: Vec<Sample>,
    pub(crate) effects: ByEffect,
    /// Runs of two effects together.
    pub(crate) pairs: BTreeMap<[String; 2], Vec<Sample>>,
    /// Points at which a drum with these effects could not be simulated.
    pub(crate) lost: BTreeMap<Vec<String>, Vec<Vec<f64>>>,
    pub(crate) curves: BTreeMap<String, Change>,
    pub(crate) theta: Vec<f64>,
    /// Runs of the whole rig that its stand-in is compared with.
    pub(crate) wholes: Vec<Whole>,
    pub(crate) modes: Vec<Vec<[f64; 4]>>,
    /// The base model by fresh runs, which every answer is compared with.
    pub(crate) before: Option<Fresh>,
    /// Whether the data are taken to differ from any simulation by what codes differ by.
    pub(crate) codes_differ: bool,
}

impl<'a> State<'a> {
    /// Nothing known yet; at most so many runs may be made, in such a time.
    pub(crate) fn new(
        setup: Setup,
        effort: Effort,
        (most, time_s): (usize, Option<f64>),
        runs: Runs<'a>,
    ) -> Self {
        let codes_differ = setup.codes.is_some() && !setup.codes_may_agree;
        Self {
            codes_differ,
            setup,
            effort,
            most,
            time_s,
            cut_short: false,
            luck: LUCK,
            refuted: 0,
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
        }
    }

    /// An effect of the catalogue, with the range that it has by now.
    pub(crate) fn effect(&self, path: &str) -> Option<&Effect> {
        self.setup.catalogue.effects.iter().find(|e| e.path == path)
    }

    /// Time left, s, if so many models are to be confirmed after it; none without a limit.
    fn time_left(&self, models: usize) -> Option<f64> {
        let costly = self.setup.cast.fresh.is_some();
        let fresh = self.runs.clock.time_of(costly, models * self.fillings());
        Some(self.time_s? - self.runs.clock.spent_s - fresh)
    }

    /// Whether there is time for more, if so many models are to be confirmed after it; it is noted if there is not.
    pub(crate) fn has_time(&mut self, models: usize) -> bool {
        let has = self.time_left(models).is_none_or(|left| left > 0.0);
        self.cut_short |= !has;
        has
    }

    /// Whether there is time for so many more runs.
    pub(crate) fn affords(&self, runs: usize) -> bool {
        self.time_left(0).is_none_or(|left| left >= self.runs.clock.time_of(false, runs))
    }

    /// Runs that can be spent on refining if so many models are to be confirmed after it.
    fn spare(&mut self, models: usize) -> usize {
        let by_number = self.most.saturating_sub(self.runs.everyday + models * self.effort.confirm);
        let by_time = self.time_left(models).map_or(usize::MAX, |s| self.runs.clock.runs_in(s));
        self.cut_short |= by_time < by_number;
        by_number.min(by_time)
    }
}

impl<'a> CloseLoop<'a> {
    /// What was measured, load by load, the rig's own first.
    pub(crate) fn tables(&self) -> impl Iterator<Item = Measured<'a>> {
        let data = &self.case.data;
        let given = |path| self.case.rig.settings.given(path).map(|amount| (path, amount));
        let fill = given("fill.count").or(given("fill.mass_kg")).unwrap_or(("fill.count", 0.0));
        let (n_eff, fillings, table) = (data.n_eff, data.fillings, self.measured);
        let other = |(load, table): (&Load, &'a MeasuredTable)| {
            let (fill, n_eff) = (load.fill.setting(), load.n_eff);
            Measured { fill, n_eff, fillings: load.fillings, table }
        };
        let others: Vec<Measured<'a>> = data.loads.iter().zip(self.loads).map(other).collect();
        std::iter::once(Measured { fill, n_eff, fillings, table }).chain(others)
    }
}

impl CloseLoop<'_> {
    /// Runs at the middle of the free ranges, to see what they cost.
    ///
    /// # Errors
    /// Those of a case that cannot be simulated.
    pub fn pilot(&self) -> Result<Pilot, CloseLoopError> {
        let setup = Setup::new(self)?;
        let middle = setup.middle()?;
        let all = loads(&middle, &setup.further);
        let cast = |by: StandIn| all.iter().map(|own| by.of(own)).collect::<Result<Vec<Rig>, _>>();
        let rigs = cast(setup.cast.everyday)?;
        let runs = setup.cast.whole_runs();
        let whole = setup.cast.whole.map(cast).transpose()?;
        Ok(Pilot { rigs, whole: whole.map(|w| (w, runs)) })
    }

    /// Runs of the plan, at most.
    ///
    /// # Errors
    /// As [`CloseLoop::pilot`]; [`CloseLoopError::Budget`] for too few runs.
    pub fn planned(&self) -> Result<usize, CloseLoopError> {
        let setup = Setup::new(self)?;
        let effects = simulated_effects(&setup);
        Ok(setup.effort(self.settings.runs, effects)?.total(effects))
    }

    /// Close the loop. What is simulated is kept in the laboratory: a second call goes through the
    /// same stages with what is there and gives the same figures.
    ///
    /// # Errors
    /// [`CloseLoopError`]; single runs that fail are in [`Outcome::failed`].
    pub fn run(&self, watch: &mut dyn FnMut(&Told)) -> Result<Outcome, CloseLoopError> {
        let (mut state, finding) = self.stages(watch)?;
        let outcome = self.answer(&mut state, finding, watch)?;
        let outcome = self.or_most(&mut state, outcome, watch)?;
        self.next(&mut state, outcome, watch)
    }

    /// From what the models say to an answer that fresh runs bear out, or to none.
    fn answer(
        &self,
        state: &mut State<'_>,
        mut finding: Finding,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Outcome, CloseLoopError> {
        // Fresh runs are of a rig whose cost a stand-in had to save.
        let costly = state.setup.cast.fresh.is_some();
        if finding.verdict != Verdict::None && costly {
            finding = self.ask_the_whole_rig(state, &finding, watch)?;
            if finding.verdict != Verdict::None {
                finding = self.hear_rivals(state, &finding, watch)?;
            }
        }
        let retries = if costly { FEW_RETRIES } else { RETRIES };
        let mut round = 0;
        let mut looked_on = false;
        // The answer that fresh runs had not refuted before.
        let mut stood: Option<Outcome> = None;
        loop {
            let (outcome, learned) = confirm::outcome(self, state, finding, round, watch)?;
            // Fresh runs that refute an answer are the best that its model can learn from; those of a class tell its
            // members apart, where they cost no more than others.
            let refuted = outcome.confirmed == Some(false);
            let several = matches!(outcome.finding.verdict, Verdict::Class(_));
            // An alarm that fresh runs of the calibrated model do not bear out may be its surface's.
            let level = self.settings.attribution.level;
            let alarm = !outcome.members.is_empty() && outcome.before.errors.p_all > level;
            // An answer that fresh runs bear out only just has a strength that they know better.
            let stands = outcome.confirmed == Some(true);
            let barely = stands && outcome.after.errors.p_all < BARELY;
            let open = several && outcome.members.len() > 1 || alarm || barely;
            let open = open && !costly;
            let spare = state.spare(1 + if refuted { 2 } else { CONFIRMED_MEMBERS });
            let learns = learned.iter().any(|l| state.can_learn(l));
            let tired = round == retries || spare == 0;
            if !(refuted || open) || tired || !learns {
                // What was kept for answers that are refuted looks on where nobody has looked, once.
                // Of what nothing explains there is no class to be confirmed, at most a pair.
                let unknown = matches!(outcome.finding.verdict, Verdict::Unknown);
                let models = 1 + if unknown { 1 } else { CONFIRMED_MEMBERS };
                let left = state.spare(models);
                let gate = &outcome.finding.gate;
                let settled = gate.passes && gate.p_combined > OPEN;
                if looked_on || left == 0 || settled || costly {
                    return Ok(standing(outcome, stood));
                }
                looked_on = true;
                state.luck = MORE_LUCK;
                state.learn(learned);
                let before = state.runs.everyday;
                state.refine(left, &self.settings.attribution, watch)?;
                if unknown {
                    let left = state.spare(models);
                    state.refine_pairs(left, &self.settings.attribution, watch)?;
                }
                if state.runs.everyday == before {
                    return Ok(standing(outcome, stood));
                }
                if stands {
                    stood = Some(outcome);
                }
                round += 1;
                finding = state.attribute(&self.settings.attribution)?;
                continue;
            }
            if barely {
                stood = Some(outcome);
            }
            state.learn(learned);
            state.learn_base()?;
            state.refuted += usize::from(refuted);
            round += 1;
            finding = self.sharpen(state, (2, 2), &self.settings.attribution, watch)?;
        }
    }

    /// Simulate what little is known of, single effects and then, where none will do, pairs, and ask again.
    /// Runs are kept back for so many models to be confirmed after either.
    pub(crate) fn sharpen(
        &self,
        state: &mut State<'_>,
        (singles, pairs): (usize, usize),
        settings: &Settings,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Finding, CloseLoopError> {
        // What is left after this is for answers that fresh runs refute: those are what models learn most from.
        let part = |spare: usize| spare.div_ceil(2);
        let spare = part(state.spare(singles));
        state.refine(spare, settings, watch)?;
        let mut finding = state.attribute(&self.settings.attribution)?;
        let fits = |f: &Finding| !matches!(f.verdict, Verdict::Pairs(_) | Verdict::Unknown);
        for _ in 0..fillings::PLACES {
            let spare = part(state.spare(singles));
            if fits(&finding) || !state.refill(&finding, spare, watch)? {
                break;
            }
            let spare = part(state.spare(singles));
            state.refine(spare, settings, watch)?;
            finding = state.attribute(&self.settings.attribution)?;
        }
        let spare = part(state.spare(pairs));
        if spare == 0 || fits(&finding) {
            return Ok(finding);
        }
        state.refine_pairs(spare, settings, watch)?;
        state.attribute(&self.settings.attribution)
    }

    /// Everything but the fresh runs.
    fn stages(&self, watch: &mut dyn FnMut(&Told)) -> Result<(State<'_>, Finding), CloseLoopError> {
        let setup = Setup::new(self)?;
        let effects = simulated_effects(&setup);
        let effort = setup.effort(self.settings.runs, effects)?;
        let most = self.settings.runs.unwrap_or_else(|| effort.total(effects));
        let runs = Runs::new(self.lab, (setup.cast, setup.further.clone()), self.settings.seed);
        let mut state = State::new(setup, effort, (most, self.settings.time_s), runs);
        state.calibrate(watch)?;
        state.probe(watch)?;
        let quick = Settings {
            bootstrap: self.settings.attribution.bootstrap.min(199),
            stability_bootstrap: 0,
            ..self.settings.attribution.clone()
        };
        let first = state.attribute(&quick)?;
        let finding = if first.gate.passes && first.gate.p_combined > OPEN {
            state.attribute(&self.settings.attribution)?
        } else {
            self.sharpen(&mut state, (4, 3), &quick, watch)?
        };
        let spare = if finding.verdict == Verdict::None { state.spare(2) } else { 0 };
        let finding = state.prove(finding, spare, &self.settings.attribution, watch)?;
        Ok((state, finding))
    }
}

/// The last answer, or where fresh runs refuted it the one that stood before.
fn standing(outcome: Outcome, stood: Option<Outcome>) -> Outcome {
    let (runs, cost_s) = (outcome.runs, outcome.cost_s);
    let kept = stood.filter(|_| outcome.confirmed == Some(false));
    kept.map_or(outcome, |o| Outcome { runs, cost_s, ..o })
}

/// Effects that need simulations of their own; an uncertain known takes two.
fn simulated_effects(setup: &Setup) -> usize {
    setup.catalogue.effects.iter().filter(|e| is_simulated(e)).count() + 2 * setup.simulated.len()
}

pub(crate) fn is_simulated(effect: &Effect) -> bool {
    matches!(effect.layer, Layer::Physics | Layer::Code)
}
