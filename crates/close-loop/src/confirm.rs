//! Fresh runs of the calibrated model and of the winner, and what remains of the error.

use calib::attribution::{Finding, Verdict};
use calib::{Nuisance, Observation, Observations, OperatingPoint, variance_ratio_p};
use campaign::SpeedRow;
use faer::linalg::solvers::Solve as _;
use faer::{Mat, Side as Triangle};
use rig_schema::Response;

use crate::catalogue::Effect;
use crate::closest::Closest;
use crate::codes::Codes;
use crate::compare::{self, Values};
use crate::driver::{CloseLoop, Stage, State, Told};
use crate::emulator::{Emulator, Sample};
use crate::error::CloseLoopError;
use crate::fillings::Shifts;
use crate::mostly;
use crate::outcome::{Errors, Outcome, Side, SpeedResponse, StrengthOf};
use crate::predict::{predicted_rows, predictions};
use crate::process::Local;
use crate::runs::{Made, rig_with_all, sample};

/// Level below which fresh runs contradict the winner, at fitted and held-out speeds together. A right
/// answer that falls below it by chance is simulated again, so the level costs runs, not answers.
const CONTRADICTED: f64 = 1e-3;

/// The same for two effects, which imitate much that is in no catalogue: they are held to ten times as much, as their fits are.
const CONTRADICTED_PAIR: f64 = 10.0 * CONTRADICTED;

/// Fillings from one round of fresh runs to the next.
const ROUND: usize = 1000;

/// Members of a class that are confirmed.
pub(crate) const CONFIRMED_MEMBERS: usize = 3;

/// One model by fresh runs.
#[derive(Clone)]
pub(crate) struct Fresh {
    side: Side,
    /// Prediction and standard deviation at fitted, then held-out observations.
    points: Values,
    /// The runs, for the models to learn from if they are refuted: of the whole rig where a stand-in is simulated otherwise.
    pub(crate) samples: Vec<Sample>,
    runs: Vec<Made>,
    /// Rows of the speeds to predict, of each run.
    asked: Vec<Vec<SpeedRow>>,
    /// Frictions.
    theta: Vec<f64>,
    /// Whether codes were taken to differ.
    codes_differ: bool,
    /// How fillings shift, load by load, where they differ by more than those of the calibrated drum.
    restless: Option<Vec<Shifts>>,
}

/// What fresh runs of one effect or of two have shown: paths, runs.
pub(crate) type Learned = (Vec<String>, Vec<Sample>);

/// Fresh runs of what was found; `round` counts earlier answers.
pub(crate) fn outcome(
    this: &CloseLoop<'_>,
    state: &mut State<'_>,
    finding: Finding,
    round: usize,
    watch: &mut dyn FnMut(&Told),
) -> Result<(Outcome, Vec<Learned>), CloseLoopError> {
    let mut learned: Vec<Learned> = Vec::new();
    let base = state.base_model()?;
    let mut names: Vec<String> = match &finding.verdict {
        Verdict::None | Verdict::Unknown => Vec::new(),
        Verdict::Effect(name) => vec![name.clone()],
        Verdict::Class(names) => names.clone(),
        Verdict::Pairs(pairs) => pairs.first().map(|p| p.to_vec()).unwrap_or_default(),
    };
    let is_pair = matches!(finding.verdict, Verdict::Pairs(_));
    if state.before.is_none() {
        state.before = fresh(state, &base, &finding.base.theta, &[], round, watch)?;
    }
    // What is compared with each other is held against the data in the same way.
    if let Some(b) = state.before.take_if(|b| b.codes_differ != state.codes_differ) {
        state.before = Some(compared(state, &base, &b.theta, &[], (b.runs, b.asked))?);
    }
    let Some(before) = state.before.clone() else {
        let asked = state.fillings();
        let first = state.runs.failed.last().map_or_else(String::new, |f| f.1.clone());
        return Err(CloseLoopError::Base { failed: asked, asked, first });
    };
    let mut others = Vec::new();
    let mut after = None;
    // Whether no drum with the effect could be simulated.
    let mut failed = false;
    if is_pair {
        if let Some(p) = finding.pairs.iter().find(|p| p.names[..] == names[..]) {
            let free = state.setup.free.len();
            let theta = p.fit.theta[..free.min(p.fit.theta.len())].to_vec();
            let with = effects_at(state, &p.names, &p.strengths.map(|s| s.value));
            after = fresh(state, &base, &theta, &with, round, watch)?;
            let samples = after.as_ref().map(|a| a.samples.clone());
            learned.push((names.clone(), samples.unwrap_or_default()));
            failed = after.is_none();
        }
    } else {
        let mut tried = Vec::new();
        for name in names.iter().take(CONFIRMED_MEMBERS) {
            let Some(r) = finding.ranked.iter().find(|r| r.name == *name) else { continue };
            let Some((strength, theta)) = r.fit.theta.split_last() else { continue };
            if !tried.is_empty() && !state.has_time(1) {
                break;
            }
            let with = effects_at(state, std::slice::from_ref(name), &[*strength]);
            let Some(model) = fresh(state, &base, theta, &with, round, watch)? else {
                state.shorten(name, *strength, true);
                learned.push((vec![name.clone()], Vec::new()));
                continue;
            };
            learned.push((vec![name.clone()], model.samples.clone()));
            tried.push((name.clone(), model));
        }
        failed = tried.is_empty() && !learned.is_empty();
        // A member that its own fresh runs contradict is out, as long as another stands.
        let stands = |(_, f): &(String, Fresh)| f.side.errors.p_all > CONTRADICTED;
        if tried.iter().any(stands) {
            let refuted: Vec<&String> =
                tried.iter().filter(|t| !stands(t)).map(|(n, _)| n).collect();
            let ran = |n: &String| {
                tried.iter().any(|(t, _)| t == n) || !learned.iter().any(|(l, _)| l.contains(n))
            };
            names.retain(|n| !refuted.contains(&n) && ran(n));
        }
        // Of those that stand the one that its fresh runs bear out best goes first and is what is compared with the base.
        let borne_out = |t: &(String, Fresh)| if stands(t) { t.1.side.errors.p_all } else { 0.0 };
        let best = (0..tried.len())
            .reduce(|a, b| if borne_out(&tried[b]) > borne_out(&tried[a]) { b } else { a });
        for (k, (name, model)) in tried.into_iter().enumerate() {
            if Some(k) == best {
                names.sort_by_key(|n| *n != name);
                after = Some(model);
            } else {
                others.push(model.side);
            }
        }
    }
    // What is missing for the most part does not fit, neither by its model nor by fresh runs.
    let mostly = mostly::named(&finding, this.settings.attribution.level).is_some();
    let confirmed = match &after {
        Some(a) if mostly => Some(mostly::is_little(a.side.errors.chi2, before.side.errors.chi2)),
        Some(a) if is_pair => Some(a.side.errors.p_all > CONTRADICTED_PAIR),
        Some(a) => Some(a.side.errors.p_all > CONTRADICTED),
        None => failed.then_some(false),
    };
    let catalogue = &state.setup.catalogue.effects;
    let mut strengths = compare::strengths(catalogue, &finding, &names);
    mostly::widen(&mut strengths, catalogue, &finding, this.settings.attribution.level);
    let with = after.as_ref().unwrap_or(&before);
    let (items, fitted) =
        compare::everything(&state.setup.observations, state.setup.held_out.as_ref());
    let points = compare::points(&items, fitted, &before.points, &with.points);
    let removed =
        after.as_ref().and_then(|a| compare::removed(&items, fitted, &before.points, &a.points));
    let verdict = match (&finding.verdict, confirmed) {
        (Verdict::None, _) => "none",
        (Verdict::Unknown, _) | (_, Some(false)) => "unknown",
        (Verdict::Pairs(_), _) => "class",
        (Verdict::Effect(_) | Verdict::Class(_), _) if names.len() == 1 => "effect",
        (Verdict::Effect(_) | Verdict::Class(_), _) => "class",
    };
    let mut sentence = sentence(&finding, verdict, &strengths, is_pair);
    if verdict == "effect" {
        sentence += &mostly::beside(&finding, this.settings.attribution.level);
    }
    let outcome = Outcome {
        case: this.case.rig.name.clone(),
        verdict,
        members: names,
        sentence,
        strengths,
        closest: Closest::of(&finding, &state.setup.catalogue.effects),
        calibrated: compare::calibrated(&finding),
        before: before.side.clone(),
        after: with.side.clone(),
        others,
        removed,
        confirmed,
        refuted: state.refuted,
        points,
        speeds_rpm: state.setup.loads[0].speeds_rpm.clone(),
        loads: state.setup.loads.clone(),
        inflation: base.inflation(),
        off_by: off_by(state, &base),
        effort: state.effort,
        runs: state.runs.made,
        cost_s: state.runs.cost_s,
        simulated: simulated(state),
        failed: state.runs.failed.clone(),
        left_out: state.setup.catalogue.left_out.clone(),
        assumed: assumed(this, state, &base, after.as_ref()),
        finding,
    };
    Ok((outcome, learned))
}

/// What the stand-in was shifted by.
fn off_by(state: &State<'_>, base: &Emulator) -> Vec<SpeedResponse> {
    let off = base.off(&state.theta).shift;
    let each = state.setup.knots.iter().zip(&off);
    each.flat_map(|(at, (mean, covariance))| {
        Response::ALL.map(|response| {
            let r = response.index();
            let sd = covariance[r][r].max(0.0).sqrt();
            let (load, omega_rpm) = (at.load, at.omega_rpm);
            SpeedResponse { load, omega_rpm, response: response.column(), mean: mean[r], sd }
        })
    })
    .collect()
}

/// Every sample: which effects, and where.
fn simulated(state: &State<'_>) -> Vec<(String, Vec<f64>)> {
    let effects = state.effects.iter().map(|(path, own)| (path.clone(), own));
    let pairs = state.pairs.iter().map(|(names, own)| (names.join(" + "), own));
    std::iter::once((String::new(), &state.base))
        .chain(effects)
        .chain(pairs)
        .flat_map(|(name, own)| own.iter().map(move |s| (name.clone(), s.at.clone())))
        .collect()
}

/// Effects of the catalogue at strengths.
pub(crate) fn effects_at(
    state: &State<'_>,
    names: &[String],
    strengths: &[f64],
) -> Vec<(Effect, f64)> {
    names.iter().zip(strengths).filter_map(|(n, s)| Some((state.effect(n)?.clone(), *s))).collect()
}

/// Run a model with fillings that no fit has seen, and compare it with the data; `None` if none of its
/// drums could be simulated.
pub(crate) fn fresh(
    state: &mut State<'_>,
    base: &Emulator,
    theta: &[f64],
    effects: &[(Effect, f64)],
    round: usize,
    watch: &mut dyn FnMut(&Told),
) -> Result<Option<Fresh>, CloseLoopError> {
    let mut rig = state.setup.rig.clone();
    rig.run.speeds_rpm = state.setup.speeds_of_fresh_runs();
    let mut rigs = Vec::new();
    for k in 0..state.fillings() {
        let filling = state.runs.filling(Stage::Confirm, ROUND * round + k);
        let (named, with) = rig_with_all(&rig, &state.setup.axes, theta, effects, filling)?;
        let label = if effects.is_empty() { "the calibrated model".to_owned() } else { named };
        rigs.push((format!("{label}, fresh"), with));
    }
    let mut runs: Vec<Made> =
        state.runs.all(Stage::Confirm, &rigs, watch)?.into_iter().flatten().collect();
    if runs.is_empty() {
        return Ok(None);
    }
    // Speeds to predict are set aside; the rest is as in every other run.
    let asked = predicted_rows(&mut runs, &state.setup);
    Ok(Some(compared(state, base, theta, effects, (runs, asked))?))
}

/// Fresh runs of a model, and rows of the speeds to predict, held against the data.
fn compared(
    state: &State<'_>,
    base: &Emulator,
    theta: &[f64],
    effects: &[(Effect, f64)],
    (runs, asked): (Vec<Made>, Vec<Vec<SpeedRow>>),
) -> Result<Fresh, CloseLoopError> {
    let n = runs.len() as f64;
    // As if they had the volume that is expected.
    let excess = |load: usize| runs.iter().map(|m| m.excess[load]).sum::<f64>() / n;
    let of_volume = base.of_volume(theta);
    let knots = base.knots();
    let mean = |k: usize, r: usize| {
        let seen = runs.iter().map(|m| m.rows[k].1.mean[r]).sum::<f64>() / n;
        seen - excess(knots[k].load) * of_volume[k][r]
    };
    // Fillings may differ by more than those of the calibrated drum.
    let at: Vec<f64> = theta.iter().copied().chain(effects.iter().map(|(_, s)| *s)).collect();
    let samples: Vec<Sample> = runs.iter().map(|run| sample(at.clone(), run)).collect();
    let own = base.unlike(&samples.iter().collect::<Vec<_>>());
    let restless = own.filter(|_| !effects.is_empty());
    let usual = || (0..state.setup.loads.len()).map(|load| base.shifts_at(load, theta)).collect();
    let fillings: Vec<Shifts> = restless.clone().unwrap_or_else(usual);
    let witnesses = 2.0 * (n - 1.0) * fillings.len() as f64;
    let errors_dof = restless.as_ref().map_or(base.errors_dof(), |_| witnesses);
    let shared = knots.iter().map(|k| fillings[k.load].sd.map(|s| s / n.sqrt())).collect();
    let at = base.frames().enumerate();
    let at =
        at.map(|(k, f)| (std::array::from_fn(|r| mean(k, r)), f.map(|row| row.map(|v| v / n))));
    let unknown = vec![[0.0; 4]; knots.len()];
    let (at, unsure) = (at.collect(), Vec::new());
    let local = Local { at, unknown, shared, unsure, of_volume, fillings };
    let (items, fitted) =
        compare::everything(&state.setup.observations, state.setup.held_out.as_ref());
    let (points, place) = Observation::places(&items);
    let predicted = base.spread(&points, &local);
    let noise = |i: usize, j: usize| {
        let own = |o: &Observations, i: usize, j: usize| o.covariance(i, j);
        let measured = match (&state.setup.held_out, i < fitted, j < fitted) {
            (_, true, true) => own(&state.setup.observations, i, j),
            (Some(h), false, false) => own(h, i - fitted, j - fitted),
            _ => 0.0,
        };
        let at = |i: usize| (items[i].omega_rpm, items[i].response.index());
        let codes = state.codes().map_or(0.0, |c| c.covariance(at(i), at(j)));
        measured + codes + predicted.covariance(place[i], place[j])
    };
    let residual: Vec<f64> =
        items.iter().zip(&place).map(|(o, p)| o.mean - predicted.mean[*p]).collect();
    let nuisances = &state.setup.nuisances;
    let slope = |n: &Nuisance, i: usize| n.slope(items[i].response, items[i].mean);
    let offset =
        |i: usize| -> f64 { nuisances.iter().map(|n| slope(n, i) * n.departure(n.mean)).sum() };
    let free = theta.len() + effects.len();
    // Chi-square of the first `m` observations, and their covariance's inverse on the residual.
    let chi_square = |m: usize| {
        let covariance = Mat::from_fn(m, m, |i, j| {
            let both = nuisances.iter().map(|n| slope(n, i) * slope(n, j) * n.sd * n.sd);
            noise(i, j) + both.sum::<f64>()
        });
        let fault = calib::CalibError::Covariance { what: "fresh runs", size: m };
        let llt = covariance.llt(Triangle::Lower).map_err(|_| fault)?;
        let r = Mat::from_fn(m, 1, |i, _| residual[i] - offset(i));
        let solved = llt.solve(&r);
        let chi2: f64 = (0..m).map(|i| r[(i, 0)] * solved[(i, 0)]).sum();
        Ok::<_, CloseLoopError>((chi2, solved))
    };
    let (chi2, solved) = chi_square(fitted)?;
    let degrees = |m: usize| m.saturating_sub(free).max(1);
    let dof = degrees(fitted);
    // As in the gate: few runs tell how large errors are.
    let p_of = |chi2: f64, dof: usize| variance_ratio_p(chi2, dof, errors_dof);
    let p_all = p_of(chi_square(items.len())?.0, degrees(items.len()));
    let estimate: Vec<f64> = nuisances
        .iter()
        .map(|n| {
            let pull: f64 = (0..fitted).map(|i| slope(n, i) * solved[(i, 0)]).sum();
            n.sd * n.sd * pull
        })
        .collect();
    // What nuisances at their estimates add to a response.
    let nuisance = |r: Response, mean: f64| -> f64 {
        let each = nuisances.iter().zip(&estimate);
        each.map(|(n, e)| n.slope(r, mean) * (n.departure(n.mean) + e)).sum()
    };
    let points: Values = (0..items.len())
        .map(|i| {
            let moved = nuisance(items[i].response, items[i].mean);
            (predicted.mean[place[i]] + moved, noise(i, i).max(0.0).sqrt())
        })
        .collect();
    let errors = Errors {
        fitted: compare::errors(&items, &points, 0..fitted),
        held_out: compare::errors(&items, &points, fitted..items.len()),
        chi2,
        dof,
        p: p_of(chi2, dof),
        p_all,
    };
    let volume = (excess(0), &local.of_volume[..]);
    let shift = local.fillings[0].sd;
    let predictions = predictions(&asked, volume, &state.setup, (base, shift), &nuisance);
    let mut named: Vec<(String, f64)> =
        state.setup.free.iter().map(|f| f.name.clone()).zip(theta.iter().copied()).collect();
    named.extend(effects.iter().map(|(e, s)| (e.path.clone(), *s)));
    let effect = (!effects.is_empty())
        .then(|| effects.iter().map(|(e, _)| e.path.clone()).collect::<Vec<_>>().join(" + "));
    let side = Side { effect, at: named, fillings: runs.len(), errors, predictions };
    let theta = theta.to_vec();
    let codes_differ = state.codes_differ;
    Ok(Fresh { side, points, samples, runs, asked, theta, codes_differ, restless })
}

fn sentence(finding: &Finding, verdict: &str, strengths: &[StrengthOf], is_pair: bool) -> String {
    let named: Vec<String> = strengths
        .iter()
        .map(|s| {
            let [value, lo, hi, null] = [s.value, s.lo, s.hi, s.null].map(figures);
            format!("{} = {value} ({lo} to {hi}; the rig has {null})", s.name)
        })
        .collect();
    match verdict {
        "none" => format!(
            "No missing effect can be detected: chi-square {:.1} with {} degrees of freedom, p = {:.2}.",
            finding.gate.chi2, finding.gate.dof, finding.gate.p_combined
        ),
        "effect" => format!("The model lacks {}.", named[0]),
        "class" if is_pair => {
            format!("Two effects together explain the data: {}.", named.join(" and "))
        }
        "class" => format!(
            "The model lacks one of these, which the data cannot tell apart: {}.",
            named.join("; ")
        ),
        _ if !strengths.is_empty() => {
            let names: Vec<&str> = strengths.iter().map(|s| &s.name[..]).collect();
            let closest = if is_pair { names.join(" with ") } else { names[0].to_owned() };
            format!(
                "Something is missing; {closest} came closest, but fresh simulations do not confirm it."
            )
        }
        _ => format!(
            "Something is missing that is not in the catalogue: chi-square {:.1} with {} degrees of freedom, p = {:.2e}, and no effect brings the model to the data.",
            finding.gate.chi2, finding.gate.dof, finding.gate.p_combined
        ),
    }
}

/// A value with three figures that count.
pub(crate) fn figures(value: f64) -> String {
    let size = if value == 0.0 { 0.0 } else { value.abs().log10().floor() };
    format!("{value:.*}", (2.0 - size).clamp(0.0, 9.0) as usize)
}

fn assumed(
    this: &CloseLoop<'_>,
    state: &State<'_>,
    base: &Emulator,
    after: Option<&Fresh>,
) -> Vec<String> {
    let mut all = Vec::new();
    if let Some((after, shifts)) = after.and_then(|a| Some((a, a.restless.as_ref()?))) {
        let each: Vec<String> = shifts
            .iter()
            .map(|s| {
                let [lin, mid, x, y] = s.sd;
                format!("by {lin:.1} and {mid:.1} deg, {x:.1} and {y:.1} % of R")
            })
            .collect();
        all.push(format!(
            "Fillings of the drum with {} differ by more than those of the calibrated one, as where a bed slides as one body and keeps the surface that it was filled with: all speeds of a filling shift {} (standard deviations of {} fillings). Means over more fillings would tell more.",
            after.side.effect.as_deref().unwrap_or_default(),
            each.join("; with the next load "),
            after.side.fillings
        ));
    }
    let refuted = state.refuted;
    if refuted > 0 {
        all.push(format!(
            "Fresh runs refuted {refuted} answer{} before this one; the models learnt from them.",
            if refuted == 1 { "" } else { "s" }
        ));
    }
    if state.cut_short {
        all.push(
            "The time that runs may take was spent before all runs were made that are planned: with more of it more might be told."
                .to_owned(),
        );
    }
    let given =
        this.tables().all(|t| t.n_eff.is_some() || t.table.rows.iter().all(|r| r.n_eff.is_some()));
    if !given {
        all.push(
            "A measured mean counts as 15 independent frames where the table does not say."
                .to_owned(),
        );
    }
    let rows = || this.tables().flat_map(|t| &t.table.rows);
    if rows().all(|r| r.covariance.iter().flatten().all(Option::is_none)) {
        all.push(
            "The four responses of a frame swing together with correlation 0.5, since the table gives no covariances.".to_owned(),
        );
    }
    for (load, own) in state.setup.loads.iter().enumerate() {
        let of_load = match (state.setup.loads.len(), own.fill) {
            (1, _) => String::new(),
            (_, (path, amount)) => format!(" with {path} = {amount}"),
        };
        let [lin, mid, x, y] = base.shift(load);
        let measured = match own.fillings {
            1 => format!("The measured drum{of_load} is one filling of many"),
            n => format!("The measured means{of_load} are over {n} fillings of many"),
        };
        all.push(format!(
            "{measured}: from one of the same volume to the next all speeds shift by {lin:.2} and {mid:.2} deg, {x:.2} and {y:.2} % of R (standard deviations found in the simulations)."
        ));
        let volume = 100.0 * own.volume_sd;
        if volume >= 0.05 {
            let middle = own.speeds_rpm[own.speeds_rpm.len() / 2];
            let at = OperatingPoint { load, omega_rpm: middle };
            let [lin, mid, x, y] =
                base.of_volume_at(&base.of_volume(&state.theta), at).map(|g| 0.01 * g);
            all.push(format!(
                "Particles of a spread of sizes that are counted have a volume to {volume:.1} %; one per cent more moves the responses at {at} by {lin:+.2} and {mid:+.2} deg, {x:+.2} and {y:+.2} % of R. The volume of every simulated filling is known, that of the measured one is not."
            ));
        }
    }
    let swings = state.setup.knots.iter().map(|k| (*k, base.swings(*k)));
    if let Some((at, most)) = swings.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|s| s.1 > 1.05) {
        all.push(format!(
            "The bed swings more slowly than frames show: means of runs scatter by up to {most:.1} times the variance that their frames give (at {at}), and measured frames count for fewer by as much."
        ));
    }
    let (simulated, of) = (state.setup.knots.len(), rows().count());
    if simulated < of {
        all.push(format!(
            "{simulated} of {of} speeds were simulated; the others are interpolated by a cubic spline."
        ));
    }
    if state.setup.codes.is_some() {
        let how = match (&this.settings.codes, state.codes_differ) {
            (Codes::Given(_), _) => {
                "The data may differ from any simulation by what codes differ among themselves, as the case tells."
            }
            (_, true) => {
                "The data may differ from any simulation by what LIGGGHTS and LAMMPS differ by from Tumble in drums that lack nothing: that explains them better."
            }
            (_, false) => {
                "That the data differ from any simulation by what LIGGGHTS and LAMMPS differ by from Tumble explains them no better, so they are taken not to."
            }
        };
        all.push(how.to_owned());
    }
    all.extend(state.setup.cast.assumed());
    for n in &this.case.nuisance {
        all.push(format!("{}: prior {} +- {} ({}).", n.path, n.mean, n.sd, n.reason));
    }
    all
}

#[cfg(test)]
mod tests {
    use campaign::{Laboratory, Sampling};

    use super::*;
    use crate::fixture::{FRICTIONS, SIX, nothing_known, run};

    #[test]
    fn strengths_are_written_with_three_figures() {
        let all = [8551.63, 0.00341, -1.6142, 0.0, 12.0].map(figures);
        assert_eq!(all, ["8552", "0.00341", "-1.61", "0.00", "12.0"]);
    }

    /// A fresh run that shows the same at both speeds.
    fn made(mean: [f64; 4]) -> Made {
        let covariance = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * 1e-3));
        let (sd, n_eff) = ([0.3; 4], [20.0; 4]);
        let row = |omega_rpm: f64| SpeedRow {
            omega_rpm,
            mean,
            sd,
            covariance,
            n_eff,
            n_frames: 20,
            rejected: 0,
            fill: None,
            approach_s: 1.0,
        };
        let mut made = Made::default();
        made.rows = [50.0, 80.0].map(|s| (OperatingPoint::from(s), row(s))).to_vec();
        made.excess = vec![0.0];
        made
    }

    #[test]
    fn fresh_runs_that_differ_by_their_fillings_are_held_to_their_own_scatter() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
        let mut state = nothing_known(&lab, "", "30,0.3,31,0.3,10,0.3,15,0.3,20");
        let shown = |mid: f64| [30.0, mid, 10.0, 15.0];
        let of_base = |k: usize| run(FRICTIONS[k / 2], &[], shown(31.0 + 0.2 * SIX[k % 6]));
        state.base = (0..18).map(of_base).collect();
        state.theta = vec![0.5];
        let base = state.base_model().unwrap();
        let wall = state.effect("friction.mantle").unwrap().clone();
        // Six fillings whose middle line is on average 2 deg steeper than the one that was measured.
        let fresh = |sd: f64, effects: &[(Effect, f64)]| {
            let runs = SIX.map(|d| made(shown(33.0 + sd * d))).to_vec();
            compared(&state, &base, &[0.5], effects, (runs, Vec::new())).unwrap()
        };
        let with = [(wall, 0.15)];
        let (alike, unlike) = (fresh(0.2, &with), fresh(2.0, &with));
        assert!(alike.restless.is_none());
        assert!(alike.side.errors.p_all < CONTRADICTED, "{:?}", alike.side.errors);
        let own = unlike.restless.as_ref().unwrap()[0];
        // The standard deviation of the six is 1.98.
        assert!((1.9..2.0).contains(&own.sd[1]), "{own:?}");
        assert!(unlike.side.errors.p_all > 0.1, "{:?}", unlike.side.errors);
        // The measured filling and the mean of six: sqrt(1 + 1/6) of that.
        let mid = |f: &Fresh| f.points[1].1;
        assert!((2.0..2.3).contains(&mid(&unlike)) && mid(&alike) < 0.5, "{}", mid(&unlike));
        // The calibrated drum is never excused by what its own fresh runs scatter by.
        assert!(fresh(2.0, &[]).restless.is_none());
    }
}
