//! Accuracy on frames of known silhouette: errors, coverage and rejected frames, as a table.
//!
//! `cargo run --release -p drum-vision --example accuracy -- [FRAMES] [WIDTH] [FIRST]`
//!
//! FRAMES clean and as many degraded frames of drum-film (200 each by default), WIDTH pixels wide, numbered from FIRST
//! (7000 by default; the weights of the uncertainty were fitted on numbers 0 to 299), then the hundred
//! frames of the independent renderer where the fixtures are at hand. VERBOSE=1 lists the worst frames, OUT=FOLDER
//! keeps the drawn ones, DUMP=1 prints errors with the components of the uncertainty instead.

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

fn main() {
    let mut args = std::env::args().skip(1);
    let n: u64 = args.next().and_then(|a| a.parse().ok()).unwrap_or(200);
    let width: u32 = args.next().and_then(|a| a.parse().ok()).unwrap_or(484);
    let first: u64 = args.next().and_then(|a| a.parse().ok()).unwrap_or(7000);
    let size = (width, width * 2 / 3);
    let config = drum_vision::VisionConfig::default();
    let verbose = std::env::var_os("VERBOSE").is_some();
    type Maker = fn(u64, (u32, u32)) -> scenes::Case;
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
        if std::env::var_os("DUMP").is_some() {
            dump(name, &all);
        } else {
            report(name, &all, verbose);
        }
    }
    for (name, degraded) in [("independent clean", false), ("independent degraded", true)] {
        let all = independent(degraded, &config);
        if std::env::var_os("DUMP").is_some() {
            dump(name, &all);
        } else {
            report(name, &all, verbose);
        }
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
                    warned: !m.warnings.is_empty(),
                })
            });
            (r.path.file_name().unwrap().to_string_lossy().into_owned(), outcome)
        })
        .collect()
}

fn report(name: &str, all: &[Row], verbose: bool) {
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
    for (k, label) in ["aor_lin", "aor_mid", "cen_x", "cen_y"].iter().enumerate() {
        let e: Vec<f64> = good.iter().map(|o| o.error[k]).collect();
        let a: Vec<f64> = e.iter().map(|v| v.abs()).collect();
        let u: Vec<f64> = good.iter().map(|o| o.sd[k]).collect();
        let n = e.len() as f64;
        let bias = e.iter().sum::<f64>() / n;
        let rms = (e.iter().map(|v| v * v).sum::<f64>() / n).sqrt();
        let cover = good.iter().filter(|o| o.error[k].abs() <= 2.0 * o.sd[k]).count() as f64 / n;
        let q = scenes::quantile;
        println!(
            "  {label:8} {:9.4} {:9.4} {:9.4} {bias:9.4} {rms:9.4} {:8.4} {:7.1}% {:9.2} {:9.2}",
            q(&a, 0.5),
            q(&a, 0.95),
            q(&a, 1.0),
            q(&u, 0.5),
            100.0 * cover,
            q(&u, 0.5) / rms,
            q(&u, 0.5) / q(&a, 0.5)
        );
    }
    let limit = if name.ends_with("clean") { [0.15, 0.15, 0.2, 0.2] } else { [0.5; 4] };
    let silent = good
        .iter()
        .filter(|o| (0..4).any(|k| o.error[k].abs() > limit[k] && o.error[k].abs() > 3.0 * o.sd[k]))
        .count();
    println!("  frames beyond a limit {limit:?} and 3 u, without a warning: {silent}");
    println!("  frames with a warning: {}", good.iter().filter(|o| o.warned).count());
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
        let mut worst: Vec<&Row> = all.iter().filter(|r| r.1.is_ok()).collect();
        let score = |r: &Row| {
            r.1.as_ref().map_or(0.0, |o| {
                o.error[0].abs().max(o.error[1].abs()).max(o.error[2].abs()).max(o.error[3].abs())
            })
        };
        worst.sort_by(|a, b| score(b).total_cmp(&score(a)));
        for r in worst.iter().take(10) {
            if let Ok(o) = &r.1 {
                println!("  {}: err {:.3?} u {:.3?} circle {:.3?}", r.0, o.error, o.sd, o.circle);
            }
        }
    }
}

/// Errors and components of the uncertainty, one row a frame and response, for fitting the weights.
fn dump(name: &str, all: &[Row]) {
    for (k, o) in all {
        let Ok(o) = o else { continue };
        for r in 0..4 {
            print!(
                "{name},{},{r},{},{}",
                k.split(' ').next().unwrap_or(""),
                o.radius_px,
                o.error[r]
            );
            for (_, c) in o.budget.components() {
                print!(",{}", c[r]);
            }
            println!();
        }
    }
}
