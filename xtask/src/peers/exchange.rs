//! Files that all codes share: LAMMPS data files (which LIGGGHTS reads as well) and dumps.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, bail};
use dem_core::prelude::DVec3;

use super::scene::{BEAD_RADIUS_M, Bead, DENSITY, Scene};

/// Write beads as a LAMMPS data file of atom style `sphere` (in LIGGGHTS `granular`) with two
/// types, beads and walls.
pub(crate) fn write_data(path: &Path, scene: &Scene, beads: &[Bead]) -> anyhow::Result<()> {
    let margin = 0.04 * scene.radius;
    let (half, low, high) = (scene.radius + margin, -margin, scene.length + margin);
    let mut text = String::from("beads in a turning drum, settled\n\n");
    write!(text, "{} atoms\n2 atom types\n\n", beads.len())?;
    write!(text, "{:e} {half:e} xlo xhi\n{:e} {half:e} ylo yhi\n", -half, -half)?;
    write!(text, "{low:e} {high:e} zlo zhi\n\nAtoms\n\n")?;
    for (n, b) in beads.iter().enumerate() {
        let (d, p) = (2.0 * BEAD_RADIUS_M, b.position);
        writeln!(text, "{} 1 {d:e} {DENSITY:e} {:e} {:e} {:e}", n + 1, p.x, p.y, p.z)?;
    }
    text.push_str("\nVelocities\n\n");
    for (n, b) in beads.iter().enumerate() {
        let (v, w) = (b.velocity, b.spin);
        let id = n + 1;
        writeln!(text, "{id} {:e} {:e} {:e} {:e} {:e} {:e}", v.x, v.y, v.z, w.x, w.y, w.z)?;
    }
    crate::write_whole(path, &text)
}

/// Read what [`write_data`] wrote.
pub(crate) fn read_data(path: &Path) -> anyhow::Result<Vec<Bead>> {
    let text =
        std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let (atoms, velocities) = text
        .split_once("\nAtoms\n")
        .and_then(|(_, rest)| rest.split_once("\nVelocities\n"))
        .with_context(|| format!("{}: no sections Atoms and Velocities", path.display()))?;
    let mut beads = Vec::new();
    let lines = |s: &'static str, t: &str| -> anyhow::Result<Vec<Vec<f64>>> {
        t.lines().filter(|l| !l.trim().is_empty()).map(|l| numbers(l, s)).collect()
    };
    let (atoms, velocities) = (lines("Atoms", atoms)?, lines("Velocities", velocities)?);
    if atoms.len() != velocities.len() {
        bail!("{}: {} atoms, {} velocities", path.display(), atoms.len(), velocities.len());
    }
    for (a, v) in atoms.iter().zip(&velocities) {
        let ([_, _, _, _, x, y, z], [_, vx, vy, vz, wx, wy, wz]) = (&a[..], &v[..]) else {
            bail!("{}: expected 7 columns in Atoms and in Velocities", path.display());
        };
        beads.push(Bead {
            position: DVec3::new(*x, *y, *z),
            velocity: DVec3::new(*vx, *vy, *vz),
            spin: DVec3::new(*wx, *wy, *wz),
        });
    }
    Ok(beads)
}

/// Write a square plate of two triangles at height `z` (m), as STL.
pub(crate) fn write_plate(path: &Path, half_width: f64, z: f64) -> anyhow::Result<()> {
    let corner = |x: f64, y: f64| [x * half_width, y * half_width];
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let mut text = String::from("solid plate\n");
    for triangle in [[a, b, c], [a, c, d]] {
        text.push_str(" facet normal 0 0 1\n  outer loop\n");
        for [x, y] in triangle {
            writeln!(text, "   vertex {x} {y} {z}")?;
        }
        text.push_str("  endloop\n endfacet\n");
    }
    text.push_str("endsolid plate\n");
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

/// Write beads as a dump `id x y z vx vy vz omegax omegay omegaz`.
pub(crate) fn write_dump(path: &Path, beads: &[Bead]) -> anyhow::Result<()> {
    let mut text = String::from("ITEM: ATOMS id x y z vx vy vz omegax omegay omegaz\n");
    for (n, b) in beads.iter().enumerate() {
        write!(text, "{}", n + 1)?;
        for part in [b.position, b.velocity, b.spin] {
            write!(text, " {:e} {:e} {:e}", part.x, part.y, part.z)?;
        }
        text.push('\n');
    }
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

/// Read the last frame of a dump with the columns of [`write_dump`].
pub(crate) fn read_dump(path: &Path) -> anyhow::Result<Vec<Bead>> {
    let text =
        std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let (_, rows) = text
        .rsplit_once("ITEM: ATOMS")
        .with_context(|| format!("{}: no ITEM: ATOMS", path.display()))?;
    let mut beads = Vec::new();
    for row in rows.lines().skip(1).filter(|l| !l.trim().is_empty()) {
        let [_, x, y, z, vx, vy, vz, wx, wy, wz] = numbers(row, "dump")?[..] else {
            bail!("{}: expected 10 columns, found `{row}`", path.display());
        };
        beads.push(Bead {
            position: DVec3::new(x, y, z),
            velocity: DVec3::new(vx, vy, vz),
            spin: DVec3::new(wx, wy, wz),
        });
    }
    Ok(beads)
}

fn numbers(line: &str, section: &str) -> anyhow::Result<Vec<f64>> {
    line.split_whitespace()
        .map(|w| w.parse().with_context(|| format!("{section}: `{w}` is not a number: {line}")))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_data_file_gives_back_the_bits_of_every_bead() {
        let scene = Scene::similar(200);
        let mut beads = scene.lattice(3).unwrap();
        beads[7].velocity = DVec3::new(1.0 / 3.0, -2e-7, 0.1);
        beads[9].spin = DVec3::new(-1e3 / 7.0, 0.0, 5.0);
        let folder = tempfile::tempdir().unwrap();
        let (data, dump) = (folder.path().join("a.data"), folder.path().join("a.dump"));
        write_data(&data, &scene, &beads).unwrap();
        assert_eq!(read_data(&data).unwrap(), beads);
        write_dump(&dump, &beads).unwrap();
        assert_eq!(read_dump(&dump).unwrap(), beads);
    }

    #[test]
    fn a_broken_data_file_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("broken.data");
        std::fs::write(&path, "x\nAtoms\n\n1 1 a\n\nVelocities\n\n").unwrap();
        let error = format!("{:#}", read_data(&path).unwrap_err());
        assert!(error.contains("`a` is not a number"), "{error}");
    }
}
