//! Names the effect that a model lacks: surfaces through runs of a formula, data with cohesion.
//!
//! `cargo run --release -p calib --example name_effect`
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use calib::attribution::{Attribution, Candidate, Layer, Settings};
use calib::{
    Basis, CalibError, FrameCorrelation, FreeParameter, Observation, Observations, Problem,
    Surrogate,
};
use rig_schema::Response;

/// Strength of each effect: cohesion, rolling, exposure.
type Effects = [f64; 3];

/// A bed: angles rise with friction and speed, the centre of area follows.
fn bed(omega: f64, mu: f64, s: Effects) -> [f64; 4] {
    let f = (omega / 30.0).powi(2);
    let level = 14.0 + 24.0 * (2.2 * mu).atan();
    let rolling = 8.0 * s[1] / (1.0 + s[1]) * (1.0 - 0.9 * f);
    let lin = level + 8.0 * f + 7.0 * s[0] * (1.0 - f).powi(2) + rolling;
    let mid = level + 14.0 * f + 8.0 * s[0] * (1.0 - f).powi(2) + rolling - 5.0 * s[2] * f.sqrt();
    let angle = (0.5 * (lin + mid)).to_radians();
    [lin, mid, 45.0 * angle.sin(), 45.0 * angle.cos()]
}

/// Surfaces through runs over speed, friction and the strength of effect `k`.
fn surfaces(k: Option<usize>) -> Result<Surrogate, CalibError> {
    let strengths: &[f64] = if k.is_some() { &[0.0, 0.25, 0.5, 0.75, 1.0] } else { &[0.0] };
    let (mut points, mut values) = (Vec::new(), [const { Vec::new() }; 4]);
    for omega in [4.0, 10.0, 16.0, 22.0, 28.0] {
        for mu in [0.3, 0.35, 0.4, 0.45, 0.5] {
            for s in strengths {
                let mut effects = Effects::default();
                let mut point = vec![omega, mu];
                if let Some(k) = k {
                    effects[k] = *s;
                    point.push(*s);
                }
                points.push(point);
                for (list, v) in values.iter_mut().zip(bed(omega, mu, effects)) {
                    list.push(v);
                }
            }
        }
    }
    let mut names = vec!["friction.pp"];
    names.extend(k.map(|k| NAMES[k]));
    Surrogate::from_points(&names, &points, &values, &Basis::Quadratic)
}

const NAMES: [&str; 3] = ["cohesion.pp", "rolling.pp", "camera.exposure_s"];

fn main() -> Result<(), CalibError> {
    // ANCHOR: attribute
    // What was measured: cohesion of strength 0.4, which the base model does not know.
    let mut items = Vec::new();
    for (k, omega_rpm) in [4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0].into_iter().enumerate() {
        for (response, mean) in Response::ALL.into_iter().zip(bed(omega_rpm, 0.38, [0.4, 0.0, 0.0]))
        {
            let noise = 0.2 * ((7 * k + 3 * response.index()) as f64).sin();
            items.push(Observation { load: 0, omega_rpm, response, mean: mean + noise, sd: 1.0 });
        }
    }
    let base = surfaces(None)?;
    let with: Vec<Surrogate> = (0..3).map(|k| surfaces(Some(k))).collect::<Result<_, _>>()?;
    let candidates = NAMES.iter().zip(&with).map(|(name, simulator)| Candidate {
        name: (*name).to_owned(),
        simulator,
        null: 0.0,
        range: (0.0, 1.0),
        layer: if name.starts_with("camera") { Layer::Camera } else { Layer::Physics },
        prior: 1.0,
        strength_sd: None,
        exposed_by: "an experiment of its own".to_owned(),
        meaning: "an effect of this example".to_owned(),
    });
    let attribution = Attribution {
        base: Problem {
            observations: Observations::new(items, 15.0, FrameCorrelation::Swinging)?,
            simulator: &base,
            free: vec![FreeParameter { name: "friction.pp".to_owned(), range: (0.3, 0.5) }],
            nuisances: Vec::new(),
        },
        candidates: candidates.collect(),
        pair_models: Vec::new(),
        code_covariance: None,
        held_out: None,
        experiments: Vec::new(),
        settings: Settings::default(),
    };
    let found = attribution.attribute()?;
    println!("verdict: {:?}", found.verdict);
    for r in &found.ranked {
        println!(
            "{:18} chi2 {:6.1} (p {:.1e})  strength {:.2}  evidence {:.3}  {}",
            r.name,
            r.fit.chi2,
            r.p_absolute,
            r.strength.value,
            r.evidence,
            r.objections.join("; ")
        );
    }
    // ANCHOR_END: attribute
    let g = &found.gate;
    println!("base: chi2 {:.1} on {}, p {:.3}", g.chi2, g.dof, g.p_combined);
    for d in &found.detectable {
        println!("{} would be seen from {:?}", d.name, d.strength);
    }
    for h in &found.held_out {
        println!("{}: {:?} of the error above the floor removed", h.kind, h.removed);
    }
    for s in &found.stability {
        println!("{}: {:?}", s.change, s.verdict);
    }
    println!("{:?}", found.overturn);
    Ok(())
}
