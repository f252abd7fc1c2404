//! From the judgement to plain numbers.

use super::evidence::{Profile, interval, laplace, log_mean, profile, unknown};
use super::gate::{Case, Screen};
use super::model::Model;
use super::next;
use super::pairs::pairs_fitted;
use super::ranking::{self, Decision, Judged, decide};
use super::signature::{classes, cosines, detectable, signatures};
use super::solver::{Settled, held};
use super::stability::{self, overturn};
use super::{
    Attribution, Evidence, Finding, Fit, HeldOut, PairFit, PairPlace, Ranked, ResidualPoint,
    Strength, Trial, Verdict,
};
use crate::attribution::data::Variation;
use crate::attribution::linear::covariance;
use crate::covariance::square;
use crate::{CalibError, chi_square_p, upper_quantile};

/// The whole finding.
pub(super) fn finding(attribution: &Attribution<'_>) -> Result<Finding, CalibError> {
    let settings = &attribution.settings;
    let observations = &attribution.base.observations;
    let case = Case::new(attribution, observations, Variation::default(), true)?;
    let screen = Screen::new(&case, settings.bootstrap, false)?;
    let decision = decide(&case, &screen, true)?;
    let names: Vec<String> = attribution.candidates.iter().map(|c| c.name.clone()).collect();
    let mut profiles = Vec::new();
    for judged in &decision.singles {
        profiles.push(profile(&judged.model, &case.data, &judged.fit)?);
    }
    let mut strengths = vec![0.0; names.len()];
    for j in &decision.singles {
        strengths[j.of[0]] = j.fit.theta[j.model.frictions()];
    }
    let cosines = cosines(&signatures(&case, &screen, &strengths)?);
    let (classes, class_of) = classes(&names, &cosines, settings.class_cosine);
    let evidence = evidence(&case, &screen, &decision, &profiles)?;
    let posterior =
        |name: &str| evidence.iter().find(|e| e.name == name).map_or(0.0, |e| e.posterior);
    let ranked = decision
        .singles
        .iter()
        .zip(&profiles)
        .map(|(j, p)| ranked(&case, &screen, j, p, class_of[j.of[0]], posterior(&names[j.of[0]])))
        .collect::<Result<Vec<_>, _>>()?;
    let none_eligible = !decision.singles.iter().any(|j| j.eligible);
    let mut pairs = Vec::new();
    if !screen.gate.passes && none_eligible {
        for j in &decision.pairs {
            pairs.push(pair_fit(&case, j, j.eligible)?);
        }
    }
    let verdict_without_code = match attribution.code_covariance {
        Some(_) if settings.without_codes => {
            let without = Case::new(attribution, observations, Variation::default(), false)?;
            let screen = Screen::new(&without, settings.bootstrap, true)?;
            Some(decide(&without, &screen, false)?.verdict)
        }
        _ => None,
    };
    let overturn = if screen.gate.passes { None } else { Some(overturn(&case, &screen)?) };
    Ok(Finding {
        verdict_without_code,
        base: report_fit(&case, &case.base, &screen.base)?,
        ranked,
        classes,
        cosines,
        pairs,
        detectable: detectable(&case, &screen)?,
        held_out: held_out(&case, &screen, &decision)?,
        stability: stability::rows(attribution),
        overturn,
        next: next_experiments(attribution, &decision, &evidence, &names)?,
        evidence,
        names,
        gate: screen.gate,
        verdict: decision.verdict,
    })
}

/// Best fit of the base, and every optimum of every candidate.
pub(super) fn fits(attribution: &Attribution<'_>) -> Result<(Fit, Vec<Vec<Fit>>), CalibError> {
    let observations = &attribution.base.observations;
    let case = Case::new(attribution, observations, Variation::default(), true)?;
    let base = case.fit_base()?;
    let mut all = Vec::new();
    for (k, model) in case.singles.iter().enumerate() {
        let optima = ranking::fits(&case, model, &[k], &base)?;
        let one = |judged: &Judged<'_>| {
            let mut own = report_fit(&case, model, &judged.fit)?;
            own.deviance += judged.aside + judged.penalty;
            Ok::<Fit, CalibError>(own)
        };
        all.push(optima.iter().map(one).collect::<Result<_, _>>()?);
    }
    Ok((report_fit(&case, &case.base, &base)?, all))
}

/// A candidate at given parameters.
pub(super) fn trials(
    attribution: &Attribution<'_>,
    k: usize,
    thetas: &[Vec<f64>],
) -> Result<Vec<Trial>, CalibError> {
    let observations = &attribution.base.observations;
    let case = Case::new(attribution, observations, Variation::default(), true)?;
    let Some(model) = case.singles.get(k) else { return Ok(Vec::new()) };
    let dof = case.data.len() - model.len();
    let without = case.base.aside(&case.fit_base()?.theta)?;
    let one = |theta: &Vec<f64>| {
        let predicted = model.predict(theta, &case.data.points)?;
        let weight = case.data.weight(&predicted, None)?;
        let mean = case.data.pick(&predicted.mean);
        let residual: Vec<f64> = case.data.y.iter().zip(&mean).map(|(y, m)| y - m).collect();
        let chi2 = square(&weight.whiten(&residual));
        let penalty = ranking::penalty(&case, &[k], &theta[model.frictions()..]);
        let penalty = penalty + ranking::aside(model, theta, without)?;
        let deviance = chi2 + weight.log_det + penalty;
        Ok(Trial { chi2, penalty, deviance, p: chi_square_p(chi2, dof) })
    };
    thetas.iter().map(one).collect()
}

/// The base, and pairs along their valleys.
pub(super) fn pair_places(
    attribution: &Attribution<'_>,
    among: &[[String; 2]],
    parts: &[f64],
) -> Result<(Fit, Vec<PairPlace>), CalibError> {
    let observations = &attribution.base.observations;
    let case = Case::new(attribution, observations, Variation::default(), true)?;
    let base = case.fit_base()?;
    let without = case.base.aside(&base.theta)?;
    let mut places = Vec::new();
    let wanted = |a: &str, b: &str| among.iter().any(|[c, d]| a == c && b == d);
    for judged in pairs_fitted(&case, &base, wanted)? {
        let (model, best) = (&judged.model, &judged.fit);
        let name = |k: usize| attribution.candidates[judged.of[k]].name.clone();
        let mut all = vec![(best.theta.clone(), best.chi2, best.deviance())];
        for part in parts.iter().filter(|_| model.frictions() > 0) {
            let mut unit = best.point.unit.clone();
            unit[0] = *part;
            let there = held(model, &case.data, &unit, 0)?;
            all.push((there.theta, there.chi2, there.deviance));
        }
        let dof = case.data.len() - model.len();
        let fits = judged.inside() && judged.p_absolute > attribution.settings.level;
        for (k, (theta, chi2, deviance)) in all.into_iter().enumerate() {
            let penalty = ranking::penalty(&case, &judged.of, &theta[model.frictions()..])
                + ranking::aside(model, &theta, without)?;
            let p = chi_square_p(chi2, dof);
            let trial = Trial { chi2, penalty, deviance: deviance + penalty, p };
            let names = [name(0), name(1)];
            places.push(PairPlace { names, theta, trial, eligible: fits && k == 0 });
        }
    }
    Ok((report_fit(&case, &case.base, &base)?, places))
}

fn pair_fit(
    case: &Case<'_, '_>,
    judged: &Judged<'_>,
    eligible: bool,
) -> Result<PairFit, CalibError> {
    let d = judged.model.frictions();
    let name = |k: usize| case.attribution.candidates[judged.of[k]].name.clone();
    let model = &judged.model;
    let fit = report_fit(case, model, &judged.fit)?;
    let strength = |k: usize| {
        if eligible {
            return interval(model, &case.data, &judged.fit, d + k);
        }
        let (value, (low, high)) = (fit.theta[d + k], model.ranges[d + k]);
        let half = fit.sd[d + k].map(|sd| upper_quantile(0.95).sqrt() * sd);
        let lo = half.map(|h| value - h).filter(|v| *v > low);
        let hi = half.map(|h| value + h).filter(|v| *v < high);
        Ok(Strength { value, lo, hi })
    };
    Ok(PairFit {
        names: [name(0), name(1)],
        strengths: [strength(0)?, strength(1)?],
        fit,
        held_out_gain: judged.gain,
        at_ends: judged.at_ends,
        eligible,
    })
}

fn ranked(
    case: &Case<'_, '_>,
    screen: &Screen,
    judged: &Judged<'_>,
    profile: &Profile,
    class: usize,
    evidence: f64,
) -> Result<Ranked, CalibError> {
    let candidate = &case.attribution.candidates[judged.of[0]];
    let (low, high) = candidate.range;
    let value = profile.strength.value;
    let near = |end: f64| (value - end).abs() < 1e-6 * (high - low);
    Ok(Ranked {
        name: candidate.name.clone(),
        layer: candidate.layer,
        exposed_by: candidate.exposed_by.clone(),
        meaning: candidate.meaning.clone(),
        fit: report_fit(case, &judged.model, &judged.fit)?,
        strength: profile.strength,
        at_bound: (near(low) || near(high)) && !near(candidate.null),
        aside: judged.aside,
        p_absolute: judged.p_absolute,
        improvement: screen.improvements[judged.of[0]],
        p_single: judged.p_single,
        p_family: judged.p_family,
        evidence,
        held_out_gain: judged.gain,
        worsens: judged.worsens.clone(),
        eligible: judged.eligible,
        objections: judged.objections.clone(),
        class,
    })
}

fn report_fit(case: &Case<'_, '_>, model: &Model<'_>, fit: &Settled) -> Result<Fit, CalibError> {
    let data = &case.data;
    let predicted = model.predict(&fit.theta, &data.points)?;
    let nuisance = data.nuisance_posterior(&fit.weight, &fit.white);
    let spread = covariance(&fit.point.columns, 1e-9);
    let sd = (0..model.len())
        .map(|k| {
            let u = fit.point.unit[k];
            let (low, high) = model.ranges[k];
            let sd = spread.as_ref().map(|c| c[k][k].max(0.0).sqrt())?;
            (sd < 1.0 && u > 1e-9 && u < 1.0 - 1e-9).then_some(sd * (high - low))
        })
        .collect();
    let residuals = (0..data.len())
        .map(|i| {
            let shift: f64 = data.nuisance.iter().zip(&nuisance).map(|(g, n)| g[i] * n.0).sum();
            ResidualPoint {
                load: data.items[i].load,
                omega_rpm: data.items[i].omega_rpm,
                response: data.items[i].response.column(),
                value: data.y[i] - fit.point.mean[i] - shift,
                sd: data.variance(i, &predicted).sqrt(),
            }
        })
        .collect();
    let dof = data.len() - model.len();
    Ok(Fit {
        parameters: model.parameters.clone(),
        theta: fit.theta.clone(),
        sd,
        chi2: fit.chi2,
        deviance: fit.deviance(),
        dof,
        p: chi_square_p(fit.chi2, dof),
        residuals,
    })
}

/// Posterior of none, unknown, pairs and each effect.
fn evidence(
    case: &Case<'_, '_>,
    screen: &Screen,
    decision: &Decision<'_>,
    profiles: &[Profile],
) -> Result<Vec<Evidence>, CalibError> {
    let settings = &case.attribution.settings;
    let candidates = &case.attribution.candidates;
    let pair = |j: &Judged<'_>| laplace(&j.fit) - 0.5 * j.aside;
    let pairs: Vec<f64> = decision.pairs.iter().map(pair).collect();
    let mut rows = vec![
        ("none".to_owned(), settings.prior_none, laplace(&screen.base)),
        (
            "unknown".to_owned(),
            settings.prior_unknown,
            unknown(&case.base, &case.data, &screen.base)?,
        ),
    ];
    if !pairs.is_empty() {
        rows.push(("pairs".to_owned(), settings.prior_pairs, log_mean(&pairs)));
    }
    let rest = 1.0 - settings.prior_none - settings.prior_unknown - settings.prior_pairs;
    let weights: f64 = candidates.iter().map(|c| c.prior).sum();
    for (judged, profile) in decision.singles.iter().zip(profiles) {
        let c = &candidates[judged.of[0]];
        let log_likelihood = profile.log_likelihood - 0.5 * judged.aside;
        rows.push((c.name.clone(), rest * c.prior / weights, log_likelihood));
    }
    let top = rows.iter().map(|r| r.2).fold(f64::NEG_INFINITY, f64::max);
    let mass: Vec<f64> = rows.iter().map(|r| r.1 * (r.2 - top).exp()).collect();
    let total: f64 = mass.iter().sum();
    Ok(rows
        .into_iter()
        .zip(mass)
        .map(|((name, prior, log_likelihood), m)| {
            let scaled = |f: f64| f * m / (total - m + f * m);
            Evidence {
                name,
                prior,
                log_likelihood: log_likelihood - top,
                posterior: scaled(1.0),
                halved: scaled(0.5),
                doubled: scaled(2.0),
            }
        })
        .collect())
}

/// Error at data not fitted for what the verdict names, else for the best candidate.
fn held_out(
    case: &Case<'_, '_>,
    screen: &Screen,
    decision: &Decision<'_>,
) -> Result<Vec<HeldOut>, CalibError> {
    let best = match decision.verdict {
        Verdict::Pairs(_) => decision.pairs.iter().find(|j| j.eligible),
        _ => None,
    };
    let eligible = decision.singles.iter().find(|j| j.eligible);
    let Some(best) = best.or(eligible).or(decision.singles.first()) else {
        return Ok(Vec::new());
    };
    decision
        .folds
        .iter()
        .map(|set| {
            let compared = set.compare((&case.base, &screen.base), (&best.model, &best.fit))?;
            Ok(compared.report(set.kind, &best.model.name, case.attribution.settings.seed))
        })
        .collect()
}

/// Experiments between the members of a class; with no class, between the three most probable.
fn next_experiments(
    attribution: &Attribution<'_>,
    decision: &Decision<'_>,
    evidence: &[Evidence],
    names: &[String],
) -> Result<Vec<super::NextExperiment>, CalibError> {
    let posterior = |j: &Judged<'_>| {
        evidence.iter().find(|e| e.name == names[j.of[0]]).map_or(0.0, |e| e.posterior)
    };
    let mut between: Vec<(&Judged<'_>, f64)> =
        decision.singles.iter().map(|j| (j, posterior(j))).collect();
    if let Verdict::Class(class) = &decision.verdict {
        between.retain(|(j, _)| class.contains(&names[j.of[0]]));
    } else {
        between.sort_by(|a, b| b.1.total_cmp(&a.1));
        between.truncate(3);
    }
    between.retain(|(_, share)| *share > 0.0);
    next::rank(
        &attribution.experiments,
        &attribution.candidates,
        &attribution.base.free,
        &between,
        attribution.settings.seed,
    )
}
