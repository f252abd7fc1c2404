//! One timed run of Tumble, as a process of its own like every other code's.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::Context;
use clap::Args;
use serde::{Deserialize, Serialize};

use super::code::Task;
use super::log::Told;
use super::scene::{ROLLING, Scene, beads_of};
use super::{Mode, exchange};

/// Looks at the contacts during the timed run, as in the decks.
const LOOKS: u64 = 10;

/// What a worker is asked to do.
#[derive(Args)]
pub(crate) struct Worker {
    #[arg(long)]
    data: PathBuf,
    #[arg(long)]
    out: PathBuf,
    #[arg(long)]
    radius: f64,
    #[arg(long)]
    length: f64,
    #[arg(long)]
    rate: f64,
    #[arg(long)]
    threads: usize,
    #[arg(long)]
    skin: f64,
    #[arg(long)]
    rolling: f64,
    #[arg(long)]
    warm: u64,
    #[arg(long)]
    steps: u64,
    #[arg(long, value_enum)]
    kernels: Mode,
    /// Keep the energy ledger during the timed run.
    #[arg(long)]
    ledger: bool,
}

/// What a worker prints, one line of JSON.
#[derive(Serialize, Deserialize)]
struct Line {
    loop_s: f64,
    contacts: f64,
    list_pairs: usize,
    builds: u64,
    /// Dissipated, and what the ledger cannot account for, J.
    ledger: Option<[f64; 2]>,
}

/// The command line that [`run`] answers.
pub(crate) fn arguments(
    command: &mut Command,
    task: &Task<'_>,
    mode: Mode,
    threads: usize,
    skin: f64,
    dump: &Path,
) {
    command.args(["peers-worker", "--data"]).arg(task.data).arg("--out").arg(dump);
    for (name, value) in [
        ("--radius", task.scene.radius),
        ("--length", task.scene.length),
        ("--rate", task.scene.rate),
        ("--skin", skin),
    ] {
        command.arg(name).arg(format!("{value}"));
    }
    for (name, value) in
        [("--threads", threads as u64), ("--warm", task.warm), ("--steps", task.steps)]
    {
        command.arg(name).arg(value.to_string());
    }
    command.args(["--kernels", mode.name()]);
}

/// Do the run and print its line.
pub(crate) fn run(w: &Worker) -> anyhow::Result<()> {
    let beads = exchange::read_data(&w.data)?;
    let scene = Scene { beads: beads.len(), radius: w.radius, length: w.length, rate: w.rate };
    let mut world = scene.world(&beads, w.threads, w.skin, w.rolling, w.kernels.kernels())?;
    world.run(w.warm)?;
    if w.ledger {
        world.open_ledger()?;
    }
    let before = world.list_builds();
    let (mut loop_s, mut contacts) = (0.0, 0.0);
    for look in 0..LOOKS {
        let part = w.steps * (look + 1) / LOOKS - w.steps * look / LOOKS;
        let start = Instant::now();
        world.run(part)?;
        loop_s += start.elapsed().as_secs_f64();
        contacts += world.contact_count() as f64 / LOOKS as f64;
    }
    exchange::write_dump(&w.out, &beads_of(&world))?;
    let energy = world.energy();
    let line = Line {
        loop_s,
        contacts,
        list_pairs: world.list_pairs(),
        builds: world.list_builds() - before,
        ledger: w.ledger.then(|| [energy.dissipated.total(), energy.remainder]),
    };
    println!("{}", serde_json::to_string(&line)?);
    Ok(())
}

/// Read a worker's line.
pub(crate) fn read(screen: &str) -> anyhow::Result<Told> {
    let line: Line = line(screen)?;
    Ok(Told {
        version: format!("Tumble {}", env!("CARGO_PKG_VERSION")),
        loop_s: line.loop_s,
        contacts: line.contacts,
        list_pairs: line.list_pairs as f64,
        builds: line.builds as f64,
    })
}

fn line(screen: &str) -> anyhow::Result<Line> {
    let last = screen.lines().last().context("the worker said nothing")?;
    serde_json::from_str(last).with_context(|| format!("not a worker's line: {last}"))
}

/// Dissipated energy and what the ledger cannot account for (J) over a run with the ledger open.
pub(crate) fn ledger(task: &Task<'_>, skin: f64) -> anyhow::Result<[f64; 2]> {
    let dump = task.folder.join("ledger.dump");
    let program = super::own_program()?;
    let mut command = Command::new(&program);
    arguments(&mut command, task, task.mode, 1, skin, &dump);
    command.arg("--rolling").arg(ROLLING.to_string()).arg("--ledger");
    let done = command.output().with_context(|| format!("cannot start {}", program.display()))?;
    let screen = String::from_utf8_lossy(&done.stdout).into_owned();
    anyhow::ensure!(
        done.status.success(),
        "the run with the ledger failed: {}",
        String::from_utf8_lossy(&done.stderr)
    );
    line(&screen)?.ledger.context("no ledger in the worker's line")
}
