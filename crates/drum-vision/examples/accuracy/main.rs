//! Accuracy on synthetic frames of known silhouette: errors, coverage and rejected frames, as a table.
//!
//! `cargo run --release -p drum-vision --example accuracy -- [FRAMES] [WIDTH]`

#![expect(clippy::print_stdout, reason = "an example reports to the terminal")]
#![expect(clippy::unwrap_used, reason = "synthetic scenes are drawn from valid ranges")]
#![allow(missing_docs, clippy::allow_attributes, reason = "shared with the tests")]

#[path = "../../tests/it/scenes.rs"]
mod scenes;

use rayon::prelude::*;

fn main() {
    let mut args = std::env::args().skip(1);
    let n: u64 = args.next().and_then(|a| a.parse().ok()).unwrap_or(100);
    let width: u32 = args.next().and_then(|a| a.parse().ok()).unwrap_or(484);
    let size = (width, width * 2 / 3);
    let config = drum_vision::VisionConfig::default();
    let verbose = std::env::var_os("VERBOSE").is_some();
    type Maker = fn(u64, (u32, u32)) -> scenes::Case;
    let makers: [(&str, Maker); 2] = [("clean", scenes::clean), ("degraded", scenes::degraded)];
    for (name, make) in makers {
        let all: Vec<Row> = (0..n)
            .into_par_iter()
            .map(|k| {
                let case = make(k, size);
                let o = scenes::outcome(&case, &config);
                if let Some(dir) = std::env::var_os("OUT") {
                    let path = std::path::Path::new(&dir).join(format!("{name}_{k:03}.png"));
                    drum_vision::overlay::write_png(&case.frame, &path).unwrap();
                }
                (k, case.bed, o)
            })
            .collect();
        if std::env::var_os("DUMP").is_some() {
            dump(name, &all);
        } else {
            report(name, &all, verbose);
        }
    }
}

type Row = (u64, drum_film::Bed, Result<scenes::Outcome, drum_vision::VisionError>);

fn report(name: &str, all: &[Row], verbose: bool) {
    let good: Vec<&scenes::Outcome> = all.iter().filter_map(|r| r.2.as_ref().ok()).collect();
    println!("{name}: {} frames, {} rejected", all.len(), all.len() - good.len());
    for (k, _, o) in all {
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
        let mut worst: Vec<&Row> = all.iter().filter(|r| r.2.is_ok()).collect();
        let score = |r: &Row| {
            r.2.as_ref().map_or(0.0, |o| {
                o.error[0].abs().max(o.error[1].abs()).max(o.error[2].abs()).max(o.error[3].abs())
            })
        };
        worst.sort_by(|a, b| score(b).total_cmp(&score(a)));
        for r in worst.iter().take(15) {
            let o = r.2.as_ref().unwrap();
            println!(
                "  frame {:4} fill {:.2} lin {:.1} s {:.1} curv {:+.2} {:?}: err {:.3?} u {:.3?} circle {:.3?}",
                r.0,
                r.1.fill,
                r.1.aor_lin_deg,
                r.1.s_shape_deg,
                r.1.curvature,
                r.1.raised,
                o.error,
                o.sd,
                o.circle
            );
        }
    }
}

/// Errors and components of the uncertainty, one row a frame and response, for fitting the weights.
fn dump(name: &str, all: &[Row]) {
    for (k, _, o) in all {
        let Ok(o) = o else { continue };
        for r in 0..4 {
            print!("{name},{k},{r},{},{}", o.radius_px, o.error[r]);
            for (_, c) in o.budget.components() {
                print!(",{}", c[r]);
            }
            println!();
        }
    }
}
