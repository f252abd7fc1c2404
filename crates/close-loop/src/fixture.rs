//! A loop about a small drum of which nothing is known yet, for tests.

use campaign::Laboratory;
use rig_schema::{Case, MeasuredTable};

use crate::driver::{CloseLoop, State};
use crate::emulator::Sample;
use crate::plan::{Effort, LoopSettings, Setup};
use crate::runs::Runs;

const CASE: &str = r#"
name = "small"
drum = { radius_m = 0.03, length_m = 0.02, mantle = "glass", end_plates = "glass", ends = "periodic" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
fill.count = 420
friction = { pp = 0.5, mantle = 0.8 }
restitution = { pp = 0.6, mantle = 0.6 }
rolling = { pp = 0.01, mantle = 0.01 }
run = { speeds_rpm = [50.0, 80.0], frames = 6 }
[data]
responses = "measured.csv"
[free]
friction.pp = { range = [0.2, 0.8] }
[simulator.rig]
coarse = false
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 1e5 }
"#;

const HEAD: &str = "omega_rpm,aor_lin_deg,aor_lin_sd,aor_mid_deg,aor_mid_sd,cen_x_pct,cen_x_sd,cen_y_pct,cen_y_sd,n_eff";

/// Frictions that were run without any effect.
pub(crate) const FRICTIONS: [f64; 9] = [0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.7];

/// Departures of six fillings from their mean, in standard deviations.
pub(crate) const SIX: [f64; 6] = [-1.2, 0.9, 0.3, -0.7, 1.3, -0.6];

/// Its state before anything is run, for `more` lines of the case and the same row of the table at both speeds.
pub(crate) fn nothing_known<'l>(lab: &'l Laboratory, more: &str, row: &str) -> State<'l> {
    let case = Case::parse("case.toml", &format!("{CASE}{more}")).unwrap();
    let table = format!("{HEAD}\n50,{row}\n80,{row}\n");
    let measured = MeasuredTable::parse("measured.csv", &table).unwrap();
    let settings = LoopSettings::default();
    let (case, measured, settings) = (&case, &measured, &settings);
    let setup = Setup::new(&CloseLoop { case, measured, loads: &[], lab, settings }).unwrap();
    let runs = Runs::new(lab, (setup.cast, Vec::new()), 1);
    State::new(setup, Effort::nothing(), (0, None), runs)
}

/// A run that shows the same at both speeds.
pub(crate) fn run(friction: f64, strengths: &[f64], shows: [f64; 4]) -> Sample {
    let noise = std::array::from_fn(|r| std::array::from_fn(|c| f64::from(r == c) * 1e-3));
    Sample {
        at: [friction].iter().chain(strengths).copied().collect(),
        mean: vec![shows; 2],
        covariance: vec![noise; 2],
        variance: vec![[0.1; 4]; 2],
        excess: vec![0.0],
    }
}
