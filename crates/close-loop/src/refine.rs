//! Which effect is simulated next, and where: at the best point of the one that may explain the data best,
//! as long as nobody knows what it does there.

use calib::CalibError;
use calib::attribution::{Settings, at_the_end};

use crate::catalogue::Effect;
use crate::coded::Model;
use crate::driver::{GRID, Stage, State, Told};
use crate::emulator::Sample;
use crate::error::CloseLoopError;
use crate::runs::{rig_with_all, sample};

/// Runs between two looks at the models: two, so that two cores are busy, whatever the number of workers.
const BATCH: usize = 2;

/// Variance of a model over that of one run from its frames below which runs have said what they can:
/// about two runs at the point.
pub(crate) const KNOWN: f64 = 0.6;

/// Runs near a point that are enough in any case, and how near, coded units.
pub(crate) const ENOUGH: (usize, f64) = (3, 0.5);

/// Deviance by which an effect must be better than the base to be simulated.
const WORTH: f64 = 4.0;

/// What is to be run: effects, and the free parameters followed by their strengths.
pub(crate) struct Asked {
    pub(crate) effects: Vec<Effect>,
    pub(crate) at: Vec<f64>,
}

impl State<'_> {
    /// Simulate effects at their best points, the most promising first, with at most `most` runs.
    pub(crate) fn refine(
        &mut self,
        most: usize,
        settings: &Settings,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<(), CloseLoopError> {
        self.look(most, 0, watch, |state, count| state.doubtful(count, settings))
    }

    /// Run what `ask` asks for, [`BATCH`] at a time, until it asks for nothing more or `most` runs are made.
    /// Fillings of an effect are numbered from `first`.
    pub(crate) fn look(
        &mut self,
        most: usize,
        first: usize,
        watch: &mut dyn FnMut(&Told),
        ask: impl Fn(&Self, usize) -> Result<Vec<Asked>, CalibError>,
    ) -> Result<(), CloseLoopError> {
        let free = self.setup.free.len();
        let mut left = most;
        while left > 0 {
            let asked = ask(self, BATCH.min(left))?;
            if asked.is_empty() {
                break;
            }
            left -= asked.len();
            let mut rigs = Vec::new();
            for one in &asked {
                let (theta, strengths) = one.at.split_at(free);
                let effects: Vec<(Effect, f64)> =
                    one.effects.iter().cloned().zip(strengths.iter().copied()).collect();
                let number = first + self.seen(&one.effects).len();
                let filling = self.runs.filling(Stage::Refine, number);
                let (rig, axes) = (&self.setup.rig, &self.setup.axes);
                rigs.push(rig_with_all(rig, axes, theta, &effects, filling)?);
            }
            let runs = self.runs.all(Stage::Refine, &rigs, watch)?;
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
                    // Which of two goes too far is not known: the first one is held back.
                    (None, [a, ..]) => self.shorten(&a.path, one.at.get(free).copied()),
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

    /// Best points of the effects that may explain the data best and of which too little is known there.
    fn doubtful(&self, count: usize, settings: &Settings) -> Result<Vec<Asked>, CalibError> {
        let base = self.base_model()?;
        let models = self.models(&base)?;
        let fits = self.question(&base, &models, &[], settings).fits()?;
        let Some((without, fits)) = fits.split_first() else { return Ok(Vec::new()) };
        let mut order: Vec<usize> = (0..fits.len()).collect();
        order.sort_by(|a, b| fits[*a].deviance.total_cmp(&fits[*b].deviance));
        let mut limit = without.deviance - WORTH;
        let mut points = Vec::new();
        for k in order {
            let (fit, (effect, coded)) = (&fits[k], &models[k]);
            if points.len() == count || fit.deviance > limit {
                break;
            }
            let at = coded.decoded(&fit.theta);
            let open = match &coded.inner {
                Model::Runs(model) => {
                    let near = |s: &&Sample| model.apart(&s.at, &at) < ENOUGH.1;
                    let own = self.effects.get(&effect.path).map_or(&[][..], |s| &s[..]);
                    model.doubt(&at) > KNOWN && own.iter().filter(near).count() < ENOUGH.0
                }
                Model::Curve(_) => {
                    // A reading at the end of its range stands for something else.
                    let (low, high) = coded.range(effect.range);
                    if fit.theta.last().is_some_and(|v| at_the_end((v - low) / (high - low))) {
                        continue;
                    }
                    false
                }
            };
            if open {
                let at = self.on_grid(effect, &at);
                points.push(Asked { effects: vec![(*effect).clone()], at });
            } else if fit.p > settings.level {
                // Only what may be as good as this is worth a run.
                limit = limit.min(fit.deviance + 2.0 * settings.class_ratio.ln());
            }
        }
        Ok(points)
    }

    /// The nearest point of a grid, so that loops on the same rig share runs.
    fn on_grid(&self, effect: &Effect, at: &[f64]) -> Vec<f64> {
        let Some((strength, theta)) = at.split_last() else { return Vec::new() };
        let mut point = self.snap(theta);
        let axes = self.effect_axes(effect);
        let axis = &axes[axes.len() - 1];
        let origin = axis.scale.forth(effect.null);
        let v = ((axis.scale.forth(*strength) - origin) / axis.unit / GRID).round() * GRID;
        let value = axis.scale.back(origin + v * axis.unit);
        point.push(value.clamp(effect.range.0, effect.range.1));
        point
    }

    /// End an effect's range before a strength at which its drum could not be simulated.
    pub(crate) fn shorten(&mut self, path: &str, failed: Option<f64>) {
        let Some(failed) = failed else { return };
        let known = self.effects.get(path).into_iter().flatten().filter_map(|s| s.at.last());
        let known: Vec<f64> = known.copied().collect();
        let Some(effect) = self.setup.catalogue.effects.iter_mut().find(|e| e.path == path) else {
            return;
        };
        let (null, up) = (effect.null, failed > effect.null);
        let inside = known.iter().copied().filter(|s| (*s > null) == up && (*s < failed) == up);
        let last = inside.fold(null, |a, b| if up { a.max(b) } else { a.min(b) });
        if up {
            effect.range.1 = last;
        } else {
            effect.range.0 = last;
        }
        let why = format!("not beyond {last:.4}: its drum cannot be simulated at {failed:.4}");
        let narrow = effect.range.1 <= effect.range.0;
        self.setup.catalogue.left_out.push((path.to_owned(), why));
        if narrow {
            self.effects.remove(path);
        }
    }
}
