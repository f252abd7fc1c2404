//! Tumble's memory for a million beads, as the system counts it.

use std::path::PathBuf;
use std::process::Command;

use anyhow::Context;
use clap::Args;
use dem_core::prelude::{DVec3, Kernels};
use serde::{Deserialize, Serialize};

use super::scene::{Bead, ROLLING, Scene};
use super::{Peers, exchange, settled};

/// Beads wanted.
const MILLION: usize = 1_000_000;
/// Steps, so that lists have been made anew and buffers have their size.
const STEPS: u64 = 60;

/// What a worker is asked to do.
#[derive(Args)]
pub(crate) struct MemoryWorker {
    #[arg(long)]
    data: PathBuf,
    #[arg(long)]
    copies: usize,
    #[arg(long)]
    radius: f64,
    #[arg(long)]
    length: f64,
    #[arg(long)]
    rate: f64,
}

#[derive(Serialize, Deserialize)]
struct Memory {
    particles: usize,
    contacts_per_particle: f64,
    list_pairs_per_particle: f64,
    /// Most that was resident at any time, bytes.
    peak_bytes: u64,
    /// Resident after the steps, bytes.
    resident_bytes: u64,
}

/// Copies of the settled bed one behind the other in a drum as long, on one thread.
pub(crate) fn run(w: &MemoryWorker) -> anyhow::Result<()> {
    let bed = exchange::read_data(&w.data)?;
    let scene = Scene {
        beads: bed.len() * w.copies,
        radius: w.radius,
        length: w.length * w.copies as f64,
        rate: w.rate,
    };
    let mut beads = Vec::with_capacity(scene.beads);
    for copy in 0..w.copies {
        let shift = DVec3::Z * (copy as f64 * w.length);
        beads.extend(bed.iter().map(|b| Bead { position: b.position + shift, ..*b }));
    }
    let mut world = scene.world(&beads, 1, 0.8e-3, ROLLING, Kernels::Fastest)?;
    drop(beads);
    world.run(STEPS)?;
    let n = world.len() as f64;
    let memory = Memory {
        particles: world.len(),
        contacts_per_particle: world.contact_count() as f64 / n,
        list_pairs_per_particle: world.list_pairs() as f64 / n,
        peak_bytes: status("VmHWM:")?,
        resident_bytes: status("VmRSS:")?,
    };
    println!("{}", serde_json::to_string(&memory)?);
    Ok(())
}

/// Measure in a process of its own and print.
pub(crate) fn measure(options: &Peers) -> anyhow::Result<()> {
    let scene = Scene::similar(options.particles);
    let (data, _) = settled(&scene, options.settle)?;
    let copies = MILLION.div_ceil(scene.beads);
    let program = super::own_program()?;
    let mut command = Command::new(&program);
    command.args(["peers-memory-worker", "--data"]).arg(&data);
    for (name, value) in [
        ("--copies", copies.to_string()),
        ("--radius", scene.radius.to_string()),
        ("--length", scene.length.to_string()),
        ("--rate", scene.rate.to_string()),
    ] {
        command.arg(name).arg(value);
    }
    let done = command.output().with_context(|| format!("cannot start {}", program.display()))?;
    anyhow::ensure!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let line = String::from_utf8_lossy(&done.stdout);
    let m: Memory = serde_json::from_str(line.trim())?;
    if options.json {
        println!("{}", line.trim());
        return Ok(());
    }
    let each = |bytes: u64| bytes as f64 / m.particles as f64;
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    println!(
        "{} beads, {:.2} contacts and {:.2} list pairs a particle: peak {:.0} MiB ({:.0} bytes a particle), after {STEPS} steps {:.0} MiB ({:.0} bytes a particle)",
        m.particles,
        m.contacts_per_particle,
        m.list_pairs_per_particle,
        mib(m.peak_bytes),
        each(m.peak_bytes),
        mib(m.resident_bytes),
        each(m.resident_bytes)
    );
    Ok(())
}

/// A line of `/proc/self/status` in bytes.
fn status(head: &str) -> anyhow::Result<u64> {
    let text = std::fs::read_to_string("/proc/self/status")
        .context("memory is measured on Linux only: no /proc/self/status")?;
    let line =
        text.lines().find_map(|l| l.strip_prefix(head)).with_context(|| format!("no {head}"))?;
    let kib: u64 = line.trim().trim_end_matches(" kB").parse()?;
    Ok(kib * 1024)
}
