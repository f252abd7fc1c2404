//! `measure`, `film` and `roi` on small pictures that drum-film draws.

use std::path::Path;

use drum_film::{Bed, Camera, Film};
use serde_json::Value;

use crate::run::{stderr, stdout, tumble};

/// Draws frames of one bed and returns its true angle over the whole surface and its circle `(x, y, r)`.
fn draw(folder: &Path, names: &[&str]) -> (f64, [f64; 3]) {
    let film = Film { camera: Camera::default().with_size(484, 322), ..Film::default() };
    let bed = Bed { fill: 0.35, aor_lin_deg: 32.0, s_shape_deg: 3.0, ..Bed::default() };
    let mut truth = None;
    for (index, name) in names.iter().enumerate() {
        let made = film.bed_frame(&bed, index as u64).expect("a bed within the range");
        made.image.save(folder.join(name)).expect("the frame is written");
        truth = Some(made.truth);
    }
    let t = truth.expect("at least one frame");
    (t.aor_lin_deg, [t.center_x_px, t.center_y_px, t.radius_px])
}

fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("a number is expected, not {v}"))
}

#[test]
fn measure_prints_every_field_of_its_json() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    std::fs::create_dir(&frames).expect("a folder");
    let (angle, [x, y, r]) = draw(&frames, &["a.png", "b.png", "c.png", "d.png"]);
    let out =
        tumble(folder.path(), &["measure", "frames", "--speed", "10", "--json", "--out", "o"]);
    assert!(out.status.success(), "{}", stderr(&out));
    let json: Value = serde_json::from_str(&stdout(&out)).expect("JSON on standard output");
    assert_eq!(json["n_frames"], 4);
    assert_eq!(json["rejected"].as_array().map(Vec::len), Some(0));
    // Half a pixel of 112: far more than the error of the fit, far less than a ring's width.
    assert!((number(&json["drum"]["center_px"][0]) - x).abs() < 0.5);
    assert!((number(&json["drum"]["center_px"][1]) - y).abs() < 0.5);
    assert!((number(&json["drum"]["radius_px"]) - r).abs() < 0.5);
    let responses = json["responses"].as_object().expect("an object");
    assert_eq!(responses.len(), 4);
    for name in ["aor_lin_deg", "aor_mid_deg", "cen_x_pct", "cen_y_pct"] {
        assert!(number(&responses[name]["mean"]).is_finite());
        assert!(number(&responses[name]["sd"]) >= 0.0);
        assert!((1.0..=4.0).contains(&number(&responses[name]["n_eff"])), "{}", responses[name]);
    }
    assert!((number(&responses["aor_lin_deg"]["mean"]) - angle).abs() < 0.3);
    let covariance = json["covariance"].as_array().expect("a matrix");
    assert_eq!(covariance.len(), 4);
    for (i, row) in covariance.iter().enumerate() {
        assert_eq!(row.as_array().map(Vec::len), Some(4));
        assert!(number(&row[i]) >= 0.0);
        for (j, other) in covariance.iter().enumerate() {
            assert_eq!(number(&row[j]).to_bits(), number(&other[i]).to_bits());
        }
    }
    let list = json["frames"].as_array().expect("a list");
    assert_eq!(list.len(), 4);
    for (frame, name) in list.iter().zip(["a.png", "b.png", "c.png", "d.png"]) {
        assert_eq!(frame["frame"], name);
        assert!(number(&frame["aor_lin_deg"]["sd"]) > 0.0);
    }
    for name in ["result.json", "frames.csv", "responses.csv", "contact_sheet.png"] {
        assert!(folder.path().join("o").join(name).is_file(), "{name}");
    }
    let overlays = std::fs::read_dir(folder.path().join("o"))
        .expect("the folder is there")
        .filter(|e| {
            e.as_ref().is_ok_and(|e| e.file_name().to_string_lossy().ends_with("_overlay.png"))
        })
        .count();
    assert_eq!(overlays, 4);
}

#[test]
fn a_truncated_and_a_foreign_file_are_rejected_by_name_among_good_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let frames = folder.path().join("frames");
    std::fs::create_dir(&frames).expect("a folder");
    draw(&frames, &["a.png", "b.png", "cut.png"]);
    let whole = std::fs::read(frames.join("cut.png")).expect("the frame is there");
    std::fs::write(frames.join("cut.png"), &whole[..whole.len() / 2]).expect("written");
    std::fs::write(frames.join("text.jpg"), "this is no picture\n").expect("written");
    let out = tumble(folder.path(), &["measure", "frames", "--json", "--out", "o"]);
    assert!(out.status.success(), "{}", stderr(&out));
    let json: Value = serde_json::from_str(&stdout(&out)).expect("JSON on standard output");
    assert_eq!(json["n_frames"], 2);
    let rejected = json["rejected"].as_array().expect("a list");
    let names: Vec<&str> = rejected.iter().filter_map(|r| r["frame"].as_str()).collect();
    assert_eq!(names, ["cut.png", "text.jpg"]);
    for r in rejected {
        assert_eq!(r["stage"], "decode", "{r}");
        assert!(r["reason"].as_str().is_some_and(|s| s.len() > 10), "{r}");
    }
}

#[test]
fn nothing_but_bad_files_fails_and_says_why() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("text.png"), "no picture").expect("written");
    let out = tumble(folder.path(), &["measure", "text.png", "--out", "o"]);
    assert!(!out.status.success());
    assert!(stderr(&out).contains("text.png"), "{}", stderr(&out));
    assert!(!stderr(&out).contains("panicked"), "{}", stderr(&out));
    // What an earlier call has measured does not stand beside it.
    let old = folder.path().join("o").join("responses.csv");
    std::fs::write(&old, "omega_rpm\n30\n").expect("written");
    tumble(folder.path(), &["measure", "text.png", "--speed", "45", "--out", "o"]);
    assert!(!old.exists());
    let out = tumble(folder.path(), &["measure", "text.png", "nowhere", "--out", "o"]);
    assert!(stderr(&out).contains("nowhere does not exist"), "{}", stderr(&out));
}

#[test]
fn film_draws_a_picture_for_every_frame_of_a_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut text = String::from("frame,x,y,z,radius\n");
    for frame in 0..3 {
        for k in 0..5 {
            let x = 0.02 * f64::from(k) - 0.04;
            text.push_str(&format!("{frame},{x},{},0,0.008\n", -0.06 - 0.01 * f64::from(frame)));
        }
    }
    std::fs::write(folder.path().join("positions.csv"), text).expect("written");
    let film = ["film", "positions.csv", "--drum-radius", "0.125", "--drum-length", "0.15"];
    let out = tumble(folder.path(), &[&film[..], &["--width", "300", "--out", "o"]].concat());
    assert!(out.status.success(), "{}", stderr(&out));
    let open = |name: &str| {
        drum_film::image::open(folder.path().join("o").join(name)).expect("a picture").to_rgb8()
    };
    let pictures = ["frame_00000.png", "frame_00001.png", "frame_00002.png"].map(open);
    assert_eq!(pictures[0].dimensions(), (300, 200));
    // The spheres sink from frame to frame.
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);
    assert!(open("preview.png").width() > 0);
    // It is no frame: what is measured is what was filmed, whether or not a bed is found in five spheres.
    let out = tumble(folder.path(), &["measure", "o", "--out", "m"]);
    let said = String::from_utf8_lossy(&out.stdout).into_owned() + &stderr(&out);
    assert!(said.contains("frame_00000") && !said.contains("preview"), "{said}");

    // Another film, of one frame, leaves none of this one behind; millimetres are no metres.
    let one = "frame,x,y,z,radius\n0,0,-0.06,0,0.008\n";
    std::fs::write(folder.path().join("positions.csv"), one).expect("written");
    let again = [&film[..], &["--width", "300", "--out", "o"]].concat();
    assert!(tumble(folder.path(), &again).status.success());
    assert!(!folder.path().join("o").join("frame_00002.png").exists());
    let far = "frame,x,y,z,radius\n0,0,-60,0,8\n";
    std::fs::write(folder.path().join("positions.csv"), far).expect("written");
    let out = tumble(folder.path(), &again);
    assert!(!out.status.success() && stderr(&out).contains("outside the drum"), "{}", stderr(&out));
    assert!(folder.path().join("o").join("frame_00000.png").exists());

    std::fs::write(folder.path().join("positions.csv"), "frame,x,y,z,radius\n0,0,zero,0,0.01\n")
        .expect("written");
    let out = tumble(folder.path(), &[&film[..], &["--width", "300", "--out", "p"]].concat());
    assert!(!out.status.success());
    assert!(stderr(&out).contains("zero") && stderr(&out).contains('2'), "{}", stderr(&out));
    assert!(!folder.path().join("p").join("frame_00000.png").exists());
}

#[test]
fn roi_writes_a_page_that_holds_the_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    draw(folder.path(), &["a.png"]);
    let out = tumble(folder.path(), &["roi", "a.png", "--out", "o"]);
    assert!(out.status.success(), "{}", stderr(&out));
    let page = std::fs::read_to_string(folder.path().join("o/a.png.html")).expect("the page");
    assert!(page.contains("<html") && page.contains("data:image/") && page.contains("a.png"));
    let out = tumble(folder.path(), &["roi", "missing.png", "--out", "o"]);
    assert!(!out.status.success());
    assert!(stderr(&out).contains("missing.png"), "{}", stderr(&out));
}

#[test]
fn a_drum_lined_with_its_own_cylinder_carries_its_bed() {
    let folder = tempfile::tempdir().expect("a folder");
    let corner = |k: usize, z: f64| {
        let a = std::f64::consts::TAU * (k % 48) as f64 / 48.0;
        format!("vertex {:.6} {:.6} {z}\n", 0.05 * a.cos(), 0.05 * a.sin())
    };
    let facet = |three: [String; 3]| {
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", three.concat())
    };
    let mut tube = String::from("solid tube\n");
    for k in 0..48 {
        let (low, high) = (-0.015, 0.015);
        tube += &facet([corner(k, low), corner(k + 1, high), corner(k + 1, low)]);
        tube += &facet([corner(k, low), corner(k, high), corner(k + 1, high)]);
    }
    std::fs::write(folder.path().join("tube.stl"), tube + "endsolid tube\n").expect("written");
    let rig = r#"
name = "lined"
drum = { radius_m = 0.05, length_m = 0.03, mantle = "glass", end_plates = "glass", liner = "tube.stl" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.007 } } }
fill.count = 250
friction = { pp = 0.4, mantle = 0.9 }
restitution = { pp = 0.6, mantle = 0.6 }
run = { speeds_rpm = [30.0], frames = 4 }
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 1e5 }
"#;
    std::fs::write(folder.path().join("rig.toml"), rig).expect("written");
    let angle = |name: &str| {
        let out = tumble(folder.path(), &["simulate", name, "--width", "300", "--json"]);
        assert!(out.status.success(), "{}", stderr(&out));
        let v: Value = serde_json::from_slice(&out.stdout).expect("JSON");
        number(&v["responses"][0]["responses"]["aor_lin_deg"]["mean"])
    };
    let lined = angle("rig.toml");
    std::fs::write(folder.path().join("plain.toml"), rig.replace(", liner = \"tube.stl\"", ""))
        .expect("written");
    // The same drum but for its facets; four frames of 250 beads scatter by 2 deg.
    assert!((lined - angle("plain.toml")).abs() < 6.0, "{lined}");
    std::fs::remove_file(folder.path().join("tube.stl")).expect("removed");
    let out = tumble(folder.path(), &["simulate", "rig.toml"]);
    assert!(stderr(&out).contains("tube.stl") && out.status.code() == Some(2), "{}", stderr(&out));
}
