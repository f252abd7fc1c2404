//! A drum made of formulas: what is fitted, and a truth of another form.
//!
//! The bed's angle saturates in the friction, its S-shape grows with the square of the speed,
//! the centre of area follows from both. The truth uses another saturation and a slow wave over
//! speed: it differs from the model by about 0.15 deg, which the model states as its error.

use calib::attribution::{Attribution, Candidate, Layer, Settings};
use calib::{
    CalibError, Effect, FrameCorrelation, FreeParameter, Nuisance, Observation, Observations,
    OperatingPoint, Predicted, Problem, Simulator,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rig_schema::Response;

pub(crate) const SPEEDS: [f64; 8] = [4.0, 7.0, 10.0, 13.0, 16.0, 20.0, 24.0, 28.0];

/// Standard deviation of the model's own error, deg and % R.
const ERROR: f64 = 0.2;

/// Scatter of frames, deg and % R.
pub(crate) const SD: [f64; 4] = [1.0, 1.0, 0.8, 0.8];

/// Names, ranges, layers.
pub(crate) const EFFECTS: [(&str, (f64, f64), Layer); 8] = [
    ("rolling.pp", (0.0, 1.0), Layer::Physics),
    ("camera.roll_deg", (-5.0, 5.0), Layer::Camera),
    ("cohesion.pp", (0.0, 1.0), Layer::Physics),
    ("rig.fill", (-1.0, 1.0), Layer::Measurement),
    ("rig.end_plates", (0.0, 1.0), Layer::Physics),
    ("camera.exposure", (0.0, 1.0), Layer::Camera),
    ("shape.blockiness", (0.0, 1.0), Layer::Physics),
    ("rig.air", (0.0, 1.0), Layer::Physics),
];

/// Angles with effects, then the centre of area from them.
fn bed(omega: f64, level: f64, mu: f64, s: &[f64]) -> [f64; 4] {
    let f = (omega / 30.0).powi(2);
    let mut lin = level + 8.0 * f + 4.0 * f * mu;
    let mut mid = level + 1.0 + 13.0 * f * (1.0 + 0.4 * mu);
    // Rolling: more angle, less so at speed; blocky particles nearly the same.
    let rolling = 10.0 * s[0] / (1.0 + s[0]);
    lin += rolling * (1.0 - 0.9 * f);
    mid += rolling * (1.0 - 1.3 * f);
    let blocky = 9.0 * s[6] / (1.0 + 0.9 * s[6]);
    lin += blocky * (1.0 - 0.86 * f);
    mid += blocky * (1.0 - 1.26 * f);
    // Cohesion steepens a slow bed.
    let sticky = 8.0 * s[2] * (1.0 - f).powi(3);
    lin += sticky * 0.8;
    mid += sticky;
    // End plates hold the ends of the surface.
    lin += 4.0 * s[4] * f.sqrt();
    mid += 1.0 * s[4] * f.sqrt();
    // Exposure smears the middle of the surface.
    mid -= 5.0 * s[5] * f.sqrt();
    // Air slows a fast bed.
    lin -= 3.0 * s[7] * f * f;
    mid -= 8.0 * s[7] * f * f;
    let reach = 45.0 * (1.0 - 0.12 * s[3]) * (1.0 - 0.08 * f);
    let angle = (0.5 * (lin + mid)).to_radians();
    let roll = s[1].to_radians();
    [lin + s[1], mid + s[1], reach * (angle + roll).sin(), reach * (angle + roll).cos()]
}

/// The model that is fitted: friction, and the strength of one effect or of none.
pub(crate) struct Drum(pub(crate) Option<usize>);

impl Simulator for Drum {
    fn parameters(&self) -> Vec<String> {
        let effect = self.0.map(|k| EFFECTS[k].0.to_owned());
        std::iter::once("friction.pp".to_owned()).chain(effect).collect()
    }
    fn speed_range_rpm(&self) -> (f64, f64) {
        (2.0, 30.0)
    }
    fn predict(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Predicted, CalibError> {
        let mean = self.expected(theta, at)?;
        let n = mean.len();
        let mut covariance = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                if i % 4 == j % 4 {
                    let apart = (at[i / 4].omega_rpm - at[j / 4].omega_rpm) / 7.0;
                    covariance[i * n + j] = ERROR * ERROR * (-0.5 * apart * apart).exp();
                }
            }
        }
        Ok(Predicted { mean, covariance })
    }
    fn expected(&self, theta: &[f64], at: &[OperatingPoint]) -> Result<Vec<f64>, CalibError> {
        let mut s = [0.0; 8];
        if let Some(k) = self.0 {
            s[k] = theta[1];
        }
        let mu = theta[0];
        let level = 14.0 + 24.0 * (2.2 * mu).atan();
        Ok(at.iter().flat_map(|p| bed(p.omega_rpm, level, mu, &s)).collect())
    }
}

/// What the drum would do: another saturation, a slow wave over speed.
pub(crate) fn truth(omega: f64, mu: f64, s: &[f64], phase: f64) -> [f64; 4] {
    let level = 13.9 + 39.8 * mu.powf(1.2) / (mu.powf(1.2) + 0.43);
    let mut r = bed(omega, level, mu * (1.0 + 0.03 * mu), s);
    for (k, v) in r.iter_mut().enumerate() {
        *v += 0.2 * (omega / 6.0 + phase + 1.7 * k as f64).sin();
    }
    r
}

/// A measurement of the truth: frames' scatter (correlated as assumed), offsets of the circle.
pub(crate) fn measure(seed: u64, mu: f64, s: &[f64], sd_factor: f64) -> Observations {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let phase = 3.0 * normal();
    let offset = [0.0, 0.0, 0.5 * normal(), 0.5 * normal()];
    let mut items = Vec::new();
    for omega_rpm in SPEEDS {
        let expected = truth(omega_rpm, mu, s, phase);
        let swing = normal();
        for response in Response::ALL {
            let k = response.index();
            let down = if response == Response::CenY { -1.0 } else { 1.0 };
            let noise = (down * swing + normal()) * 0.5_f64.sqrt() * SD[k] / 15_f64.sqrt();
            let mean = expected[k] + offset[k] + sd_factor * noise;
            items.push(Observation { load: 0, omega_rpm, response, mean, sd: SD[k] });
        }
    }
    Observations::new(items, 15.0, FrameCorrelation::Swinging).expect("is well formed")
}

/// A draw of the fitted model itself with all of its stated errors.
pub(crate) fn draw(seed: u64, mu: f64) -> Observations {
    draw_with(seed, mu, None)
}

/// The same with an effect.
pub(crate) fn draw_with(seed: u64, mu: f64, effect: Option<(usize, f64)>) -> Observations {
    let theta: Vec<f64> = [mu].into_iter().chain(effect.map(|e| e.1)).collect();
    let drum = Drum(effect.map(|e| e.0));
    let predicted =
        drum.predict(&theta, &SPEEDS.map(OperatingPoint::from)).expect("is well formed");
    let mut data = measure(seed, mu, &[0.0; 8], 1.0);
    // Frames and offsets of `measure` without its truth; errors of the model by a Cholesky factor.
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5eed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
    let offset = [0.0, 0.0, 0.5 * normal(), 0.5 * normal()];
    let n = predicted.mean.len();
    let mut l = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum();
            let rest = predicted.covariance(i, j) - known;
            l[i * n + j] = if i == j { rest.max(1e-12).sqrt() } else { rest / l[j * n + j] };
        }
    }
    let z: Vec<f64> = (0..n).map(|_| normal()).collect();
    for (k, item) in data.items.iter_mut().enumerate() {
        let error: f64 = (0..=k).map(|j| l[k * n + j] * z[j]).sum();
        item.mean = predicted.mean[k] + error + offset[k % 4];
    }
    for at in 0..SPEEDS.len() {
        let swing = normal();
        for (k, sd) in SD.into_iter().enumerate() {
            let down = if k == 3 { -1.0 } else { 1.0 };
            let noise = (down * swing + normal()) * 0.5_f64.sqrt() * sd / 15_f64.sqrt();
            data.items[4 * at + k].mean += noise;
        }
    }
    data
}

pub(crate) fn simulators() -> Vec<Drum> {
    (0..EFFECTS.len()).map(|k| Drum(Some(k))).collect()
}

pub(crate) fn free() -> Vec<FreeParameter> {
    vec![FreeParameter { name: "friction.pp".to_owned(), range: (0.1, 0.9) }]
}

pub(crate) fn nuisances() -> Vec<Nuisance> {
    let offset = |name: &str, r| Nuisance {
        name: name.to_owned(),
        effect: Effect::Shift(r),
        mean: 0.0,
        sd: 0.5,
    };
    vec![
        offset("measure.offset_x_pct", Response::CenX),
        offset("measure.offset_y_pct", Response::CenY),
    ]
}

/// An attribution with the effects listed.
pub(crate) fn attribution<'s>(
    observations: Observations,
    base: &'s Drum,
    simulators: &'s [Drum],
    of: &[usize],
) -> Attribution<'s> {
    let candidates = of
        .iter()
        .map(|k| Candidate {
            name: EFFECTS[*k].0.to_owned(),
            simulator: &simulators[*k],
            null: 0.0,
            range: EFFECTS[*k].1,
            layer: EFFECTS[*k].2,
            prior: 1.0,
            strength_sd: None,
            exposed_by: "a test".to_owned(),
            meaning: "an effect of a test".to_owned(),
        })
        .collect();
    Attribution {
        base: Problem { observations, simulator: base, free: free(), nuisances: nuisances() },
        candidates,
        pair_models: Vec::new(),
        code_covariance: None,
        held_out: None,
        experiments: Vec::new(),
        settings: Settings {
            bootstrap: 299,
            stability_bootstrap: 0,
            seed: 7,
            ..Settings::default()
        },
    }
}

pub(crate) fn strengths(pairs: &[(usize, f64)]) -> [f64; 8] {
    let mut s = [0.0; 8];
    for (k, v) in pairs {
        s[*k] = *v;
    }
    s
}

pub(crate) const ALL: [usize; 8] = [0, 1, 2, 3, 4, 5, 6, 7];
