//! A drum of 420 beads, too small to name much, large enough to go through every stage.

use close_loop::campaign::{Laboratory, Resolution, Sampling};
use close_loop::rig_schema::{Case, MeasuredTable};
use close_loop::{CloseLoop, CloseLoopError, Codes, Fidelity, LoopSettings, Outcome};

const CASE: &str = r#"
name = "tiny"
drum = { radius_m = 0.03, length_m = 0.02, mantle = "glass", end_plates = "glass", ends = "periodic" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
fill.count = 420
friction = { pp = 0.5, mantle = 0.8 }
restitution = { pp = 0.6, mantle = 0.6 }
rolling = { pp = 0.01, mantle = 0.01 }
camera = { distance_m = 0.25 }
size = { spread = 0.1 }
run = { speeds_rpm = [50.0, 80.0], frames = 6 }
[data]
responses = "measured.csv"
[free]
friction.pp = { range = [0.2, 0.8] }
[catalogue]
only = ["fill.scale", "camera.roll_deg", "measure"]
[simulator.rig]
coarse = false
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 1e5 }
"#;

/// A bed that no friction gives: twice as high as 90 beads can lie.
const IMPOSSIBLE: &str = "\
omega_rpm,aor_lin_deg,aor_lin_sd,aor_mid_deg,aor_mid_sd,cen_x_pct,cen_x_sd,cen_y_pct,cen_y_sd,n_eff
50,30,1,31,1,10,0.5,15,0.5,20
80,30,1,31,1,10,0.5,15,0.5,20
";

fn laboratory(folder: &std::path::Path, jobs: usize) -> Laboratory {
    let resolution = Resolution { width_px: 400, most_sub_frames: 1 };
    let sampling = Sampling { resolution, frame_interval_s: Some(0.1), ..Sampling::default() };
    Laboratory::open(folder, jobs, sampling).unwrap()
}

fn close(folder: &std::path::Path, table: &str, jobs: usize) -> Result<Outcome, CloseLoopError> {
    close_by(folder, table, jobs, Fidelity::Case)
}

fn close_by(
    folder: &std::path::Path,
    table: &str,
    jobs: usize,
    fidelity: Fidelity,
) -> Result<Outcome, CloseLoopError> {
    close_with(folder, table, jobs, LoopSettings { fidelity, ..LoopSettings::default() })
}

fn close_with(
    folder: &std::path::Path,
    table: &str,
    jobs: usize,
    settings: LoopSettings,
) -> Result<Outcome, CloseLoopError> {
    close_case(folder, (CASE, &[table]), jobs, settings)
}

/// A case with a table for each load, the rig's own first.
fn close_case(
    folder: &std::path::Path,
    (case, tables): (&str, &[&str]),
    jobs: usize,
    settings: LoopSettings,
) -> Result<Outcome, CloseLoopError> {
    let case = Case::parse("case.toml", case).unwrap();
    let parse = |text: &&str| MeasuredTable::parse("measured.csv", text).unwrap();
    let tables: Vec<MeasuredTable> = tables.iter().map(parse).collect();
    let (measured, loads) = tables.split_first().unwrap();
    let lab = laboratory(folder, jobs);
    let mut settings = LoopSettings { runs: Some(38), predict: vec![65.0], ..settings };
    settings.attribution.bootstrap = 99;
    settings.attribution.stability_bootstrap = 0;
    CloseLoop { case: &case, measured, loads, lab: &lab, settings: &settings }.run(&mut |_| ())
}

/// Everything but the time that runs took.
fn words(o: &Outcome) -> String {
    format!("{} {:?} {:?} {:?} {:?}", o.sentence, o.strengths, o.before, o.after, o.points)
}

#[test]
fn a_loop_says_the_same_again_from_what_is_kept_and_with_other_workers() {
    let one = tempfile::tempdir().unwrap();
    let first = close(one.path(), IMPOSSIBLE, 2).unwrap();
    assert_ne!(first.verdict, "none");
    assert!(first.before.errors.chi2 > 100.0);
    // As after a kill: some rows are kept, some motions, some are gone or torn.
    for (k, file) in std::fs::read_dir(one.path().join("responses")).unwrap().enumerate() {
        let path = file.unwrap().path();
        match k % 4 {
            0 => std::fs::remove_file(path).unwrap(),
            1 => std::fs::write(path, "{ torn").unwrap(),
            _ => {}
        }
    }
    for (k, file) in std::fs::read_dir(one.path().join("motions")).unwrap().enumerate() {
        let path = file.unwrap().path();
        if k % 3 == 0 {
            std::fs::write(&path, &std::fs::read(&path).unwrap()[..40]).unwrap();
        }
    }
    let again = close(one.path(), IMPOSSIBLE, 1).unwrap();
    assert_eq!(words(&first), words(&again));
    // Codes are taken to differ, and it is said what the answer would be if they did not.
    assert!(first.finding.verdict_without_code.is_some());
    assert!(first.assumed.iter().any(|a| a.contains("LIGGGHTS and LAMMPS")), "{:?}", first.assumed);
    let own = LoopSettings { codes: Codes::Alike, ..LoopSettings::default() };
    let alike = close_with(one.path(), IMPOSSIBLE, 2, own).unwrap();
    assert_eq!(alike.finding.verdict_without_code, None);
    assert!(alike.assumed.iter().all(|a| !a.contains("LIGGGHTS")), "{:?}", alike.assumed);
    assert!(alike.before.errors.chi2 >= first.before.errors.chi2);
    // Where there is no time nothing is looked for, and what there is says so.
    assert!(first.assumed.iter().all(|a| !a.contains("time")), "{:?}", first.assumed);
    let hurried = LoopSettings { time_s: Some(0.0), ..LoopSettings::default() };
    let hurried = close_with(one.path(), IMPOSSIBLE, 2, hurried).unwrap();
    assert!(hurried.runs < first.runs, "{} {}", hurried.runs, first.runs);
    assert!(hurried.assumed.iter().any(|a| a.contains("time")), "{:?}", hurried.assumed);
    // A speed between the two is predicted between their values.
    let own = &first.before.predictions;
    assert_eq!(own.len(), 4);
    for p in own {
        let at = |omega: f64| {
            let same = |q: &&close_loop::Point| q.omega_rpm == omega && q.response == p.response;
            first.points.iter().find(same).unwrap().before
        };
        // Three fillings of six frames each tell all three means to about the standard deviation that is said.
        let (low, high) = (at(50.0).min(at(80.0)), at(50.0).max(at(80.0)));
        let within = low - 3.0 * p.sd..high + 3.0 * p.sd;
        assert!(p.omega_rpm == 65.0 && within.contains(&p.mean), "{p:?}, {within:?}");
        assert!(p.sd > 0.0 && p.sd < 2.5, "{p:?}");
    }
}

/// What a drum with fewer beads than `count` shows, in another filling, as a table.
fn fewer_beads(folder: &std::path::Path, count: f64, scale: f64) -> String {
    let mut rig = Case::parse("case.toml", CASE).unwrap().rig;
    rig.settings.set("fill.count", count).unwrap();
    rig.settings.set("fill.scale", scale).unwrap();
    rig.settings.set("friction.pp", 0.4).unwrap();
    rig.run.seed = 77;
    rig.run.frames = 40;
    let run = laboratory(folder, 2).run(&[rig], |_| ()).pop().unwrap().unwrap();
    let mut table = IMPOSSIBLE.lines().next().unwrap().to_owned();
    for s in &run.speeds {
        let cells: Vec<String> =
            (0..4).map(|r| format!("{:.4},{:.4}", s.mean[r], s.sd[r])).collect();
        table += &format!("\n{},{},20", s.omega_rpm, cells.join(","));
    }
    table
}

#[test]
fn fewer_beads_are_named_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let table = fewer_beads(&folder.path().join("nature"), 420.0, 0.8);
    let found = close(&folder.path().join("fits"), &table, 2).unwrap();
    assert!(found.members.iter().any(|m| m == "fill.scale"), "{}", found.sentence);
    assert_eq!(found.confirmed, Some(true), "{}", found.sentence);
    // The interval holds the truth and is no wider than a fifth of the beads; two speeds of six frames tell no more.
    let fill = found.strengths.iter().find(|s| s.name == "fill.scale").unwrap();
    assert!(fill.lo < 0.8 && 0.8 < fill.hi && fill.hi - fill.lo < 0.2, "{fill:?}");
}

#[test]
fn two_loads_of_a_drum_are_explained_together() {
    let folder = tempfile::tempdir().unwrap();
    let nature = folder.path().join("nature");
    let [full, half] = [420.0, 230.0].map(|count| fewer_beads(&nature, count, 0.8));
    let other = "\n[[data.loads]]\nresponses = \"half.csv\"\nfill.count = 230\n[free]";
    let case = CASE.replace("\n[free]", other);
    let fits = folder.path().join("fits");
    let close = |tables: &[&str]| close_case(&fits, (&case, tables), 2, LoopSettings::default());
    let found = close(&[&full, &half]).unwrap();
    assert!(found.members.iter().any(|m| m == "fill.scale"), "{}", found.sentence);
    assert_eq!(found.confirmed, Some(true), "{}", found.sentence);
    let fill = found.strengths.iter().find(|s| s.name == "fill.scale").unwrap();
    assert!(fill.lo < 0.8 && 0.8 < fill.hi && fill.hi - fill.lo < 0.15, "{fill:?}");
    // Both loads are in what is told, each with what fresh runs of it say.
    let amounts: Vec<f64> = found.loads.iter().map(|l| l.fill.1).collect();
    assert_eq!(amounts, [420.0, 230.0]);
    for load in 0..2 {
        let own: Vec<_> = found.points.iter().filter(|p| p.load == load).collect();
        assert_eq!(own.len(), 8);
        let near = own.iter().filter(|p| (p.measured - p.after).abs() < 3.0 * p.sd).count();
        assert!(near >= 7, "{own:?}");
    }
    // The lower bed has its centre of area lower, by a tenth of the radius and more.
    let height = |load| {
        let own = |p: &&close_loop::Point| p.load == load && p.response == "cen_y_pct";
        found.points.iter().find(own).unwrap().after
    };
    assert!(height(1) > height(0) + 10.0, "{} {}", height(0), height(1));
    assert!(
        found.assumed.iter().any(|a| a.contains("with fill.count = 230")),
        "{:?}",
        found.assumed
    );
    let fault = close(&[&full]).unwrap_err();
    assert!(matches!(fault, CloseLoopError::Loads { expected: 1, given: 0 }), "{fault}");
}

#[test]
fn what_would_tell_a_class_apart_is_weighed() {
    let folder = tempfile::tempdir().unwrap();
    // Whole lines alone, 4 deg steeper than the drum's: a turned camera does that, and so does somebody who reads them so. One filling
    // lies some 2 deg off another, and lines of few frames differ between the two by chance: twice the usual number of frames here.
    let table = fewer_beads(&folder.path().join("nature"), 420.0, 1.0);
    let row = |row: &str| row.split(',').map(|c| c.parse().unwrap()).collect();
    let rows: Vec<Vec<f64>> = table.lines().skip(1).map(row).collect();
    let mut lines = vec!["omega_rpm,aor_lin_deg,aor_lin_sd,n_eff".to_owned()];
    // Half-way between the two speeds the line is half-way.
    for part in [0.0, 0.5, 1.0] {
        let cell = |k: usize| rows[0][k] + part * (rows[1][k] - rows[0][k]);
        lines.push(format!("{},{},{},20", cell(0), cell(1) + 4.0, cell(2)));
    }
    let case = CASE.replace("[0.2, 0.8]", "[0.39, 0.41]").replace(
        "\"fill.scale\", \"camera.roll_deg\", \"measure\"",
        "\"camera.roll_deg\", \"measure.bias_lin_deg\"",
    );
    let case = case.replace("frames = 6", "frames = 12");
    let fits = folder.path().join("fits");
    let found =
        close_case(&fits, (&case, &[&lines.join("\n")]), 2, LoopSettings::default()).unwrap();
    let mut members = found.members.clone();
    members.sort();
    assert_eq!(members, ["camera.roll_deg", "measure.bias_lin_deg"], "{}", found.sentence);
    // Turned the other way the camera lowers the line by as much as it raised it, the reader raises it as before. Neither more
    // photographs nor another load tell them apart.
    let next = &found.finding.next;
    assert_eq!(next.len(), 3, "{next:?}");
    assert!(next[0].name.contains("the other way"), "{next:?}");
    assert!(next[0].gain_bits > 0.9 * next[0].most_bits, "{next:?}");
    assert!(next[1..].iter().all(|n| n.gain_bits < 0.3 * n.most_bits), "{next:?}");
    assert!(next.iter().any(|n| n.name.contains("fill.count = 210")), "{next:?}");
    // Half as much is not simulated where nobody asks for it.
    let few = LoopSettings { next: false, ..LoopSettings::default() };
    let few = close_case(&fits, (&case, &[&lines.join("\n")]), 2, few).unwrap();
    assert_eq!(few.finding.next.len(), 2);
    assert!(few.runs < found.runs && few.sentence == found.sentence);
}

#[test]
fn a_coarse_stand_in_is_held_against_the_drum_and_the_answer_is_the_drums() {
    let folder = tempfile::tempdir().unwrap();
    let coarse = close_by(folder.path(), IMPOSSIBLE, 2, Fidelity::Coarse).unwrap();
    // Beads half as large again lie differently, and it is said by how much.
    assert_eq!(coarse.off_by.len(), 2 * 4);
    let height = coarse.off_by.iter().filter(|s| s.response == "cen_y_pct").map(|s| s.mean.abs());
    assert!(height.fold(0.0, f64::max) > 0.5, "{:?}", coarse.off_by);
    assert!(coarse.assumed.iter().any(|a| a.contains("fresh runs are of the rig itself")));
    assert_eq!(coarse.before.fillings, 1);
    assert!(coarse.before.errors.chi2 > 50.0);
    // What the shifted stand-in says is what a fresh run of the drum shows.
    for residual in &coarse.finding.base.residuals {
        let same = |p: &&close_loop::Point| {
            p.omega_rpm == residual.omega_rpm && p.response == residual.response
        };
        let point = coarse.points.iter().find(same).unwrap();
        let said = point.measured - residual.value;
        // Six frames of 420 beads tell the middle line to four degrees, and that is said.
        let within = 3f64.max(1.5 * point.sd);
        assert!((said - point.before).abs() < within, "{said} {point:?}");
    }
}

#[test]
fn a_load_that_no_drum_can_hold_is_refused_before_anything_is_simulated() {
    use close_loop::rig_schema::{Amount, Load};
    let folder = tempfile::tempdir().unwrap();
    let mut case = Case::parse("case.toml", CASE).unwrap();
    let (responses, fill) = ("half.csv".to_owned(), Amount::Count(-5.0));
    case.data.loads = vec![Load { responses, fill, n_eff: None, fillings: None }];
    let measured = MeasuredTable::parse("measured.csv", IMPOSSIBLE).unwrap();
    let (lab, settings) = (laboratory(folder.path(), 1), LoopSettings::default());
    let loads = [measured.clone()];
    let (case, measured, loads, lab, settings) = (&case, &measured, &loads, &lab, &settings);
    let fault = CloseLoop { case, measured, loads, lab, settings }.planned().unwrap_err();
    let CloseLoopError::Strength { path, value } = fault else { panic!("{fault}") };
    assert_eq!((path.as_str(), value), ("fill.count", -5.0));
}

#[test]
fn too_few_runs_are_refused_before_anything_is_simulated() {
    let folder = tempfile::tempdir().unwrap();
    let case = Case::parse("case.toml", CASE).unwrap();
    let measured = MeasuredTable::parse("measured.csv", IMPOSSIBLE).unwrap();
    let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
    let settings = LoopSettings { runs: Some(3), ..LoopSettings::default() };
    let looped =
        CloseLoop { case: &case, measured: &measured, loads: &[], lab: &lab, settings: &settings };
    let error = looped.planned().unwrap_err();
    assert!(matches!(error, CloseLoopError::Budget { runs: 3, least, .. } if least > 3), "{error}");
}

#[test]
fn a_case_with_a_table_is_pointed_to_the_other_way() {
    let folder = tempfile::tempdir().unwrap();
    let text = CASE.replace(
        "[simulator.rig]\ncoarse = false",
        "[simulator.table]\nfile = \"runs.csv\"\ncolumns = { mu_pp = \"friction.pp\" }",
    );
    let case = Case::parse("case.toml", &text).unwrap();
    let measured = MeasuredTable::parse("measured.csv", IMPOSSIBLE).unwrap();
    let lab = Laboratory::open(folder.path(), 1, Sampling::default()).unwrap();
    let settings = LoopSettings::default();
    let looped =
        CloseLoop { case: &case, measured: &measured, loads: &[], lab: &lab, settings: &settings };
    assert!(matches!(looped.planned(), Err(CloseLoopError::NoRig { .. })));
}
