//! Which effect is simulated next, and where: where it may explain the data, as long as nobody knows what it
//! does there.

use calib::CalibError;
use calib::attribution::Settings;

use crate::catalogue::Effect;
use crate::driver::{GRID, Stage, State, Told};
use crate::emulator::{Emulator, Sample};
use crate::error::CloseLoopError;
use crate::outlook::{Outlook, Place};
use crate::runs::{rig_with_all, sample};

/// Runs between two looks at the models: two, so that two cores are busy, whatever the number of workers.
const BATCH: usize = 2;

/// Variance of a model over that of what was measured below which runs have said what they can: about two runs at the
/// point for each filling that was measured.
const KNOWN: f64 = 0.6;

/// Runs near a point that are enough, of which the last two are for each filling that was measured: as long as nothing was
/// run near other points, as long as others are open, and in any case. Where a valley leads is learnt from other places of it, not from more fillings of one.
pub(crate) const ENOUGH: [usize; 3] = [1, 3, 6];

/// Runs near a point of which it can be said what is there.
pub(crate) const TOLD: usize = ENOUGH[1];

/// The order in which places are looked at: runs near each that are enough, and whether those come too that explain the data
/// better than friction alone and still do not fit ([`FORLORN`]). What may be right is told before the valleys of what is hardly
/// right are followed: once something fits, most of those need no look at all.
const LOOKS: [(usize, bool); 5] = [
    (ENOUGH[0], false),
    (ENOUGH[1], false),
    (ENOUGH[0], true),
    (ENOUGH[1], true),
    (ENOUGH[2], true),
];

/// How near, coded units.
pub(crate) const NEAR: f64 = 0.5;

/// Least distance of two points of an effect that are run together, coded units.
const APART: f64 = 0.9;

/// Probability of a fit, with what its model does not know, below which runs are better spent elsewhere.
pub(crate) const FORLORN: f64 = 1e-6;

/// What is to be run: effects, and the free parameters followed by their strengths.
pub(crate) struct Asked {
    pub(crate) effects: Vec<Effect>,
    pub(crate) at: Vec<f64>,
}

impl State<'_> {
    /// Simulate effects where they may explain the data, the most promising first, with at most `most` runs.
    pub(crate) fn refine(
        &mut self,
        most: usize,
        settings: &Settings,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<(), CloseLoopError> {
        self.look(Stage::Refine, most, watch, |state, count| state.doubtful(count, settings))
    }

    /// Run what `ask` asks for, [`BATCH`] at a time, until it asks for nothing more or `most` runs are made.
    pub(crate) fn look(
        &mut self,
        stage: Stage,
        most: usize,
        watch: &mut dyn FnMut(&Told),
        ask: impl Fn(&Self, usize) -> Result<Vec<Asked>, CalibError>,
    ) -> Result<(), CloseLoopError> {
        let free = self.setup.free.len();
        let mut left = most;
        while left > 0 && self.has_time(2) {
            let asked = ask(self, BATCH.min(left))?;
            if asked.is_empty() {
                break;
            }
            left -= asked.len();
            let mut rigs = Vec::new();
            for (k, one) in asked.iter().enumerate() {
                let (theta, strengths) = one.at.split_at(free);
                let effects: Vec<(Effect, f64)> =
                    one.effects.iter().cloned().zip(strengths.iter().copied()).collect();
                let made = self.seen(&one.effects).iter().map(|s| &s.at);
                // Two that are asked for at once are two fillings.
                let beside = asked[..k].iter().filter(|a| paths(&a.effects) == paths(&one.effects));
                let before = made.chain(self.lost(&one.effects)).chain(beside.map(|a| &a.at));
                let earlier = before.filter(|at| **at == one.at).count();
                let filling = self.runs.filling_at(&one.effects, &one.at, earlier);
                let (rig, axes) = (&self.setup.rig, &self.setup.axes);
                rigs.push(rig_with_all(rig, axes, theta, &effects, filling)?);
            }
            let runs = self.runs.all(stage, &rigs, watch)?;
            for (one, run) in asked.into_iter().zip(&runs) {
                match (run, &one.effects[..]) {
                    (Some(run), [a]) => {
                        let own = sample(one.at, run);
                        self.effects.entry(a.path.clone()).or_default().push(own);
                    }
                    (Some(run), [a, b]) => {
                        let names = [a.path.clone(), b.path.clone()];
                        self.pairs.entry(names).or_default().push(sample(one.at, run));
                    }
                    (None, effects) => self.lose(effects, one.at),
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Runs of an effect alone, or of two together.
    pub(crate) fn seen(&self, effects: &[Effect]) -> &[Sample] {
        let own = match effects {
            [a] => self.effects.get(&a.path),
            [a, b] => self.pairs.get(&[a.path.clone(), b.path.clone()]),
            _ => None,
        };
        own.map_or(&[], |s| &s[..])
    }

    /// Remember a point at which a drum could not be simulated. One may be a matter of its friction; the
    /// second ends the effect's range.
    pub(crate) fn lose(&mut self, effects: &[Effect], at: Vec<f64>) {
        let strength = at.last().copied();
        let lost = self.lost.entry(paths(effects)).or_default();
        lost.push(at);
        if let (true, [one], Some(strength)) = (lost.len() > 1, effects, strength) {
            self.shorten(&one.path, strength, false);
        }
    }

    /// Points at which a drum with these effects could not be simulated.
    pub(crate) fn lost(&self, effects: &[Effect]) -> &[Vec<f64>] {
        self.lost.get(&paths(effects)).map_or(&[], |l| &l[..])
    }

    /// Whether runs have said at a point what they can: enough of them, a model that is sure, or a drum that
    /// cannot be simulated there.
    pub(crate) fn settled(
        &self,
        effects: &[Effect],
        model: &Emulator,
        at: &[f64],
        enough: usize,
    ) -> bool {
        let near = |x: &[f64]| model.apart(x, at) < NEAR;
        let made = self.seen(effects).iter().filter(|s| near(&s.at)).count();
        // What is measured well is told apart only by surfaces that are known as well.
        let fillings = if enough > ENOUGH[0] { self.setup.most_fillings() } else { 1 };
        let known = model.doubt(at) <= KNOWN || made >= enough * fillings;
        known || self.lost(effects).iter().any(|x| near(x))
    }

    /// Points at which effects may explain the data best and at which too little is known of them, in turn with those
    /// at which an effect would have to be if it were what is missing; then where more would tell.
    fn doubtful(&self, count: usize, settings: &Settings) -> Result<Vec<Asked>, CalibError> {
        let base = self.base_model()?;
        let models = self.models(&base)?;
        let Outlook { places, far } = self.outlook(&base, &models, settings)?;
        for (k, (enough, forlorn)) in LOOKS.into_iter().enumerate() {
            let mut points: Vec<Asked> = Vec::new();
            let open = |p: &&Place<'_>| {
                (forlorn || !p.is_forlorn())
                    && !self.settled(std::slice::from_ref(p.effect), p.model, &p.at, enough)
            };
            let mut near = places.iter().filter(open);
            // Nobody has run anything near these: they have their turn as long as that is asked for.
            let mut away = far.iter().filter(|_| k == 0);
            while points.len() < count {
                let both = [near.next(), away.next()];
                if both.iter().all(Option::is_none) {
                    break;
                }
                for place in both.into_iter().flatten() {
                    let at = self.on_grid(place.effect, &place.at);
                    let beside = |a: &Asked| {
                        a.effects[0].path == place.effect.path
                            && place.model.apart(&a.at, &at) < APART
                    };
                    if points.len() < count && !points.iter().any(beside) {
                        points.push(Asked { effects: vec![place.effect.clone()], at });
                    }
                }
            }
            if !points.is_empty() {
                return Ok(points);
            }
        }
        Ok(Vec::new())
    }

    /// The nearest point of a grid, so that loops on the same rig share runs; one with the effect, not without.
    pub(crate) fn on_grid(&self, effect: &Effect, at: &[f64]) -> Vec<f64> {
        let Some((strength, theta)) = at.split_last() else { return Vec::new() };
        let mut point = self.snap(theta);
        let axes = self.effect_axes(effect);
        let axis = &axes[axes.len() - 1];
        let origin = axis.scale.forth(effect.null);
        let off = (axis.scale.forth(*strength) - origin) / axis.unit / GRID;
        let steps = if off.abs() < 0.5 { off.signum() } else { off.round() };
        let v = steps * GRID;
        let value = axis.scale.back(origin + v * axis.unit);
        point.push(value.clamp(effect.range.0, effect.range.1));
        point
    }

    /// End an effect's range where its drum cannot be simulated any more ([`end`]).
    pub(crate) fn shorten(&mut self, path: &str, failed: f64, sure: bool) {
        let known = self.effects.get(path).into_iter().flatten().filter_map(|s| s.at.last());
        let known: Vec<f64> = known.copied().collect();
        let Some(effect) = self.setup.catalogue.effects.iter_mut().find(|e| e.path == path) else {
            return;
        };
        let Some(end) = end(effect, &known, failed, sure) else { return };
        if failed > effect.null {
            effect.range.1 = effect.range.1.min(end);
        } else {
            effect.range.0 = effect.range.0.max(end);
        }
        let why = format!("not beyond {end:.4}: its drum cannot be simulated at {failed:.4}");
        self.setup.catalogue.left_out.push((path.to_owned(), why));
    }
}

fn paths(effects: &[Effect]) -> Vec<String> {
    effects.iter().map(|e| e.path.clone()).collect()
}

/// Middle between a strength at which a drum could not be simulated and the next one that is `known`; none,
/// unless it is `sure`, if others came out that are as strong.
fn end(effect: &Effect, known: &[f64], failed: f64, sure: bool) -> Option<f64> {
    let (null, up) = (effect.null, failed > effect.null);
    let weaker = |s: f64| if up { s < failed } else { s > failed };
    let same_side = |s: &&f64| **s == null || (**s > null) == up;
    let same = || known.iter().filter(same_side).copied();
    if !sure && same().any(|s| !weaker(s)) {
        return None;
    }
    let last =
        same().filter(|s| weaker(*s)).fold(null, |a, b| if up { a.max(b) } else { a.min(b) });
    Some(effect.scale.half_way(last, failed))
}

#[cfg(test)]
mod tests {
    use campaign::{Laboratory, Sampling};

    use super::*;
    use crate::fixture::{FRICTIONS, nothing_known, run};
    use crate::scale::Scale;

    #[test]
    fn one_drum_that_fails_does_not_forbid_what_others_have_shown() {
        let effect = |null: f64, range: (f64, f64), scale: Scale| Effect {
            null,
            range,
            scale,
            ..Effect::bare("a.b")
        };
        let cohesion = effect(0.0, (0.0, 4e4), Scale::Linear);
        let known = [2000.0, 8000.0, 12_000.0];
        assert_eq!(end(&cohesion, &known, 12_000.0, false), None);
        assert_eq!(end(&cohesion, &known, 12_000.0, true), Some(10_000.0));
        assert_eq!(end(&cohesion, &known, 20_000.0, false), Some(16_000.0));
        assert_eq!(end(&cohesion, &[], 20_000.0, false), Some(10_000.0));
        let stiffness = effect(1.0, (0.1, 10.0), Scale::Log);
        let low = end(&stiffness, &[3.0], 0.25, false);
        assert!(low.is_some_and(|l| (l - 0.5).abs() < 1e-12), "{low:?}");
    }

    #[test]
    fn what_may_be_right_is_told_before_the_valley_of_what_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
        let only = r#"[catalogue]
only = ["cohesion.energy_density_j_m3", "speed.scale"]"#;
        let mut state = nothing_known(&lab, only, "36,0.3,34,0.3,10,0.1,15,0.1,20");
        // Friction steepens both lines; cohesion the whole line alone, as was measured; a wrong speed does something else.
        let run = |friction: f64, strengths: &[f64], (more, across): (f64, f64)| {
            let lin = 34.0 + 6.0 * (friction / 0.5).ln();
            run(friction, strengths, [lin + more, lin, 10.0 + across, 15.0])
        };
        state.base = FRICTIONS.iter().map(|f| run(*f, &[], (0.0, 0.0))).collect();
        state.theta = vec![0.5];
        let does = |path: &str, s: f64| match path {
            "speed.scale" => (s - 1.0, 4.0 * (s - 1.0)),
            _ => (s / 2000.0, 0.0),
        };
        for (path, strengths) in
            [("cohesion.energy_density_j_m3", [2000.0, 4000.0]), ("speed.scale", [1.1, 1.2])]
        {
            let own = strengths.map(|s| run(0.5, &[s], does(path, s)));
            state.effects.insert(path.to_owned(), own.to_vec());
        }
        let mut looks = Vec::new();
        loop {
            let asked = state.doubtful(2, &Settings::default()).unwrap();
            if asked.is_empty() || looks.len() > 20 {
                break;
            }
            for Asked { effects, at } in asked {
                let path = &effects[0].path;
                let own = run(at[0], &at[1..], does(path, at[1]));
                state.effects.entry(path.clone()).or_default().push(own);
                looks.push((path.clone(), at));
            }
        }
        // Once cohesion of 4000 J/m3 is told, which fits, no strong cohesion at a low friction is worth a run.
        let (path, at) = looks.last().unwrap();
        assert!(path.starts_with("cohesion") && (at[1] / 4000.0 - 1.0).abs() < 0.25, "{looks:?}");
        assert!(looks.len() < 8, "{looks:?}");
    }
}
