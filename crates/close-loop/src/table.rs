//! Closing the loop on a table of given simulated responses.
//!
//! A table cannot be asked for an effect that it does not hold, so the candidates are those that
//! follow from it: offsets of the circle, definitions of the lines, the radius, a camera that was
//! turned, a drum that turned faster or slower than was written down. Whatever is left is physics
//! that the table lacks, and is called not in the catalogue.

use calib::attribution::{Attribution, Candidate, Finding, Settings, Verdict};
use calib::{
    CalibError, Observations, OperatingPoint, Predicted, Problem, Simulator, Study, Surrogate,
};
use rig_schema::{Case, Response};

use crate::catalogue::{Catalogue, Effect};
use crate::closest::Closest;
use crate::compare::{self, Values};
use crate::error::CloseLoopError;
use crate::outcome::{Errors, Outcome, Side};
use crate::plan::Effort;

/// A surrogate read with an error; the parameters are the surrogate's and the strength.
struct Misread<'a> {
    base: &'a Surrogate,
    path: String,
    null: f64,
}

impl Misread<'_> {
    fn change(&self, strength: f64, mean: &mut [f64]) {
        if self.path == "camera.roll_deg" {
            // The picture turns about the drum's axis: angles shift, the centre goes round.
            let turn = strength - self.null;
            let (sin, cos) = turn.to_radians().sin_cos();
            for four in mean.chunks_exact_mut(4) {
                let (x, y) = (four[2], four[3]);
                four[0] += turn;
                four[1] += turn;
                (four[2], four[3]) = (x * cos + y * sin, y * cos - x * sin);
            }
        }
        for (i, v) in mean.iter_mut().enumerate() {
            match (self.path.as_str(), i % 4) {
                ("measure.bias_lin_deg", 0)
                | ("measure.bias_mid_deg", 1)
                | ("measure.offset_x_pct", 2)
                | ("measure.offset_y_pct", 3) => *v += strength - self.null,
                ("measure.scale", 2 | 3) => *v /= strength / self.null,
                _ => {}
            }
        }
    }
}

impl Simulator for Misread<'_> {
    fn parameters(&self) -> Vec<String> {
        let mut all = self.base.parameters();
        all.push(self.path.clone());
        all
    }

    fn speed_range_rpm(&self) -> (f64, f64) {
        self.base.speed_range_rpm()
    }

    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        let expected = self.parameters().len();
        let Some((strength, base)) = theta.split_last().filter(|_| theta.len() == expected) else {
            return Err(CalibError::Parameters { expected, given: theta.len() });
        };
        let mut predicted = if self.path == "speed.scale" {
            // The drum turned at another speed than was written down; beyond the table's range
            // its end stands in.
            let (low, high) = self.base.speed_range_rpm();
            let true_speed = |p: &OperatingPoint| OperatingPoint {
                omega_rpm: (p.omega_rpm * strength / self.null).clamp(low, high),
                ..*p
            };
            let true_speeds: Vec<OperatingPoint> = at.iter().map(true_speed).collect();
            self.base.predict(base, &true_speeds)?
        } else {
            self.base.predict(base, at)?
        };
        self.change(*strength, &mut predicted.mean);
        Ok(predicted)
    }
}

/// Whether an effect follows from a table without another simulation.
fn can_be_read(path: &str) -> bool {
    matches!(path, "camera.roll_deg" | "speed.scale")
        || (path.starts_with("measure.") && path != "measure.threshold_bias")
}

/// Close the loop of a case whose simulator is a table.
///
/// # Errors
/// [`CloseLoopError::Calib`] if the problem is not well posed; [`CloseLoopError::Range`] for a range that an effect cannot have.
pub fn close_with_table(
    case: &Case,
    study: &Study,
    settings: &Settings,
) -> Result<Outcome, CloseLoopError> {
    let taken: Vec<String> = study
        .free
        .iter()
        .map(|f| f.name.clone())
        .chain(study.nuisances.iter().map(|n| n.name.clone()))
        .collect();
    let all = Catalogue::of(&case.rig, &taken).chosen(&case.catalogue)?;
    let (effects, mut left_out) = (all.effects, all.left_out);
    let (reading, other): (Vec<Effect>, Vec<Effect>) =
        effects.into_iter().partition(|e| can_be_read(&e.path));
    left_out.extend(
        other.iter().map(|e| {
            (e.path.clone(), "the table of simulated responses does not vary it".to_owned())
        }),
    );
    let models: Vec<Misread<'_>> = reading
        .iter()
        .map(|e| Misread { base: &study.surrogate, path: e.path.clone(), null: e.null })
        .collect();
    let candidates = reading
        .iter()
        .zip(&models)
        .map(|(e, model)| Candidate {
            name: e.path.clone(),
            simulator: model,
            null: e.null,
            range: e.range,
            layer: e.layer,
            prior: e.prior,
            strength_sd: None,
            exposed_by: e.exposed_by.clone(),
            meaning: e.meaning.clone(),
        })
        .collect();
    let held_out = (!study.held_out.items.is_empty()).then(|| study.held_out.clone());
    let attribution = Attribution {
        base: study.problem(),
        candidates,
        pair_models: Vec::new(),
        code_covariance: None,
        held_out: held_out.clone(),
        experiments: Vec::new(),
        settings: settings.clone(),
    };
    let finding = attribution.attribute()?;
    let members: Vec<String> = match &finding.verdict {
        Verdict::Effect(name) => vec![name.clone()],
        Verdict::Class(names) => names.clone(),
        Verdict::Pairs(pairs) => pairs.first().map(|p| p.to_vec()).unwrap_or_default(),
        Verdict::None | Verdict::Unknown => Vec::new(),
    };
    let base = Table { study, held_out: held_out.as_ref() };
    let before = base.side(&study.surrogate, None, &finding.base.theta)?;
    let after = match &finding.verdict {
        Verdict::Effect(_) | Verdict::Class(_) if !members.is_empty() => {
            let best = finding.ranked.iter().find(|r| r.name == members[0]);
            let model = models.iter().find(|m| m.path == members[0]);
            match (best, model) {
                (Some(r), Some(m)) => Some(base.side(m, Some(&members[0]), &r.fit.theta)?),
                _ => None,
            }
        }
        _ => None,
    };
    let (verdict, sentence) = words(&finding, &members);
    let strengths = compare::strengths(&reading, &finding, &members);
    let (side, values) = before;
    let (items, fitted) = compare::everything(&study.observations, held_out.as_ref());
    let (last, last_values) = match &after {
        Some((s, v)) => (s.clone(), v),
        None => (side.clone(), &values),
    };
    let assumed = std::iter::once(
        "The simulator is a table of given responses; only effects of reading can be named."
            .to_owned(),
    )
    .chain(
        case.nuisance
            .iter()
            .map(|n| format!("{}: prior {} +- {} ({}).", n.path, n.mean, n.sd, n.reason)),
    )
    .collect();
    Ok(Outcome {
        case: study.name.clone(),
        verdict,
        members,
        sentence,
        strengths,
        closest: Closest::of(&finding, &reading),
        calibrated: compare::calibrated(&finding),
        removed: after
            .as_ref()
            .and_then(|_| compare::removed(&items, fitted, &values, last_values)),
        before: side,
        after: last,
        others: Vec::new(),
        confirmed: None,
        refuted: 0,
        points: compare::points(&items, fitted, &values, last_values),
        speeds_rpm: Vec::new(),
        loads: Vec::new(),
        inflation: 1.0,
        off_by: Vec::new(),
        effort: Effort::nothing(),
        runs: 0,
        cost_s: 0.0,
        simulated: Vec::new(),
        failed: Vec::new(),
        left_out,
        assumed,
        finding,
    })
}

fn words(finding: &Finding, members: &[String]) -> (&'static str, String) {
    let gate = &finding.gate;
    let chi = format!("chi-square {:.0} with {} degrees of freedom", gate.chi2, gate.dof);
    match &finding.verdict {
        Verdict::None => (
            "none",
            format!("No missing effect can be detected: {chi}, p = {:.2}.", gate.p_combined),
        ),
        Verdict::Effect(_) | Verdict::Class(_) if members.len() == 1 => {
            ("effect", format!("The reading differs, not the physics: {}.", members[0]))
        }
        Verdict::Effect(_) | Verdict::Class(_) | Verdict::Pairs(_) => {
            ("class", format!("Errors of reading explain the data: {}.", members.join(", ")))
        }
        Verdict::Unknown => (
            "unknown",
            format!(
                "The table lacks physics that it does not vary: {chi}, p = {:.1e}, and no error of reading brings it to the data.",
                gate.p_combined
            ),
        ),
    }
}

struct Table<'a> {
    study: &'a Study,
    held_out: Option<&'a Observations>,
}

impl Table<'_> {
    /// Errors of a model at fitted and held-out speeds.
    fn side(
        &self,
        model: &dyn Simulator,
        effect: Option<&String>,
        theta: &[f64],
    ) -> Result<(Side, Values), CloseLoopError> {
        let mut free = self.study.free.clone();
        if let Some(name) = effect {
            let range = (f64::NEG_INFINITY, f64::INFINITY);
            free.push(calib::FreeParameter { name: name.clone(), range });
        }
        let problem = Problem {
            observations: self.study.observations.clone(),
            simulator: model,
            free: free.clone(),
            nuisances: self.study.nuisances.clone(),
        };
        let chi2 = problem.chi2_at(theta)?;
        let fitted = problem.residuals_at(theta)?;
        let (points, place) = self.study.observations.places();
        let raw = model.predict(theta, &points)?.mean;
        // What the fitted speeds say of the nuisances holds at the others too.
        let shift: Vec<f64> = Response::ALL
            .iter()
            .map(|r| {
                let of: Vec<f64> = fitted
                    .iter()
                    .zip(&place)
                    .filter(|(x, _)| x.response == *r)
                    .map(|(x, unmoved)| x.model - raw[*unmoved])
                    .collect();
                of.iter().sum::<f64>() / of.len().max(1) as f64
            })
            .collect();
        let mut values: Values = fitted.iter().map(|r| (r.model, r.sd)).collect();
        if let Some(held) = self.held_out {
            let (points, place) = held.places();
            let predicted = model.predict(theta, &points)?;
            for (i, (o, at)) in held.items.iter().zip(place).enumerate() {
                let variance = predicted.covariance(at, at) + held.covariance(i, i);
                values.push((predicted.mean[at] + shift[o.response.index()], variance.sqrt()));
            }
        }
        let (items, count) = compare::everything(&self.study.observations, self.held_out);
        let dof = count.saturating_sub(theta.len()).max(1);
        let errors = Errors {
            fitted: compare::errors(&items, &values, 0..count),
            held_out: compare::errors(&items, &values, count..items.len()),
            chi2,
            dof,
            p: calib::chi_square_p(chi2, dof),
            p_all: {
                let n = items.len() - count;
                let held: f64 = values[count..]
                    .iter()
                    .zip(&items[count..])
                    .map(|((value, sd), o)| ((o.mean - value) / sd).powi(2))
                    .sum();
                calib::chi_square_p(chi2 + held, dof + n)
            },
        };
        let at = free.iter().map(|f| f.name.clone()).zip(theta.iter().copied()).collect();
        Ok((
            Side { effect: effect.cloned(), at, fillings: 0, errors, predictions: Vec::new() },
            values,
        ))
    }
}
