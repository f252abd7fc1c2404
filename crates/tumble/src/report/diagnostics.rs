//! Diagnostics of one regression as pictures and tables.

use calib_report::calibration::ResponseDiagnostics;
use calib_report::page::{Column, Row, Table};
use calib_report::pictures::{
    Coefficient, CoefficientPlot, EffectPlot, EffectPoint, FitQuality, InteractionLine,
    InteractionPlot, NormalProbability, ObservedPredicted, ObservedPrediction, ReplicatePlot,
    ReplicatePoint, ResponseHistogram, StudentisedResidual,
};
use doe::Fit;
use rig_schema::Response;

const LEVEL: f64 = 0.95;
const LEVEL_NAME: &str = "95 %";

/// Points of a curve over one factor.
const CURVE: usize = 41;

/// Quality of a fit for the summary picture.
pub(crate) fn quality(response: Response, fit: &Fit) -> FitQuality {
    let s = fit.summary();
    FitQuality {
        response: response.title().to_owned(),
        r2: Some(s.r2),
        q2: s.q2,
        validity: s.validity,
        reproducibility: s.reproducibility,
    }
}

/// Everything that the report says of one response's surface; `runs` names the rows.
pub(crate) fn diagnostics(
    response: Response,
    fit: &Fit,
    runs: &[String],
) -> anyhow::Result<ResponseDiagnostics> {
    let name = response.title().to_owned();
    let unit = response.unit().to_owned();
    let s = fit.summary();
    let warnings = s.warnings();
    let mut summary = format!(
        "{} runs, {} terms, {} degrees of freedom: R2 {:.4}, R2adj {:.4}, Q2 {}, residual sd {:.3} {unit}, condition number {:.1}.",
        fit.runs(),
        fit.coefficients().len(),
        s.df,
        s.r2,
        s.r2_adjusted,
        s.q2.map_or("undefined".to_owned(), |q| format!("{q:.4}")),
        s.rmse,
        s.condition_number,
    );
    for w in &warnings {
        summary.push(' ');
        summary.push_str(w);
        summary.push('.');
    }
    let rows = fit.coefficient_table(LEVEL)?;
    let intercept = fit.model().intercept();
    let coefficients = rows
        .iter()
        .enumerate()
        .filter(|(i, _)| Some(*i) != intercept)
        .map(|(_, r)| Coefficient {
            term: r.term.clone(),
            value: r.estimate,
            interval: Some((r.low, r.high)),
        })
        .collect();
    let table = Table {
        caption: format!("Coefficients, factors coded to -1..1, {LEVEL_NAME} intervals by t"),
        columns: vec![
            Column::text("term"),
            Column::number("estimate", unit.clone()),
            Column::number("standard error", unit.clone()),
            Column::number("t", ""),
            Column::number("p", ""),
            Column::number("from", unit.clone()),
            Column::number("to", unit.clone()),
        ],
        rows: rows
            .iter()
            .map(|r| Row {
                strong: r.p < 0.05,
                ..Row::new(vec![
                    r.term.clone(),
                    format!("{:.3}", r.estimate),
                    format!("{:.3}", r.standard_error),
                    format!("{:.2}", r.t),
                    p_value(r.p),
                    format!("{:.3}", r.low),
                    format!("{:.3}", r.high),
                ])
            })
            .collect(),
    };
    let fitted = fit.fitted();
    let skewness = fit.response_skewness();
    let advice = match skewness.as_ref().and_then(|k| k.advice(fit.response())) {
        Some(doe::Transform::Identity) => "skewed, but no power makes it more even".to_owned(),
        Some(doe::Transform::BoxCox { lambda }) => {
            format!("skewed: a Box-Cox transform with lambda {lambda:.2} makes it more even")
        }
        Some(_) => "skewed: a (negative) logarithm makes it more even".to_owned(),
        None => "no transform needed".to_owned(),
    };
    Ok(ResponseDiagnostics {
        response: name.clone(),
        summary,
        tables: vec![table],
        coefficients: Some(CoefficientPlot {
            title: format!("Coefficients: {name}"),
            response: name.clone(),
            unit: unit.clone(),
            coefficients,
            level: LEVEL_NAME.to_owned(),
        }),
        replicates: Some(ReplicatePlot {
            title: format!("Replicates: {name}"),
            response: name.clone(),
            unit: unit.clone(),
            points: replicate_points(fit, runs),
        }),
        histogram: Some(ResponseHistogram {
            title: format!("Distribution: {name}"),
            response: name.clone(),
            unit: unit.clone(),
            values: fit.response().to_vec(),
            skewness: skewness.as_ref().map(|k| k.value),
            skewness_se: skewness.as_ref().map(|k| k.standard_error),
            advice,
        }),
        normal: Some(NormalProbability {
            title: format!("Deleted studentised residuals: {name}"),
            residuals: fit
                .studentised_deleted_residuals()
                .iter()
                .zip(runs)
                .filter_map(|(t, run)| {
                    Some(StudentisedResidual { run: run.clone(), residual: (*t)? })
                })
                .collect(),
            limit: Some(4.0),
        }),
        observed: Some(ObservedPredicted {
            title: format!("Observed against predicted: {name}"),
            response: name.clone(),
            unit: unit.clone(),
            points: fit
                .response()
                .iter()
                .zip(&fitted)
                .zip(runs)
                .map(|((o, p), run)| ObservedPrediction {
                    run: run.clone(),
                    observed: *o,
                    predicted: *p,
                })
                .collect(),
        }),
        effects: effects(fit, &name, &unit)?,
        interactions: interactions(fit, &name, &unit),
    })
}

/// A probability as a person reads it.
pub(crate) fn p_value(p: f64) -> String {
    if p < 1e-4 { format!("{p:.0e}") } else { format!("{p:.4}") }
}

fn replicate_points(fit: &Fit, runs: &[String]) -> Vec<ReplicatePoint> {
    let points = fit.points();
    (0..points.len())
        .map(|i| ReplicatePoint {
            run: runs[i].clone(),
            setting: points.iter().position(|p| *p == points[i]).unwrap_or(i),
            value: fit.response()[i],
        })
        .collect()
}

fn centre(fit: &Fit) -> Vec<f64> {
    fit.model().factors().iter().map(doe::Factor::centre).collect()
}

fn curve(low: f64, high: f64) -> impl Iterator<Item = f64> {
    (0..CURVE).map(move |i| low + (high - low) * i as f64 / (CURVE - 1) as f64)
}

fn effects(fit: &Fit, name: &str, unit: &str) -> anyhow::Result<Vec<EffectPlot>> {
    let mut plots = Vec::new();
    for (k, factor) in fit.model().factors().iter().enumerate() {
        let mut points = Vec::new();
        for x in curve(factor.low, factor.high) {
            let mut at = centre(fit);
            at[k] = x;
            let p = fit.predict(&at)?;
            points.push(EffectPoint {
                factor: x,
                response: p.mean,
                interval: Some(p.interval(LEVEL)?),
            });
        }
        plots.push(EffectPlot {
            title: format!("Effect of {}", factor.name),
            factor: factor.name.clone(),
            response: name.to_owned(),
            unit: unit.to_owned(),
            points,
            response_range: None,
            level: LEVEL_NAME.to_owned(),
        });
    }
    // One range for all factors of a response, so that a steep curve looks steep.
    let all = || plots.iter().flat_map(|p| &p.points).filter_map(|p| p.interval);
    let low = all().map(|i| i.0).fold(f64::INFINITY, f64::min);
    let high = all().map(|i| i.1).fold(f64::NEG_INFINITY, f64::max);
    plots.iter_mut().for_each(|p| p.response_range = Some((low, high)));
    Ok(plots)
}

fn interactions(fit: &Fit, name: &str, unit: &str) -> Vec<InteractionPlot> {
    let factors = fit.model().factors();
    let mut plots = Vec::new();
    for (k, along) in factors.iter().enumerate() {
        for (l, other) in factors.iter().enumerate().skip(k + 1) {
            let lines = [(other.low, "low"), (other.high, "high")].map(|(value, which)| {
                let points = curve(along.low, along.high).map(|x| {
                    let mut at = centre(fit);
                    at[k] = x;
                    at[l] = value;
                    (x, fit.mean(&at))
                });
                InteractionLine {
                    level: format!("{} {value} ({which})", other.name),
                    points: points.collect(),
                }
            });
            plots.push(InteractionPlot {
                title: format!("{} with {}", along.name, other.name),
                factor: along.name.clone(),
                response: name.to_owned(),
                unit: unit.to_owned(),
                lines: lines.into(),
            });
        }
    }
    plots
}
