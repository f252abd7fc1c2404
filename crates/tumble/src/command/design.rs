//! `tumble design`: the table of runs of a plan.

use std::path::Path;

use campaign::Resolution;
use campaign::drum_rig::Coarsening;
use campaign::plan::{Freeze, Manifest, SPEED};
use serde::Serialize;

use crate::cli::DesignArgs;
use crate::{input, output};

#[derive(Serialize)]
struct Run<'a> {
    run: u64,
    values: Vec<(&'a str, f64)>,
    speeds_rpm: &'a [f64],
    seed: u64,
    particles: usize,
    time_step_s: f64,
    least_steps: u64,
}

pub(crate) fn run(args: &DesignArgs) -> anyhow::Result<()> {
    let text = input::read(&args.plan)?;
    let coarse = args.coarse.then(Coarsening::default);
    let how = Freeze { resolution: Resolution::default(), coarse };
    let manifest = Manifest::freeze(&text.name, &text.text, &how)?;
    let runs: Vec<Run<'_>> = manifest
        .rows()
        .iter()
        .map(|row| {
            let outline = manifest.outline(row)?;
            let factors = manifest.factors().iter().map(String::as_str);
            Ok(Run {
                run: row.index,
                values: factors.zip(row.values.iter().copied()).collect(),
                speeds_rpm: &row.speeds_rpm,
                seed: row.seed,
                particles: outline.particles,
                time_step_s: outline.time_step_s,
                least_steps: outline.least_steps,
            })
        })
        .collect::<anyhow::Result<_>>()?;
    let table = if args.json { serde_json::to_string_pretty(&runs)? + "\n" } else { csv(&runs) };
    let Some(path) = &args.out else {
        print!("{table}");
        return Ok(());
    };
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or("runs.csv");
    let written = output::write(&output::folder(Some(folder), "")?, name, &table)?;
    println!("{} runs: {}", runs.len(), written.display());
    Ok(())
}

/// One row a run; several speeds of one run stand in one cell.
fn csv(runs: &[Run<'_>]) -> String {
    let Some(first) = runs.first() else { return String::new() };
    let mut header = vec!["run"];
    header.extend(first.values.iter().map(|(path, _)| *path).filter(|path| *path != SPEED));
    header.extend(["speeds_rpm", "seed", "particles", "time_step_s", "least_steps"]);
    let mut text = header.join(",") + "\n";
    for r in runs {
        let mut cells = vec![r.run.to_string()];
        let values = r.values.iter().filter(|(path, _)| *path != SPEED);
        cells.extend(values.map(|(_, value)| value.to_string()));
        let speeds: Vec<String> = r.speeds_rpm.iter().map(f64::to_string).collect();
        cells.push(speeds.join(" "));
        cells.extend([r.seed.to_string(), r.particles.to_string()]);
        cells.extend([format!("{:.3e}", r.time_step_s), r.least_steps.to_string()]);
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}
