//! Simulate drums and seal what was done to them.

use std::fmt::Write as _;
use std::path::Path;

use close_loop::campaign::export::Code;
use close_loop::campaign::{Laboratory, Resolution, Run, Sampling};
use close_loop::rig_schema::Rig;

use super::drums::{self, DOSES};
use super::elsewhere::{self, Other};
use super::sealed::{Truth, seal};

/// Speeds of every drum, rpm: Froude numbers 0.013 to 0.27. With three to fit, effects that change the rise with
/// speed looked like friction.
const SPEEDS: [f64; 6] = [15.0, 25.0, 35.0, 45.0, 55.0, 70.0];
/// The one that is kept aside.
const HELD_OUT: f64 = 35.0;
/// Speeds of a coarse drum, with the one that is kept aside.
const FEW_SPEEDS: [f64; 5] = [15.0, 25.0, 35.0, 50.0, 70.0];
/// Photographs of a speed, as an experimenter with a camera on a tripod takes them; half as many of a coarse drum.
const PHOTOGRAPHS: u32 = 120;
/// Frames of a simulation.
const FRAMES: u32 = 24;

/// How much care an experimenter takes.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct Care {
    /// Fillings of each drum; they share the photographs.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=12))]
    pub(crate) fillings: u32,
    /// Photographs of each speed, shared by fillings and loads [default: 120, of a coarse drum 60]. (The slope of a few hundred
    /// beads swings by 2.5 to 4 deg from one to the next, that of the thesis's drums of thousands by 0.2 to 1 deg: as sure a mean as
    /// thirty of those give takes hundreds of these.)
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=2000))]
    pub(crate) photographs: Option<u32>,
    /// Beads are weighed, not counted.
    #[arg(long)]
    pub(crate) weighed: bool,
    /// A coarse drum: beads of 7 mm instead of 6, five speeds instead of six, half the frames: a fifth of the work. (With fewer than
    /// 300 beads a bed is no continuum: of 43 drums of 236 beads that lack nothing three were alarms.)
    #[arg(long)]
    pub(crate) coarse: bool,
    /// Each drum is filled with about half as much as well; both loads share the photographs.
    #[arg(long)]
    pub(crate) two_loads: bool,
}

/// The table of what was measured with a load.
pub(crate) fn table_of(load: usize) -> &'static str {
    ["measured.csv", "half.csv"][load]
}

impl Care {
    /// Number of loads.
    fn loads(self) -> u32 {
        1 + u32::from(self.two_loads)
    }

    /// What a load is given by.
    fn fill(self, load: usize) -> (&'static str, f64) {
        if self.weighed {
            // What so many beads of that spread weigh, to three figures; and half of them.
            ("fill.mass_kg", [0.165, 0.08][load])
        } else if self.coarse {
            ("fill.count", [353.0, 171.0][load])
        } else {
            ("fill.count", [560.0, 272.0][load])
        }
    }

    fn speeds(self) -> &'static [f64] {
        if self.coarse { &FEW_SPEEDS } else { &SPEEDS }
    }

    /// As many of them as are made of so many in the usual drum.
    fn frames(self, usual: u32) -> u32 {
        if self.coarse { usual / 2 } else { usual }
    }

    /// Photographs of a speed of each filling.
    fn photographs_of_each(self) -> u32 {
        let among = self.fillings * self.loads();
        let usual = || self.frames(PHOTOGRAPHS.div_ceil(among));
        self.photographs.map_or_else(usual, |own| own.div_ceil(among))
    }
}

/// The drum as an experimenter knows it; `law` is a line of contact laws, `frames` their number. (The time step is an eighth
/// of the Rayleigh time; twice that moves cohesive beds.)
fn rig_text(law: &str, frames: u32, care: Care) -> String {
    let speeds = care.speeds();
    let (diameter, dt) = if care.coarse { (0.007, 2.3e-4) } else { (0.006, 2e-4) };
    let (fill, amount) = care.fill(0);
    format!(
        r#"name = "blind"
{law}
drum = {{ radius_m = 0.05, length_m = 0.034, mantle = "glass", end_plates = "glass", ends = "periodic" }}
particles = {{ material = "glass", shape = {{ sphere = {{ diameter_m = {diameter} }} }} }}
size = {{ spread = 0.12 }}
{fill} = {amount}
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
pub(crate) fn case_text(without: &[String], care: Care) -> String {
    let mut text = rig_text("", care.frames(FRAMES), care);
    let fillings = care.fillings;
    let _ = write!(text, "\n[data]\nresponses = \"{}\"\nfillings = {fillings}\n", table_of(0));
    if care.two_loads {
        let ((path, amount), table) = (care.fill(1), table_of(1));
        let _ = write!(
            text,
            "\n[[data.loads]]\nresponses = \"{table}\"\n{path} = {amount}\nfillings = {fillings}\n"
        );
    }
    let _ = write!(
        text,
        "\n[free]\nfriction.pp = {{ range = [0.15, 0.9] }}\n\n[holdout]\nspeeds_rpm = [{HELD_OUT:?}]\n\n[simulator.rig]\ncoarse = false\n"
    );
    if !without.is_empty() {
        let names: Vec<String> = without.iter().map(|n| format!("\"{n}\"")).collect();
        let _ = write!(text, "\n[catalogue]\nwithout = [{}]\n", names.join(", "));
    }
    text
}

/// The rigs that nature runs, one a filling, load after load: other fillings than those of any fit, a finer step.
pub(crate) fn nature(truth: &Truth, seed: u64, care: Care) -> anyhow::Result<Vec<Rig>> {
    let law = truth
        .effects
        .iter()
        .filter_map(|(path, _)| DOSES.iter().find(|d| d.path == path))
        .map(|d| d.law)
        .find(|l| !l.is_empty())
        .unwrap_or("");
    let mut rig = Rig::parse("blind.toml", &rig_text(law, care.photographs_of_each(), care))?;
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
    let filling = |k: u32| {
        let mut own = rig.clone();
        // A first filling is that of an experimenter who has but one.
        own.run.seed = seed + 1_000_003 * u64::from(k);
        let (path, amount) = care.fill((k / care.fillings) as usize);
        own.settings
            .set(path, amount)
            .map_err(|_| anyhow::anyhow!("{path} = {amount} is refused"))?;
        Ok(own)
    };
    (0..care.fillings * care.loads()).map(filling).collect()
}

/// Fillings of one drum as one table: means of means, frames of all.
pub(crate) fn averaged(runs: &[Run]) -> Option<Run> {
    let (first, n) = (runs.first()?, runs.len() as f64);
    let mut all = first.clone();
    for (k, row) in all.speeds.iter_mut().enumerate() {
        let rows = || runs.iter().map(|r| &r.speeds[k]);
        for r in 0..4 {
            row.mean[r] = rows().map(|s| s.mean[r]).sum::<f64>() / n;
            row.sd[r] = (rows().map(|s| s.sd[r].powi(2)).sum::<f64>() / n).sqrt();
            row.n_eff[r] = rows().map(|s| s.n_eff[r]).sum();
            for c in 0..4 {
                row.covariance[r][c] = rows().map(|s| s.covariance[r][c]).sum::<f64>() / (n * n);
            }
        }
        row.n_frames = rows().map(|s| s.n_frames).sum();
    }
    Some(all)
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

/// Tables of what was measured, load by load, from runs of all fillings.
pub(crate) fn measured(fillings: &[Run], care: Care) -> Vec<String> {
    let loads = fillings.chunks(care.fillings as usize);
    loads.filter_map(averaged).map(|run| table(&run)).collect()
}

/// Write one case, and seal what was done to it. A drum that does not settle is no measurement; what it was
/// stays sealed.
fn keep(
    folder: &Path,
    key: &[u8; 32],
    truth: &Truth,
    fillings: anyhow::Result<Vec<Run>>,
    care: Care,
) -> anyhow::Result<()> {
    let loads = match fillings {
        Ok(all) => measured(&all, care),
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
    for (load, text) in loads.iter().enumerate() {
        std::fs::write(own.join(table_of(load)), text)?;
    }
    std::fs::write(own.join("case.toml"), case_text(&without, care))?;
    Ok(())
}

pub(crate) fn run(
    folder: &Path,
    seed: u64,
    most: Option<usize>,
    only: Option<&str>,
    care: Care,
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
        .map(|(k, t)| nature(t, seed * 1000 + 17 * k as u64, care))
        .collect::<anyhow::Result<Vec<Vec<Rig>>>>()?;
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
    let own_rigs: Vec<Rig> = own.iter().flat_map(|k| rigs[*k].clone()).collect();
    let mut runs = lab
        .run(&own_rigs, |d| {
            let cost = d.run.map_or(f64::NAN, |r| r.cost_s);
            println!("{} of {}: {cost:.0} s", d.index + 1, own_rigs.len());
        })
        .into_iter();
    for k in own {
        let fillings: Vec<_> = runs.by_ref().take(rigs[k].len()).collect();
        let all: Result<Vec<Run>, _> = fillings.into_iter().collect();
        keep(folder, &key, &truths[k], all.map_err(Into::into), care)?;
    }
    let other = Other::locate(Code::Liggghts).ok();
    for k in others {
        let truth = &truths[k];
        let Some(other) = &other else {
            println!("{}: left out, LIGGGHTS is not installed", truth.case);
            continue;
        };
        let decks = folder.join("decks").join(&truth.case);
        keep(folder, &key, truth, elsewhere::run_all(other, &rigs[k], &decks), care)?;
        println!("{} by another code", truth.case);
    }
    println!("{count} cases in {}", folder.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use close_loop::campaign::SpeedRow;

    #[test]
    fn fillings_are_averaged_with_the_frames_of_all() {
        let run = |mean: f64, sd: f64, n: f64| {
            let row = SpeedRow {
                omega_rpm: 20.0,
                mean: [mean; 4],
                sd: [sd; 4],
                covariance: [[sd * sd / n; 4]; 4],
                n_eff: [n; 4],
                n_frames: 40,
                rejected: 0,
                fill: None,
                approach_s: 0.0,
            };
            Run { key: String::new(), speeds: vec![row], steps: 0, particles: 0, cost_s: 0.0 }
        };
        assert_eq!(averaged(&[]), None);
        let all = averaged(&[run(20.0, 1.0, 10.0), run(23.0, 7f64.sqrt(), 20.0)]).unwrap();
        let row = &all.speeds[0];
        assert_eq!((row.mean[0], row.sd[1], row.n_eff[2], row.n_frames), (21.5, 2.0, 30.0, 80));
        // (1 / 10 + 7 / 20) / 4.
        assert!((row.covariance[0][3] - 0.1125).abs() < 1e-12);
    }

    #[test]
    fn an_experimenter_who_takes_care_refills_and_weighs() {
        let truth = drums::truth("null", "", 0.3, &[]);
        let care =
            Care { fillings: 3, photographs: None, weighed: true, coarse: false, two_loads: false };
        let rigs = nature(&truth, 5, care).unwrap();
        let seeds: Vec<u64> = rigs.iter().map(|r| r.run.seed).collect();
        assert_eq!(seeds, [5, 1_000_008, 2_000_011]);
        assert!(rigs.iter().all(|r| r.run.frames == 40));
        assert!(case_text(&[], care).contains("fill.mass_kg = 0.165"));
        let case = close_loop::rig_schema::Case::parse("c.toml", &case_text(&[], care)).unwrap();
        assert_eq!(case.data.fillings, Some(3));
        // As many kilograms of larger beads.
        let coarse = nature(&truth, 5, Care { coarse: true, ..care }).unwrap();
        assert_eq!((coarse[0].run.frames, coarse[0].run.speeds_rpm.len()), (20, 5));
        let count = |care: Care| {
            let outline = nature(&truth, 5, care).unwrap();
            let options = close_loop::campaign::drum_rig::Options::default();
            close_loop::campaign::drum_rig::outline(&outline[0], &options).unwrap().particles as f64
        };
        let [few, many] =
            [true, false].map(|coarse| count(Care { fillings: 1, weighed: false, coarse, ..care }));
        assert!((few / many - (6.0_f64 / 7.0).powi(3)).abs() < 2e-3, "{few} {many}");
    }

    #[test]
    fn two_loads_share_the_photographs_and_each_has_its_table() {
        let truth = drums::truth("null", "", 0.3, &[]);
        let care =
            Care { fillings: 2, photographs: None, weighed: true, coarse: true, two_loads: true };
        let rigs = nature(&truth, 5, care).unwrap();
        let mass = |r: &Rig| r.settings.value("fill.mass_kg");
        assert_eq!(rigs.iter().filter_map(mass).collect::<Vec<_>>(), [0.165, 0.165, 0.08, 0.08]);
        // 120, half of them of a coarse drum, among four fillings.
        assert!(rigs.iter().all(|r| r.run.frames == 15));
        // What is given is what is taken.
        let many = nature(&truth, 5, Care { photographs: Some(240), ..care }).unwrap();
        assert!(many.iter().all(|r| r.run.frames == 60));
        let case = close_loop::rig_schema::Case::parse("c.toml", &case_text(&[], care)).unwrap();
        let half = &case.data.loads[0];
        assert_eq!((half.responses.as_str(), half.fillings), (table_of(1), Some(2)));
        assert_eq!(mass(&half.of(&case.rig)), Some(0.08));
    }
}
