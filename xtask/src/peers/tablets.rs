//! Ten-sphere tablets as rigid clumps: Tumble beside LIGGGHTS multisphere.
//!
//! 5997 coated tablets (nine spheres of 1.87 mm on a ring, one of 2.3 mm in the middle) in the drum
//! of 250 x 150 mm at 17 rpm, as in configuration AZ4. Each code fills its own drum (LIGGGHTS reads
//! no clumps from a file) and lets it turn for the same time before it is timed, so the beds are
//! alike but not the same: contacts a tablet stand beside the times.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::Context;
use dem_core::prelude::*;
use dem_shapes::{ClumpMass, ClumpShape, RingTabletSpec};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::code::{Code, deck_path, locate};
use super::scene::{GRAVITY, MU, MU_WALL, Model, RESTITUTION, ROLLING, law};
use super::spread::Spread;
use super::tuning::fastest;
use super::{Peers, exchange, folder, load, log, machine};

/// Tablets of configuration AZ4.
const TABLETS: usize = 5997;
/// Radius and length of the drum, m.
const DRUM_M: (f64, f64) = (0.125, 0.150);
/// Time step of the thesis for tablets, s.
const DT_S: f64 = 5e-5;
/// Shear modulus (Pa), Poisson's ratio and density (kg/m3) of coated tablets.
const TABLET: (f64, f64, f64) = (2.92e6, 0.29, 1350.0);
/// Skins that are tried, m.
const SKINS: [f64; 5] = [0.3e-3, 0.5e-3, 0.8e-3, 1.2e-3, 1.8e-3];

/// One code's times.
#[derive(Debug, Serialize)]
struct Line {
    code: &'static str,
    version: String,
    threads: usize,
    skin_mm: f64,
    ns_per_tablet_step: Spread,
    contacts_per_tablet: f64,
    list_pairs_per_tablet: f64,
    steps_per_list: f64,
    angle_deg: f64,
}

#[derive(Debug, Serialize)]
struct Summary {
    machine: String,
    load: [Option<f64>; 2],
    tablets: usize,
    spheres_per_tablet: usize,
    dt_s: f64,
    steps: u64,
    runs: Vec<Line>,
    /// LIGGGHTS over Tumble, one thread each; none where LIGGGHTS is not installed.
    ratio: Option<f64>,
    absent: Vec<String>,
}

fn shape() -> anyhow::Result<ClumpShape> {
    let spec = RingTabletSpec {
        ring_spheres: 9,
        ring_radius: 2.418e-3,
        sphere_radius: 1.87e-3,
        middle_radius: Some(2.3e-3),
    };
    Ok(spec.build()?.clump(ClumpMass::Density(TABLET.2))?)
}

fn rate() -> f64 {
    17.0 * std::f64::consts::TAU / 60.0
}

/// The drum with tablets where they are said to be, or on a lattice, each turned at random.
fn world(
    threads: usize,
    skin: f64,
    kernels: Kernels,
    tablets: Option<&[PlacedClump]>,
) -> anyhow::Result<World<Model>> {
    let material = Material::from_shear_modulus(TABLET.0, TABLET.1, TABLET.2);
    let mut b = WorldBuilder::<Model>::new(DT_S);
    let (tablet, wall) = (b.material(material), b.material(material));
    b.pair_law(tablet, tablet, law(&material, MU, ROLLING)?);
    b.pair_law(tablet, wall, law(&material, MU_WALL, ROLLING)?);
    b.kernels(kernels);
    b.gravity(DVec3::NEG_Y * GRAVITY).threads(threads).skin(skin);
    let (radius, length) = DRUM_M;
    let half = 1.1 * radius;
    b.domain(DVec3::new(-half, -half, -0.01), DVec3::new(half, half, length + 0.01));
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, rate());
    let far = DVec3::Z * length;
    b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, radius, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 1.05 * radius, wall).with_motion(turning));
    b.wall(Wall::disc(far, DVec3::NEG_Z, 1.05 * radius, wall).with_motion(turning));
    let clump = Clump::try_from(ClumpSpec {
        spheres: shape()?
            .spheres
            .iter()
            .map(|s| ClumpSphere { centre: s.center, radius: s.radius })
            .collect(),
        mass: shape()?.mass,
        centre_of_mass: DVec3::ZERO,
        inertia: DMat3::from_diagonal(shape()?.principal_moments),
        material: tablet,
    })?;
    let reach = clump.bounding_radius();
    let shape = b.clump_shape(clump);
    for t in tablets.unwrap_or_default() {
        b.clump(t.clone());
    }
    let pitch = 2.0 * reach;
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut uniform = || random.random_range(-1.0..1.0);
    let (across, along) = ((2.0 * radius / pitch) as usize, (length / pitch) as usize);
    let mut left = if tablets.is_some() { 0 } else { TABLETS };
    'fill: for j in 0..across {
        for i in 0..across {
            let place = |n: usize| (n as f64 + 0.5) * pitch - radius;
            let (x, y) = (place(i), place(j));
            if x.hypot(y) > radius - reach {
                continue;
            }
            for k in 0..along {
                if left == 0 {
                    break 'fill;
                }
                left -= 1;
                let turn = DQuat::from_xyzw(uniform(), uniform(), uniform(), uniform());
                b.clump(PlacedClump {
                    shape,
                    position: DVec3::new(x, y, (k as f64 + 0.5) * length / along as f64),
                    orientation: turn.normalize(),
                    velocity: DVec3::ZERO,
                    spin: DVec3::ZERO,
                });
            }
        }
    }
    anyhow::ensure!(left == 0, "{left} of {TABLETS} tablets find no place in the drum");
    b.build().context("the scene of the tablets is not a valid world")
}

/// Inclination of the bed: direction of the centre of mass below the axis, deg.
fn angle(positions: impl Iterator<Item = DVec3>) -> f64 {
    let sum: DVec3 = positions.sum();
    sum.x.abs().atan2(-sum.y).to_degrees()
}

fn timed(world: &mut World<Model>, steps: u64) -> anyhow::Result<f64> {
    let start = Instant::now();
    world.run(steps)?;
    Ok(start.elapsed().as_secs_f64() * 1e9 / (steps as f64 * TABLETS as f64))
}

fn tumble(options: &Peers, threads: usize) -> anyhow::Result<Line> {
    let settled = {
        let mut world = world(2, 0.5e-3, options.kernels.kernels(), None)?;
        eprintln!("tumble: {TABLETS} tablets fall and turn for {} steps", options.settle);
        world.run(options.settle)?;
        let tablet = |id| PlacedClump {
            shape: 0,
            position: world.position(id),
            orientation: world.orientation(id),
            velocity: world.velocity(id),
            spin: world.spin(id),
        };
        world.particles().map(tablet).collect::<Vec<_>>()
    };
    let (skin, _) = fastest(SKINS, |skin| {
        let mut world = world(threads, skin, options.kernels.kernels(), Some(&settled))?;
        world.run(100)?;
        let ns = timed(&mut world, options.tune_steps.min(300))?;
        eprintln!("tumble: skin {:.2} mm, {ns:.0} ns a tablet-step", 1e3 * skin);
        Ok(ns)
    })?;
    let mut world = world(threads, skin, options.kernels.kernels(), Some(&settled))?;
    world.run(options.warm)?;
    let before = world.list_builds();
    let (mut times, mut contacts) = (Vec::new(), 0.0);
    for round in 0..options.repeats {
        let ns = timed(&mut world, options.steps)?;
        eprintln!("tumble, {threads} threads, part {}: {ns:.0} ns a tablet-step", round + 1);
        times.push(ns);
        contacts += world.contact_count() as f64 / options.repeats as f64;
    }
    let builds = (world.list_builds() - before).max(1);
    Ok(Line {
        code: Code::Tumble.name(),
        version: format!("Tumble {}", env!("CARGO_PKG_VERSION")),
        threads,
        skin_mm: 1e3 * skin,
        ns_per_tablet_step: Spread::of(times),
        contacts_per_tablet: contacts / TABLETS as f64,
        list_pairs_per_tablet: world.list_pairs() as f64 / TABLETS as f64,
        steps_per_list: (options.steps * options.repeats as u64) as f64 / builds as f64,
        angle_deg: angle(world.particles().map(|id| world.position(id))),
    })
}

fn liggghts(options: &Peers, folder: &Path) -> anyhow::Result<Line> {
    let program = locate("TUMBLE_LIGGGHTS", "liggghts").map_err(anyhow::Error::msg)?;
    let template = folder.join("tablet.txt");
    let rows: Vec<String> = shape()?
        .spheres
        .iter()
        .map(|s| format!("{:e} {:e} {:e} {:e}", s.center.x, s.center.y, s.center.z, s.radius))
        .collect();
    std::fs::write(&template, rows.join("\n") + "\n")?;
    for (name, z) in [("near", 0.0), ("far", DRUM_M.1)] {
        exchange::write_plate(&folder.join(format!("tablets_{name}.stl")), 1.5 * DRUM_M.0, z)?;
    }
    // The skin of LIGGGHTS is added to sphere pairs; it is tuned by short runs of its own below.
    let run = |skin: f64, steps: u64, settle: u64| -> anyhow::Result<(log::Told, f64)> {
        let screen = folder.join("tablets_liggghts.screen.log");
        let dump = folder.join("tablets_liggghts.dump");
        let output = std::fs::File::create(&screen)?;
        let mut command = Command::new(&program);
        command
            .current_dir(folder)
            .arg("-in")
            .arg(deck_path("tablets.lig")?)
            .args(["-log", "none"]);
        for (name, value) in [
            ("tablets", TABLETS as f64),
            ("skin", skin),
            ("dt", DT_S),
            ("radius", DRUM_M.0),
            ("length", DRUM_M.1),
            ("rate", rate()),
            ("youngs", 2.0 * TABLET.0 * (1.0 + TABLET.1)),
            ("poisson", TABLET.1),
            ("density", TABLET.2),
            ("restitution", RESTITUTION),
            ("mu", MU),
            ("mu_wall", MU_WALL),
            ("rolling", ROLLING),
            ("settle", settle as f64),
            ("steps", steps as f64),
        ] {
            command.args(["-var", name, &format!("{value}")]);
        }
        command.arg("-var").arg("out").arg(&dump);
        command.stdin(Stdio::null()).stderr(output.try_clone()?).stdout(output);
        let status = command.status().context("cannot start LIGGGHTS")?;
        let text = std::fs::read_to_string(&screen)?;
        anyhow::ensure!(
            status.success(),
            "LIGGGHTS failed ({status}): {}",
            text.lines().rev().take(4).collect::<Vec<_>>().join(" | ")
        );
        let centres = exchange::read_dump(&dump)?;
        Ok((log::read(&text)?, angle(centres.iter().map(|b| b.position))))
    };
    let (skin, _) = fastest(SKINS, |skin| {
        // Tablets in the air: what is tuned is the list, at a tenth of the price.
        let (told, _) = run(skin, 200, options.settle / 4)?;
        let ns = told.loop_s * 1e9 / (200.0 * TABLETS as f64);
        eprintln!("liggghts: skin {:.2} mm, {ns:.0} ns a tablet-step", 1e3 * skin);
        Ok(ns)
    })?;
    let steps = options.steps * options.repeats as u64;
    let (told, angle_deg) = run(skin, steps, options.settle + options.warm)?;
    let ns = told.loop_s * 1e9 / (steps as f64 * TABLETS as f64);
    eprintln!("liggghts: {ns:.0} ns a tablet-step over {steps} steps");
    Ok(Line {
        code: Code::Liggghts.name(),
        version: told.version.clone(),
        threads: 1,
        skin_mm: 1e3 * skin,
        ns_per_tablet_step: Spread::of([ns]),
        contacts_per_tablet: told.contacts / TABLETS as f64,
        list_pairs_per_tablet: told.list_pairs / TABLETS as f64,
        steps_per_list: steps as f64 / told.builds.max(1.0),
        angle_deg,
    })
}

/// Time both codes and print.
pub(crate) fn run(options: &Peers) -> anyhow::Result<()> {
    let load_before = load();
    let folder = folder()?;
    let mut runs = vec![tumble(options, 1)?, tumble(options, 2)?];
    let mut absent = Vec::new();
    match liggghts(options, &folder) {
        Ok(line) => runs.push(line),
        Err(error) => absent.push(format!("liggghts: {error:#}")),
    }
    let ratio =
        runs.get(2).map(|l| l.ns_per_tablet_step.median / runs[0].ns_per_tablet_step.median);
    let summary = Summary {
        machine: machine(),
        load: [load_before, load()],
        tablets: TABLETS,
        spheres_per_tablet: shape()?.spheres.len(),
        dt_s: DT_S,
        steps: options.steps,
        runs,
        ratio,
        absent,
    };
    if options.json {
        println!("{}", serde_json::to_string_pretty(&summary)?);
        return Ok(());
    }
    println!("{}; load {:?} before, {:?} after", summary.machine, load_before, summary.load[1]);
    println!("{TABLETS} tablets of {} spheres, dt {DT_S:e} s\n", summary.spheres_per_tablet);
    println!(
        "| code | threads | ns a tablet-step | contacts a tablet | list pairs a tablet | steps a list | skin, mm | centre of mass, deg |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for l in &summary.runs {
        let t = l.ns_per_tablet_step;
        println!(
            "| {} | {} | {:.0} ({:.0}..{:.0}) | {:.2} | {:.1} | {:.1} | {:.2} | {:.1} |",
            l.code,
            l.threads,
            t.median,
            t.least,
            t.most,
            l.contacts_per_tablet,
            l.list_pairs_per_tablet,
            l.steps_per_list,
            l.skin_mm,
            l.angle_deg
        );
    }
    if let Some(ratio) = ratio {
        println!("\nLIGGGHTS multisphere over Tumble: {ratio:.2}");
    }
    for a in &summary.absent {
        println!("absent: {a}");
    }
    Ok(())
}
