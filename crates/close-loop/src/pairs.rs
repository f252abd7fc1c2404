//! Two effects together: simulated where what is known of either alone does not keep them from explaining the data.

use calib::CalibError;
use calib::attribution::{PairPlace, Settings};

use crate::anchors::Whole;
use crate::catalogue::Effect;
use crate::coded::{Coded, Model};
use crate::confirm::Learned;
use crate::driver::{Stage, State, Told, is_simulated};
use crate::emulator::{Emulator, Sample};
use crate::error::CloseLoopError;
use crate::outlook::{LUCK, TURN, doubted};
use crate::refine::{Asked, ENOUGH, TOLD};

/// Pairs of either kind that are looked into.
const SHORT: usize = 16;

/// Of these, pairs that are looked into at several places whatever their first runs say.
const LEARNT: usize = 6;

/// At how many.
const LEAST: usize = 3;

/// Parts of the range of a friction at which the strengths of pairs are fitted: the truth often lies far along a valley of
/// frictions, where surfaces that know little do not expect it.
const FRICTIONS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];

impl State<'_> {
    /// Models of the pairs that were simulated, by their names.
    pub(crate) fn pair_models(
        &self,
        base: &Emulator,
    ) -> Result<Vec<([String; 2], Coded)>, CalibError> {
        let seen: Vec<[String; 2]> = self.pairs.keys().cloned().collect();
        self.pair_models_of(base, &seen)
    }

    /// Models of pairs, whether or not anybody has run both effects together; none of a reading or a camera.
    fn pair_models_of(
        &self,
        base: &Emulator,
        pairs: &[[String; 2]],
    ) -> Result<Vec<([String; 2], Coded)>, CalibError> {
        let mut models = Vec::new();
        for names in pairs {
            if let Some([a, b]) = self.both(names)
                && [a, b].into_iter().all(is_simulated)
            {
                let own = self.pairs.get(names).map_or(&[][..], |s| &s[..]);
                let model = self.pair_model(base, [a, b], own)?;
                models.push((names.clone(), Coded::new(&[a, b], Model::Runs(model))));
            }
        }
        Ok(models)
    }

    fn both(&self, names: &[String; 2]) -> Option<[&Effect; 2]> {
        Some([self.effect(&names[0])?, self.effect(&names[1])?])
    }

    /// A surface over the free parameters and both strengths, from the runs of the base, of each effect
    /// alone, and of both.
    fn pair_model(
        &self,
        base: &Emulator,
        [a, b]: [&Effect; 2],
        own: &[Sample],
    ) -> Result<Emulator, CalibError> {
        let with = |s: &Sample, more: &[f64]| {
            let at = s.at.iter().chain(more).copied().collect();
            Sample { at, ..s.clone() }
        };
        let mut all: Vec<Sample> = self.base.iter().map(|s| with(s, &[a.null, b.null])).collect();
        all.extend(self.effects.get(&a.path).into_iter().flatten().map(|s| with(s, &[b.null])));
        for s in self.effects.get(&b.path).into_iter().flatten() {
            let mut at = s.at.clone();
            at.insert(at.len() - 1, a.null);
            all.push(Sample { at, ..s.clone() });
        }
        all.extend_from_slice(own);
        let mut axes = self.effect_axes(a);
        axes.extend(self.effect_axes(b).pop());
        let mut origin = self.middle();
        origin.extend([a.null, b.null]);
        Ok(self.dress(base.of_others(axes, origin, &all)?))
    }

    /// Simulate pairs at their best points, the most promising first, with at most `most` runs.
    pub(crate) fn refine_pairs(
        &mut self,
        most: usize,
        settings: &Settings,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<(), CloseLoopError> {
        let short = self.short_list(settings)?;
        self.look(Stage::Refine, most, watch, |state, count| {
            state.doubtful_pairs(&short, count, settings)
        })
    }

    /// Pairs that may explain the data, by what is known of each effect alone. Of two effects that are simulated nobody
    /// knows what they do together: their model says how little, so that they are listed by the least chi-square
    /// with most of that forgiven. A reading or a camera adds to an effect what it does without it.
    fn short_list(&self, settings: &Settings) -> Result<Vec<[String; 2]>, CalibError> {
        let base = self.base_model()?;
        let models = self.models(&base)?;
        let names: Vec<&Effect> = models.iter().map(|(e, _)| *e).collect();
        let (mut simulated, mut others) = (Vec::new(), Vec::new());
        for (k, a) in names.iter().enumerate() {
            for b in &names[k + 1..] {
                let both = [a.path.clone(), b.path.clone()];
                let of_runs = is_simulated(a) && is_simulated(b);
                if of_runs { simulated.push(both) } else { others.push(both) }
            }
        }
        let together = self.pair_models_of(&base, &simulated)?;
        let question = self.question(&base, &models, &together, settings);
        let mut short = Vec::new();
        let (without, mut places) = question.pair_places(&simulated, &[])?;
        places.retain(|p| p.trial.chi2 < without.chi2);
        places.sort_by(|a, b| doubted(&a.trial).total_cmp(&doubted(&b.trial)));
        short.extend(places.into_iter().take(SHORT).map(|p| p.names));
        let (_, added) = question.pair_places(&others, &[])?;
        let added = added.into_iter().filter(|p| p.eligible);
        short.extend(added.take(SHORT).map(|p| p.names));
        Ok(short)
    }

    /// Best points of the pairs that may explain the data and of which too little is known there, those that promise most
    /// for the runs that they have had.
    fn doubtful_pairs(
        &self,
        short: &[[String; 2]],
        count: usize,
        settings: &Settings,
    ) -> Result<Vec<Asked>, CalibError> {
        let base = self.base_model()?;
        let models = self.models(&base)?;
        let pairs = self.pair_models_of(&base, short)?;
        let question = self.question(&base, &models, &pairs, settings);
        let (without, mut places) = question.pair_places(short, &FRICTIONS)?;
        // Only what may be as good as something known that fits is worth a run.
        let mut limit = f64::INFINITY;
        for best in places.iter().filter(|p| p.eligible) {
            if self.asked(&base, &models, (&best.names, &best.theta), TOLD)?.is_none() {
                limit = limit.min(best.trial.deviance + settings.class_deviance());
            }
        }
        let sure = without.deviance - without.chi2;
        places.retain(|p| {
            p.trial.chi2 < without.chi2 && p.trial.chi2 + p.trial.penalty + sure <= limit + LUCK
        });
        let turn = |p: &PairPlace| doubted(&p.trial) + TURN * self.made(&p.names) as f64;
        places.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
        // A surface of both is learnt from runs of both: the first ones go to unlike places of the best pairs in turn.
        let new = |p: &&PairPlace| {
            short.iter().take(LEARNT).any(|s| *s == p.names) && self.made(&p.names) < LEAST
        };
        let mut first: Vec<&PairPlace> = places.iter().filter(new).collect();
        first.sort_by_key(|p| self.made(&p.names));
        let all: Vec<&PairPlace> = places.iter().collect();
        for (places, enough) in [(first, ENOUGH[0]), (all.clone(), TOLD), (all, ENOUGH[2])] {
            let mut points: Vec<Asked> = Vec::new();
            let mut taken: Vec<&[String; 2]> = Vec::new();
            for place in places {
                if points.len() == count {
                    break;
                }
                if taken.contains(&&place.names) {
                    continue;
                }
                let at = (&place.names, &place.theta[..]);
                if let Some(asked) = self.asked(&base, &models, at, enough)? {
                    points.push(asked);
                    taken.push(&place.names);
                }
            }
            if !points.is_empty() {
                return Ok(points);
            }
        }
        Ok(Vec::new())
    }

    /// Runs of a pair that were made or failed.
    fn made(&self, names: &[String; 2]) -> usize {
        let lost = self.lost.get(&names[..]).map_or(0, Vec::len);
        self.pairs.get(names).map_or(0, Vec::len) + lost
    }

    /// The run that would tell most of a pair at its best point; `None` if it is known there, or has been told by
    /// as many runs as are enough.
    fn asked(
        &self,
        base: &Emulator,
        models: &[(&Effect, Coded)],
        (names, theta): (&[String; 2], &[f64]),
        enough: usize,
    ) -> Result<Option<Asked>, CalibError> {
        let Some([a, b]) = self.both(names) else { return Ok(None) };
        let coded = |e: &Effect| models.iter().find(|(m, _)| m.path == e.path).map(|(_, c)| c);
        let (theta, strengths) = theta.split_at(self.setup.free.len());
        // Readings and cameras add to what an effect does; the effect itself must be known there.
        let simulated: Vec<(&Effect, f64)> = [a, b]
            .into_iter()
            .zip(strengths)
            .filter(|(e, _)| is_simulated(e))
            .filter_map(|(e, v)| Some((e, coded(e)?.strength(*v))))
            .collect();
        let at: Vec<f64> = theta.iter().copied().chain(simulated.iter().map(|(_, s)| *s)).collect();
        let effects: Vec<Effect> = simulated.iter().map(|(e, _)| (*e).clone()).collect();
        let own = self.seen(&effects);
        let model = match simulated[..] {
            [(e, _)] => self.effect_model(base, e, own)?,
            [(e, _), (f, _)] => self.pair_model(base, [e, f], own)?,
            _ => return Ok(None),
        };
        let known = self.settled(&effects, &model, &at, enough);
        Ok((!known).then_some(Asked { effects, at }))
    }

    /// Whether a model is made of simulations and can take more.
    pub(crate) fn can_learn(&self, (names, samples): &Learned) -> bool {
        match &names[..] {
            [name] => self.effects.contains_key(name),
            // Their runs, the fresh ones that refute them too, are what a model of both is first made of.
            [a, b] => {
                let both = self.both(&[a.clone(), b.clone()]);
                !samples.is_empty() && both.is_some_and(|e| e.into_iter().all(is_simulated))
            }
            _ => false,
        }
    }

    /// Take the fresh runs of the calibrated model into it: what seems to be missing may be its own error. It is shown by
    /// others from then on.
    pub(crate) fn learn_base(&mut self) -> Result<(), CloseLoopError> {
        if self.setup.cast.whole.is_some() {
            return Ok(());
        }
        if let Some(before) = self.before.take() {
            self.base.extend(before.samples);
            self.theta = self.best()?;
        }
        Ok(())
    }

    /// Take fresh runs into the models of their effects: as runs, or as what tells by how much a stand-in is off.
    pub(crate) fn learn(&mut self, learned: Vec<Learned>) {
        for (names, samples) in learned {
            let learns = self.can_learn(&(names.clone(), samples.clone()));
            if self.setup.cast.whole.is_some() {
                let whole = |sample| Whole { names: names.clone(), sample };
                self.wholes.extend(samples.into_iter().map(whole));
                continue;
            }
            let known = match &names[..] {
                [name] => self.effects.get_mut(name),
                [a, b] if learns => Some(self.pairs.entry([a.clone(), b.clone()]).or_default()),
                _ => None,
            };
            if let Some(known) = known {
                known.extend(samples);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use campaign::{Laboratory, Sampling};

    use super::*;
    use crate::fixture::{FRICTIONS, nothing_known, run};

    const ROW: &str = "30,1,31,1,10,0.5,15,0.5,20";

    #[test]
    fn what_two_effects_do_together_is_unknown_until_somebody_has_run_both() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
        let mut state = nothing_known(&lab, "", ROW);
        let run = |friction: f64, strengths: &[f64], more: f64| {
            let lin = 30.0 + 6.0 * (friction / 0.5).ln() + more;
            run(friction, strengths, [lin, lin + 1.0, 10.0, 15.0])
        };
        state.base = FRICTIONS.iter().map(|f| run(*f, &[], 0.0)).collect();
        let [a, b, camera] = ["cohesion.energy_density_j_m3", "speed.scale", "camera.roll_deg"];
        let does = |s: f64| s / 1000.0;
        let cohesive = [2000.0, 4000.0, 6000.0].map(|s| run(0.5, &[s], does(s)));
        let fast = [1.1, 1.2, 1.3].map(|s| run(0.5, &[s], 10.0 * (s - 1.0)));
        state.effects.insert(a.to_owned(), cohesive.to_vec());
        state.effects.insert(b.to_owned(), fast.to_vec());
        let base = state.base_model().unwrap();
        let names = [a, b].map(str::to_owned);
        let asked = [names.clone(), [a, camera].map(str::to_owned)];
        let models = |state: &State<'_>| state.pair_models_of(&base, &asked).unwrap();
        let unknown = |state: &State<'_>, at: &[f64]| {
            let models = models(state);
            let Model::Runs(model) = &models[0].1.inner else { panic!("no surface") };
            let local = model.moments(at);
            (local.at[0].0[0], local.unknown[0][0])
        };
        // A camera needs no runs of both.
        assert_eq!(models(&state).len(), 1);
        assert!(state.pair_models(&base).unwrap().is_empty());
        let (_, alone) = unknown(&state, &[0.5, 6000.0, 1.0]);
        let (_, both) = unknown(&state, &[0.5, 6000.0, 1.3]);
        assert!(alone < 0.2 && both > 4.0 * alone, "{alone} {both}");
        // They do less together than they add up to: 7 deg, not 9.
        state.pairs.insert(names, vec![run(0.5, &[6000.0, 1.3], 7.0)]);
        let (mean, seen) = unknown(&state, &[0.5, 6000.0, 1.3]);
        assert!((mean - 37.0).abs() < 0.5 && seen < 0.3 * both, "{mean} {seen}");
        assert_eq!(state.pair_models(&base).unwrap().len(), 1);
    }

    #[test]
    fn fresh_runs_that_refute_a_pair_are_what_its_model_is_first_made_of() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
        let mut state = nothing_known(&lab, "", ROW);
        let physics = ["cohesion.energy_density_j_m3", "speed.scale"].map(str::to_owned);
        let reading = ["cohesion.energy_density_j_m3", "camera.roll_deg"].map(str::to_owned);
        let run = run(0.5, &[6000.0, 1.2], [30.0, 31.0, 10.0, 15.0]);
        // Nothing to learn from a drum that failed, nor of a reading, which no particles show.
        for (names, own) in [(&physics, vec![]), (&reading, vec![run.clone()])] {
            let learned = (names.to_vec(), own);
            assert!(!state.can_learn(&learned), "{names:?}");
            state.learn(vec![learned]);
            assert!(state.pairs.is_empty(), "{names:?}");
        }
        let learned = (physics.to_vec(), vec![run; 3]);
        assert!(state.can_learn(&learned));
        state.learn(vec![learned.clone(), learned]);
        assert_eq!(state.pairs[&physics].len(), 6);
    }
}
