//! `cargo xtask dosta`: the soft drum of Dosta et al. 2024 in Tumble and, where installed, LIGGGHTS.

mod case;
pub(crate) mod counts;
mod liggghts;
mod start;

use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::Context;
use clap::{Args, ValueEnum};
use dem_core::contact::tangential::MindlinTotalSpring;
use dem_core::prelude::*;

use case::{DURATION, EVERY, SPECIES, STEP, Shear, drum};
use counts::{Moment, count, to_csv};
use start::Start;

/// What to run.
#[derive(Args)]
pub(crate) struct Options {
    /// Seed of the start.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Shear law of Tumble.
    #[arg(long, value_enum, default_value = "total-spring")]
    shear: ShearChoice,
    /// Run LIGGGHTS on the same start instead.
    #[arg(long)]
    liggghts: bool,
    /// Duration, s.
    #[arg(long, default_value_t = DURATION)]
    seconds: f64,
    /// Threads of Tumble (they change no bit).
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// Put the table into fixtures/validation/dosta.
    #[arg(long)]
    freeze: bool,
    /// Skin of the neighbour list, mm (it changes no trajectory beyond rounding).
    #[arg(long, default_value_t = 0.3)]
    skin: f64,
}

/// Shear laws that can be asked for.
#[derive(Clone, Copy, ValueEnum)]
enum ShearChoice {
    /// Whole displacement times present stiffness, as LIGGGHTS computes it.
    TotalSpring,
    /// Incremental Mindlin.
    Incremental,
}

/// Folder of the frozen tables.
pub(crate) fn frozen(root: &Path) -> PathBuf {
    root.join("fixtures/validation/dosta")
}

/// Make (or read) the start, run one code on it, write its table.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let root = crate::root();
    let folder = root.join("target/dosta");
    std::fs::create_dir_all(&folder)?;
    println!("step {STEP} s is {:.3} of the Rayleigh time", case::rayleigh_share()?);
    let start = start_of(&folder, options)?;
    let steps = (options.seconds / STEP).round() as u64;
    let begun = Instant::now();
    let (name, moments) = if options.liggghts {
        let own = folder.join(format!("liggghts-{}", options.seed));
        std::fs::create_dir_all(&own)?;
        ("liggghts", liggghts::run(&root, &own, &start, steps)?)
    } else {
        match options.shear {
            ShearChoice::TotalSpring => {
                ("tumble", simulate::<MindlinTotalSpring>(&start, steps, options)?)
            }
            ShearChoice::Incremental => {
                ("tumble-incremental", simulate::<Mindlin>(&start, steps, options)?)
            }
        }
    };
    let wall = begun.elapsed().as_secs_f64();
    let spheres = start.centres.len() as f64;
    println!("{wall:.0} s, {:.0} ns a particle-step", wall * 1e9 / (steps as f64 * spheres));
    let file = format!("{name}-{}.csv", options.seed);
    let target = if options.freeze { frozen(&root) } else { folder };
    std::fs::create_dir_all(&target)?;
    let path = target.join(file);
    std::fs::write(&path, to_csv(&moments)).with_context(|| path.display().to_string())?;
    println!("{}", path.display());
    Ok(())
}

fn start_of(folder: &Path, options: &Options) -> anyhow::Result<Start> {
    let path = folder.join(format!("start-{}.txt", options.seed));
    if let Ok(text) = std::fs::read_to_string(&path) {
        return Start::parse(&text).with_context(|| path.display().to_string());
    }
    println!("settling seed {}", options.seed);
    let start = start::settled(options.seed, options.threads)?;
    std::fs::write(&path, start.to_text())?;
    Ok(start)
}

fn simulate<T: Shear>(start: &Start, steps: u64, options: &Options) -> anyhow::Result<Vec<Moment>> {
    let (mut builder, ids) = drum::<T>(true)?;
    for (n, at) in start.centres.iter().enumerate() {
        let kind = start::species_of(n);
        builder.sphere(Sphere::at(*at, SPECIES[kind].radius, ids[kind]));
    }
    builder.threads(options.threads).skin(options.skin * 1e-3);
    let mut world = builder.build()?;
    let now = |world: &World<_>| {
        let centres = world.particles().map(|p| (p.0 as usize, world.position(p)));
        count(world.time(), centres)
    };
    let mut moments = vec![now(&world)];
    for _ in 0..steps / EVERY {
        world.run(EVERY)?;
        moments.push(now(&world));
    }
    println!(
        "{} list builds, {:.2} contacts a particle",
        world.list_builds(),
        world.contact_count() as f64 / start.centres.len() as f64
    );
    Ok(moments)
}
