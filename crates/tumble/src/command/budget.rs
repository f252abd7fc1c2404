//! What a budget of time pays for: how many runs, at how many speeds, of the rig or of what stands in for it.

use std::time::Duration;

use campaign::Laboratory;
use campaign::drum_rig::{Options, outline};
use close_loop::{CloseLoop, CloseLoopError, Fidelity, LoopSettings, Pilot};
use rig_schema::Rig;

use crate::input::InputError;

/// Share of a budget that runs may take; the rest is statistics.
const SIMULATING: f64 = 0.8;

/// Share of a budget after which nothing more is looked for, whatever was planned: some runs take longer than pilots tell.
const AT_MOST: f64 = 0.9;

/// Fewest speeds that a budget may leave: two to fit, one to predict.
const LEAST_SPEEDS: usize = 3;

/// Fewest particles of a coarse stand-in: with fewer a bed is no continuum.
const LEAST_PARTICLES: usize = 300;

/// Time that no machine undercuts by much for one step of one sphere, s.
const LEAST_COST_S: f64 = 80e-9;

/// Cost of a step of a sphere in a whole drum over that in its stand-in, of whose few spheres filming takes a larger part. Measured:
/// 976 beads 126 ns, 7807 beads 81 to 89 ns, filming included.
const WHOLE: f64 = 0.75;

/// Most pilots that are run at a time.
const MOST_PILOTS: usize = 8;

/// Runs that the smallest plans have about.
const LEAST_RUNS: f64 = 30.0;

/// Time of one step of one sphere, s, on a processor of 2026: 90 ns in large drums, 160 ns in small ones, and half as much again for
/// settling, waiting for the steady state, and filming.
const USUAL_COST_S: f64 = 200e-9;

/// One way to simulate a case.
struct Way {
    fidelity: Fidelity,
    /// Steps of all spheres in one run.
    work: f64,
    /// The same of all runs of the whole rig beside them: those that anchor it, and fresh ones.
    whole: f64,
    /// The rig with each of its loads.
    pilot: Vec<Rig>,
}

/// What a budget pays for.
pub(super) struct Fitted {
    pub(super) settings: LoopSettings,
    /// Time that its runs take at most, s.
    pub(super) longest_s: f64,
}

/// Steps of all spheres in one run, at least, and the number of particles of the least load.
fn work(rigs: &[Rig]) -> Result<(f64, usize), CloseLoopError> {
    let (mut steps, mut least) = (0.0, usize::MAX);
    for rig in rigs {
        let outline = outline(rig, &Options::default())?;
        let spheres = (outline.particles * outline.spheres_per_particle) as f64;
        steps += spheres * outline.least_steps as f64;
        least = least.min(outline.particles);
    }
    Ok((steps, least))
}

/// The same of all runs of the whole rig beside its stand-in's: those that anchor it, and fresh ones.
fn work_of_whole(pilot: &Pilot) -> Result<f64, CloseLoopError> {
    let Some((whole, runs)) = &pilot.whole else { return Ok(0.0) };
    Ok(*runs as f64 * work(whole)?.0)
}

/// Ways to simulate the case, the nearest to the rig first: itself, and what saves at least a third.
fn ways(asked: &CloseLoop<'_>) -> anyhow::Result<Vec<Way>> {
    let mut ways: Vec<Way> = Vec::new();
    for fidelity in [Fidelity::Case, Fidelity::Soft, Fidelity::Coarse] {
        let settings = LoopSettings { fidelity, ..asked.settings.clone() };
        let this = CloseLoop { settings: &settings, ..*asked };
        // Only the case itself has to be possible.
        let pilot = match this.pilot() {
            Err(e) if fidelity == Fidelity::Case => return Err(e.into()),
            Err(_) => continue,
            Ok(pilot) => pilot,
        };
        let (own, particles) = work(&pilot.rigs)?;
        if fidelity == Fidelity::Coarse && particles < LEAST_PARTICLES {
            continue;
        }
        let whole = work_of_whole(&pilot)?;
        let least = |work: f64, whole: f64| LEAST_RUNS * work + whole;
        if ways.iter().all(|w| least(own, whole) < least(w.work, w.whole) / 1.5) {
            ways.push(Way { fidelity, work: own, whole, pilot: pilot.rigs });
        }
    }
    Ok(ways)
}

/// What a run of this way costs, s, as many at a time as will be: each of them is slower than one alone. The cost is kept
/// with the runs, so that a loop that goes on has the same number of them.
fn cost_of_pilots(way: &Way, lab: &Laboratory, jobs: usize) -> anyhow::Result<f64> {
    let count = jobs.clamp(1, MOST_PILOTS);
    let of_filling = |k: usize| {
        way.pilot.iter().cloned().map(move |mut rig| {
            rig.run.seed = rig.run.seed.wrapping_add(k as u64);
            rig
        })
    };
    let pilots: Vec<Rig> = (0..count).flat_map(of_filling).collect();
    let mut cost = 0.0;
    for run in lab.run(&pilots, |_| ()) {
        cost += run?.cost_s / count as f64;
    }
    Ok(cost)
}

/// Set the number of runs that a budget pays for; returns how long they take at most, s. Where it does not pay for the rig,
/// softer particles, a coarse stand-in and then fewer speeds are taken, the first that will do.
pub(super) fn fit(jobs: usize, budget: Duration, this: &CloseLoop<'_>) -> anyhow::Result<Fitted> {
    let ways = ways(this)?;
    let (lab, mut settings) = (this.lab, this.settings.clone());
    let time = SIMULATING * budget.as_secs_f64() * jobs as f64;
    // A pilot of what no plan could pay for would only spend the budget.
    let hopeless = |w: &Way| LEAST_RUNS * w.work * LEAST_COST_S > time;
    let from = ways.iter().position(|w| !hopeless(w)).unwrap_or(ways.len() - 1);
    let ways = &ways[from..];
    let first = &ways[0];
    eprintln!("pilot runs tell what a run costs");
    let cost_of_first = cost_of_pilots(first, lab, jobs)?;
    let rate = cost_of_first / first.work;
    let mut costs: Vec<Option<f64>> = vec![None; ways.len()];
    costs[0] = Some(cost_of_first);
    let speeds_of = |rig: &Rig| rig.run.speeds_rpm.len();
    let simulated = first.pilot.iter().map(speeds_of).max().unwrap_or(LEAST_SPEEDS);
    let mut shortest: Option<f64> = None;
    for speeds in (LEAST_SPEEDS.min(simulated)..=simulated).rev() {
        let share = speeds as f64 / simulated as f64;
        for (way, cost) in ways.iter().zip(&mut costs) {
            let whole = way.whole * WHOLE * rate * share;
            settings.fidelity = way.fidelity;
            settings.most_speeds = speeds;
            let mut plan = |each: f64| {
                settings.runs = Some(((time - whole).max(0.0) / each) as usize);
                (CloseLoop { settings: &settings, ..*this }).planned()
            };
            // What its particles cost by the first pilot; its own, with frames and filling, if that would do.
            let part = |cost: f64| (cost * share).max(1e-3);
            let mut each = part(cost.unwrap_or(way.work * rate));
            let mut planned = plan(each);
            if planned.is_ok() && cost.is_none() {
                let own = cost_of_pilots(way, lab, jobs)?;
                *cost = Some(own);
                each = part(own);
                planned = plan(each);
            }
            match planned {
                Ok(runs) => {
                    // Pilots were run one way after another.
                    let pilots: f64 = costs.iter().flatten().sum();
                    settings.time_s = Some((AT_MOST * budget.as_secs_f64() - pilots).max(0.0));
                    eprintln!("{}", told(way.fidelity, speeds, simulated));
                    let longest_s = (runs as f64 * each + whole) / jobs as f64;
                    return Ok(Fitted { settings, longest_s });
                }
                Err(CloseLoopError::Budget { least, .. }) => {
                    let needed = (least as f64 * each + whole) / (SIMULATING * jobs as f64);
                    shortest = Some(shortest.map_or(needed, |s| s.min(needed)));
                }
                Err(e) => return Err(e.into()),
            }
        }
    }
    let minutes = shortest.unwrap_or(f64::NAN) / 60.0;
    let what = format!(
        "the budget is too small: the cheapest plan takes about {minutes:.0} min at {jobs} jobs"
    );
    let expected = "more time, fewer effects (`catalogue.only`), or a smaller drum".to_owned();
    Err(InputError::Run { what, expected }.into())
}

/// About how long a number of runs takes, s, known before any is made.
pub(super) fn expected(
    this: &CloseLoop<'_>,
    runs: usize,
    jobs: usize,
) -> Result<f64, CloseLoopError> {
    let pilot = this.pilot()?;
    let all = runs as f64 * work(&pilot.rigs)?.0 + work_of_whole(&pilot)?;
    Ok(all * USUAL_COST_S / jobs as f64)
}

fn told(fidelity: Fidelity, speeds: usize, of: usize) -> String {
    let what = match fidelity {
        Fidelity::Case => "the rig is simulated as the case asks",
        Fidelity::Soft => "to keep to the budget the rig is simulated with softer particles",
        Fidelity::Coarse => {
            "to keep to the budget a coarse stand-in is simulated, shifted to agree with a few runs of the whole drum"
        }
    };
    if speeds < of { format!("{what}, at {speeds} of {of} speeds") } else { what.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use campaign::Sampling;
    use rig_schema::{Case, MeasuredTable};

    /// The drum of the thesis, six speeds.
    const FULL_SIZE: &str = r#"
name = "beads"
drum = { radius_m = 0.125, length_m = 0.15, mantle = "glass", end_plates = "glass" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.006 } } }
fill.count = 7807
friction = { pp = 0.5, mantle = 0.6 }
restitution = { pp = 0.9, mantle = 0.85 }
rolling = { pp = 0.01, mantle = 0.01 }
run = { speeds_rpm = [4.0], frames = 15 }
data.responses = "measured.csv"
free.friction.pp.range = [0.1, 0.9]
simulator.rig = {}
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e7 }
"#;

    const MEASURED: &str = "\
omega_rpm,aor_lin_deg,aor_lin_sd,aor_mid_deg,aor_mid_sd,cen_x_pct,cen_x_sd,cen_y_pct,cen_y_sd,n_eff
10,28,1,28,1,25,0.5,45,0.5,20
20,29,1,30,1,26,0.5,44,0.5,20
30,30,1,32,1,27,0.5,43,0.5,20
";

    #[test]
    fn a_large_drum_has_cheaper_ways_that_keep_its_measured_speeds() {
        let case = Case::parse("beads.toml", FULL_SIZE).unwrap();
        let measured = MeasuredTable::parse("measured.csv", MEASURED).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
        let settings = LoopSettings::default();
        let (case, measured, lab, settings) = (&case, &measured, &lab, &settings);
        let ways = ways(&CloseLoop { case, measured, loads: &[], lab, settings }).unwrap();
        let names: Vec<Fidelity> = ways.iter().map(|w| w.fidelity).collect();
        assert_eq!(names, [Fidelity::Case, Fidelity::Soft, Fidelity::Coarse]);
        // Steps are 4.7 times as long; the stand-in has an eighth of the beads and steps twice as long again.
        let softer = ways[0].work / ways[1].work;
        assert!((softer / 4.7 - 1.0).abs() < 0.05, "{softer}");
        let coarser = ways[1].work / ways[2].work;
        assert!((coarser / 2.0_f64.powi(4) - 1.0).abs() < 0.05, "{coarser}");
        assert!(ways.iter().all(|w| w.pilot[0].run.speeds_rpm == [10.0, 20.0, 30.0]));
    }
}
