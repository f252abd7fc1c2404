//! Signatures of effects: which are collinear, which would have been seen.

use statrs::distribution::{ContinuousCDF, Normal};

use super::gate::{Case, Screen};
use super::linear::{dot, orthonormal, without};
use super::model::Model;
use super::solver::{FINE, Search, held};
use super::{CollinearClass, Detectable};
use crate::CalibError;
use crate::covariance::square;

/// Steps in which a strength is searched.
const STEPS: usize = 24;

/// Whitened change by each effect at the strength given, frictions projected out (nuisances are
/// in the covariance), of length 1; zero where frictions take all.
pub(super) fn signatures(
    case: &Case<'_, '_>,
    screen: &Screen,
    strengths: &[f64],
) -> Result<Vec<Vec<f64>>, CalibError> {
    let base = &screen.base;
    // Orthonormal directions of the frictions.
    let taken = orthonormal(&base.point.columns);
    case.singles
        .iter()
        .zip(strengths)
        .map(|(model, strength)| {
            let absent = model.absent(&base.theta);
            let axis = model.frictions();
            let (low, high) = model.ranges[axis];
            let null = model.nulls[0];
            let mut present = absent.clone();
            present[axis] = if (strength - null).abs() > 1e-3 * (high - low) {
                *strength
            } else if high - null >= null - low {
                null + 0.1 * (high - null)
            } else {
                null - 0.1 * (null - low)
            };
            let with = case.data.pick(&model.expected(&present, &case.data.points)?);
            let none = case.data.pick(&model.expected(&absent, &case.data.points)?);
            let change: Vec<f64> = with.iter().zip(&none).map(|(a, b)| a - b).collect();
            let white = base.weight.whiten(&change);
            let rest = without(&white, &taken);
            let length = square(&rest).sqrt();
            let visible = length > 1e-9 * square(&white).sqrt() && length > 0.0;
            Ok(rest.iter().map(|x| if visible { x / length } else { 0.0 }).collect())
        })
        .collect()
}

/// Cosines between all signatures.
pub(super) fn cosines(signatures: &[Vec<f64>]) -> Vec<Vec<f64>> {
    signatures.iter().map(|a| signatures.iter().map(|b| dot(a, b)).collect()).collect()
}

/// Candidates joined by cosines (of either sign) above `least`; the class of each.
pub(super) fn classes(
    names: &[String],
    cosines: &[Vec<f64>],
    least: f64,
) -> (Vec<CollinearClass>, Vec<usize>) {
    let n = names.len();
    let mut class: Vec<usize> = (0..n).collect();
    for i in 0..n {
        for j in 0..i {
            if cosines[i][j].abs() >= least {
                let (from, to) = (class[i].max(class[j]), class[i].min(class[j]));
                class.iter_mut().filter(|c| **c == from).for_each(|c| *c = to);
            }
        }
    }
    let mut heads = class.clone();
    heads.sort_unstable();
    heads.dedup();
    let list = heads
        .iter()
        .map(|h| {
            let of: Vec<usize> = (0..n).filter(|i| class[*i] == *h).collect();
            let pairs = of.iter().flat_map(|i| of.iter().map(move |j| (*i, *j)));
            CollinearClass {
                names: of.iter().map(|i| names[*i].clone()).collect(),
                least_cosine: pairs
                    .filter(|(i, j)| i != j)
                    .map(|(i, j)| cosines[i][j].abs())
                    .fold(1.0, f64::min),
            }
        })
        .collect();
    let place = class.iter().map(|c| heads.partition_point(|h| h < c)).collect();
    (list, place)
}

/// Strength of each effect, towards each end of its range, that the focused part of the gate
/// would see with the power asked for.
///
/// A drum with the effect is asked for that calibrates to the very point that these data calibrate to: for every strength the
/// frictions are those that hide it best, not those that were found without it. (Kinetic friction of half the
/// static one at 0.45 reads as 0.24: whoever takes 0.24 for given would see half of it.) The chi-square that is left once
/// friction is refitted is the non-centrality. An effect that is seen only by the omnibus part is smaller yet: the strength is
/// on the safe side.
pub(super) fn detectable(
    case: &Case<'_, '_>,
    screen: &Screen,
) -> Result<Vec<Detectable>, CalibError> {
    let normal = Normal::standard();
    let threshold = screen.critical_improvement.sqrt();
    let needed = threshold + normal.inverse_cdf(case.attribution.settings.power);
    let calibrated = case.data.with(screen.base.point.mean.clone());
    let mut list = Vec::new();
    for model in &case.singles {
        let (low, high) = model.ranges[model.frictions()];
        let null = model.nulls[0];
        for end in [low, high].into_iter().filter(|e| (e - null).abs() > 1e-12 * (high - low)) {
            let mut before = (0.0, 0.0);
            let mut strength = None;
            let mut at = Vec::new();
            let mut distance = 0.0;
            let mut theta = model.absent(&screen.base.theta);
            for k in 1..=STEPS {
                let part = k as f64 / STEPS as f64;
                let s = null + part * (end - null);
                theta[model.frictions()] = s;
                theta = held(model, &calibrated, &model.unit(&theta), model.frictions())?.theta;
                distance = noncentrality(case, screen, model, &theta)?.sqrt();
                if distance < needed {
                    strength = None;
                } else if strength.is_none() {
                    at = theta[..model.frictions()].to_vec();
                    let t = (needed - before.1) / (distance - before.1);
                    strength = Some(null + (before.0 + t * (part - before.0)) * (end - null));
                }
                before = (part, distance);
            }
            if strength.is_none() {
                at = theta[..model.frictions()].to_vec();
            }
            list.push(Detectable {
                name: model.name.clone(),
                towards: end,
                strength,
                at,
                power_at_end: 1.0 - normal.cdf(threshold - distance),
            });
        }
    }
    Ok(list)
}

/// Chi-square that the base leaves of a drum with an effect, less what the effect's own model does not know of it.
fn noncentrality(
    case: &Case<'_, '_>,
    screen: &Screen,
    model: &Model<'_>,
    present: &[f64],
) -> Result<f64, CalibError> {
    let base = &screen.base;
    let frictions = &present[..model.frictions()];
    let absent = model.absent(frictions);
    let predicted = model.predict(present, &case.data.points)?;
    let with = case.data.pick(&predicted.mean);
    let none = case.data.pick(&model.expected(&absent, &case.data.points)?);
    let own = case.data.pick(&case.base.expected(frictions, &case.data.points)?);
    let shifted = own.iter().zip(with.iter().zip(&none));
    let y: Vec<f64> = shifted.map(|(m, (a, b))| m + a - b).collect();
    let search = Search { model: &case.base, data: &case.data, weight: &base.weight };
    let left = search.descend(&y, &base.point, None, FINE)?.chi2;
    let unknown = case.data.weight(&predicted, None)?.log_det - base.weight.log_det;
    Ok((left - unknown.max(0.0)).max(0.0))
}
