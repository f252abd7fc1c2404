//! `tumble cases`: what is built in.

use std::path::Path;

use rig_schema::ErrataLevel;
use serde::Serialize;

use crate::cli::CasesArgs;
use crate::given::{self, DEMO};
use crate::input;

#[derive(Serialize)]
struct Row {
    case: String,
    title: String,
    speeds_rpm: Vec<f64>,
    runs: usize,
    particles: Option<f64>,
}

#[derive(Serialize)]
struct Written {
    case: String,
    tables: Vec<String>,
}

pub(crate) fn run(args: &CasesArgs) -> anyhow::Result<()> {
    match (&args.case, &args.write) {
        (Some(case), Some(folder)) => write(case, folder, args.json),
        _ => list(args.json),
    }
}

fn write(name: &str, folder: &Path, json: bool) -> anyhow::Result<()> {
    let files = given::write(name, folder)?;
    let mut files = files.iter().map(|f| f.display().to_string());
    let written = Written { case: files.next().unwrap_or_default(), tables: files.collect() };
    if json {
        println!("{}", serde_json::to_string_pretty(&written)?);
        return Ok(());
    }
    for file in std::iter::once(&written.case).chain(&written.tables) {
        println!("wrote {file}");
    }
    let command = if name.eq_ignore_ascii_case(DEMO) { "close-loop" } else { "calibrate" };
    println!("\nNext: tumble {command} {}", written.case);
    Ok(())
}

fn list(json: bool) -> anyhow::Result<()> {
    let mut rows = Vec::new();
    for name in tumble_fixtures::CASES {
        let loaded = input::load(name, ErrataLevel::None)?;
        rows.push(Row {
            case: name.to_owned(),
            title: loaded.case.rig.title.clone(),
            speeds_rpm: loaded.measured.rows.iter().map(|r| r.omega_rpm).collect(),
            runs: loaded.simulated.rows.len(),
            particles: loaded.case.rig.settings.value("fill.count"),
        });
    }
    if json {
        println!("{}", serde_json::to_string_pretty(&rows)?);
        return Ok(());
    }
    println!("{:<11} {:>6} {:>14} {:>5}  what", "case", "speeds", "range, rpm", "runs");
    for r in &rows {
        let range = match (r.speeds_rpm.first(), r.speeds_rpm.last()) {
            (Some(low), Some(high)) => format!("{low} to {high}"),
            _ => String::new(),
        };
        println!(
            "{:<11} {:>6} {:>14} {:>5}  {}",
            r.case,
            r.speeds_rpm.len(),
            range,
            r.runs,
            r.title
        );
    }
    println!("\nNext: tumble calibrate AZ4_Steel");
    println!("A case to start your own from: tumble cases demo --write my_drum");
    Ok(())
}
