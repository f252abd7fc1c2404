//! The report of a calibrated case, filled from the fits.

use calib::{Match, Sensitivity, Simulator, Study, upper_quantile};
use calib_report::calibration::{
    CalibrationReport, FrictionRow, GoodnessRow, ParameterRow, ResidualRow, WallFriction,
};
use calib_report::contour::Grid;
use calib_report::page::{Column, Provenance, Row, Table, Tone, Verdict};
use calib_report::pictures::{
    CalibrationMap, FitSummary, FrictionAtSpeed, FrictionSpeed, MappedResponse, PosteriorDensity,
    PrintedRange, ProfileLikelihood, ResidualAtSpeed, ResidualSpeed, ResponseResiduals,
};
use rig_schema::Response;

use super::diagnostics::{diagnostics, p_value, quality};
use super::json::{Outlier, rmse};
use super::{interval, number};
use crate::input::Loaded;

const LEVEL_NAME: &str = "95 %";

/// Speeds of the central pictures, rpm.
const MAP_SPEEDS: [f64; 3] = [4.0, 17.0, 30.0];

/// Nodes of a map along each axis.
const MAP_NODES: usize = 61;

/// What a report is made of.
pub(crate) struct Parts<'a> {
    pub(crate) loaded: &'a Loaded,
    pub(crate) study: &'a Study,
    pub(crate) joint: &'a Match,
    pub(crate) per_speed: &'a [(f64, Match)],
    pub(crate) sensitivity: &'a Sensitivity,
    pub(crate) held_out: &'a [calib::Residual],
    pub(crate) outliers: &'a [Outlier],
    pub(crate) printed: &'a [(f64, f64, f64)],
    pub(crate) duplicates: &'a [String],
    pub(crate) seed: u64,
    pub(crate) command: String,
}

/// The result in one sentence.
pub(crate) fn sentence(joint: &Match) -> (String, Tone) {
    let e = &joint.estimates[0];
    let g = &joint.goodness;
    let fits = g.p > 0.01;
    let text = format!(
        "{} is {:.3} ({LEVEL_NAME}: {}); the simulator {} the measurements (chi-square {:.0} for {} degrees of freedom).",
        title_of(&e.name),
        e.value,
        interval(e.lo, e.hi),
        if fits { "fits" } else { "does not fit" },
        g.chi2,
        g.dof
    );
    (text, if fits { Tone::Good } else { Tone::Caution })
}

fn title_of(path: &str) -> &str {
    match path {
        "friction.pp" => "Particle friction",
        "friction.mantle" => "Mantle friction",
        other => other,
    }
}

/// Make the report.
pub(crate) fn report(parts: &Parts<'_>) -> anyhow::Result<CalibrationReport> {
    let (study, joint) = (parts.study, parts.joint);
    let (sentence, tone) = sentence(joint);
    let runs: Vec<String> = study
        .table()
        .rows
        .iter()
        .filter(|r| r.cells.iter().all(Option::is_some))
        .map(|r| format!("N{}", r.run))
        .collect();
    let mut responses = Vec::new();
    let mut rows = Vec::new();
    for r in Response::ALL {
        responses.push(diagnostics(r, study.surrogate.fit(r), &runs)?);
        rows.push(quality(r, study.surrogate.fit(r)));
    }
    Ok(CalibrationReport {
        case: study.name.clone(),
        subtitle: parts.loaded.case.rig.title.clone(),
        verdict: Some(Verdict { sentence, tone }),
        facts: facts(parts),
        warnings: warnings(parts),
        friction: friction_rows(parts),
        interval_level: LEVEL_NAME.to_owned(),
        wall: wall(joint),
        parameters: parameters(parts),
        goodness: goodness(parts.sensitivity),
        maps: maps(parts),
        friction_speed: Some(friction_speed(parts)),
        residual_speed: Some(residual_speed(parts)),
        residuals: joint
            .residuals
            .iter()
            .map(|r| ResidualRow {
                omega_rpm: r.omega_rpm,
                response: r.response.title().to_owned(),
                unit: r.response.unit().to_owned(),
                measured: r.measured,
                model: r.model,
                sd: r.sd,
                outlier: is_outlier(parts, r),
            })
            .collect(),
        outliers: parts.outliers.iter().map(Outlier::row).collect(),
        profiles: joint
            .estimates
            .iter()
            .map(|e| ProfileLikelihood {
                title: format!("Profile likelihood of {}", e.name),
                parameter: e.name.clone(),
                points: e.profile.clone(),
                best: Some(e.value),
                threshold: upper_quantile(0.95) * joint.goodness.inflation(),
                interval: (e.lo, e.hi),
                level: LEVEL_NAME.to_owned(),
            })
            .collect(),
        posteriors: joint
            .estimates
            .iter()
            .map(|e| PosteriorDensity {
                title: format!("Posterior of {}", e.name),
                parameter: e.name.clone(),
                points: e
                    .marginal
                    .values
                    .iter()
                    .copied()
                    .zip(e.marginal.density.iter().copied())
                    .collect(),
                prior: {
                    let height = 1.0 / (e.range.1 - e.range.0);
                    vec![(e.range.0, height), (e.range.1, height)]
                },
                centre: Some(e.marginal.mean),
                centre_label: "mean".to_owned(),
                interval: Some(e.marginal.interval),
                level: LEVEL_NAME.to_owned(),
            })
            .collect(),
        sensitivity: sensitivity(parts.sensitivity),
        fit_summary: Some(FitSummary { title: "Summary of fit".to_owned(), rows }),
        responses,
        extra: Vec::new(),
        assumptions: assumptions(parts),
        provenance: Some(Provenance {
            inputs: parts.loaded.inputs.clone(),
            seed: Some(parts.seed),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: parts.command.clone(),
            settings: Vec::new(),
        }),
    })
}

fn is_outlier(parts: &Parts<'_>, r: &calib::Residual) -> bool {
    parts.outliers.iter().any(|o| o.is_at(r.omega_rpm, r.response))
}

fn facts(parts: &Parts<'_>) -> Vec<(String, String)> {
    let rig = &parts.loaded.case.rig;
    let speeds = parts.study.observations.speeds_rpm();
    let mut facts = vec![
        (
            "drum".to_owned(),
            format!(
                "{:.0} x {:.0} mm, {} mantle",
                2000.0 * rig.drum.radius_m,
                1000.0 * rig.drum.length_m,
                rig.drum.mantle
            ),
        ),
        (
            "speeds fitted".to_owned(),
            format!("{} from {} to {} rpm", speeds.len(), speeds[0], speeds[speeds.len() - 1]),
        ),
        ("simulated runs".to_owned(), parts.study.table().rows.len().to_string()),
    ];
    if let Some(n) = rig.settings.value("fill.count") {
        facts.insert(0, ("particles".to_owned(), format!("{n:.0}")));
    }
    facts
}

/// Everything that a reader should know before trusting the numbers.
pub(crate) fn warnings(parts: &Parts<'_>) -> Vec<String> {
    let mut warnings = Vec::new();
    let left_out = &parts.study.left_out_rpm;
    if !left_out.is_empty() {
        let (low, high) = parts.study.surrogate.speed_range_rpm();
        let list: Vec<String> = left_out.iter().map(f64::to_string).collect();
        warnings.push(format!(
            "measured speeds beyond the simulated {low} to {high} rpm are left out: {} rpm",
            list.join(", ")
        ));
    }
    for r in &parts.loaded.measured.absent {
        warnings.push(format!("the measured table has no {r}: it is not matched"));
    }
    for e in &parts.loaded.errata {
        let what = match e.suggested {
            Some(value) => format!("{} is read as {value}", e.printed),
            None => "is left out".to_owned(),
        };
        warnings.push(format!(
            "erratum applied to {}, {}, {}: {what} ({})",
            e.file, e.row, e.column, e.reason
        ));
    }
    for e in &parts.joint.estimates {
        if !e.flatness.identified {
            warnings.push(format!(
                "{} is not determined: its interval is {} within {} to {} (deviance changes by {:.1} over the range)",
                e.name,
                interval(e.lo, e.hi),
                e.range.0,
                e.range.1,
                e.flatness.deviance_range
            ));
        }
    }
    if parts.joint.goodness.p <= 0.01 {
        let lag = parts.joint.lag1.map_or(String::new(), |l| {
            format!("; neighbouring speeds miss alike (lag-1 correlation {l:.2})")
        });
        warnings.push(format!(
            "the model misses the data by more than the stated errors: intervals are widened by the factor {:.2}{lag}",
            parts.joint.goodness.inflation().sqrt()
        ));
    }
    for n in &parts.joint.nuisances {
        if n.pull.abs() > 2.0 {
            warnings.push(format!(
                "{} is pulled to {:.2}, {:.1} prior standard deviations from what was expected of it",
                n.name, n.value, n.pull
            ));
        }
    }
    warnings.extend(parts.duplicates.iter().cloned());
    warnings
}

fn friction_rows(parts: &Parts<'_>) -> Vec<FrictionRow> {
    let row = |omega: Option<f64>, m: &Match| {
        let e = &m.estimates[0];
        FrictionRow {
            omega_rpm: omega,
            method: String::new(),
            mu_pp: Some(e.value),
            lo: e.lo,
            hi: e.hi,
            printed: omega
                .and_then(|w| parts.printed.iter().find(|p| p.0 == w).map(|p| (p.1, p.2))),
            chi2: Some(m.goodness.chi2),
            dof: Some(m.goodness.dof),
            note: if e.value <= e.range.0 || e.value >= e.range.1 {
                "at the edge of the simulated range".to_owned()
            } else {
                String::new()
            },
        }
    };
    let mut rows: Vec<FrictionRow> =
        parts.per_speed.iter().map(|(w, m)| row(Some(*w), m)).collect();
    rows.push(row(None, parts.joint));
    rows
}

fn wall(joint: &Match) -> Option<WallFriction> {
    let e = joint.estimates.iter().find(|e| e.name == "friction.mantle")?;
    let reason = if e.flatness.identified {
        format!("its interval covers {:.0} % of the range", 100.0 * e.flatness.covered)
    } else {
        format!(
            "the likelihood is flat or open along it: minus twice its logarithm changes by {:.1} over the whole range, and the interval is {}",
            e.flatness.deviance_range,
            interval(e.lo, e.hi)
        )
    };
    Some(WallFriction {
        value: Some(e.value),
        lo: e.lo,
        hi: e.hi,
        identified: e.flatness.identified,
        reason,
    })
}

fn parameters(parts: &Parts<'_>) -> Vec<ParameterRow> {
    let spec = &parts.loaded.case.nuisance;
    let nuisances = parts.joint.nuisances.iter().zip(spec).map(|(n, s)| {
        let unit = rig_schema::namespace::find(&s.path).map_or("", |p| p.unit);
        ParameterRow {
            name: n.name.clone(),
            unit: if unit == "1" { String::new() } else { unit.to_owned() },
            prior: format!("normal, {} ± {}", s.mean, s.sd),
            value: Some(n.value),
            lo: Some(n.value - 1.96 * n.sd),
            hi: Some(n.value + 1.96 * n.sd),
            note: s.reason.clone(),
        }
    });
    nuisances.collect()
}

fn goodness(sensitivity: &Sensitivity) -> Vec<GoodnessRow> {
    sensitivity
        .by_n_eff
        .iter()
        .map(|(n, m)| {
            let e = &m.estimates[0];
            GoodnessRow {
                errors: if *n == 1.0 {
                    "scatter of the frames (n_eff 1)".to_owned()
                } else {
                    format!("error of the mean, n_eff {n}")
                },
                chi2: Some(m.goodness.chi2),
                dof: Some(m.goodness.dof),
                p_chi2: Some(m.goodness.p),
                p_bootstrap: m.bootstrap.as_ref().map(|b| b.p),
                mu_pp: Some((e.value, e.lo, e.hi)),
                reading: if m.goodness.p > 0.01 { "fits" } else { "rejected" }.to_owned(),
            }
        })
        .collect()
}

fn maps(parts: &Parts<'_>) -> Vec<CalibrationMap> {
    let study = parts.study;
    let place = |path: &str| study.free.iter().position(|f| f.name == path);
    let (Some(wall), Some(pp)) = (place("friction.mantle"), place("friction.pp")) else {
        return Vec::new();
    };
    if study.free.len() != 2 {
        return Vec::new();
    }
    let (x_range, y_range) = (study.free[wall].range, study.free[pp].range);
    let shift = |r: Response| -> f64 {
        // The bands are drawn in the simulator's own reading: nuisances at their estimates.
        let all = &parts.joint.nuisances;
        study
            .nuisances
            .iter()
            .zip(all)
            .filter(|(n, _)| n.effect == calib::Effect::Shift(r))
            .map(|(_, e)| e.value)
            .sum()
    };
    let e = &parts.joint.estimates[pp];
    MAP_SPEEDS
        .iter()
        .map(|omega| {
            let measured = study.observations.at_speed(*omega);
            let responses = Response::ALL.into_iter().map(|r| {
                let mut values = Vec::with_capacity(MAP_NODES * MAP_NODES);
                for j in 0..MAP_NODES {
                    for i in 0..MAP_NODES {
                        let at = |range: (f64, f64), k: usize| {
                            range.0 + (range.1 - range.0) * k as f64 / (MAP_NODES - 1) as f64
                        };
                        let mut theta = vec![0.0; 2];
                        theta[wall] = at(x_range, i);
                        theta[pp] = at(y_range, j);
                        values.push(study.surrogate.mean(r, *omega, &theta) + shift(r));
                    }
                }
                let here = measured
                    .as_ref()
                    .and_then(|m| m.items.iter().find(|o| o.response == r).copied());
                MappedResponse {
                    name: r.label().to_owned(),
                    unit: r.unit().to_owned(),
                    field: Grid { nx: MAP_NODES, ny: MAP_NODES, x_range, y_range, values },
                    measured: here.map(|o| o.mean),
                    sd: here.map_or(0.0, |o| o.sd),
                }
            });
            CalibrationMap {
                title: format!("{} at {omega} rpm", study.name),
                x_label: "mantle friction".to_owned(),
                y_label: "particle friction".to_owned(),
                responses: responses.collect(),
                estimate: Some((e.value, e.lo, e.hi)),
                estimate_label: "all speeds".to_owned(),
                printed: parts.printed.iter().find(|p| p.0 == *omega).map(|p| (p.1, p.2)),
            }
        })
        .collect()
}

fn friction_speed(parts: &Parts<'_>) -> FrictionSpeed {
    let at = |omega_rpm: f64, m: &Match| {
        let e = &m.estimates[0];
        FrictionAtSpeed { omega_rpm, value: Some(e.value), lo: e.lo, hi: e.hi }
    };
    FrictionSpeed {
        title: "Friction against speed".to_owned(),
        friction_label: "particle friction".to_owned(),
        estimates: parts.per_speed.iter().map(|(w, m)| at(*w, m)).collect(),
        joint: Some(at(0.0, parts.joint)),
        printed: parts
            .printed
            .iter()
            .map(|p| PrintedRange { omega_rpm: p.0, lo: p.1, hi: p.2 })
            .collect(),
        range: Some(parts.joint.estimates[0].range),
        level: LEVEL_NAME.to_owned(),
    }
}

fn residual_speed(parts: &Parts<'_>) -> ResidualSpeed {
    ResidualSpeed {
        title: "Residuals against speed".to_owned(),
        sd_of: "error of the mean and of the surrogate".to_owned(),
        responses: Response::ALL
            .into_iter()
            .map(|r| ResponseResiduals {
                response: r.title().to_owned(),
                points: parts
                    .joint
                    .residuals
                    .iter()
                    .filter(|x| x.response == r)
                    .map(|x| ResidualAtSpeed {
                        omega_rpm: x.omega_rpm,
                        residual_sd: x.in_sd(),
                        outlier: is_outlier(parts, x),
                    })
                    .collect(),
            })
            .collect(),
        limit: Some(2.0),
    }
}

fn sensitivity(s: &Sensitivity) -> Vec<Table> {
    let table = |caption: &str, head: &str, rows: Vec<(String, &Match)>| Table {
        caption: caption.to_owned(),
        columns: vec![
            Column::text(head),
            Column::number("particle friction", ""),
            Column::number("from", ""),
            Column::number("to", ""),
            Column::number("chi-square", ""),
            Column::number("degrees of freedom", ""),
            Column::number("p", ""),
        ],
        rows: rows
            .into_iter()
            .map(|(name, m)| {
                let e = &m.estimates[0];
                Row::new(vec![
                    name,
                    format!("{:.3}", e.value),
                    number(e.lo),
                    number(e.hi),
                    format!("{:.1}", m.goodness.chi2),
                    m.goodness.dof.to_string(),
                    p_value(m.goodness.p),
                ])
            })
            .collect(),
    };
    vec![
        table(
            "By the responses that are matched",
            "responses",
            s.by_responses.iter().map(|(r, m)| (r.key().replace('_', " "), m)).collect(),
        ),
        table(
            "By the assumed correlation of the responses within a frame, which the tables do not give",
            "correlation",
            s.by_correlation.iter().map(|(c, m)| (c.name().to_owned(), m)).collect(),
        ),
        table(
            "By the basis: 1, mu, exp(-mu/m0) instead of the quadratic; levels of 0.1, 0.5 and 0.9 do not determine m0",
            "m0",
            s.by_m0.iter().map(|(m0, m)| (format!("{m0}"), m)).collect(),
        ),
    ]
}

fn assumptions(parts: &Parts<'_>) -> Vec<String> {
    let n_eff = parts.study.observations.n_eff[0];
    let mut list = vec![
        format!("The printed standard deviation is the scatter of single pictures; the mean is worth {n_eff} independent ones. Fits for 1, 5, 15 and 30 are listed under goodness of fit."),
        "The four responses of a picture scatter together with correlation 0.5 (centre of area downwards -0.5); 0 and 0.9 are listed.".to_owned(),
        "The surrogate's error is the uncertainty of its coefficients and its residual standard deviation, correlated between responses as its residuals are, and between speeds over a quarter of their range.".to_owned(),
        "Nuisances have the normal priors listed, are common to all speeds, and are marginalised.".to_owned(),
        format!("Intervals are where minus twice the log likelihood rises by {:.2}, times chi-square over its degrees of freedom where that is above 1.", upper_quantile(0.95)),
    ];
    if !parts.held_out.is_empty() {
        let list_of: Vec<String> =
            rmse(parts.held_out).iter().map(|(r, v)| format!("{r} {v:.2}")).collect();
        list.push(format!(
            "Speeds kept aside are predicted with root mean square errors {}.",
            list_of.join(", ")
        ));
    }
    list
}
