//! Where effects may explain the data: places along their valleys, and those that nobody has looked at.

use calib::CalibError;
use calib::attribution::{Settings, Trial, at_the_end};

use crate::catalogue::Effect;
use crate::coded::{Coded, Model};
use crate::driver::State;
use crate::emulator::Emulator;
use crate::refine::{FORLORN, TOLD};

/// Intervals of a strength's range at whose ends it is tried.
const STRENGTHS: usize = 24;

/// Deviance by which an effect must be better than the base to be simulated.
const WORTH: f64 = 4.0;

/// Part of what ignorance costs a place that counts against it where an effect is surveyed: little, since friction leads
/// data along the valley of an effect and not anywhere, so that a far end of it is more probable than its deviance says.
const DOUBTED: f64 = 0.2;

/// By how much less chi-square an effect has to promise for every run that it has had, to be surveyed before another.
pub(crate) const TURN: f64 = 3.0;

/// By how much chi-square may fall short of what is expected of a place about which little is known: some
/// two standard deviations of twenty data.
pub(crate) const LUCK: f64 = 12.0;

/// The same where runs are left once an answer stands. Friction and effect may do more together than any run has told: rolling
/// resistance of 0.06 raises a bed of friction 0.3 by 5 deg, where its runs at 0.5 said 2.5 to 3.5.
pub(crate) const MORE_LUCK: f64 = 40.0;

/// A point of one effect.
pub(crate) struct Place<'m> {
    pub(crate) effect: &'m Effect,
    pub(crate) model: &'m Emulator,
    pub(crate) at: Vec<f64>,
    trial: Trial,
}

impl Place<'_> {
    /// Whether runs are better spent elsewhere: it does not fit, ignorance included.
    pub(crate) fn is_forlorn(&self) -> bool {
        self.trial.p <= FORLORN
    }
}

/// Where runs may go.
pub(crate) struct Outlook<'m> {
    /// Places that may explain the data, best deviance first.
    pub(crate) places: Vec<Place<'m>>,
    /// One place of each effect at most that nobody has looked at.
    pub(crate) far: Vec<Place<'m>>,
}

impl State<'_> {
    /// Where effects that are simulated may explain the data as well as any that is known to: their optima,
    /// and the best strength at each of a number of frictions, since what is known least is often the far
    /// end of a valley. Those that fit with what their models do not know come first, the most probable first: the
    /// deviance counts what is unknown at a place.
    ///
    /// Beside them, for each effect, where it has to be if it is what is missing: of the points that nobody has run anything
    /// near the one of least chi-square, ignorance included ([`doubted`]). First come those that promise most for the
    /// runs that their effects have had.
    pub(crate) fn outlook<'m>(
        &self,
        base: &Emulator,
        models: &'m [(&'m Effect, Coded)],
        settings: &Settings,
    ) -> Result<Outlook<'m>, CalibError> {
        let question = self.question(base, models, &[], settings);
        let (without, optima) = question.fits()?;
        let mut limit = without.deviance - WORTH;
        // Only what may be as good as something known that fits is worth a run.
        for (own, (effect, coded)) in optima.iter().zip(models) {
            for fit in own.iter().filter(|f| f.p > settings.level) {
                let at = coded.decoded(&fit.theta);
                let stands = match &coded.inner {
                    Model::Runs(model) => {
                        self.settled(std::slice::from_ref(*effect), model, &at, TOLD)
                    }
                    // A reading at the end of its range stands for something else.
                    Model::Curve(_) => {
                        let (low, high) = coded.range(effect.range);
                        let part = fit.theta.last().map(|v| (v - low) / (high - low));
                        part.is_some_and(|p| !at_the_end(p))
                    }
                };
                if stands {
                    limit = limit.min(fit.deviance + settings.rival_deviance());
                }
            }
        }
        let sure = without.deviance - without.chi2;
        let frictions = self.frictions();
        let mut places = Vec::new();
        let mut far = Vec::new();
        for (k, (own, (effect, coded))) in optima.iter().zip(models).enumerate() {
            let Model::Runs(model) = &coded.inner else { continue };
            let (low, high) = coded.range(effect.range);
            let mut thetas: Vec<Vec<f64>> = own.iter().map(|f| f.theta.clone()).collect();
            let first = thetas.len();
            for friction in &frictions {
                for s in 0..=STRENGTHS {
                    let v = low + (high - low) * s as f64 / STRENGTHS as f64;
                    thetas.push(friction.iter().copied().chain([v]).collect());
                }
            }
            let trials = question.trials(k, &thetas)?;
            let better = |a: &&(Vec<f64>, Trial), b: &&(Vec<f64>, Trial)| {
                a.1.deviance.total_cmp(&b.1.deviance)
            };
            let all: Vec<(Vec<f64>, Trial)> = thetas.into_iter().zip(trials).collect();
            let along = all[first..].chunks(STRENGTHS + 1).filter_map(|c| c.iter().min_by(better));
            let place = |(theta, trial): &(Vec<f64>, Trial)| Place {
                effect,
                model,
                at: coded.decoded(theta),
                trial: *trial,
            };
            let worth = |(_, t): &&(Vec<f64>, Trial)| hope(t, sure).min(t.deviance) <= limit;
            places.extend(all[..first].iter().chain(along).filter(worth).map(place));
            let promises =
                |(_, t): &&(Vec<f64>, Trial)| t.p > FORLORN && hope(t, sure) <= limit + self.luck;
            let mut hopeful: Vec<&(Vec<f64>, Trial)> = all.iter().filter(promises).collect();
            hopeful.sort_by(|a, b| doubted(&a.1).total_cmp(&doubted(&b.1)));
            let unseen =
                |p: &Place<'_>| !self.settled(std::slice::from_ref(*effect), model, &p.at, 1);
            far.extend(hopeful.into_iter().map(place).find(unseen));
        }
        places.sort_by(|a, b| {
            a.is_forlorn().cmp(&b.is_forlorn()).then(a.trial.deviance.total_cmp(&b.trial.deviance))
        });
        let turn = |p: &Place<'_>| {
            let own = std::slice::from_ref(p.effect);
            doubted(&p.trial) + TURN * (self.seen(own).len() + self.lost(own).len()) as f64
        };
        far.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
        Ok(Outlook { places, far })
    }

    /// Values of the free parameters, equally spaced in their coordinates, in all combinations.
    fn frictions(&self) -> Vec<Vec<f64>> {
        let each = match self.setup.free.len() {
            0 | 1 => 11,
            2 => 6,
            _ => 4,
        };
        let mut all = vec![Vec::new()];
        for (axis, free) in self.setup.axes.iter().zip(&self.setup.free) {
            let (low, high) = (axis.scale.forth(free.range.0), axis.scale.forth(free.range.1));
            let value =
                |k: usize| axis.scale.back(low + (high - low) * k as f64 / (each - 1) as f64);
            all = all
                .iter()
                .flat_map(|p: &Vec<f64>| {
                    (0..each).map(|k| p.iter().copied().chain([value(k)]).collect())
                })
                .collect();
        }
        all
    }
}

/// What a model that knows little at a point may turn out to be there: as close, and as sure as the base, whose deviance
/// is by `sure` above its chi-square.
fn hope(trial: &Trial, sure: f64) -> f64 {
    misfit(trial) + sure
}

fn misfit(trial: &Trial) -> f64 {
    trial.chi2 + trial.penalty
}

/// Deviance with little of what ignorance costs.
pub(crate) fn doubted(trial: &Trial) -> f64 {
    let misfit = misfit(trial);
    misfit + DOUBTED * (trial.deviance - misfit)
}
