//! Files for ParaView: their structure, and what an independent reader finds in them.

use std::path::Path;
use std::process::Command;

use campaign::drum_rig::{Experiment, Flow, Options};
use campaign::rig_schema::Rig;
use campaign::vtk::{Encoding, Series, contacts, particles};

const BEADS: &str = r#"
name = "beads"
drum = { radius_m = 0.02, length_m = 0.02, mantle = "glass", end_plates = "glass" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
fill.count = 60
friction = { pp = 0.5, mantle = 0.6 }
restitution = { pp = 0.7, mantle = 0.7 }
rolling = { pp = 0.01, mantle = 0.01 }
run = { speeds_rpm = [60.0], frames = 3 }
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e5 }
"#;

/// An experiment, stopped after some looks at it.
fn stopped(text: &str, looks: u32) -> Experiment {
    let rig = Rig::parse("drum.toml", text).unwrap_or_else(|e| panic!("{e}"));
    let mut drum = Experiment::new(&rig, &Options::default()).expect("is built");
    let mut seen = 0;
    drum.run(|_, _| {
        seen += 1;
        if seen >= looks { Flow::Stop } else { Flow::Go }
    })
    .expect("runs");
    drum
}

/// Three-sphere clumps in place of beads.
fn clumps() -> String {
    BEADS.replace("fill.count = 60", "fill.count = 30\nshape.aspect_ratio = 1.5")
}

/// Numbers of an array in a text file.
fn numbers(text: &str, name: &str) -> Vec<f64> {
    let from = text.split_once(&format!("Name=\"{name}\"")).expect("the array is there").1;
    let inside = from.split_once('>').expect("opens").1.split('<').next().expect("closes");
    inside.split_whitespace().map(|t| t.parse().expect("a number")).collect()
}

#[test]
fn particles_and_contacts_hold_what_the_experiment_holds() {
    let drum = stopped(BEADS, 40);
    let text = particles(&drum, Encoding::Ascii);
    let states = drum.particles();
    assert!(text.contains("NumberOfPoints=\"60\" NumberOfCells=\"60\""));
    let points = numbers(&text, "Points");
    let spins = numbers(&text, "spin");
    let forces = numbers(&text, "force");
    for (k, s) in states.iter().enumerate() {
        assert_eq!(points[3 * k..3 * k + 3], s.position.to_array());
        assert_eq!(spins[3 * k..3 * k + 3], s.spin.to_array());
        assert_eq!(forces[3 * k..3 * k + 3], s.force.to_array());
    }
    assert!(numbers(&text, "radius").iter().all(|r| *r == 0.002));
    let coordination: f64 = numbers(&text, "coordination").iter().sum();
    let wall: f64 = numbers(&text, "wall_contacts").iter().sum();
    let text = contacts(&drum, Encoding::Ascii);
    let other = numbers(&text, "other");
    let with_walls = other.iter().filter(|o| **o < 0.0).count();
    assert!(other.len() > 30 && with_walls > 0, "a settled bed has contacts");
    assert_eq!(coordination, 2.0 * (other.len() - with_walls) as f64);
    assert_eq!(wall, with_walls as f64);
    // The lines join centres: two radii long less the overlap, one at a wall.
    let ends = numbers(&text, "Points");
    for (k, o) in other.iter().enumerate() {
        let p = &ends[6 * k..6 * k + 6];
        let length = ((p[3] - p[0]).powi(2) + (p[4] - p[1]).powi(2) + (p[5] - p[2]).powi(2)).sqrt();
        let expected = if *o < 0.0 { 0.002 } else { 0.004 };
        assert!(length <= expected * (1.0 + 1e-9) && length > 0.9 * expected, "{length}");
    }
    assert_eq!(numbers(&text, "offsets").last(), Some(&(2.0 * other.len() as f64)));
    assert!(numbers(&text, "types").iter().all(|t| *t == 3.0));
    // The pull of the contacts adds up to the force of each bead.
    let force = numbers(&text, "force");
    let first = numbers(&text, "particle");
    let mut sum = [0.0; 3];
    for (k, (i, j)) in first.iter().zip(&other).enumerate() {
        let sign = if *i == 5.0 {
            1.0
        } else if *j == 5.0 {
            -1.0
        } else {
            0.0
        };
        (0..3).for_each(|a| sum[a] += sign * force[3 * k + a]);
    }
    // The settling drag, a few percent of the weight here, is the rest.
    let weight = states[5].mass * 9.81;
    for (own, whole) in sum.iter().zip(states[5].force.to_array()) {
        assert!((own - whole).abs() < 0.2 * weight);
    }
}

#[test]
fn the_spheres_of_a_clump_share_its_number_and_move_as_one() {
    let drum = stopped(&clumps(), 5);
    let text = particles(&drum, Encoding::Ascii);
    let number = numbers(&text, "particle");
    assert_eq!(number.len(), 90);
    assert_eq!(number.iter().filter(|n| **n == 7.0).count(), 3);
    let (points, velocity) = (numbers(&text, "Points"), numbers(&text, "velocity"));
    let own: Vec<usize> = (0..90).filter(|&k| number[k] == 7.0).collect();
    let at = |list: &[f64], k: usize| [list[3 * k], list[3 * k + 1], list[3 * k + 2]];
    let (p, q) = (at(&points, own[0]), at(&points, own[2]));
    let (u, v) = (at(&velocity, own[0]), at(&velocity, own[2]));
    // A rigid body does not stretch: relative velocity is normal to the distance.
    let stretch: f64 = (0..3).map(|a| (p[a] - q[a]) * (u[a] - v[a])).sum();
    let size: f64 = (0..3).map(|a| (u[a] - v[a]).powi(2)).sum::<f64>().sqrt();
    assert!(stretch.abs() <= 1e-12 * size.max(1e-6), "{stretch}");
}

#[test]
fn a_series_lists_its_instants_once_and_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut drum = stopped(BEADS, 2);
    let mut series = Series::begin(folder.path(), Encoding::Ascii).expect("begins");
    series.write(&drum).expect("written");
    let mut looks = 0;
    drum.run(|_, _| {
        looks += 1;
        if looks >= 2 { Flow::Stop } else { Flow::Go }
    })
    .expect("runs");
    let mut series = Series::go_on(folder.path(), Encoding::Ascii).expect("goes on");
    series.write(&drum).expect("written");
    series.write(&drum).expect("written again");
    let list = std::fs::read_to_string(folder.path().join("particles.pvd")).expect("the list");
    let files: Vec<&str> = list.lines().filter_map(|l| Some(l.split_once("file=\"")?.1)).collect();
    assert_eq!(files.len(), 2, "{list}");
    for file in files {
        let name = file.split('"').next().expect("a name");
        assert!(folder.path().join(name).exists(), "{name}");
    }
    std::fs::write(folder.path().join("contacts.pvd"), "<DataSet timestep=\"x\"/>\n").expect("w");
    let shown = Series::go_on(folder.path(), Encoding::Ascii).expect_err("refused").to_string();
    assert!(shown.contains("contacts.pvd"), "{shown}");
}

#[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
/// A Python that has a package, from TUMBLE_PYTHON or the path.
fn python_with(package: &str) -> Option<String> {
    let python = std::env::var("TUMBLE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let found = Command::new(&python).args(["-c", &format!("import {package}")]).output();
    if found.is_ok_and(|o| o.status.success()) {
        return Some(python);
    }
    println!("skipped: {python} has no {package} (TUMBLE_PYTHON names another)");
    None
}

#[test]
fn meshio_reads_the_same_numbers_in_both_encodings() {
    let Some(python) = python_with("meshio") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let drum = stopped(&clumps(), 10);
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text);
    for (name, encoding) in [("text", Encoding::Ascii), ("base64", Encoding::Base64)] {
        write(&format!("p_{name}.vtu"), particles(&drum, encoding)).expect("written");
        write(&format!("c_{name}.vtu"), contacts(&drum, encoding)).expect("written");
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/read_vtk.py");
    let done = Command::new(python).arg(script).arg(folder.path()).output().expect("Python starts");
    let (out, err) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(done.status.success(), "{out}{err}");
    assert!(out.contains("particles 90"), "{out}");
    let balls = drum.exposure();
    let x: f64 = balls.balls(drum.grains()).map(|b| b.centre.x).sum();
    let read: f64 = out
        .split_once("sum_x ")
        .and_then(|(_, t)| t.split_whitespace().next()?.parse().ok())
        .expect("the sum");
    assert!((read - x).abs() < 1e-12, "{read} {x}");
}
