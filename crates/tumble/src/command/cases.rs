//! `tumble cases`: what is built in.

use rig_schema::ErrataLevel;
use serde::Serialize;

use crate::cli::CasesArgs;
use crate::input;

#[derive(Serialize)]
struct Row {
    case: String,
    title: String,
    speeds_rpm: Vec<f64>,
    runs: usize,
    particles: Option<f64>,
}

pub(crate) fn run(args: &CasesArgs) -> anyhow::Result<()> {
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
    if args.json {
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
    Ok(())
}
