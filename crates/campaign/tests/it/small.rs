//! A plan of six runs of a slice of beads, a second or so each.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use campaign::Resolution;
use campaign::plan::{Campaign, Freeze, Manifest, RunOptions, Summary};

pub(crate) const PLAN: &str = r#"
name = "a slice of beads"
factors.friction.pp = [0.2, 0.5, 0.8]
factors.run.speed_rpm = [50.0, 70.0]
design.full_factorial = { centre_points = 0 }
drum = { radius_m = 0.02, length_m = 0.0075, mantle = "glass", end_plates = "glass", ends = "periodic" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.0025 } } }
fill.count = 180
friction.mantle = 0.6
restitution = { pp = 0.7, mantle = 0.7 }
rolling = { pp = 0.01, mantle = 0.01 }
camera.distance_m = 0.1
run = { speeds_rpm = [60.0], frames = 4, seed = 11 }
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2e5 }
"#;

/// Small frames.
pub(crate) fn freeze() -> Freeze {
    Freeze { resolution: Resolution { width_px: 480, ..Resolution::default() }, coarse: None }
}

/// The campaign of a plan in a folder.
pub(crate) fn campaign(folder: &Path, plan: &str) -> Campaign {
    let manifest = Manifest::freeze("plan.toml", plan, &freeze()).expect("is a plan");
    Campaign::begin(folder, manifest).expect("the folder can be written")
}

/// Run a campaign to its end.
pub(crate) fn run(campaign: &Campaign, jobs: usize) -> Summary {
    let how = RunOptions { jobs, ..RunOptions::default() };
    campaign.run(&how, &AtomicBool::new(false), |_| {}).expect("the campaign runs")
}

/// The plan with one text in place of another that is there.
pub(crate) fn with(from: &str, to: &str) -> String {
    assert!(PLAN.contains(from), "{from}");
    PLAN.replacen(from, to, 1)
}

/// An error with its causes.
pub(crate) fn words(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(e) = cause {
        text = format!("{text}: {e}");
        cause = e.source();
    }
    text
}
