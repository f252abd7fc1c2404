//! Which effect is simulated next, and where: at the best point of the one that may explain the data best,
//! as long as nobody knows what it does there.

use calib::CalibError;
use calib::attribution::{NEAR_END, Settings};

use crate::catalogue::Effect;
use crate::coded::Model;
use crate::driver::{GRID, Stage, State, Told};
use crate::error::CloseLoopError;
use crate::runs::{rig_with, sample};

/// Runs between two looks at the models: two, so that two cores are busy, whatever the number of workers.
pub(crate) const BATCH: usize = 2;

/// Variance of a model over that of one run from its frames below which runs have said what they can:
/// about two runs at the point.
pub(crate) const KNOWN: f64 = 0.6;

/// Runs near a point that are enough in any case, and how near, coded units.
pub(crate) const ENOUGH: (usize, f64) = (3, 0.5);

/// Deviance by which an effect must be better than the base to be simulated.
const WORTH: f64 = 4.0;

impl State<'_> {
    /// Simulate effects at their best points, the most promising first, with at most `most` runs.
    pub(crate) fn refine(
        &mut self,
        most: usize,
        settings: &Settings,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<(), CloseLoopError> {
        let mut left = most;
        while left > 0 {
            let points = self.doubtful(BATCH.min(left), settings)?;
            if points.is_empty() {
                break;
            }
            left -= points.len();
            let mut rigs = Vec::new();
            for (effect, at) in &points {
                let Some((strength, theta)) = at.split_last() else { continue };
                let number = self.effects.get(&effect.path).map_or(0, Vec::len);
                let filling = self.runs.filling(Stage::Refine, number);
                let (rig, axes) = (&self.setup.rig, &self.setup.axes);
                let with = rig_with(rig, axes, theta, (effect, *strength), filling)?;
                rigs.push((format!("{} = {strength:.4}", effect.path), with));
            }
            let runs = self.runs.all(Stage::Refine, &rigs, watch)?;
            for ((effect, at), run) in points.into_iter().zip(&runs) {
                match run {
                    Some(run) => {
                        let own = sample(at, run);
                        self.effects.entry(effect.path).or_default().push(own);
                    }
                    None => self.shorten(&effect.path, at.last().copied()),
                }
            }
        }
        Ok(())
    }

    /// Best points of the effects that may explain the data best and of which too little is known there.
    fn doubtful(
        &self,
        count: usize,
        settings: &Settings,
    ) -> Result<Vec<(Effect, Vec<f64>)>, CalibError> {
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
                    let near = |s: &&crate::Sample| model.apart(&s.at, &at) < ENOUGH.1;
                    let own = self.effects.get(&effect.path).map_or(&[][..], |s| &s[..]);
                    model.doubt(&at) > KNOWN && own.iter().filter(near).count() < ENOUGH.0
                }
                Model::Curve(_) => {
                    // A reading at the end of its range stands for something else.
                    let (low, high) = coded.range(effect.range);
                    let v = fit.theta.last().map_or(0.0, |v| (v - low) / (high - low));
                    if !(NEAR_END..=1.0 - NEAR_END).contains(&v) {
                        continue;
                    }
                    false
                }
            };
            if open {
                points.push(((*effect).clone(), self.on_grid(effect, &at)));
            } else if fit.p > settings.level {
                // Only what may be as good as this is worth a run.
                limit = limit.min(fit.deviance + 2.0 * settings.class_ratio.ln());
            }
        }
        Ok(points)
    }

    /// The nearest point of a grid, so that loops on the same rig share runs.
    pub(crate) fn on_grid(&self, effect: &Effect, at: &[f64]) -> Vec<f64> {
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
