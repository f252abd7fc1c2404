//! The same start in LIGGGHTS, counted by the same code.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Command;

use anyhow::{Context, bail, ensure};
use dem_core::glam::DVec3;

use super::case::{EVERY, LENGTH, RADIUS, STEP};
use super::counts::{Moment, count};
use super::start::Start;

/// Deck, below the workspace's root.
const DECK: &str = "benches/peers/dosta.lig";

/// Run the deck for `steps` in `folder`.
pub(crate) fn run(
    root: &Path,
    folder: &Path,
    start: &Start,
    steps: u64,
) -> anyhow::Result<Vec<Moment>> {
    std::fs::write(folder.join("start.data"), start.to_liggghts())?;
    for (name, side) in [("front", -1.0), ("back", 1.0)] {
        std::fs::write(folder.join(format!("{name}.stl")), end_plate(side))?;
    }
    let mut command = Command::new("liggghts");
    command.arg("-in").arg(root.join(DECK)).current_dir(folder);
    for (name, value) in [("steps", steps), ("every", EVERY)] {
        command.args(["-var", name, &value.to_string()]);
    }
    let status = command
        .stdout(std::fs::File::create(folder.join("stdout.txt"))?)
        .status()
        .context("liggghts does not start (Debian: apt-get install liggghts)")?;
    ensure!(status.success(), "liggghts failed: see {}", folder.join("stdout.txt").display());
    counted(&folder.join("trajectory.txt"))
}

/// A square of two triangles that covers one end of the drum and turns in its own plane.
fn end_plate(side: f64) -> String {
    let (a, z) = (1.4 * RADIUS, side * 0.5 * LENGTH);
    let corner = |x: f64, y: f64| format!("      vertex {x} {y} {z}\n");
    let facet = |corners: [String; 3]| {
        format!(
            "  facet normal 0 0 {}\n    outer loop\n{}    endloop\n  endfacet\n",
            -side,
            corners.concat()
        )
    };
    let first = facet([corner(-a, -a), corner(a, -a), corner(a, a)]);
    let second = facet([corner(-a, -a), corner(a, a), corner(-a, a)]);
    format!("solid end\n{first}{second}endsolid end\n")
}

/// Count every frame of a dump `id x y z`, whose coordinates are ours in the order z, x, y.
fn counted(path: &Path) -> anyhow::Result<Vec<Moment>> {
    let file = std::fs::File::open(path).with_context(|| path.display().to_string())?;
    let mut lines = BufReader::new(file).lines();
    let mut moments = Vec::new();
    while let Some(line) = lines.next() {
        let line = line?;
        if line != "ITEM: TIMESTEP" {
            bail!("{}: expected a time step, found `{line}`", path.display());
        }
        let mut next = || lines.next().context("the dump ends within a frame");
        let step: u64 = next()??.trim().parse()?;
        next()??;
        let atoms: usize = next()??.trim().parse()?;
        for _ in 0..5 {
            next()??;
        }
        let mut spheres = Vec::with_capacity(atoms);
        for _ in 0..atoms {
            let line = next()??;
            let n: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
            ensure!(n.len() == 4, "{}: expected `id x y z`, found `{line}`", path.display());
            spheres.push((n[0] as usize - 1, DVec3::new(n[2], n[3], n[1])));
        }
        moments.push(count(step as f64 * STEP, spheres.into_iter()));
    }
    Ok(moments)
}
