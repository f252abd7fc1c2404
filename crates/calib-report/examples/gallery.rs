//! Draws every picture from the published data of one configuration and writes them as a page.
//!
//! ```text
//! cargo run --release -p calib-report --example gallery -- AZ4_Steel gallery.html
//! ```
//!
//! The surrogates are the full quadratics of `doe`; the matching is a plain chi-square with the frame
//! sd at the middle of wall friction, which serves a gallery: the crate `calib` does it in earnest.

use std::error::Error;

use calib_report::calibration::{
    CalibrationReport, FrictionRow, GoodnessRow, OutlierRow, ResidualRow, ResponseDiagnostics,
    WallFriction,
};
use calib_report::contour::Grid;
use calib_report::page::{Block, Figure, InputFile, Provenance, Section, Tone, Verdict};
use calib_report::pictures::*;
use doe::{DoeError, Factor, Fit, Model, ModelTerms, Skewness, Transform, Weighting};
use statrs::distribution::{ChiSquared, ContinuousCDF};

const RESPONSES: [(&str, &str, &str); 4] = [
    ("AoR line", "°", "aor_lin"),
    ("AoR mid", "°", "aor_mid"),
    ("centre x", "% R", "cen_x"),
    ("centre y", "% R", "cen_y"),
];
const WALL: (f64, f64) = (0.4, 0.8);
const PARTICLE: (f64, f64) = (0.1, 0.9);

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let case = arguments.next().unwrap_or_else(|| "AZ4_Steel".into());
    let path = arguments.next().unwrap_or_else(|| "gallery.html".into());
    let simulated = table(&format!("thesis/tables/edem_{case}.csv"))?;
    let measured = table(&format!("thesis/tables/experiment_{case}.csv"))?;
    let fits: Vec<Fit> =
        RESPONSES.iter().map(|(_, _, key)| quadratic(&simulated, key)).collect::<Result<_, _>>()?;
    let report = report(&case, &simulated, &measured, &fits)?;
    std::fs::write(path, report.html())?;
    Ok(())
}

/// A table of numbers under named columns.
struct Numbers {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Numbers {
    fn column(&self, name: &str) -> Vec<f64> {
        match self.names.iter().position(|n| n == name) {
            Some(c) => self.rows.iter().map(|r| r[c]).collect(),
            None => vec![f64::NAN; self.rows.len()],
        }
    }
}

fn table(path: &str) -> Result<Numbers, Box<dyn Error>> {
    let text = tumble_fixtures::read(path).ok_or_else(|| format!("no fixture {path}"))?;
    let mut lines = text.lines().filter(|l| !l.starts_with('#'));
    let names = lines.next().unwrap_or_default().split(',').map(Into::into).collect();
    let number = |cell: &str| cell.trim().parse().unwrap_or(f64::NAN);
    let rows = lines.map(|l| l.split(',').map(number).collect()).collect();
    Ok(Numbers { names, rows })
}

fn mean_column(table: &Numbers, key: &str) -> String {
    let unit = if key.starts_with("aor") { "deg" } else { "pct" };
    let name = format!("{key}_{unit}");
    if table.names.contains(&name) { name } else { key.into() }
}

fn ranges(case: &str) -> Result<Vec<PrintedRange>, Box<dyn Error>> {
    let text =
        tumble_fixtures::read("thesis/tables/mu_ranges_section5_1.csv").ok_or("no ranges")?;
    let rows = text.lines().map(|l| l.split(',').collect::<Vec<_>>());
    let rows = rows.filter(|cells| cells.first() == Some(&case));
    rows.map(|cells| {
        Ok(PrintedRange {
            omega_rpm: cells[1].parse()?,
            lo: cells[2].parse()?,
            hi: cells[3].parse()?,
        })
    })
    .collect()
}

/// A full quadratic in speed, wall and particle friction.
fn quadratic(simulated: &Numbers, key: &str) -> Result<Fit, DoeError> {
    let factors = [
        Factor::new("ω", 4.0, 30.0)?,
        Factor::new("μ_{wall}", WALL.0, WALL.1)?,
        Factor::new("μ_{pp}", PARTICLE.0, PARTICLE.1)?,
    ];
    let columns = ["omega_rpm", "mu_wall", "mu_pp"].map(|n| simulated.column(n));
    let points: Vec<[f64; 3]> =
        (0..simulated.rows.len()).map(|i| [columns[0][i], columns[1][i], columns[2][i]]).collect();
    let model = Model::new(&factors, &ModelTerms::quadratic(&factors))?;
    let response = simulated.column(&mean_column(simulated, key));
    doe::fit(&model, &points, &response, Weighting::Ordinary)
}

/// A term as it is set in type.
fn typeset(term: &str) -> String {
    term.replace('*', "·").replace("^2", "^{2}")
}

/// Chi-square of one measured row at a friction, with the frame sd.
fn chi2(measured: &Numbers, fits: &[Fit], row: usize, particle: f64) -> f64 {
    let omega = measured.column("omega_rpm")[row];
    RESPONSES
        .iter()
        .zip(fits)
        .map(|((_, _, key), fit)| {
            let mean = measured.column(&mean_column(measured, key))[row];
            let sd = measured.column(&format!("{key}_sd"))[row];
            ((mean - fit.mean(&[omega, 0.6, particle])) / sd.hypot(fit.rmse())).powi(2)
        })
        .sum()
}

/// Best value and the interval in which a function rises by less than 3.84.
fn interval(f: impl Fn(f64) -> f64) -> (f64, Option<f64>, Option<f64>) {
    let grid: Vec<f64> = (0..=1600).map(|i| 0.1 + 0.0005 * f64::from(i)).collect();
    let values: Vec<f64> = grid.iter().map(|m| f(*m)).collect();
    let best = (0..grid.len()).min_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap_or(0);
    let out = |i: &usize| values[*i] > values[best] + 3.84;
    let lo = (0..best).rev().find(out).map(|i| grid[i]);
    let hi = (best..grid.len()).find(out).map(|i| grid[i]);
    (grid[best], lo, hi)
}

fn report(
    case: &str,
    simulated: &Numbers,
    measured: &Numbers,
    fits: &[Fit],
) -> Result<CalibrationReport, Box<dyn Error>> {
    let speeds = measured.column("omega_rpm");
    let inside: Vec<usize> = (0..speeds.len()).filter(|&i| speeds[i] <= 30.0).collect();
    let printed = ranges(case)?;
    let estimates: Vec<FrictionAtSpeed> = inside
        .iter()
        .map(|&i| {
            let (value, lo, hi) = interval(|m| chi2(measured, fits, i, m));
            FrictionAtSpeed { omega_rpm: speeds[i], value: Some(value), lo, hi }
        })
        .collect();
    let joint_chi2 = |m: f64| inside.iter().map(|&i| chi2(measured, fits, i, m)).sum::<f64>();
    let (best, lo, hi) = interval(joint_chi2);
    let joint = FrictionAtSpeed { omega_rpm: 0.0, value: Some(best), lo, hi };

    let maps = [4.0, 17.0, 30.0]
        .into_iter()
        .map(|omega| map(case, omega, measured, fits, &printed, (best, lo, hi)))
        .collect();
    let residuals: Vec<ResidualRow> = inside
        .iter()
        .flat_map(|&i| {
            RESPONSES.iter().zip(fits).map(move |((name, unit, key), fit)| ResidualRow {
                omega_rpm: speeds_of(measured, i),
                response: (*name).into(),
                unit: (*unit).into(),
                measured: measured.column(&mean_column(measured, key))[i],
                model: fit.mean(&[speeds_of(measured, i), 0.6, best]),
                sd: measured.column(&format!("{key}_sd"))[i].hypot(fit.rmse()),
                outlier: false,
            })
        })
        .map(|mut r| {
            r.outlier = ((r.measured - r.model) / r.sd).abs() > 6.0;
            r
        })
        .collect();
    let residual_speed = ResidualSpeed {
        title: format!("Residuals of {case} against speed"),
        sd_of: "sd".into(),
        limit: Some(2.0),
        responses: RESPONSES
            .iter()
            .map(|(name, _, _)| ResponseResiduals {
                response: (*name).into(),
                points: residuals
                    .iter()
                    .filter(|r| r.response == *name)
                    .map(|r| ResidualAtSpeed {
                        omega_rpm: r.omega_rpm,
                        residual_sd: (r.measured - r.model) / r.sd,
                        outlier: r.outlier,
                    })
                    .collect(),
            })
            .collect(),
    };
    let dof = 4 * inside.len() - 1;
    let p = ChiSquared::new(dof as f64)?.sf(joint_chi2(best));
    let outliers = residuals
        .iter()
        .filter(|r| r.outlier)
        .map(|r| OutlierRow {
            place: format!("{} rpm", r.omega_rpm),
            response: r.response.clone(),
            value: Some(r.measured),
            expected: Some(r.model),
            distance_sd: Some((r.measured - r.model) / r.sd),
            note: "beyond 6 sd of the joint fit".into(),
        })
        .collect();
    let friction = inside
        .iter()
        .zip(&estimates)
        .map(|(&i, e)| FrictionRow {
            omega_rpm: Some(e.omega_rpm),
            mu_pp: e.value,
            lo: e.lo,
            hi: e.hi,
            printed: printed.iter().find(|p| p.omega_rpm == e.omega_rpm).map(|p| (p.lo, p.hi)),
            chi2: e.value.map(|m| chi2(measured, fits, i, m)),
            dof: Some(3),
            ..Default::default()
        })
        .chain([FrictionRow {
            mu_pp: Some(best),
            lo,
            hi,
            chi2: Some(joint_chi2(best)),
            dof: Some(dof),
            ..Default::default()
        }])
        .collect();
    let grid: Vec<f64> = (0..=1600).map(|i| 0.1 + 0.0005 * f64::from(i)).collect();
    let density: Vec<(f64, f64)> = (0..=1600)
        .map(|i| 0.1 + 0.0005 * f64::from(i))
        .map(|m| (m, (-0.5 * (joint_chi2(m) - joint_chi2(best))).exp()))
        .collect();
    let norm: f64 = 0.0005 * density.iter().map(|d| d.1).sum::<f64>();
    Ok(CalibrationReport {
        case: case.into(),
        subtitle: "Gallery of pictures: one configuration, matched by a plain chi-square".into(),
        verdict: Some(Verdict {
            sentence: format!(
                "Particle friction μ_{{pp}} is {best:.3} by a plain chi-square of all speeds."
            ),
            tone: Tone::Neutral,
        }),
        facts: vec![
            ("measured speeds".into(), format!("{} from 4 to 30 rpm", inside.len())),
            ("simulated runs".into(), simulated.rows.len().to_string()),
        ],
        warnings: vec![
            "Speeds above 30 rpm, if measured, are beyond the simulated range and left out.".into(),
        ],
        friction,
        interval_level: "95 %".into(),
        wall: Some(WallFriction {
            reason: "The gallery holds it at 0.6, the middle of its range.".into(),
            ..Default::default()
        }),
        goodness: vec![GoodnessRow {
            errors: "frame sd and surrogate".into(),
            chi2: Some(joint_chi2(best)),
            dof: Some(dof),
            p_chi2: Some(p),
            reading: if p < 0.01 { "rejected" } else { "fits" }.into(),
            mu_pp: Some((best, lo, hi)),
            ..Default::default()
        }],
        maps,
        friction_speed: Some(FrictionSpeed {
            title: format!("Friction of {case} against speed"),
            estimates,
            joint: Some(joint),
            printed,
            range: Some(PARTICLE),
            level: "95 %".into(),
            ..Default::default()
        }),
        residual_speed: Some(residual_speed),
        residuals,
        outliers,
        profiles: vec![ProfileLikelihood {
            title: "Profile of μ_{pp}, all speeds".into(),
            parameter: "particle friction μ_{pp}".into(),
            points: grid.iter().map(|m| (*m, joint_chi2(*m) - joint_chi2(best))).collect(),
            best: Some(best),
            threshold: 3.84,
            interval: (lo, hi),
            level: "95 %".into(),
        }],
        posteriors: vec![PosteriorDensity {
            title: "Posterior of μ_{pp}, all speeds".into(),
            parameter: "particle friction μ_{pp}".into(),
            points: density.iter().map(|(m, d)| (*m, d / norm)).collect(),
            prior: vec![(0.1, 1.25), (0.9, 1.25)],
            centre: Some(best),
            centre_label: "mode".into(),
            interval: lo.zip(hi),
            level: "95 %".into(),
        }],
        fit_summary: Some(FitSummary {
            title: "Summary of fit".into(),
            rows: RESPONSES
                .iter()
                .zip(fits)
                .map(|((name, _, _), fit)| (name, fit.summary()))
                .map(|(name, summary)| FitQuality {
                    response: (*name).into(),
                    r2: Some(summary.r2),
                    q2: summary.q2,
                    validity: summary.validity,
                    reproducibility: summary.reproducibility,
                })
                .collect(),
        }),
        responses: RESPONSES
            .iter()
            .zip(fits)
            .map(|((name, unit, _), fit)| diagnostics(name, unit, fit))
            .collect::<Result<_, _>>()?,
        extra: vec![general()],
        assumptions: vec![
            "Responses of one picture are taken as independent.".into(),
            "Wall friction is held at 0.6.".into(),
        ],
        provenance: Some(Provenance {
            inputs: vec![InputFile {
                name: format!("experiment_{case}.csv"),
                hash: "blake3 9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"
                    .into(),
            }],
            version: format!("calib-report {}", env!("CARGO_PKG_VERSION")),
            command: format!("cargo run -p calib-report --example gallery -- {case}"),
            settings: vec![("errata applied".into(), "none".into())],
            ..Default::default()
        }),
        ..Default::default()
    })
}

fn speeds_of(measured: &Numbers, row: usize) -> f64 {
    measured.column("omega_rpm")[row]
}

fn map(
    case: &str,
    omega: f64,
    measured: &Numbers,
    fits: &[Fit],
    printed: &[PrintedRange],
    estimate: (f64, Option<f64>, Option<f64>),
) -> CalibrationMap {
    let nearest = (0..measured.rows.len()).min_by(|a, b| {
        let distance = |i: usize| (speeds_of(measured, i) - omega).abs();
        distance(*a).total_cmp(&distance(*b))
    });
    CalibrationMap {
        title: match nearest.map(|i| speeds_of(measured, i)) {
            Some(speed) if speed != omega => {
                format!("{case} at {omega:.0} rpm, measured at {speed:.0} rpm")
            }
            _ => format!("{case} at {omega:.0} rpm"),
        },
        x_label: "wall friction μ_{wall}".into(),
        y_label: "particle friction μ_{pp}".into(),
        responses: RESPONSES
            .iter()
            .zip(fits)
            .map(|((name, unit, key), fit)| MappedResponse {
                name: (*name).into(),
                unit: (*unit).into(),
                field: Grid::sample(41, 81, WALL, PARTICLE, |w, p| fit.mean(&[omega, w, p])),
                measured: nearest.map(|i| measured.column(&mean_column(measured, key))[i]),
                sd: nearest.map_or(0.0, |i| measured.column(&format!("{key}_sd"))[i]),
            })
            .collect(),
        estimate: Some(estimate),
        estimate_label: "this work, all speeds".into(),
        printed: printed.iter().find(|p| p.omega_rpm == omega).map(|p| (p.lo, p.hi)),
    }
}

fn diagnostics(name: &str, unit: &str, fit: &Fit) -> Result<ResponseDiagnostics, DoeError> {
    let (response, unit) = (name.to_string(), unit.to_string());
    let values = fit.response();
    let run = |i: usize| format!("N{}", i + 1);
    let points = fit.points();
    let replicates = (0..fit.runs()).map(|i| ReplicatePoint {
        run: run(i),
        // Numbered by the first run of the same setting.
        setting: points.iter().position(|p| *p == points[i]).unwrap_or(i) + 1,
        value: values[i],
    });
    let coefficients = fit.coefficient_table(0.95)?.into_iter().filter(|row| row.term != "1");
    let residuals = fit.studentised_deleted_residuals().iter().enumerate();
    let skewness = Skewness::of(values);
    let advice = match skewness.and_then(|s| s.advice(values)) {
        None | Some(Transform::Identity) => "none needed".into(),
        Some(Transform::Log) => "log y".into(),
        Some(Transform::BoxCox { lambda }) => format!("Box-Cox, λ = {lambda:.2}"),
        Some(Transform::NegativeLog { upper }) => format!("−log({upper:.1} − y)"),
    };
    let effect = (0..=40).map(|i| 0.1 + 0.02 * f64::from(i)).map(|mu| {
        let prediction = fit.predict(&[17.0, 0.6, mu])?;
        let interval = Some(prediction.interval(0.95)?);
        Ok(EffectPoint { factor: mu, response: prediction.mean, interval })
    });
    Ok(ResponseDiagnostics {
        response: response.clone(),
        summary: format!(
            "Full quadratic in speed, wall and particle friction: {} terms, {} runs, rmse {:.3} \
             {unit}, condition number {:.1}.",
            fit.coefficients().len(),
            fit.runs(),
            fit.rmse(),
            fit.condition_number()
        ),
        tables: Vec::new(),
        coefficients: Some(CoefficientPlot {
            title: format!("Coefficients of {name}"),
            response: response.clone(),
            unit: unit.clone(),
            coefficients: coefficients
                .map(|row| Coefficient {
                    term: typeset(&row.term),
                    value: row.estimate,
                    interval: Some((row.low, row.high)),
                })
                .collect(),
            level: "95 %".into(),
        }),
        replicates: Some(ReplicatePlot {
            title: format!("Replicates of {name}"),
            response: response.clone(),
            unit: unit.clone(),
            points: replicates.collect(),
        }),
        histogram: Some(ResponseHistogram {
            title: format!("Histogram of {name}"),
            response: response.clone(),
            unit: unit.clone(),
            values: values.to_vec(),
            skewness: skewness.map(|s| s.value),
            skewness_se: skewness.map(|s| s.standard_error),
            advice,
        }),
        normal: Some(NormalProbability {
            title: format!("Residuals of {name}"),
            residuals: residuals
                .map(|(i, r)| StudentisedResidual { run: run(i), residual: r.unwrap_or(f64::NAN) })
                .collect(),
            limit: Some(4.0),
        }),
        observed: Some(ObservedPredicted {
            title: format!("Observed against predicted {name}"),
            response: response.clone(),
            unit: unit.clone(),
            points: (fit.fitted().into_iter().zip(values).enumerate())
                .map(|(i, (predicted, observed))| ObservedPrediction {
                    run: run(i),
                    observed: *observed,
                    predicted,
                })
                .collect(),
        }),
        effects: vec![EffectPlot {
            title: format!("Effect of μ_{{pp}} on {name}"),
            factor: "particle friction μ_{pp}".into(),
            response: response.clone(),
            unit: unit.clone(),
            points: effect.collect::<Result<_, DoeError>>()?,
            response_range: None,
            level: "95 %".into(),
        }],
        interactions: vec![InteractionPlot {
            title: format!("Interaction of speed and μ_{{pp}} on {name}"),
            factor: "particle friction μ_{pp}".into(),
            response,
            unit,
            lines: [4.0, 17.0, 30.0]
                .into_iter()
                .map(|omega| InteractionLine {
                    level: format!("{omega:.0} rpm"),
                    points: (0..=20)
                        .map(|i| 0.1 + 0.04 * f64::from(i))
                        .map(|m| (m, fit.mean(&[omega, 0.6, m])))
                        .collect(),
                })
                .collect(),
        }],
    })
}

/// The pictures of general use, on made-up numbers.
fn general() -> Section {
    let convergence = LineChart {
        title: "Energy error of two integrators".into(),
        x: ChartAxis { spacing: AxisSpacing::Logarithmic, ..ChartAxis::new("time step, s") },
        y: ChartAxis { spacing: AxisSpacing::Logarithmic, ..ChartAxis::new("relative error") },
        series: [
            ("first order", 1, SeriesStyle::LineAndPoints),
            ("second order", 2, SeriesStyle::LineAndPoints),
        ]
        .into_iter()
        .map(|(name, order, style)| ChartSeries {
            name: name.into(),
            style,
            points: (0..6)
                .map(|i| 1e-6 * 3f64.powi(i))
                .map(|h| ChartPoint::from((h, (h / 1e-3).powi(order))))
                .collect(),
        })
        .collect(),
        ..Default::default()
    };
    let validation = LineChart {
        title: "Angle of repose: simulated and measured".into(),
        x: ChartAxis::new("drum speed, rpm"),
        y: ChartAxis::new("angle, °"),
        series: vec![
            ChartSeries {
                name: "simulated, 95 %".into(),
                style: SeriesStyle::Line,
                points: (0..=26)
                    .map(|i| 4.0 + f64::from(i))
                    .map(|x| ChartPoint {
                        x,
                        y: 26.0 + 0.25 * x,
                        interval: Some((25.2 + 0.25 * x, 26.8 + 0.25 * x)),
                    })
                    .collect(),
            },
            ChartSeries {
                name: "measured ± sd".into(),
                style: SeriesStyle::Points,
                points: (0..6)
                    .map(|i| 5.0 + 5.0 * f64::from(i))
                    .map(|x| ChartPoint {
                        x,
                        y: 26.4 + 0.22 * x,
                        interval: Some((25.9 + 0.22 * x, 26.9 + 0.22 * x)),
                    })
                    .collect(),
            },
            ChartSeries {
                name: "without rolling friction".into(),
                style: SeriesStyle::Line,
                points: vec![(4.0, 24.0).into(), (30.0, 30.0).into()],
            },
        ],
        horizontal_limits: vec![(35.0, "end of the definition".into())],
        ..Default::default()
    };
    let bars = GroupedBars {
        title: "Error before and after the effect was added, at held-out speeds".into(),
        value_label: "mean |residual|, sd".into(),
        series: vec!["before".into(), "after".into()],
        groups: [
            ("AoR line", 2.31, Some(0.62)),
            ("AoR mid", 1.85, Some(0.71)),
            ("centre x", 3.12, Some(1.05)),
            ("centre y", 4.4, None),
        ]
        .into_iter()
        .map(|(name, before, after)| BarGroup {
            name: name.into(),
            values: vec![Some(before), after],
        })
        .collect(),
        decimals: Some(2),
        limit: Some((1.0, "noise floor".into())),
    };
    let names: Vec<String> = ["rolling friction", "camera tilt", "cohesion", "fill level", "none"]
        .map(Into::into)
        .into();
    let confusion =
        HeatMap {
            title: "Which effect was named".into(),
            row_label: "true effect".into(),
            column_label: "effect named".into(),
            rows: names.clone(),
            columns: names,
            values: (0..25)
                .map(|k| {
                    if k % 6 == 0 { 0.9 - 0.03 * f64::from(k / 6) } else { 0.02 * f64::from(k % 4) }
                })
                .collect(),
            decimals: 2,
            shading: Shading::Sequential,
        };
    let correlation = HeatMap {
        title: "Correlation of residuals".into(),
        rows: RESPONSES.map(|r| r.0.to_string()).into(),
        columns: RESPONSES.map(|r| r.0.to_string()).into(),
        values: vec![
            1.0, 0.8, 0.6, -0.5, 0.8, 1.0, 0.4, -0.3, 0.6, 0.4, 1.0, -0.7, -0.5, -0.3, -0.7, 1.0,
        ],
        decimals: 2,
        shading: Shading::Diverging,
        ..Default::default()
    };
    Section::new("General charts")
        .with(Block::Note(Tone::Caution, "These numbers are made up to show the charts.".into()))
        .with(Block::Figures(vec![
            Figure::new(&convergence, "Logarithmic axes."),
            Figure::new(&validation, "A line with its band, points with error bars, a limit."),
            Figure::new(&bars, "Grouped bars; a dash where undefined."),
            Figure::new(&confusion, "Confusion matrix."),
            Figure::new(&correlation, "Diverging shades."),
            Figure::new(
                &LineChart { title: "Nothing measured".into(), ..Default::default() },
                "No data.",
            ),
        ]))
}
