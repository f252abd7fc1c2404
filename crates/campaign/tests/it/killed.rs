//! Processes that are killed, stopped or shared out: the same bytes.

use std::path::Path;
use std::process::{Child, Command};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use campaign::plan::{Campaign, Event, RowOutcome, RowState, RunOptions};
use campaign::rig_schema::{Response, SimulatedTable};

use crate::small::{PLAN, campaign, run, with};

/// Where the child process finds its campaign.
const FOLDER: &str = "TUMBLE_TEST_CAMPAIGN";

/// Checkpoints often enough that a second's run has several.
fn often(jobs: usize) -> RunOptions {
    RunOptions { jobs, checkpoint_every: Duration::from_millis(40), ..RunOptions::default() }
}

/// What the child process does; nothing where it is called as a test.
#[test]
fn child_process() {
    let Some(folder) = std::env::var_os(FOLDER) else { return };
    let campaign = Campaign::open(Path::new(&folder)).expect("the campaign is there");
    campaign.run(&often(1), &AtomicBool::new(false), |_| {}).expect("the campaign runs");
}

fn child(folder: &Path) -> Child {
    Command::new(std::env::current_exe().expect("this program"))
        .args(["--exact", "killed::child_process", "--nocapture"])
        .env(FOLDER, folder)
        .stdout(std::process::Stdio::null())
        .spawn()
        .expect("the child starts")
}

/// Wait until `seen` holds, or fail after a long time.
fn wait(what: &str, mut seen: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !seen() {
        assert!(begun.elapsed() < Duration::from_secs(300), "{what} did not come");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn results(folder: &Path) -> usize {
    let rows = std::fs::read_dir(folder.join("rows")).expect("the folder of results");
    rows.filter(|e| {
        e.as_ref().is_ok_and(|e| {
            let name = e.file_name();
            name.to_string_lossy().ends_with(".json") && !name.to_string_lossy().starts_with('.')
        })
    })
    .count()
}

/// Outcomes of all runs, without what they cost.
fn outcomes(campaign: &Campaign) -> Vec<RowOutcome> {
    let rows = campaign.manifest().rows().iter();
    rows.map(|row| match campaign.state(row).expect("the result is read") {
        RowState::Ended(result) => result.outcome,
        other => panic!("run {} has not ended: {other:?}", row.index),
    })
    .collect()
}

#[test]
fn killed_three_times_and_with_two_workers_the_table_is_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let straight = campaign(&path("straight"), PLAN);
    let summary = run(&straight, 1);
    assert_eq!((summary.done.len(), summary.carried_out), (6, 6), "{summary:?}");
    let table = straight.collect().expect("collected");
    assert_eq!(table.rows, 6);
    assert!(table.missing.is_empty());

    let two = campaign(&path("two"), PLAN);
    run(&two, 2);
    assert_eq!(two.collect().expect("collected"), table);
    assert_eq!(outcomes(&two), outcomes(&straight));

    let killed = campaign(&path("killed"), PLAN);
    let under_way = |k: usize| path("killed").join(format!("rows/{k:04}.checkpoint"));
    for k in 0..3 {
        let mut process = child(&path("killed"));
        // In the middle of run 0, 2 and 4: with a checkpoint, without a result.
        wait("a checkpoint", || under_way(2 * k).exists());
        process.kill().expect("the child is killed");
        process.wait().expect("the child is gone");
        assert!(results(&path("killed")) < 6);
    }
    let summary = run(&killed, 1);
    assert_eq!(summary.done.len(), 6, "{summary:?}");
    assert!(summary.carried_out < 6, "what was done is not done again");
    let resumed =
        killed.manifest().rows().iter().any(
            |row| matches!(killed.state(row), Ok(RowState::Ended(r)) if r.effort.sessions > 1),
        );
    assert!(resumed, "a run went on from a checkpoint");
    assert_eq!(outcomes(&killed), outcomes(&straight), "every bit of every result");
    killed.collect().expect("collected");
    let bytes = |name: &str| std::fs::read(path(name).join("responses.csv")).expect("the table");
    assert_eq!(bytes("killed"), bytes("straight"));

    // The table is one of the schema, with what the plan varies.
    let names = SimulatedTable::factor_columns(&table.text);
    assert_eq!(names, ["friction.pp"]);
    let read = SimulatedTable::parse("responses.csv", &table.text, &["friction.pp"])
        .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(read.rows[5].factors, [0.8]);
    assert_eq!(read.rows[5].omega_rpm, 70.0);
    // Few and coarse beads: not every frame can be measured, but the bed is seen on its side.
    let seen: Vec<_> = read.rows.iter().filter(|r| r.n_frames.is_some()).collect();
    assert!(seen.len() >= 3, "{}", table.text);
    for row in seen {
        assert!(row.n_frames.is_some_and(|n| (1.0..=4.0).contains(&n)));
        assert!(row.n_eff.is_some_and(|n| (1.0..=4.0).contains(&n)));
        let centre = row.cells[Response::CenX.index()].expect("was measured").mean;
        assert!(centre > 5.0 && centre < 50.0, "{centre}");
    }
    // Doing it once more does nothing.
    assert_eq!(run(&killed, 1).carried_out, 0);
}

#[test]
fn a_stopped_campaign_keeps_its_checkpoint_and_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = with("[0.2, 0.5, 0.8]", "[0.2, 0.8]");
    let campaign = campaign(folder.path(), &plan);
    let stop = AtomicBool::new(false);
    let mut events = Vec::new();
    let summary = campaign
        .run(&often(2), &stop, |event| {
            events.push(event.clone());
            if matches!(event, Event::Progress { .. }) {
                stop.store(true, Ordering::Relaxed);
            }
        })
        .expect("the campaign runs");
    assert!(summary.open.len() >= 2, "{summary:?}");
    assert!(events.iter().any(|e| matches!(e, Event::Stopped { .. })), "{events:?}");
    let begun = campaign.manifest().rows().iter();
    assert!(begun.filter(|r| campaign.state(r).ok() == Some(RowState::Begun)).count() >= 1);
    let collected = campaign.collect().expect("collected");
    assert!(collected.missing.len() >= 2);
    assert!(collected.text.contains("# run 3 is missing: it has no result yet"));
    let mut resumed = false;
    let summary = campaign
        .run(&often(1), &AtomicBool::new(false), |event| {
            resumed |= matches!(event, Event::Started { resumed: true, .. });
        })
        .expect("the campaign runs");
    assert!(resumed);
    assert_eq!(summary.done, [0, 1, 2, 3]);
}

#[test]
fn one_simulation_goes_through_all_speeds_where_speed_is_no_factor() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = with("factors.run.speed_rpm = [50.0, 70.0]", "")
        .replace("speeds_rpm = [60.0]", "speeds_rpm = [70.0, 50.0]")
        .replace("[0.2, 0.5, 0.8]", "[0.2, 0.8]");
    let campaign = campaign(folder.path(), &plan);
    assert_eq!(campaign.manifest().rows().len(), 2);
    // Run 1 first, alone: numbers in the table do not move when run 0 follows.
    let none = AtomicBool::new(false);
    let summary = campaign.run_one(1, &often(1), &none, |_| {}).expect("the run runs");
    assert_eq!((summary.done, summary.open), (vec![1], vec![0]));
    let text = campaign.collect().expect("collected").text;
    let parse = |text: &str| {
        let table = SimulatedTable::parse("t.csv", text, &["friction.pp"]);
        table.unwrap_or_else(|e| panic!("{e}")).rows
    };
    let rows = parse(&text);
    let places: Vec<(u64, f64)> = rows.iter().map(|r| (r.run, r.omega_rpm)).collect();
    assert_eq!(places, [(2, 50.0), (3, 70.0)]);
    run(&campaign, 1);
    let all = parse(&campaign.collect().expect("collected").text);
    assert_eq!(all.len(), 4);
    assert_eq!(all[2].cells, rows[0].cells);
}
