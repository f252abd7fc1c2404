//! Simulate drums and seal what was done to them.

use std::fmt::Write as _;
use std::path::Path;

use close_loop::campaign::{Laboratory, Resolution, Run, Sampling};
use close_loop::rig_schema::Rig;

use super::drums::{self, DOSES};
use super::elsewhere;
use super::sealed::{Truth, seal};
use crate::peers::code::locate;

/// Speeds of every drum, rpm: Froude numbers 0.013 to 0.27. With three to fit, effects that change the rise with
/// speed looked like friction.
const SPEEDS: [f64; 6] = [15.0, 25.0, 35.0, 45.0, 55.0, 70.0];
/// The one that is kept aside.
const HELD_OUT: f64 = 35.0;
/// Photographs of a speed, as an experimenter with a camera on a tripod takes them.
const PHOTOGRAPHS: u32 = 120;
/// Frames of a simulation.
const FRAMES: u32 = 24;

/// The drum as an experimenter knows it; `law` is a line of contact laws, `frames` their number, `dt`
/// the time step, s (0.2 ms is an eighth of the Rayleigh time; 0.4 ms moves cohesive beds).
fn rig_text(law: &str, frames: u32, dt: f64) -> String {
    let speeds = SPEEDS;
    format!(
        r#"name = "blind"
{law}
drum = {{ radius_m = 0.05, length_m = 0.034, mantle = "glass", end_plates = "glass", ends = "periodic" }}
particles = {{ material = "glass", shape = {{ sphere = {{ diameter_m = 0.006 }} }} }}
size = {{ spread = 0.12 }}
fill.count = 560
friction = {{ pp = 0.4, mantle = 0.9 }}
restitution = {{ pp = 0.6, mantle = 0.6 }}
rolling = {{ pp = 0.01, mantle = 0.01 }}
camera = {{ distance_m = 0.5 }}
run = {{ speeds_rpm = {speeds:?}, frames = {frames}, time_step_s = {dt} }}
[materials]
glass = {{ density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 1.0e5 }}
"#
    )
}

/// The case file: the rig, and what is asked.
pub(crate) fn case_text(without: &[String]) -> String {
    let mut text = rig_text("", FRAMES, 2e-4);
    let _ = write!(
        text,
        "\n[data]\nresponses = \"measured.csv\"\n\n[free]\nfriction.pp = {{ range = [0.15, 0.9] }}\n\n[holdout]\nspeeds_rpm = [{HELD_OUT:?}]\n\n[simulator.rig]\ncoarse = false\n"
    );
    if !without.is_empty() {
        let names: Vec<String> = without.iter().map(|n| format!("\"{n}\"")).collect();
        let _ = write!(text, "\n[catalogue]\nwithout = [{}]\n", names.join(", "));
    }
    text
}

/// The rig that nature runs: other fillings, a finer step.
pub(crate) fn nature(truth: &Truth, seed: u64) -> anyhow::Result<Rig> {
    let law = truth
        .effects
        .iter()
        .filter_map(|(path, _)| DOSES.iter().find(|d| d.path == path))
        .map(|d| d.law)
        .find(|l| !l.is_empty())
        .unwrap_or("");
    let mut rig = Rig::parse("blind.toml", &rig_text(law, PHOTOGRAPHS, 2e-4))?;
    let mut set = |path: &str, value: f64| {
        rig.settings.set(path, value).map_err(|_| anyhow::anyhow!("{path} = {value} is refused"))
    };
    set("step.scale", 0.7)?;
    for (path, value) in truth.frictions.iter().chain(&truth.effects) {
        set(path, *value)?;
        let along = DOSES.iter().find(|d| d.path == path).map_or(&[][..], |d| d.along);
        for other in along {
            set(other, *value)?;
        }
    }
    rig.run.seed = seed;
    Ok(rig)
}

/// Time between two frames of nature, s.
pub(crate) const INTERVAL_S: f64 = 0.15;
/// A finer picture than any fit uses.
pub(crate) const RESOLUTION: Resolution = Resolution { width_px: 640, most_sub_frames: 12 };

/// Where nature happens, and how finely it is looked at.
pub(crate) fn nature_lab(
    folder: &Path,
    jobs: usize,
    resolution: Resolution,
) -> anyhow::Result<Laboratory> {
    let sampling =
        Sampling { resolution, frame_interval_s: Some(INTERVAL_S), ..Sampling::default() };
    Ok(Laboratory::open(&folder.join("nature"), jobs, sampling)?)
}

/// A run as a table of measured responses.
pub(crate) fn table(run: &Run) -> String {
    let mut text = String::from(
        "omega_rpm,aor_lin_deg,aor_lin_sd,aor_mid_deg,aor_mid_sd,cen_x_pct,cen_x_sd,cen_y_pct,cen_y_sd,n_frames,n_eff,cov_lin_mid,cov_lin_x,cov_lin_y,cov_mid_x,cov_mid_y,cov_x_y\n",
    );
    for s in &run.speeds {
        // One number of independent frames for all: the covariance of the means stays theirs.
        let n = s.n_eff.iter().sum::<f64>() / 4.0;
        let _ = write!(text, "{}", s.omega_rpm);
        for r in 0..4 {
            let _ = write!(text, ",{:.4},{:.4}", s.mean[r], (s.covariance[r][r] * n).sqrt());
        }
        let _ = write!(text, ",{},{n:.2}", s.n_frames);
        for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let _ = write!(text, ",{:.5}", s.covariance[a][b] * n);
        }
        text.push('\n');
    }
    text
}

/// Write one case, and seal what was done to it. A drum that does not settle is no measurement; what it was
/// stays sealed.
fn keep(
    folder: &Path,
    key: &[u8; 32],
    truth: &Truth,
    run: anyhow::Result<Run>,
) -> anyhow::Result<()> {
    let run = match run {
        Ok(run) => run,
        Err(e) => {
            println!("{}: {e}", truth.case);
            return Ok(());
        }
    };
    let own = folder.join("cases").join(&truth.case);
    std::fs::create_dir_all(&own)?;
    let without: Vec<String> = if truth.kind == "removed" {
        truth.effects.iter().map(|(p, _)| p.clone()).collect()
    } else {
        Vec::new()
    };
    let text = serde_json::to_string(truth)?;
    let sealed = folder.join("truth").join(format!("{}.sealed", truth.case));
    std::fs::write(sealed, seal(&text, key))?;
    std::fs::write(own.join("measured.csv"), table(&run))?;
    std::fs::write(own.join("case.toml"), case_text(&without))?;
    Ok(())
}

pub(crate) fn run(
    folder: &Path,
    seed: u64,
    most: Option<usize>,
    only: Option<&str>,
    jobs: usize,
) -> anyhow::Result<()> {
    let truths = drums::all(seed);
    let key = *blake3::hash(format!("seal {seed}").as_bytes()).as_bytes();
    let hex: String = key.iter().map(|b| format!("{b:02x}")).collect();
    std::fs::create_dir_all(folder.join("truth"))?;
    std::fs::write(folder.join("truth/key"), hex)?;
    let lab = nature_lab(folder, jobs, RESOLUTION)?;
    let rigs = truths
        .iter()
        .enumerate()
        .map(|(k, t)| nature(t, seed * 1000 + 17 * k as u64))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let is_ours = |k: &usize| truths[*k].code == "tumble";
    let (mut own, mut others): (Vec<usize>, Vec<usize>) = (0..truths.len()).partition(is_ours);
    if let Some(most) = most {
        // The order is a hash: the first are as good as any.
        own.truncate(most);
        others.truncate(most.div_ceil(2));
    }
    let wanted = |k: &usize| only.is_none_or(|name| truths[*k].case.contains(name));
    own.retain(wanted);
    others.retain(wanted);
    let count = own.len() + others.len();
    println!("{count} drums");
    let own_rigs: Vec<Rig> = own.iter().map(|k| rigs[*k].clone()).collect();
    let runs = lab.run(&own_rigs, |d| {
        let cost = d.run.map_or(f64::NAN, |r| r.cost_s);
        println!("{} of {}: {cost:.0} s", d.index + 1, own.len());
    });
    for (k, run) in own.into_iter().zip(runs) {
        keep(folder, &key, &truths[k], run.map_err(Into::into))?;
    }
    let other = locate("TUMBLE_LIGGGHTS", "liggghts").ok();
    for k in others {
        let truth = &truths[k];
        let Some(program) = &other else {
            println!("{}: left out, LIGGGHTS is not installed", truth.case);
            continue;
        };
        let deck = folder.join("decks").join(&truth.case);
        keep(
            folder,
            &key,
            truth,
            elsewhere::run(program, &rigs[k], &deck, INTERVAL_S, RESOLUTION),
        )?;
        println!("{} by another code", truth.case);
    }
    println!("{count} cases in {}", folder.display());
    Ok(())
}
