//! Tumble's time against the number of beads, in similar drums or in longer ones.

use serde::Serialize;
use serde_json::json;

use super::code::{Code, Task};
use super::scene::{AZ1_BEADS, Scene};
use super::spread::{Spread, exponent};
use super::{Peers, folder, load, machine, settled};

/// Particle-steps of a timed run.
const WORK: f64 = 6e7;

#[derive(Serialize)]
struct Point {
    particles: usize,
    steps: u64,
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
        let steps = (WORK / particles as f64).clamp(100.0, 20_000.0) as u64;
        scenes.push((scene, data, steps));
    }
    // Gap of the list: as in the AZ1 drum, where the side-by-side runs tune it.
    let skin = Code::Tumble.skins()[3];
    let mut runs: Vec<Vec<_>> = scenes.iter().map(|_| Vec::new()).collect();
    for round in 0..options.repeats {
        for ((scene, data, steps), runs) in scenes.iter().zip(&mut runs) {
            let warm = (*steps / 4).max(50);
            let task =
                Task { scene, data, folder: &folder, warm, steps: *steps, mode: options.kernels };
            eprintln!("round {}: {} beads", round + 1, scene.beads);
            runs.push(tumble.run(&task, 1, skin)?);
        }
    }
    let mut points = Vec::new();
    for ((scene, _, steps), runs) in scenes.iter().zip(&runs) {
        let n = scene.beads as f64;
        let ns = |loop_s: f64| loop_s * 1e9 / (n * *steps as f64);
        let told = &runs[0].told;
        points.push(Point {
            particles: scene.beads,
            steps: *steps,
            processor_ns: Spread::of(runs.iter().map(|r| r.busy * ns(r.told.loop_s))),
            wall_ns: Spread::of(runs.iter().map(|r| ns(r.told.loop_s))),
            contacts_per_particle: told.contacts / n,
            list_pairs_per_particle: told.list_pairs / n,
            steps_per_list: *steps as f64 / told.builds.max(1.0),
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
