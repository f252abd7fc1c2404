//! `tumble fit`: response surfaces of a table and their diagnostics.

use std::path::Path;

use calib_report::calibration::CalibrationReport;
use calib_report::page::{Column, Provenance, Row, Table, Tone, Verdict};
use calib_report::pictures::FitSummary;
use doe::{Factor, Fit, Model, ModelTerms, Weighting};
use rig_schema::{Response, SimulatedTable};
use serde::Serialize;

use crate::cli::FitArgs;
use crate::input::{self, InputError};
use crate::output;
use crate::report::diagnostics::{diagnostics, p_value, quality};

#[derive(Serialize)]
struct Coefficient {
    term: String,
    estimate: f64,
    standard_error: f64,
    p: f64,
}

#[derive(Serialize)]
struct Surface {
    response: &'static str,
    r2: f64,
    r2adj: f64,
    q2: Option<f64>,
    rmse: f64,
    validity: Option<f64>,
    reproducibility: Option<f64>,
    condition_number: f64,
    coefficients: Vec<Coefficient>,
    removed: Vec<String>,
}

#[derive(Serialize)]
struct Surfaces {
    table: String,
    runs: usize,
    factors: Vec<String>,
    surfaces: Vec<Surface>,
    report: String,
}

pub(crate) fn run(args: &FitArgs) -> anyhow::Result<()> {
    let (table, inputs, name) = table(args)?;
    let names: Vec<String> =
        std::iter::once("omega_rpm".to_owned()).chain(table.factors.iter().cloned()).collect();
    let mut surfaces = Vec::new();
    let mut responses = Vec::new();
    let mut rows = Vec::new();
    let mut logs = Vec::new();
    for r in Response::ALL {
        let used: Vec<_> = table.rows.iter().filter(|row| row.cells[r.index()].is_some()).collect();
        if used.is_empty() {
            continue;
        }
        let points: Vec<Vec<f64>> = used
            .iter()
            .map(|row| std::iter::once(row.omega_rpm).chain(row.factors.iter().copied()).collect())
            .collect();
        let y: Vec<f64> =
            used.iter().filter_map(|row| row.cells[r.index()]).map(|c| c.mean).collect();
        let mut factors = Vec::new();
        for (k, name) in names.iter().enumerate() {
            let column = points.iter().map(|p| p[k]);
            let (low, high) = column.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
            if low < high {
                factors.push((k, Factor::new(name.clone(), low, high)?));
            }
        }
        let points: Vec<Vec<f64>> =
            points.iter().map(|p| factors.iter().map(|(k, _)| p[*k]).collect()).collect();
        let factors: Vec<Factor> = factors.into_iter().map(|(_, f)| f).collect();
        let terms = match &args.saturating {
            Some((factor, m0)) => ModelTerms::saturating(&factors, factor, *m0)?,
            None => ModelTerms::quadratic(&factors),
        };
        let model = Model::new(&factors, &terms)?;
        let mut removed = Vec::new();
        let fit = if args.eliminate {
            let done = doe::eliminate(&model, &points, &y, Weighting::Ordinary, 0.05, &[])?;
            removed =
                done.steps.iter().map(|s| format!("{} (p {})", s.removed, p_value(s.p))).collect();
            done.fit
        } else {
            doe::fit(&model, &points, &y, Weighting::Ordinary)?
        };
        let runs: Vec<String> = used.iter().map(|row| format!("N{}", row.run)).collect();
        let mut about = diagnostics(r, &fit, &runs)?;
        if !removed.is_empty() {
            about.tables.push(elimination_table(&removed));
        }
        responses.push(about);
        rows.push(quality(r, &fit));
        logs.push(line(r, &fit, &removed));
        surfaces.push(surface(r, &fit, removed)?);
    }
    if surfaces.is_empty() {
        let what = "no row holds a response; expected numbers in one of their columns at least";
        return Err(InputError::Case { file: table.file, what: what.to_owned() }.into());
    }
    let report = CalibrationReport {
        case: name.clone(),
        subtitle: format!("response surfaces over {}", names.join(", ")),
        verdict: Some(Verdict {
            sentence: format!(
                "{} response surfaces over {} runs.",
                surfaces.len(),
                table.rows.len()
            ),
            tone: Tone::Neutral,
        }),
        fit_summary: Some(FitSummary { title: "Summary of fit".to_owned(), rows }),
        responses,
        provenance: Some(Provenance {
            inputs,
            seed: None,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: format!("tumble fit {}", args.table),
            settings: Vec::new(),
        }),
        ..CalibrationReport::default()
    };
    let folder = output::folder(args.out.as_deref(), &format!("fit_{name}"))?;
    let path = output::write(&folder, "report.html", &report.html())?;
    let all = Surfaces {
        table: table.file.clone(),
        runs: table.rows.len(),
        factors: names,
        surfaces,
        report: path.display().to_string(),
    };
    let text = serde_json::to_string_pretty(&all)?;
    output::write(&folder, "result.json", &text)?;
    if args.json {
        println!("{text}");
        return Ok(());
    }
    println!(
        "{:<14} {:>7} {:>7} {:>7} {:>7} {:>9} {:>9}",
        "response", "R2", "R2adj", "Q2", "rmse", "validity", "reprod."
    );
    logs.iter().for_each(|l| println!("{l}"));
    println!("report: {}", path.display());
    Ok(())
}

fn table(
    args: &FitArgs,
) -> anyhow::Result<(SimulatedTable, Vec<calib_report::page::InputFile>, String)> {
    if !Path::new(&args.table).is_file()
        && let Some(case) = input::built_in(&args.table)
    {
        let loaded = input::load(case, args.errata.into())?;
        return Ok((loaded.simulated, loaded.inputs, case.to_owned()));
    }
    let path = Path::new(&args.table);
    let text = input::read(path)?;
    let factors = SimulatedTable::factor_columns(&text.text);
    let factors: Vec<&str> = factors.iter().map(String::as_str).collect();
    let table = SimulatedTable::parse(&text.name, &text.text, &factors)?;
    let name =
        path.file_stem().map_or_else(|| "table".to_owned(), |s| s.to_string_lossy().into_owned());
    Ok((table, vec![text.input()], name))
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |v| format!("{v:.4}"))
}

fn line(r: Response, fit: &Fit, removed: &[String]) -> String {
    let s = fit.summary();
    let mut text = format!(
        "{:<14} {:>7.4} {:>7.4} {:>7} {:>7.3} {:>9} {:>9}",
        r.column(),
        s.r2,
        s.r2_adjusted,
        optional(s.q2),
        s.rmse,
        optional(s.validity),
        optional(s.reproducibility)
    );
    if !removed.is_empty() {
        text.push_str(&format!("\n{:<14} removed: {}", "", removed.join(", ")));
    }
    text
}

fn elimination_table(removed: &[String]) -> Table {
    Table {
        caption: "Terms removed, in order (hierarchy kept)".to_owned(),
        columns: vec![Column::text("term")],
        rows: removed.iter().map(|r| Row::new(vec![r.clone()])).collect(),
    }
}

fn surface(r: Response, fit: &Fit, removed: Vec<String>) -> anyhow::Result<Surface> {
    let s = fit.summary();
    Ok(Surface {
        response: r.column(),
        r2: s.r2,
        r2adj: s.r2_adjusted,
        q2: s.q2,
        rmse: s.rmse,
        validity: s.validity,
        reproducibility: s.reproducibility,
        condition_number: s.condition_number,
        coefficients: fit
            .coefficient_table(0.95)?
            .into_iter()
            .map(|c| Coefficient {
                term: c.term,
                estimate: c.estimate,
                standard_error: c.standard_error,
                p: c.p,
            })
            .collect(),
        removed,
    })
}
