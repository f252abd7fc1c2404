//! Two models at the same observations: their errors, and what the second one removes.

use calib::attribution::{Finding, Verdict};
use calib::{Observation, Observations};
use rig_schema::Response;

use crate::catalogue::Effect;
use crate::outcome::{Point, ResponseErrors, StrengthOf};

/// Prediction at each observation, nuisances at their estimates, with the standard deviation of the
/// difference.
pub(crate) type Values = Vec<(f64, f64)>;

/// What was fitted, then what was kept aside, and the number of the first.
pub(crate) fn everything(
    fitted: &Observations,
    held_out: Option<&Observations>,
) -> (Vec<Observation>, usize) {
    let held = held_out.into_iter().flat_map(|h| &h.items);
    (fitted.items.iter().chain(held).copied().collect(), fitted.items.len())
}

/// Root of the mean of squares over some observations.
fn root_mean(of: &[usize], square: impl Fn(usize) -> f64) -> f64 {
    (of.iter().map(|i| square(*i)).sum::<f64>() / of.len() as f64).sqrt()
}

/// Errors of each response over the observations in `range`.
pub(crate) fn errors(
    items: &[Observation],
    values: &Values,
    range: std::ops::Range<usize>,
) -> Vec<ResponseErrors> {
    let one = |response: &Response| {
        let of: Vec<usize> = range.clone().filter(|i| items[*i].response == *response).collect();
        let e = |i: usize| items[i].mean - values[i].0;
        (!of.is_empty()).then(|| ResponseErrors {
            response: response.column(),
            points: of.len(),
            rmse: root_mean(&of, |i| e(i).powi(2)),
            rmse_sd: root_mean(&of, |i| (e(i) / values[i].1).powi(2)),
            floor: root_mean(&of, |i| values[i].1.powi(2)),
        })
    };
    Response::ALL.iter().filter_map(one).collect()
}

/// Both models point by point; the first `fitted` observations were fitted.
pub(crate) fn points(
    items: &[Observation],
    fitted: usize,
    before: &Values,
    after: &Values,
) -> Vec<Point> {
    items
        .iter()
        .enumerate()
        .map(|(i, o)| Point {
            load: o.load,
            omega_rpm: o.omega_rpm,
            response: o.response.column(),
            fitted: i < fitted,
            measured: o.mean,
            sd: before[i].1,
            before: before[i].0,
            after: after[i].0,
        })
        .collect()
}

/// Part of the mean square error above the noise floor that goes away: at what was kept aside, at what was
/// fitted where nothing was. `None` where there was no more than two standard deviations of chance, of which no part
/// can be told.
pub(crate) fn removed(
    items: &[Observation],
    fitted: usize,
    before: &Values,
    after: &Values,
) -> Option<f64> {
    let from = if items.len() > fitted { fitted } else { 0 };
    let of: Vec<usize> = (from..items.len()).collect();
    let mean = |v: &Values| root_mean(&of, |i| ((items[i].mean - v[i].0) / v[i].1).powi(2)).powi(2);
    let above = mean(before) - 1.0;
    let chance = (2.0 / of.len() as f64).sqrt();
    (above > 2.0 * chance).then(|| ((mean(before) - mean(after).max(1.0)) / above).min(1.0))
}

/// Strengths of the effects that were named: each alone, or two together.
pub(crate) fn strengths(
    effects: &[Effect],
    finding: &Finding,
    names: &[String],
) -> Vec<StrengthOf> {
    let one = |name: &String| {
        let effect = effects.iter().find(|e| e.path == *name)?;
        let of_pair = || {
            let pair = finding.pairs.iter().find(|p| p.names[..] == *names)?;
            let place = pair.names.iter().position(|n| n == name)?;
            Some(pair.strengths[place])
        };
        let alone = || finding.ranked.iter().find(|r| r.name == *name).map(|r| r.strength);
        let is_pair = matches!(finding.verdict, Verdict::Pairs(_));
        let s = if is_pair { of_pair()? } else { alone()? };
        Some(StrengthOf {
            name: name.clone(),
            meaning: effect.meaning.clone(),
            null: effect.null,
            value: s.value,
            lo: s.lo.unwrap_or(effect.range.0),
            hi: s.hi.unwrap_or(effect.range.1),
        })
    };
    names.iter().filter_map(one).collect()
}

/// Free parameters of the calibrated base model: path, value, standard deviation.
pub(crate) fn calibrated(finding: &Finding) -> Vec<(String, f64, Option<f64>)> {
    let base = &finding.base;
    let each = base.parameters.iter().zip(&base.theta).zip(&base.sd);
    each.map(|((p, v), sd)| (p.clone(), *v, *sd)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_the_error_is_told_where_there_was_some_above_the_noise() {
        let item =
            |response| Observation { load: 0, omega_rpm: 30.0, response, mean: 20.0, sd: 1.0 };
        let items = Response::ALL.map(item);
        let off = |by: f64| vec![(20.0 + by, 0.5); 4];
        // Six noises before, two after: of 35 above the noise 32 go away.
        let part = removed(&items, 0, &off(3.0), &off(1.0));
        assert!(part.is_some_and(|p| (p - 32.0 / 35.0).abs() < 1e-12), "{part:?}");
        assert_eq!(removed(&items, 0, &off(3.0), &off(0.1)), Some(1.0));
        // Four numbers within one and a half noises are chance, whatever comes after.
        assert_eq!(removed(&items, 0, &off(0.75), &off(2.0)), None);
    }
}
