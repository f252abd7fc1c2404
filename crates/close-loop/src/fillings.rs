//! How fillings of one drum differ where they differ by more than those of the calibrated drum.
//!
//! A bed that avalanches forgets how it was filled. One that slides on a smooth wall as one body does not: it keeps the
//! surface that it was filled with, so that its frames are quiet and its fillings are not. (Eight drums of 362 beads of friction
//! 0.45, five speeds: on a wall of 0.9 the middle line differs from one filling to the next by 0.36 deg and on one of 0.15 by 1.8 deg,
//! where the speeds of a filling agree to 0.04 deg; half filled by 0.7 and 2.3 deg.) Drums that differ by nothing but their
//! fillings show it; misses of a surface do not, since it may be the surface's.

use calib::attribution::Finding;
use calib::variance_ratio_p;

use crate::driver::{Stage, State, Told, is_simulated};
use crate::emulator::{Emulator, Sample};
use crate::error::CloseLoopError;
use crate::mostly::is_little;
use crate::process::{HALF_SURE, Scatter};
use crate::refine::{Asked, NEAR as BESIDE};

/// Drums that differ by nothing but their fillings and are enough to ask how fillings differ.
pub(crate) const LEAST: usize = 4;

/// Probability of what they show if fillings there were as anywhere, below which they are not.
const LEVEL: f64 = 1e-4;

/// How far fillings are as they were seen to be along the strength of an effect, units: a standard deviation.
const NEAR: f64 = 0.5;

/// The same along frictions: a bed that slides as one body does so with any that is large enough.
const ALONG: f64 = 1.5;

/// Drums that are filled again to ask it.
const REFILLED: usize = 6;

/// Places of an effect at which that is done: the best point moves once its surface knows how fillings differ.
pub(crate) const PLACES: usize = 2;

/// How the responses of one filling of a drum shift, at all its speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shifts {
    /// Standard deviations.
    pub(crate) sd: [f64; 4],
    /// Their correlations.
    pub(crate) together: [[f64; 4]; 4],
}

impl Shifts {
    pub(crate) fn of(scatter: &Scatter) -> Self {
        Self { sd: scatter.shift, together: scatter.together }
    }

    fn covariance(&self) -> [[f64; 4]; 4] {
        let of = |r: usize, s: usize| self.together[r][s] * self.sd[r] * self.sd[s];
        std::array::from_fn(|r| std::array::from_fn(|s| of(r, s)))
    }

    fn of_covariance(of: &[[f64; 4]; 4]) -> Self {
        let sd: [f64; 4] = std::array::from_fn(|r| of[r][r].max(0.0).sqrt());
        let part = |r: usize, s: usize| of[r][s] / (sd[r] * sd[s]).max(f64::MIN_POSITIVE);
        let together = |r, s| if r == s { 1.0 } else { part(r, s) };
        Self { sd, together: std::array::from_fn(|r| std::array::from_fn(|s| together(r, s))) }
    }
}

/// A point about which fillings differ by more than elsewhere.
#[derive(Debug, Clone)]
pub(crate) struct Restless {
    /// In units, the free parameters first.
    at: Vec<f64>,
    /// Number of these.
    free: usize,
    /// Load by load.
    of_load: Vec<Shifts>,
}

impl Restless {
    pub(crate) fn new((at, free): (Vec<f64>, usize), of_load: Vec<Shifts>) -> Self {
        Self { at, free, of_load }
    }

    /// How far a point has to do with it, 1 at most.
    fn near(&self, point: &[f64]) -> f64 {
        let width = |k: usize| if k < self.free { ALONG } else { NEAR };
        let each = self.at.iter().zip(point).enumerate();
        let apart: f64 = each.map(|(k, (a, b))| ((a - b) / width(k)).powi(2)).sum();
        (-0.5 * apart).exp()
    }
}

/// How fillings with a load shift at a point, in units, as far as it is near to one where they were seen to.
pub(crate) fn at(elsewhere: &Scatter, restless: &[Restless], load: usize, point: &[f64]) -> Shifts {
    let usual = Shifts::of(elsewhere);
    let all: f64 = restless.iter().map(|r| r.near(point)).sum();
    if all == 0.0 {
        return usual;
    }
    let less = 1.0 / all.max(1.0);
    let mut sum = usual.covariance().map(|row| row.map(|c| c * (1.0 - all * less)));
    for r in restless {
        let (weight, own) = (r.near(point) * less, r.of_load[load].covariance());
        for (to, of) in sum.iter_mut().flatten().zip(own.iter().flatten()) {
            *to += weight * of;
        }
    }
    Shifts::of_covariance(&sum)
}

impl State<'_> {
    /// Where nothing fits though one effect leaves hardly anything of chi-square, fill its drum again and again at its best point:
    /// fillings may differ by more there than is thought. Whether that was done.
    pub(crate) fn refill(
        &mut self,
        finding: &Finding,
        most: usize,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<bool, CloseLoopError> {
        let nearest = finding
            .ranked
            .iter()
            .filter(|r| self.effect(&r.name).is_some_and(is_simulated))
            .min_by(|a, b| a.fit.deviance.total_cmp(&b.fit.deviance))
            .filter(|r| is_little(r.fit.chi2, finding.base.chi2));
        let Some(effect) = nearest.and_then(|r| self.effect(&r.name)).cloned() else {
            return Ok(false);
        };
        let at = nearest.map_or_else(Vec::new, |r| r.fit.theta.clone());
        let base = self.base_model()?;
        let own = std::slice::from_ref(&effect);
        let model = self.effect_model(&base, &effect, self.seen(own))?;
        let refilled = refilled(self.seen(own));
        let told = refilled.iter().any(|p| model.apart(p, &at) < BESIDE);
        if most < REFILLED || told || refilled.len() == PLACES || at.last() == Some(&effect.null) {
            return Ok(false);
        }
        let of = |s: &Self| s.seen(std::slice::from_ref(&effect)).len() + s.lost(own).len();
        let before = of(self);
        self.look(Stage::Refine, REFILLED, watch, |state, count| {
            let left = REFILLED.saturating_sub(of(state) - before);
            let one = |_| Asked { effects: vec![effect.clone()], at: at.clone() };
            Ok((0..count.min(left)).map(one).collect())
        })?;
        Ok(true)
    }
}

/// Points at which enough drums were filled to say how fillings differ.
pub(crate) fn refilled(runs: &[Sample]) -> Vec<Vec<f64>> {
    let mut all: Vec<Vec<f64>> = Vec::new();
    for run in runs {
        let same = runs.iter().filter(|s| s.at == run.at).count();
        if same >= LEAST && !all.contains(&run.at) {
            all.push(run.at.clone());
        }
    }
    all
}

impl Emulator {
    /// How fillings shift that drums show which differ by nothing else, load by load, if they differ by more than about the point
    /// that this model is for. Free parameters come first in where they are.
    pub(crate) fn unlike(&self, drums: &[&Sample]) -> Option<Vec<Shifts>> {
        let loads = self.knots().last()?.load + 1;
        if drums.len() < LEAST {
            return None;
        }
        // As if they had the volume that is expected.
        let of_volume = self.of_volume(drums[0].at.get(..self.axes().len())?);
        let level = |s: &&Sample| -> Vec<[f64; 4]> {
            let less = |k: usize, r: usize| s.excess[self.knots()[k].load] * of_volume[k][r];
            let each = s.mean.iter().enumerate();
            each.map(|(k, m)| std::array::from_fn(|r| m[r] - less(k, r))).collect()
        };
        let runs: Vec<Vec<[f64; 4]>> = drums.iter().map(level).collect();
        let more = (runs.len() - 1) as f64;
        let (mut excess, mut all) = (0.0, Vec::new());
        for load in 0..loads {
            let own = || self.knots().iter().enumerate().filter(|(_, k)| k.load == load);
            let speeds = own().count() as f64;
            let of_run = |run: &Vec<[f64; 4]>| -> [f64; 4] {
                std::array::from_fn(|r| own().map(|(k, _)| run[k][r]).sum::<f64>() / speeds)
            };
            let means: Vec<[f64; 4]> = runs.iter().map(of_run).collect();
            let middle: [f64; 4] = std::array::from_fn(|r| {
                means.iter().map(|m| m[r]).sum::<f64>() / means.len() as f64
            });
            let product = |r: usize, s: usize| {
                means.iter().map(|m| (m[r] - middle[r]) * (m[s] - middle[s])).sum::<f64>() / more
            };
            let usual = self.shift(load);
            let frames = |r: usize| {
                let of = |k: usize| self.frames().nth(k).map_or(0.0, |f| f[r][r]);
                own().map(|(k, _)| of(k)).sum::<f64>() / (speeds * speeds)
            };
            let believed = more / (more + HALF_SURE);
            let mut own_shifts = [[0.0; 4]; 4];
            for r in 0..4 {
                let (seen, frames) = (product(r, r), frames(r));
                excess += 0.25 * seen / (usual[r].powi(2) + frames).max(f64::MIN_POSITIVE);
                own_shifts[r][r] = (seen - frames).max(usual[r].powi(2));
            }
            for r in 0..4 {
                for s in (0..4).filter(|s| *s != r) {
                    let seen = product(r, s) / (product(r, r) * product(s, s)).sqrt();
                    let size = (own_shifts[r][r] * own_shifts[s][s]).sqrt();
                    own_shifts[r][s] = if seen.is_finite() { believed * seen * size } else { 0.0 };
                }
            }
            all.push(Shifts::of_covariance(&own_shifts));
        }
        // Of each filling a shift in angle and in height, as for those that the model is made of.
        let dof = 2 * (runs.len() - 1) * loads;
        let chi2 = excess / loads as f64 * dof as f64;
        (variance_ratio_p(chi2, dof, self.errors_dof()) < LEVEL).then_some(all)
    }
}

#[cfg(test)]
mod tests {
    use calib::attribution::{Ranked, Settings};
    use calib::{OperatingPoint, Simulator as _};
    use campaign::{Laboratory, Sampling};

    use super::*;
    use crate::fixture::{FRICTIONS, SIX, nothing_known, run};

    /// A drum whose middle line differs by `sd` from one filling to the next.
    fn filled(friction: f64, strengths: &[f64], sd: f64, nth: usize) -> Sample {
        let lin = 30.0 + 6.0 * (friction / 0.5).ln() + 0.1 * SIX[(nth + 2) % 6];
        run(friction, strengths, [lin, lin + 1.0 + sd * SIX[nth % 6], 10.0, 15.0])
    }

    #[test]
    fn fillings_of_one_drum_that_differ_by_more_than_those_of_the_base_say_so() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
        let mut state = nothing_known(&lab, "", "30,1,31,1,10,0.5,15,0.5,20");
        state.base =
            (0..18).map(|k| filled(FRICTIONS[k / 2], &[], 0.2, k)).collect::<Vec<Sample>>();
        state.theta = vec![0.5];
        let base = state.base_model().unwrap();
        let wall = state.effect("friction.mantle").unwrap().clone();
        let place = [0.5, 0.15];
        let model = |sd: f64, n: usize| {
            let own: Vec<Sample> = (0..n).map(|k| filled(0.5, &place[1..], sd, k)).collect();
            state.effect_model(&base, &wall, &own).unwrap()
        };
        let usual = base.shift(0);
        // Six that differ as any do, and three that do not: nothing is said.
        for quiet in [model(0.2, 6), model(2.0, 3)] {
            assert_eq!(quiet.shifts_at(0, &place).sd, usual);
        }
        let restless = model(2.0, 6);
        let own = restless.shifts_at(0, &place);
        // The six numbers above have a standard deviation of 0.988, in which frames have a small part.
        assert!((1.9..1.976).contains(&own.sd[1]), "{own:?}");
        assert_eq!(own.sd[0], usual[0]);
        // As elsewhere without the effect, 1.6 units away.
        let far = restless.shifts_at(0, &[0.5, wall.null]);
        assert!((far.sd[1] - usual[1]).abs() < 0.2, "{far:?} {usual:?}");
        // A measured filling is one of these, and the mean of six is known to 1.93 / sqrt(6): the surface follows none of them.
        let knots = [50.0, 80.0].map(OperatingPoint::from);
        let there = restless.predict(&place, &knots).unwrap();
        let sd = there.covariance(1, 5).sqrt();
        assert!((2.0..2.4).contains(&sd), "{sd}");
        assert!((there.mean[1] - 31.0).abs() < 0.5, "{:?}", there.mean);
        assert!(model(0.2, 6).predict(&place, &knots).unwrap().covariance(1, 5).sqrt() < 0.6);
    }

    #[test]
    fn a_drum_that_leaves_hardly_anything_of_chi_square_is_filled_again() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 2, Sampling::default()).unwrap();
        let only = "[catalogue]\nonly = [\"friction.mantle\"]";
        let mut state = nothing_known(&lab, only, "20,0.1,24,0.1,10,0.1,15,0.1,20");
        state.base = FRICTIONS.iter().map(|f| filled(*f, &[], 0.2, 0)).collect();
        state.theta = vec![0.5];
        let wall = "friction.mantle".to_owned();
        let shows = |f: f64, s: f64| run(f, &[s], [20.0, 21.0, 10.0, 15.0]);
        let own = [(0.4, 0.15), (0.5, 0.15), (0.5, 0.2), (0.6, 0.15)].map(|(f, s)| shows(f, s));
        state.effects.insert(wall.clone(), own.to_vec());
        let settings = Settings { bootstrap: 199, stability_bootstrap: 0, ..Settings::default() };
        let mut finding = state.attribute(&settings).unwrap();
        let nearest: &Ranked = &finding.ranked[0];
        assert!(nearest.fit.chi2 < 0.1 * finding.base.chi2 && nearest.fit.p < 0.01, "{nearest:?}");
        let at = nearest.fit.theta.clone();
        assert!(!state.refill(&finding, 5, &mut |_| ()).unwrap());
        assert!(state.refill(&finding, 6, &mut |_| ()).unwrap());
        let same: Vec<&Sample> = state.effects[&wall].iter().filter(|s| s.at == at).collect();
        assert_eq!(same.len(), 6);
        // No two are the same filling.
        for (k, a) in same.iter().enumerate() {
            assert!(same[..k].iter().all(|b| a.mean != b.mean));
        }
        // Once is enough, and of what leaves more nothing is asked.
        assert!(!state.refill(&finding, 6, &mut |_| ()).unwrap());
        state.effects.insert(wall, own.to_vec());
        finding.base.chi2 = 5.0 * finding.ranked[0].fit.chi2;
        assert!(!state.refill(&finding, 6, &mut |_| ()).unwrap());
    }
}
