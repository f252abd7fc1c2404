//! Designs, campaigns, files for other programs.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::tempdir;

use crate::run::{stderr, stdout, tumble};

const PLAN: &str = r#"
name = "beads"
factors.friction.pp = [0.2, 0.8]
design.full_factorial = { centre_points = 1 }
drum = { radius_m = 0.02, length_m = 0.0075, mantle = "glass", end_plates = "glass", ends = "periodic" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.0025 } } }
fill.count = 180
friction.mantle = 0.6
restitution = { pp = 0.7, mantle = 0.7 }
rolling = { pp = 0.01, mantle = 0.01 }
camera.distance_m = 0.1
run = { speeds_rpm = [60.0], frames = 4, seed = 11 }
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 5e5 }
"#;

/// A folder with a plan.
fn planned(text: &str) -> tempfile::TempDir {
    let folder = tempdir().expect("a folder");
    std::fs::write(folder.path().join("plan.toml"), text).expect("written");
    folder
}

/// The plan's rig alone.
fn rig() -> String {
    let own = |l: &&str| !l.starts_with("factors") && !l.starts_with("design");
    let lines: Vec<&str> = PLAN.lines().filter(own).collect();
    lines.join("\n").replace("fill.count = 180", "fill.count = 180\nfriction.pp = 0.5")
}

fn fine(folder: &Path, args: &[&str]) -> String {
    let output = tumble(folder, args);
    assert!(output.status.success(), "{args:?}: {}", stderr(&output));
    stdout(&output)
}

/// Exit code and error of a call that must fail.
fn refused(folder: &Path, args: &[&str]) -> (Option<i32>, String) {
    let output = tumble(folder, args);
    assert!(!output.status.success(), "{args:?} was carried out");
    (output.status.code(), stderr(&output))
}

#[test]
fn a_design_is_a_table_with_what_each_run_takes() {
    let folder = planned(PLAN);
    let text = fine(folder.path(), &["design", "plan.toml"]);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "run,friction.pp,speeds_rpm,seed,particles,time_step_s,least_steps");
    assert!(lines[1].starts_with("0,0.2,60,11,180,"), "{text}");
    assert!(lines[3].starts_with("2,0.5,60,13,180,"), "{text}");
    assert_eq!(lines.len(), 4);
    fine(folder.path(), &["design", "plan.toml", "--out", "sub/runs.csv"]);
    let written = std::fs::read_to_string(folder.path().join("sub/runs.csv")).expect("the table");
    assert_eq!(written, text);
    let json: Value =
        serde_json::from_str(&fine(folder.path(), &["design", "plan.toml", "--json"]))
            .expect("JSON");
    assert_eq!(json[1]["values"][0][1], 0.8);
}

#[test]
fn a_campaign_runs_to_its_table_and_a_second_call_does_nothing() {
    let folder = planned(PLAN);
    let outlook = fine(folder.path(), &["run", "plan.toml", "--dry-run", "--json"]);
    let outlook: Value = serde_json::from_str(&outlook).expect("JSON");
    assert_eq!(outlook["runs"], 3);
    assert_eq!(outlook["frames"], 12);
    assert!(!folder.path().join("tumble-out").exists(), "a dry run writes nothing");
    let args = ["run", "plan.toml", "--width", "480", "--jobs", "2", "--json"];
    let done: Value = serde_json::from_str(&fine(folder.path(), &args)).expect("JSON");
    assert_eq!(done["done"].as_array().map(Vec::len), Some(3), "{done}");
    assert_eq!(done["carried_out"], 3);
    let table = folder.path().join("tumble-out/beads/responses.csv");
    let first = std::fs::read_to_string(&table).expect("the table");
    let header = first.lines().find(|l| !l.starts_with('#')).expect("a header");
    assert!(header.starts_with("run,omega_rpm,friction.pp,aor_lin_deg"), "{header}");
    assert_eq!(first.lines().count(), 1 + 1 + 3);
    let again: Value = serde_json::from_str(&fine(folder.path(), &args)).expect("JSON");
    assert_eq!(again["carried_out"], 0);
    // Single runs in another folder, collected at the end: the same bytes.
    for index in ["2", "0", "1"] {
        let args = ["run", "plan.toml", "--width", "480", "--out", "single", "--index", index];
        let output = tumble(folder.path(), &args);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stderr(&output).contains(&format!("run {index} is done")));
    }
    let single = ["run", "plan.toml", "--width", "480", "--out", "single", "--collect"];
    assert!(fine(folder.path(), &single).contains("3 rows, 0 runs missing"));
    let second = std::fs::read_to_string(folder.path().join("single/responses.csv")).expect("t");
    assert_eq!(first, second);
    // Another plan does not go into the same folder.
    std::fs::write(folder.path().join("plan.toml"), PLAN.replace("0.8]", "0.9]")).expect("written");
    let (code, error) = refused(folder.path(), &args);
    assert_eq!(code, Some(2), "{error}");
    assert!(error.contains("another plan") && error.contains("run 1"), "{error}");
}

#[test]
fn the_books_plan_can_be_carried_out() {
    let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/files/plan.toml");
    let Ok(text) = std::fs::read_to_string(book) else {
        println!("skipped: the crate stands outside its repository, docs/ is absent");
        return;
    };
    let folder = planned(&text);
    let said = fine(folder.path(), &["run", "plan.toml", "--dry-run"]);
    assert!(said.starts_with("29 runs, at least"), "{said}");
}

#[test]
fn schedulers_get_their_scripts() {
    let folder = planned(PLAN);
    let script = |flag: &str, name: &str| {
        let said = fine(folder.path(), &["run", "plan.toml", "--out", "c", flag]);
        assert!(said.contains(name), "{said}");
        std::fs::read_to_string(folder.path().join("c").join(name)).expect("the script")
    };
    let slurm = script("--slurm", "campaign.slurm");
    assert!(slurm.contains("--array=0-2") && slurm.contains("--index \"$SLURM_ARRAY_TASK_ID\""));
    // The paths in it are whole: a scheduler starts elsewhere.
    let whole = folder.path().join("plan.toml").display().to_string();
    assert!(slurm.contains(&whole), "{slurm}");
    // What is printed can be pasted, whatever the folder is called.
    let said = fine(folder.path(), &["run", "plan.toml", "--out", "my runs", "--slurm"]);
    assert_eq!(said.trim(), "sbatch 'my runs/campaign.slurm'");
    assert!(script("--parallel", "campaign.sh").contains("seq 0 2 | parallel"));
    assert!(script("--snakemake", "Snakefile").contains("rule table"));
}

#[test]
fn what_is_wrong_with_a_plan_is_said_before_anything_is_written() {
    let cases = [
        ("[0.2, 0.8]", "[0.2, 8.0]", "plan.toml:3"),
        ("fill.count = 180", "fill.count = 1800", "do not fit"),
        ("fill.count = 180", "fill.count = 1\nfill.scale = 0.4", "rounds to none"),
        ("factors.friction.pp", "factors.friction.end_plate", "run 0 of the plan"),
        ("camera.distance_m = 0.1", "camera.distance_m = 0.01", "camera.distance_m"),
    ];
    for (from, to, words) in cases {
        assert!(PLAN.contains(from));
        let folder = planned(&PLAN.replacen(from, to, 1));
        let (code, error) = refused(folder.path(), &["run", "plan.toml"]);
        assert_eq!(code, Some(2), "{error}");
        assert!(error.contains(words), "{to}: {error}");
        assert!(!folder.path().join("tumble-out").exists());
    }
    let folder = planned(PLAN);
    std::fs::write(folder.path().join("file"), "").expect("written");
    let (code, error) = refused(folder.path(), &["run", "plan.toml", "--out", "file"]);
    assert_eq!(code, Some(2));
    assert!(error.contains("not a folder"), "{error}");
    let (_, error) = refused(folder.path(), &["run", "plan.toml", "--out", "file/below"]);
    assert!(error.contains("file/below"), "{error}");
    let (code, error) = refused(folder.path(), &["run", "plan.toml", "--index", "3"]);
    assert_eq!(code, Some(2));
    assert!(error.contains("runs 0 to 2"), "{error}");
    let (_, error) = refused(folder.path(), &["run", "plan.toml", "--jobs", "0"]);
    assert!(error.contains("jobs") && error.contains("at least 1"), "{error}");
    std::fs::write(folder.path().join("tumble-out/beads/manifest.json"), "{}").expect("written");
    let (code, error) = refused(folder.path(), &["run", "plan.toml"]);
    assert_eq!(code, Some(2));
    assert!(error.contains("not as it was written"), "{error}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_keeps_checkpoints_and_a_second_process_is_told() {
    let folder = planned(&PLAN.replace("frames = 4", "frames = 400"));
    let args = ["run", "plan.toml", "--width", "480", "--jobs", "1", "--checkpoint-every", "0.05"];
    let mut process = Command::new(env!("CARGO_BIN_EXE_tumble"))
        .args(args)
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    let checkpoint = folder.path().join("tumble-out/beads/rows/0000.checkpoint");
    let begun = Instant::now();
    while !checkpoint.exists() {
        assert!(begun.elapsed() < Duration::from_secs(120), "no checkpoint");
        std::thread::sleep(Duration::from_millis(5));
    }
    let (code, error) = refused(folder.path(), &args);
    assert_eq!(code, Some(1), "{error}");
    assert!(error.contains(&format!("process {}", process.id())), "{error}");
    let id = process.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().expect("kill").success());
    assert_eq!(process.wait().expect("ends").code(), Some(1));
    let mut said = String::new();
    let mut pipe = process.stderr.take().expect("is piped");
    std::io::Read::read_to_string(&mut pipe, &mut said).expect("is text");
    assert!(said.contains("the same call goes on"), "{said}");
    assert!(checkpoint.exists());
}

#[test]
fn a_simulation_gives_files_for_paraview_and_an_animation() {
    let folder = planned(PLAN);
    std::fs::write(folder.path().join("rig.toml"), rig()).expect("written");
    let args = ["simulate", "rig.toml", "--width", "480", "--out", "o", "--vtk", "vtk", "--gif"];
    fine(folder.path(), &args);
    let list = std::fs::read_to_string(folder.path().join("vtk/particles.pvd")).expect("the list");
    assert_eq!(list.matches("<DataSet").count(), 4, "{list}");
    // Nothing is left of the frames that were taken before the motion was known to be steady.
    let files = std::fs::read_dir(folder.path().join("vtk")).expect("the folder");
    assert_eq!(files.count(), 2 * (4 + 1));
    assert!(folder.path().join("vtk/contacts.pvd").exists());
    let gif = std::fs::read(folder.path().join("o/film_60rpm.gif")).expect("the animation");
    assert_eq!(&gif[..6], b"GIF89a");
    let decoder = drum_film::image::codecs::gif::GifDecoder::new(std::io::Cursor::new(gif));
    let frames = drum_film::image::AnimationDecoder::into_frames(decoder.expect("is a GIF"));
    assert_eq!(frames.count(), 4);
}

#[test]
fn a_deck_is_written_and_its_dumps_come_back_as_positions() {
    let folder = planned(PLAN);
    std::fs::write(folder.path().join("rig.toml"), rig()).expect("written");
    let export = |more: &[&str]| {
        let mut args = vec!["export", "rig.toml", "--to", "liggghts", "--out", "deck"];
        args.extend(more);
        args.into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    let call = |more: &[&str]| {
        let args = export(more);
        tumble(folder.path(), &args.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let empty = call(&["--collect"]);
    assert_eq!(empty.status.code(), Some(2));
    assert!(stderr(&empty).contains("holds no dump of LIGGGHTS"), "{}", stderr(&empty));
    let done = call(&["--times", "0.4,0.5"]);
    assert!(done.status.success(), "{}", stderr(&done));
    assert!(stdout(&done).contains("liggghts -in drum.lig"));
    let script = std::fs::read_to_string(folder.path().join("deck/drum.lig")).expect("the deck");
    assert_eq!(script.matches("write_dump").count(), 2);
    // What a calibration has found, as if it were set.
    let found = r#"{"friction": [{"omega_rpm": null, "mu_pp": 0.31}], "mu_wall": null}"#;
    std::fs::write(folder.path().join("result.json"), found).expect("written");
    let deck = |more: &[&str]| {
        let done = call(&[&["--times", "0.4,0.5"], more].concat());
        assert!(done.status.success(), "{}", stderr(&done));
        std::fs::read_to_string(folder.path().join("deck/drum.lig")).expect("the deck")
    };
    let calibrated = deck(&["--calibrated", "result.json"]);
    assert_eq!(calibrated, deck(&["--set", "friction.pp=0.31"]));
    assert_ne!(calibrated, script);
    let refused = call(&["--calibrated", "rig.toml"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("no calibrated parameters"), "{}", stderr(&refused));
    let dump = "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff ff pp\n0 1\n0 1\n0 1\n\
                ITEM: ATOMS id type x y z radius\n1 1 0.001 -0.015 0 0.00125\n";
    std::fs::write(folder.path().join("deck/frames_60rpm.dump"), dump).expect("written");
    let done = call(&["--collect"]);
    assert!(done.status.success(), "{}", stderr(&done));
    // The film reads them.
    let film = [
        "film",
        "deck/positions_60rpm.csv",
        "--drum-radius",
        "0.02",
        "--drum-length",
        "0.0075",
        "--set",
        "camera.distance_m=0.1",
        "--width",
        "240",
    ];
    assert!(fine(folder.path(), &film).contains("1 frames"));
    std::fs::write(folder.path().join("deck/frames_60rpm.dump"), &dump[..100]).expect("written");
    let done = call(&["--collect"]);
    assert_eq!(done.status.code(), Some(2));
    assert!(stderr(&done).contains("frames_60rpm.dump, line"), "{}", stderr(&done));
}
