//! What to measure next: what would tell apart the effects that an answer leaves together.
//!
//! Three experiments are weighed by the information that they are expected to give between the members of a class
//! ([`calib::attribution::Experiment`]). Two need no run: the drum is emptied and filled again and photographed as
//! often as before; or that is done with the drum turned the other way, which mirrors what the bed does but not what the camera does. For the
//! third, half as much in the drum, every member is simulated about its fitted values.
//! What codes differ by is left out: whatever it is, the present data have it too.

use calib::attribution::{Experiment, Settings};
use calib::{CalibError, Observations, OperatingPoint, Predicted, Simulator};
use rig_schema::{Amount, Load, Rig};

use crate::catalogue::Effect;
use crate::coded::{Coded, Model};
use crate::confirm::CONFIRMED_MEMBERS;
use crate::curve::{Change, Curve};
use crate::driver::{CloseLoop, Stage, State, Told};
use crate::emulator::{Axis, Emulator, Sample};
use crate::error::CloseLoopError;
use crate::outcome::Outcome;
use crate::runs::{rig_at, rig_with, sample};
use crate::scale::Scale;

/// Effects that act to the other side where the drum turns the other way and pictures are mirrored: they are the
/// camera's and the reader's, not the bed's.
const TO_THE_OTHER_SIDE: [&str; 3] = ["camera.roll_deg", "camera.yaw_deg", "measure.offset_x_pct"];

/// How far from the fitted values members are simulated, units.
const STEP: f64 = 0.5;

/// How the experiment is called that needs runs, with the amount after it.
pub const HALF_AS_MUCH: &str = "half as much in the drum";

/// The load that is tried, as a part of the present one.
const HALF: f64 = 0.5;

/// A model of an effect in an experiment that it sees to the other side.
struct Mirrored<'m>(&'m Coded);

impl Mirrored<'_> {
    fn of(theta: &[f64]) -> Vec<f64> {
        let mut all = theta.to_vec();
        all.last_mut().into_iter().for_each(|v| *v = -*v);
        all
    }
}

impl Simulator for Mirrored<'_> {
    fn parameters(&self) -> Vec<String> {
        self.0.parameters()
    }

    fn speed_range_rpm(&self) -> (f64, f64) {
        self.0.speed_range_rpm()
    }

    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        self.0.predict(&Self::of(theta), at)
    }

    fn expected(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Vec<f64>, CalibError> {
        self.0.expected(&Self::of(theta), at)
    }
}

/// A member of a class: its effect, and its fitted values, the strength last.
struct Member {
    effect: Effect,
    at: Vec<f64>,
}

impl CloseLoop<'_> {
    /// Weigh what would tell the members of a class apart: it is written into the finding of the outcome.
    pub(crate) fn next(
        &self,
        state: &mut State<'_>,
        mut outcome: Outcome,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Outcome, CloseLoopError> {
        let several = matches!(outcome.finding.verdict, calib::attribution::Verdict::Class(_));
        if !several || outcome.members.len() < 2 {
            return Ok(outcome);
        }
        let all = outcome.members.iter().take(CONFIRMED_MEMBERS);
        let members: Vec<Member> = all
            .filter_map(|name| {
                let r = outcome.finding.ranked.iter().find(|r| r.name == *name)?;
                Some(Member { effect: state.effect(name)?.clone(), at: r.fit.theta.clone() })
            })
            .collect();
        let half = self.half(state, &members, watch)?;
        let base = state.base_model()?;
        let models = state.models(&base)?;
        let settings = Settings { stability_bootstrap: 0, ..self.settings.attribution.clone() };
        let mut question = state.question(&base, &models, &[], &settings);
        let own = |m: &Member| models.iter().find(|(e, _)| e.path == m.effect.path).map(|m| &m.1);
        let named = |m: &Member| m.effect.path.clone();
        let again = members.iter().filter_map(|m| Some((named(m), own(m)? as &dyn Simulator)));
        let again: Vec<(String, &dyn Simulator)> = again.collect();
        let mirrored: Vec<Option<Mirrored<'_>>> =
            members.iter().map(|m| own(m).filter(|_| turns(&m.effect)).map(Mirrored)).collect();
        let sd = of_means(&state.setup.observations);
        let experiment = |name: &str, points: &[OperatingPoint], sd, simulators| Experiment {
            name: name.to_owned(),
            points: points.to_vec(),
            sd,
            nuisances: state.setup.nuisances.clone(),
            simulators,
        };
        let knots = &state.setup.knots;
        question.experiments.push(experiment(
            "the same once more: empty the drum, fill it, take as many photographs",
            knots,
            sd,
            again.clone(),
        ));
        if mirrored.iter().any(Option::is_some) {
            let other = again.iter().zip(&mirrored);
            let other = other.map(|((name, own), mirrored)| {
                let turned = mirrored.as_ref().map(|m| m as &dyn Simulator);
                (name.clone(), turned.unwrap_or(*own))
            });
            question.experiments.push(experiment(
                "the drum turned the other way, as many photographs, read as mirrored pictures",
                knots,
                sd,
                other.collect(),
            ));
        }
        if let Some(half) = &half {
            let simulators = half.models.iter().map(|(n, m)| (n.clone(), m as &dyn Simulator));
            question.experiments.push(experiment(
                &half.name,
                &half.points,
                half.sd,
                simulators.collect(),
            ));
        }
        outcome.finding.next = question.attribute()?.next;
        (outcome.runs, outcome.cost_s) = (state.runs.made, state.runs.cost_s);
        Ok(outcome)
    }

    /// Members of a class with half as much in the drum, about their fitted values; nothing where the case has a second load
    /// already, where it is not asked for, and where there is no time.
    fn half(
        &self,
        state: &mut State<'_>,
        members: &[Member],
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Option<Half>, CloseLoopError> {
        let one = state.setup.loads.len() == 1;
        let (path, amount) = state.setup.loads[0].fill;
        let load = match path {
            "fill.count" => Amount::Count((HALF * amount).round()),
            _ => Amount::MassKg(HALF * amount),
        };
        let load = Load { responses: String::new(), fill: load, n_eff: None, fillings: None };
        if !(one && self.settings.next) || load.fill.setting().1 <= 0.0 {
            return Ok(None);
        }
        let mut asked = Vec::new();
        for (which, m) in members.iter().enumerate() {
            let mut axes = state.effect_axes(&m.effect);
            // What is known exactly is not simulated.
            axes.truncate(axes.len() - usize::from(state.exact(&m.effect).is_some()));
            for at in star(&axes, &state.ranges(&m.effect), &m.at) {
                let rig = load.of(&self.rig_of(state, m, &at, asked.len())?);
                asked.push((which, at, rig));
            }
        }
        if !state.affords(asked.len()) {
            return Ok(None);
        }
        let rigs: Vec<(String, Rig)> = asked
            .iter()
            .map(|(which, _, rig)| {
                (format!("{HALF_AS_MUCH}, {}", members[*which].effect.path), rig.clone())
            })
            .collect();
        let runs = state.runs.all(Stage::Next, &rigs, watch)?;
        let mut samples: Vec<Vec<Sample>> = vec![Vec::new(); members.len()];
        for ((which, at, _), run) in asked.into_iter().zip(&runs) {
            if let Some(run) = run {
                samples[which].push(sample(at, run));
            }
        }
        let points = state.setup.knots.clone();
        let mut models = Vec::new();
        for (m, own) in members.iter().zip(&samples).filter(|(_, own)| own.len() > 1) {
            let axes = state.effect_axes(&m.effect);
            let model = match state.exact(&m.effect) {
                // What the runs showed is the drum without it.
                Some(change) => {
                    let free = axes.len() - 1;
                    let cut = |s: &Sample| Sample { at: s.at[..free].to_vec(), ..s.clone() };
                    let own: Vec<Sample> = own.iter().map(cut).collect();
                    let (axes, origin) = (axes[..free].to_vec(), m.at[..free].to_vec());
                    let base = Emulator::fit(axes, origin, points.clone(), &own)?;
                    let (name, null) = (m.effect.path.clone(), m.effect.null);
                    Model::Curve(Curve { base, name, null, change })
                }
                None => Model::Runs(Emulator::fit(axes, m.at.clone(), points.clone(), own)?),
            };
            models.push((m.effect.path.clone(), Coded::new(&[&m.effect], model)));
        }
        let frames: Vec<&Sample> = samples.iter().flatten().collect();
        let observations = &state.setup.observations;
        let sd = of_frames(&frames, mean_of(&observations.n_eff), of_means(observations));
        let name = format!("{HALF_AS_MUCH} ({path} = {})", load.fill.setting().1);
        Ok(Some(Half { name, points, sd, models }))
    }

    /// The rig of a member at values; of what changes no motion and is known exactly, the rig without it.
    fn rig_of(
        &self,
        state: &State<'_>,
        m: &Member,
        at: &[f64],
        nth: usize,
    ) -> Result<Rig, CloseLoopError> {
        let (rig, axes) = (&state.setup.rig, &state.setup.axes);
        let filling = state.runs.filling(Stage::Next, nth);
        match at.split_last() {
            Some((strength, theta)) if state.exact(&m.effect).is_none() => {
                rig_with(rig, axes, theta, (&m.effect, *strength), filling)
            }
            _ => rig_at(rig, axes, at, filling),
        }
    }
}

/// Half as much in the drum.
struct Half {
    name: String,
    points: Vec<OperatingPoint>,
    sd: [Option<f64>; 4],
    models: Vec<(String, Coded)>,
}

impl State<'_> {
    /// What an effect does that is known exactly.
    fn exact(&self, effect: &Effect) -> Option<Change> {
        let change = self.curves.get(&effect.path)?;
        (!matches!(change, Change::Filmed(_))).then(|| change.clone())
    }

    /// Ranges of the free parameters and of an effect.
    fn ranges(&self, effect: &Effect) -> Vec<(f64, f64)> {
        self.setup.free.iter().map(|f| f.range).chain([effect.range]).collect()
    }
}

/// Whether an effect acts to the other side where the drum turns the other way.
fn turns(effect: &Effect) -> bool {
    let evenly = effect.scale == Scale::Linear && effect.null == 0.0;
    evenly && TO_THE_OTHER_SIDE.contains(&effect.path.as_str())
}

/// The fitted values twice, and a step to either side along every axis, within its range.
fn star(axes: &[Axis], ranges: &[(f64, f64)], at: &[f64]) -> Vec<Vec<f64>> {
    let mut all = vec![at.to_vec(); 2];
    for (k, (axis, range)) in axes.iter().zip(ranges).enumerate() {
        for side in [-STEP, STEP] {
            let moved = axis.scale.back(axis.scale.forth(at[k]) + side * axis.unit);
            let mut there = at.to_vec();
            there[k] = moved.clamp(range.0, range.1);
            if there[k] != at[k] {
                all.push(there);
            }
        }
    }
    all
}

fn mean_of(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Standard deviation of a measured mean of each response, over all speeds; none of what was not measured.
fn of_means(observations: &Observations) -> [Option<f64>; 4] {
    std::array::from_fn(|r| {
        let own = observations.items.iter().enumerate();
        let own = own.filter(|(_, o)| o.response.index() == r);
        let all: Vec<f64> = own.map(|(i, _)| observations.covariance(i, i)).collect();
        (!all.is_empty()).then(|| mean_of(&all).sqrt())
    })
}

/// The same of so many simulated frames, of the responses that are measured.
fn of_frames(samples: &[&Sample], frames: f64, measured: [Option<f64>; 4]) -> [Option<f64>; 4] {
    std::array::from_fn(|r| {
        measured[r]?;
        let all: Vec<f64> =
            samples.iter().flat_map(|s| s.variance.iter().map(|four| four[r])).collect();
        Some((mean_of(&all) / frames.max(1.0)).sqrt()).filter(|sd| *sd > 0.0)
    })
}
