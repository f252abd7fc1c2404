//! Two effects together.

use super::evidence::{laplace, unknown};
use super::gate::Case;
use super::model::Model;
use super::ranking::{Folds, Judged, aside, fit, penalty, sort};
use super::solver::{Settled, held};
use crate::CalibError;

/// How much better than the level a pair must fit.
const PAIR_FACTOR: f64 = 10.0;

/// Odds, for each pair that there is, by which a pair leads that need not.
const ALONE: f64 = 100.0;

/// Whether a class of pairs is a name: no more than `most`, or all of them with one member, which is then what is
/// missing whatever the other is.
pub(super) fn are_named(class: &[&[usize]], most: usize) -> bool {
    let Some(first) = class.first() else { return false };
    let shared = first.iter().any(|k| class.iter().all(|pair| pair.contains(k)));
    class.len() <= most || shared
}

/// All pairs.
///
/// Two strengths can imitate much that is not in the catalogue, so that a pair is held to more
/// than a single effect. It is eligible if it fits at ten times the level, or at the level where it leaves all other pairs far
/// behind ([`fits`]); if each of its effects is needed (deviance beyond the class's ratio of either alone, by the effect's own model and by the pair's, whose
/// runs are others) and neither they nor a friction sit at an end of their range; if speeds left out agree better than
/// with the best single effect; and if it is more probable than "unknown" at the priors given.
pub(super) fn fit_pairs<'s>(
    case: &Case<'_, 's>,
    base: &Settled,
    singles: &[Judged<'s>],
    folds: &[Folds],
) -> Result<Vec<Judged<'s>>, CalibError> {
    let settings = &case.attribution.settings;
    let candidates = &case.attribution.candidates;
    let within = settings.class_deviance();
    let alone = |k: usize| singles.iter().find(|j| j.of[0] == k).map(|j| j.deviance());
    let best_gain = singles.iter().filter_map(|j| j.gain).fold(0.0, f64::max);
    let count = (candidates.len() * candidates.len().saturating_sub(1) / 2).max(1) as f64;
    let unknown = unknown(&case.base, &case.data, base)? + settings.prior_unknown.ln();
    let prior = (settings.prior_pairs / count).ln();
    let fitted = pairs_fitted(case, base, |_, _| true)?;
    let best: Vec<f64> = fitted.iter().take(2).map(Judged::deviance).collect();
    let mut pairs = Vec::new();
    for mut judged in fitted {
        let lead = best.get(1).map_or(0.0, |second| second - judged.deviance());
        let needed =
            judged.of.iter().all(|k| alone(*k).is_some_and(|d| d - judged.deviance() > within));
        let probable = laplace(&judged.fit) + prior > unknown;
        judged.explains = fits(judged.p_absolute, settings.level, lead, count)
            && needed
            && judged.inside()
            && probable
            && lacks_neither(case, base, &judged, within)?;
        if judged.explains {
            judged.judge_held_out(case, base, folds)?;
            judged.explains &= judged.gain.is_none_or(|g| g > best_gain);
        }
        judged.eligible = judged.explains;
        pairs.push(judged);
    }
    Ok(pairs)
}

/// Whether a pair of probability `p` fits. What is in no catalogue many pairs imitate about as well: none of them leads the next by
/// much. One that does, by odds of a hundred for each of the `count` pairs, imitates nothing, and is held to the level as single
/// effects are: to ten times the level one true pair in ten is lost by chance alone.
fn fits(p: f64, level: f64, lead: f64, count: f64) -> bool {
    let alone = lead > 2.0 * (ALONE * count).ln();
    p > if alone { level } else { PAIR_FACTOR * level }
}

/// Whether the pair's own model does worse by more than `within` with either strength absent. What a surface learnt
/// from runs of both may fit the data with one of them as good as off, where the surface of the other alone did not.
fn lacks_neither(
    case: &Case<'_, '_>,
    base: &Settled,
    judged: &Judged<'_>,
    within: f64,
) -> Result<bool, CalibError> {
    let model = &judged.model;
    let absent = model.unit(&model.absent(&judged.fit.theta[..model.frictions()]));
    let none = case.base.aside(&base.theta)?;
    for axis in model.frictions()..model.len() {
        let mut unit = judged.fit.point.unit.clone();
        unit[axis] = absent[axis];
        let without = held(model, &case.data, &unit, axis)?;
        let penalty = penalty(case, &judged.of, &without.theta[model.frictions()..]);
        let aside = aside(model, &without.theta, none)?;
        if without.deviance + aside + penalty - judged.deviance() <= within {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Best fit of every pair that is `wanted`, best deviance first, not judged yet.
pub(super) fn pairs_fitted<'s>(
    case: &Case<'_, 's>,
    base: &Settled,
    wanted: impl Fn(&str, &str) -> bool,
) -> Result<Vec<Judged<'s>>, CalibError> {
    let problem = &case.attribution.base;
    let candidates = &case.attribution.candidates;
    let together = &case.attribution.pair_models;
    let mut pairs = Vec::new();
    for a in 0..candidates.len() {
        for b in a + 1..candidates.len() {
            if !wanted(&candidates[a].name, &candidates[b].name) {
                continue;
            }
            let model = Model::pair(problem, &candidates[a], &candidates[b], together)?;
            if case.data.len() > model.len() {
                pairs.push(fit(case, &model, &[a, b], base)?);
            }
        }
    }
    sort(&mut pairs);
    Ok(pairs)
}

#[cfg(test)]
mod tests {
    use super::{are_named, fits};

    #[test]
    fn a_pair_that_leaves_all_others_far_behind_need_not_fit_better_than_a_single_effect() {
        // 78 pairs: 2 ln 7800 = 17.9.
        assert!(fits(0.11, 0.01, 0.0, 78.0) && !fits(0.09, 0.01, 17.5, 78.0));
        assert!(fits(0.02, 0.01, 18.5, 78.0) && !fits(0.009, 0.01, 50.0, 78.0));
        assert!(!fits(f64::NAN, 0.01, 50.0, 78.0));
    }

    #[test]
    fn many_pairs_are_a_name_only_with_a_member_in_common() {
        let [one, two]: [&[usize]; 2] = [&[1, 4], &[4, 7]];
        assert!(!are_named(&[], 3));
        assert!(are_named(&[one, &[2, 3]], 3));
        assert!(!are_named(&[one, two, &[2, 3], &[2, 4]], 3));
        assert!(are_named(&[one, two, &[4, 5], &[2, 4]], 3));
    }
}
