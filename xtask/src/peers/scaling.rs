//! Tumble's time against the number of beads, in similar drums or in longer ones.

use serde::Serialize;
use serde_json::json;

use super::code::{Code, Task};
use super::scene::{AZ1_BEADS, Scene};
use super::spread::{Spread, exponent};
use super::{Peers, folder, load, machine, settled};

/// Steps before the timed ones, and timed steps: the same for all sizes, so that their beds are timed in the same state (a bed
/// that settles has half as many contacts again as one that flows).
const WARM: u64 = 200;
const STEPS: u64 = 600;
/// Particle-steps of a point in each round: small beds run several times from the same file.
const WORK: f64 = 6e7;
/// Runs of the smallest.
const MOST_RUNS: f64 = 10.0;

#[derive(Serialize)]
struct Point {
    particles: usize,
    steps: u64,
    runs_a_round: usize,
    processor_ns: Spread,
    wall_ns: Spread,
    contacts_per_particle: f64,
    list_pairs_per_particle: f64,
    steps_per_list: f64,
}

/// Time every size in turn, round by round, one thread.
pub(crate) fn run(options: &Peers) -> anyhow::Result<()> {
    let load_before = load();
    let folder = folder()?;
    let tumble = Code::Tumble.find().map_err(anyhow::Error::msg)?;
    let mut scenes = Vec::new();
    for &particles in &options.sizes {
        // Froude's time grows with the square root of the length.
        let (scene, longer) = if options.along {
            (Scene::along(particles), 1.0)
        } else {
            (Scene::similar(particles), (particles as f64 / AZ1_BEADS as f64).powf(1.0 / 6.0))
        };
        let (data, _) = settled(&scene, (options.settle as f64 * longer) as u64)?;
        let again = (WORK / (particles as u64 * STEPS) as f64).clamp(1.0, MOST_RUNS) as usize;
        scenes.push((scene, data, again));
    }
    // Gap of the list: as in the AZ1 drum, where the side-by-side runs tune it.
    let skin = Code::Tumble.skins()[3];
    let mut runs: Vec<Vec<_>> = scenes.iter().map(|_| Vec::new()).collect();
    for round in 0..options.repeats {
        for ((scene, data, again), runs) in scenes.iter().zip(&mut runs) {
            let mode = options.kernels;
            let task = Task { scene, data, folder: &folder, warm: WARM, steps: STEPS, mode };
            eprintln!("round {}: {} beads", round + 1, scene.beads);
            let n = (scene.beads as u64 * STEPS) as f64;
            let (mut busy_ns, mut wall_ns) = (0.0, 0.0);
            for nth in 1..=*again {
                let run = tumble.run(&task, 1, skin)?;
                let ns = run.told.loop_s * 1e9 / n / *again as f64;
                busy_ns += run.busy * ns;
                wall_ns += ns;
                if nth == *again {
                    runs.push((busy_ns, wall_ns, run.told));
                }
            }
        }
    }
    let mut points = Vec::new();
    for ((scene, _, again), runs) in scenes.iter().zip(&runs) {
        let n = scene.beads as f64;
        let told = &runs[0].2;
        points.push(Point {
            particles: scene.beads,
            steps: STEPS,
            runs_a_round: *again,
            processor_ns: Spread::of(runs.iter().map(|r| r.0)),
            wall_ns: Spread::of(runs.iter().map(|r| r.1)),
            contacts_per_particle: told.contacts / n,
            list_pairs_per_particle: told.list_pairs / n,
            steps_per_list: STEPS as f64 / told.builds.max(1.0),
        });
    }
    let times: Vec<(f64, f64)> = points
        .iter()
        .map(|p| (p.particles as f64, p.processor_ns.median * p.particles as f64))
        .collect();
    let exponent = exponent(&times);
    if options.json {
        let value = json!({
            "machine": machine(), "load_before_and_after": [load_before, load()],
            "threads": 1, "along": options.along, "kernels": options.kernels.name(), "skin_mm": 1e3 * skin, "points": points, "exponent": exponent,
        });
        println!("{}", serde_json::to_string_pretty(&value)?);
        return Ok(());
    }
    println!(
        "{}; load {:?} before, {:?} after; one thread, skin {:.2} mm",
        machine(),
        load_before,
        load(),
        1e3 * skin
    );
    println!(
        "| beads | steps | processor ns a particle-step | wall ns a particle-step | contacts a particle | list pairs a particle | steps a list |"
    );
    println!("|---|---|---|---|---|---|---|");
    for p in &points {
        let (c, w) = (p.processor_ns, p.wall_ns);
        println!(
            "| {} | {} | {:.1} ({:.1}..{:.1}) | {:.1} ({:.1}..{:.1}) | {:.3} | {:.2} | {:.1} |",
            p.particles,
            p.steps,
            c.median,
            c.least,
            c.most,
            w.median,
            w.least,
            w.most,
            p.contacts_per_particle,
            p.list_pairs_per_particle,
            p.steps_per_list
        );
    }
    println!("\nexponent of the time of a step against the number of beads: {exponent:.3}");
    Ok(())
}
