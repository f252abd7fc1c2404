//! Accuracy on frames of known silhouette: errors, coverage and rejected frames, as a table.
//!
//! `cargo run --release -p drum-vision --example accuracy -- [FRAMES] [WIDTH] [FIRST]`
//!
//! FRAMES clean and as many degraded frames of drum-film (200 each by default), WIDTH pixels wide, numbered from FIRST
//! (7000 by default; VALIDATION.md names those on which the weights of the uncertainty were fitted), then the hundred
//! frames of the independent renderer where the fixtures are at hand. VERBOSE=1 lists the worst frames, OUT=FOLDER
//! keeps the drawn ones, JSON=FILE writes every frame (errors, uncertainties with their components, warnings) and
//! the summary for machines.

#![expect(clippy::print_stdout, reason = "an example reports to the terminal")]
#![expect(clippy::unwrap_used, reason = "synthetic scenes are drawn from valid ranges")]
#![allow(
    dead_code,
    clippy::print_stderr,
    clippy::allow_attributes,
    reason = "modules shared with the tests"
)]

#[path = "../../tests/it/scenes.rs"]
mod scenes;

#[path = "../../tests/it/other_renderer.rs"]
mod other_renderer;

use rayon::prelude::*;
use serde_json::{Value, json};

fn main() {
    let mut args = std::env::args().skip(1);
    let n: u64 = args.next().and_then(|a| a.parse().ok()).unwrap_or(200);
    let width: u32 = args.next().and_then(|a| a.parse().ok()).unwrap_or(484);
    let first: u64 = args.next().and_then(|a| a.parse().ok()).unwrap_or(7000);
    let size = (width, width * 2 / 3);
    let config = drum_vision::VisionConfig::default();
    let verbose = std::env::var_os("VERBOSE").is_some();
    type Maker = fn(u64, (u32, u32)) -> scenes::Case;
    let mut sets = Vec::new();
    let makers: [(&str, Maker); 2] = [("clean", scenes::clean), ("degraded", scenes::degraded)];
    for (name, make) in makers {
        let all: Vec<Row> = (first..first + n)
            .into_par_iter()
            .map(|k| {
                let case = make(k, size);
                let o = scenes::outcome(&case, &config);
                if let Some(dir) = std::env::var_os("OUT") {
                    let path = std::path::Path::new(&dir).join(format!("{name}_{k:03}.png"));
                    drum_vision::overlay::write_png(&case.frame, &path).unwrap();
                }
                (format!("{k} {}", describe(&case.bed)), o)
            })
            .collect();
        sets.push(report(name, &all, verbose));
    }
    for (name, degraded) in [("independent clean", false), ("independent degraded", true)] {
        let all = independent(degraded, &config);
        sets.push(report(name, &all, verbose));
    }
    if let Some(path) = std::env::var_os("JSON") {
        let text = json!({ "first": first, "width_px": width, "height_px": size.1, "sets": sets });
        std::fs::write(path, format!("{text:#}\n")).unwrap();
    }
}

/// Name of the frame and its outcome.
type Row = (String, Result<scenes::Outcome, drum_vision::VisionError>);

fn describe(b: &drum_film::Bed) -> String {
    format!(
        "fill {:.2} lin {:.1} s {:.1} curvature {:+.2} {:?}",
        b.fill, b.aor_lin_deg, b.s_shape_deg, b.curvature, b.raised
    )
}

/// The independent frames, clean or degraded.
fn independent(degraded: bool, config: &drum_vision::VisionConfig) -> Vec<Row> {
    let rows = other_renderer::rows().unwrap_or_default();
    rows.par_iter()
        .filter(|r| r.degraded == degraded)
        .map(|r| {
            let outcome = drum_vision::decode::decode_file(&r.path, &config.decode).and_then(|f| {
                let m = drum_vision::measure_frame(&f, config, drum_vision::Context::default())?;
                let four = m.four();
                let c = m.drum.fit.circle;
                Ok(scenes::Outcome {
                    error: std::array::from_fn(|k| four[k].value - r.truth[k]),
                    sd: std::array::from_fn(|k| four[k].sd),
                    circle: [c.x_px - r.circle[0], c.y_px - r.circle[1], c.radius_px - r.circle[2]],
                    budget: m.budget,
                    radius_px: c.radius_px,
                    continued: m.continued,
                    visible: m.visible,
                    scatter_px: m.scatter_px,
                    edge_width_px: m.edge_width_px,
                    warnings: m.warnings.iter().map(ToString::to_string).collect(),
                })
            });
            (r.path.file_name().unwrap().to_string_lossy().into_owned(), outcome)
        })
        .collect()
}

/// Largest error that the project allows, degrees and percent of the radius.
fn limits(name: &str) -> [f64; 4] {
    if name.ends_with("clean") { [0.15, 0.15, 0.2, 0.2] } else { [0.5; 4] }
}

/// Prints the table of a set and returns it with all its frames.
fn report(name: &str, all: &[Row], verbose: bool) -> Value {
    let good: Vec<&scenes::Outcome> = all.iter().filter_map(|r| r.1.as_ref().ok()).collect();
    println!("{name}: {} frames, {} rejected", all.len(), all.len() - good.len());
    for (k, o) in all {
        if let Err(e) = o {
            println!("  frame {k}: {}: {e}", e.stage());
        }
    }
    println!(
        "  response   p50|err|  p95|err|  max|err|      bias       rms   med(u)  cover2u  med(u)/rms med(u)/p50"
    );
    let mut columns = serde_json::Map::new();
    for (k, label) in ["aor_lin", "aor_mid", "cen_x", "cen_y"].iter().enumerate() {
        let e: Vec<f64> = good.iter().map(|o| o.error[k]).collect();
        let a: Vec<f64> = e.iter().map(|v| v.abs()).collect();
        let u: Vec<f64> = good.iter().map(|o| o.sd[k]).collect();
        let n = e.len() as f64;
        let bias = e.iter().sum::<f64>() / n;
        let rms = (e.iter().map(|v| v * v).sum::<f64>() / n).sqrt();
        let cover = good.iter().filter(|o| o.error[k].abs() <= 2.0 * o.sd[k]).count() as f64 / n;
        let q = scenes::quantile;
        let (p50, p95, most, med_u) = (q(&a, 0.5), q(&a, 0.95), q(&a, 1.0), q(&u, 0.5));
        println!(
            "  {label:8} {p50:9.4} {p95:9.4} {most:9.4} {bias:9.4} {rms:9.4} {med_u:8.4} {:7.1}% {:9.2} {:9.2}",
            100.0 * cover,
            med_u / rms,
            med_u / p50
        );
        columns.insert(
            (*label).into(),
            json!({
                "median_abs_error": p50, "p95_abs_error": p95, "max_abs_error": most,
                "bias": bias, "rms_error": rms, "median_u": med_u, "coverage_2u": cover,
            }),
        );
    }
    let limit = limits(name);
    let beyond = |o: &scenes::Outcome| (0..4).any(|k| o.error[k].abs() > limit[k]);
    let failed = good.iter().filter(|o| beyond(o)).count();
    let unreported = good.iter().filter(|o| beyond(o) && o.warnings.is_empty()).count();
    let warned = good.iter().filter(|o| !o.warnings.is_empty()).count();
    println!("  beyond a limit {limit:?}: {failed}, of them without a warning: {unreported}");
    println!("  frames with a warning: {warned}");
    for (k, label) in ["x", "y", "r"].iter().enumerate() {
        let e: Vec<f64> = good.iter().map(|o| o.circle[k]).collect();
        let a: Vec<f64> = e.iter().map(|v| v.abs()).collect();
        println!(
            "  circle {label}: bias {:.4} px, p95 {:.4} px",
            e.iter().sum::<f64>() / e.len() as f64,
            scenes::quantile(&a, 0.95)
        );
    }
    if verbose {
        list_worst(all, &beyond);
    }
    json!({
        "set": name, "frames": all.len(), "rejected": all.len() - good.len(), "limits": limit,
        "beyond_limit": failed, "beyond_limit_without_warning": unreported, "with_warning": warned,
        "responses": columns, "rows": all.iter().map(row).collect::<Vec<_>>(),
    })
}

/// The frames beyond a limit and the ten with the largest errors over their uncertainty.
fn list_worst(all: &[Row], beyond: &impl Fn(&scenes::Outcome) -> bool) {
    let score =
        |o: &scenes::Outcome| (0..4).map(|k| o.error[k].abs() / o.sd[k]).fold(0.0, f64::max);
    let mut rows: Vec<(&str, &scenes::Outcome)> =
        all.iter().filter_map(|(k, o)| Some((k.as_str(), o.as_ref().ok()?))).collect();
    rows.sort_by(|a, b| score(b.1).total_cmp(&score(a.1)));
    for (i, (k, o)) in rows.iter().enumerate() {
        let mark = if beyond(o) { "beyond" } else { "" };
        if i < 10 || beyond(o) {
            println!("  {k}: err {:.3?} u {:.3?} {mark} {:?}", o.error, o.sd, o.warnings);
        }
    }
}

/// One frame for machines.
fn row((name, outcome): &Row) -> Value {
    match outcome {
        Err(e) => {
            json!({ "frame": name, "rejected": e.to_string(), "stage": e.stage().to_string() })
        }
        Ok(o) => {
            let parts: serde_json::Map<String, Value> = o
                .budget
                .components()
                .iter()
                .map(|(label, c)| ((*label).to_owned(), json!(c[..4])))
                .collect();
            json!({
                "frame": name, "radius_px": o.radius_px, "error": o.error, "u": o.sd,
                "components": parts, "circle_error_px": o.circle, "warnings": o.warnings,
                "continued": o.continued, "visible": o.visible,
                "scatter_px": o.scatter_px, "edge_width_px": o.edge_width_px,
            })
        }
    }
}
