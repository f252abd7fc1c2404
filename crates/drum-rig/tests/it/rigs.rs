//! Small rigs that tests share.

use drum_rig::rig_schema::{Rig, Settings};
use drum_rig::{Experiment, Flow, Options, Phase, Sampled};

/// A drum of 60 x 24 mm with `count` soft beads of 4 mm.
pub(crate) fn small(count: u32) -> Rig {
    let text = format!(
        r#"
name = "small"
drum = {{ radius_m = 0.03, length_m = 0.024, mantle = "wall", end_plates = "wall" }}
particles = {{ material = "glass", shape = {{ sphere = {{ diameter_m = 0.004 }} }} }}
fill.count = {count}
friction = {{ pp = 0.5, mantle = 0.6 }}
restitution = {{ pp = 0.7, mantle = 0.7 }}
rolling = {{ pp = 0.01, mantle = 0.01 }}
run = {{ speeds_rpm = [40.0], time_step_s = 8e-5, frames = 4, seed = 3 }}
[materials]
glass = {{ density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e6 }}
wall = {{ density_kg_m3 = 1190.0, poisson_ratio = 0.37, shear_modulus_pa = 1.7e6 }}
"#
    );
    Rig::parse("small.toml", &text).expect("a valid rig")
}

/// The rig with other values.
pub(crate) fn with(rig: &Rig, values: &[(&str, f64)]) -> Rig {
    let mut rig = rig.clone();
    for (path, value) in values {
        rig.settings.set(path, *value).expect("a value in range");
    }
    rig
}

/// The rig without a value.
pub(crate) fn without(rig: &Rig, path: &str) -> Rig {
    let mut settings = Settings::default();
    for (p, v) in rig.settings.iter().filter(|(p, _)| *p != path) {
        settings.set(p, v).expect("a value in range");
    }
    Rig { settings, ..rig.clone() }
}

/// Run until the drum has turned for `seconds`.
pub(crate) fn turned_for(rig: &Rig, seconds: f64) -> Experiment {
    let mut drum = Experiment::new(rig, &Options::default()).expect("a valid rig");
    let mut begun = f64::INFINITY;
    drum.run(|_, p| {
        if p.phase == Phase::Settling {
            begun = p.time_s;
        }
        if p.time_s > begun + seconds { Flow::Stop } else { Flow::Go }
    })
    .expect("a run without faults");
    drum
}

/// Run everything.
pub(crate) fn finished(rig: &Rig, options: &Options) -> (Experiment, Vec<Sampled>) {
    let mut drum = Experiment::new(rig, options).expect("a valid rig");
    drum.run(|_, _| Flow::Go).expect("a run without faults");
    let sampled = drum.sampled();
    assert!(!sampled.is_empty());
    (drum, sampled)
}
