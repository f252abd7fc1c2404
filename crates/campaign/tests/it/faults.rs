//! What goes wrong, each with the words that a caller reads.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use campaign::CampaignError;
use campaign::plan::{
    Campaign, Event, FailureClass, Freeze, Manifest, RowOutcome, RowState, RunOptions,
};

use crate::small::{PLAN, campaign, freeze, run, with, words};

fn frozen(plan: &str) -> Result<Manifest, CampaignError> {
    Manifest::freeze("plan.toml", plan, &freeze())
}

/// Words of the refusal of a plan.
fn refused(plan: &str) -> String {
    words(&frozen(plan).expect_err("is refused"))
}

#[test]
fn a_level_outside_its_range_names_its_line() {
    let shown = refused(&with("[0.2, 0.5, 0.8]", "[0.2, 0.5, 8.0]"));
    assert!(shown.contains("plan.toml:3") && shown.contains("friction.pp"), "{shown}");
    let shown = refused(&with("[50.0, 70.0]", "[-50.0, 70.0]"));
    assert!(shown.contains("run.speed_rpm"), "{shown}");
}

#[test]
fn a_factor_that_cannot_act_names_the_run() {
    let shown = refused(&with("friction.pp = [0.2, 0.5, 0.8]", "friction.end_plate = [0.1, 0.3]"));
    assert!(shown.contains("run 0 of the plan (friction.end_plate = 0.1"), "{shown}");
    assert!(shown.contains("periodic"), "{shown}");
}

#[test]
fn no_particle_and_too_many_are_refused_before_anything_runs() {
    let scale = |levels: &str| {
        with("friction.pp = [0.2, 0.5, 0.8]", &format!("fill.scale = [{levels}]"))
            .replace("fill.count = 180", "fill.count = 1\nfriction.pp = 0.5")
    };
    let shown = refused(&scale("0.4, 1.0"));
    assert!(shown.contains("rounds to none") && shown.contains("fill.scale = 0.4"), "{shown}");
    let many = PLAN.replace("fill.count = 180", "fill.count = 900");
    let shown = refused(&many);
    assert!(shown.contains("do not fit") && shown.contains("900"), "{shown}");
}

#[test]
fn particles_that_only_turn_out_not_to_fit_are_a_failed_run_with_its_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    // 829 beads: 72 % of the drum, less than the densest packing, more than a random one.
    let plan = with("friction.pp = [0.2, 0.5, 0.8]", "fill.count = [180.0, 829.0]")
        .replace("fill.count = 180", "fill.count = 180\nfriction.pp = 0.5")
        .replace("[50.0, 70.0]", "[60.0, 70.0]");
    let campaign = campaign(folder.path(), &plan);
    let summary = run(&campaign, 2);
    assert_eq!(summary.done, [0, 2]);
    assert_eq!(summary.failed.len(), 2);
    let (index, failure) = &summary.failed[0];
    assert_eq!((*index, failure.class, failure.attempts), (1, FailureClass::Physics, 1));
    assert!(failure.reason.contains("do not fit"), "{}", failure.reason);
    let table = campaign.collect().expect("collected");
    assert_eq!((table.rows, table.missing.len()), (2, 2));
    assert!(table.text.contains("# run 1 is missing: it failed (physics): 829"), "{}", table.text);
    // A fault of physics would come again: it is not tried again unless asked for.
    assert_eq!(run(&campaign, 1).carried_out, 0);
    let again = RunOptions { retry_failed: true, ..RunOptions::default() };
    let summary = campaign.run(&again, &AtomicBool::new(false), |_| {}).expect("runs");
    assert_eq!((summary.carried_out, summary.failed.len()), (2, 2));
}

#[test]
fn an_altered_manifest_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    campaign(folder.path(), PLAN);
    let path = folder.path().join("manifest.json");
    let text = std::fs::read_to_string(&path).expect("the manifest");
    let altered = text.replacen("\"seed\": 12", "\"seed\": 99", 1);
    assert_ne!(altered, text);
    std::fs::write(&path, altered).expect("written");
    let shown = Campaign::open(folder.path()).expect_err("is refused").to_string();
    assert!(shown.contains("manifest.json") && shown.contains("checksum"), "{shown}");
    let cut = &text[..text.len() / 2];
    std::fs::write(&path, cut).expect("written");
    let shown = Campaign::open(folder.path()).expect_err("is refused").to_string();
    assert!(shown.contains("not as it was written"), "{shown}");
    // The same manifest with other white space is the same manifest.
    std::fs::write(&path, text.replace("\n  ", "\n\t")).expect("written");
    assert_eq!(Campaign::open(folder.path()).expect("is read").manifest().rows().len(), 6);
}

#[test]
fn a_folder_belongs_to_one_plan() {
    let folder = tempfile::tempdir().expect("a folder");
    campaign(folder.path(), PLAN);
    let begin = |plan: &str, how: &Freeze| {
        let manifest = Manifest::freeze("plan.toml", plan, how).expect("is a plan");
        Campaign::begin(folder.path(), manifest)
    };
    // Comments do not count.
    begin(&format!("# mine\n{PLAN}"), &freeze()).expect("the same plan");
    let shown = begin(&with("[0.2, 0.5, 0.8]", "[0.2, 0.5, 0.9]"), &freeze())
        .expect_err("another")
        .to_string();
    assert!(shown.contains("another plan") && shown.contains("run 2"), "{shown}");
    let shown =
        begin(&with("mantle = 0.6", "mantle = 0.7"), &freeze()).expect_err("another").to_string();
    assert!(shown.contains("`friction.mantle`"), "{shown}");
    let shown = begin(PLAN, &Freeze::default()).expect_err("another").to_string();
    assert!(shown.contains("width"), "{shown}");
    let nowhere = tempfile::tempdir().expect("a folder");
    let shown = Campaign::open(nowhere.path()).expect_err("no campaign").to_string();
    assert!(shown.contains("holds no campaign"), "{shown}");
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("written");
    let manifest = frozen(PLAN).expect("is a plan");
    let error = Campaign::begin(&file.join("out"), manifest).expect_err("is refused");
    let shown = error.to_string();
    assert!(matches!(error, CampaignError::Io { .. }), "{shown}");
    assert!(shown.contains("making the folder") && shown.contains("out"), "{shown}");
}

#[test]
fn a_second_process_is_told_who_is_at_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = campaign(folder.path(), PLAN);
    let stop = AtomicBool::new(false);
    let how = RunOptions::default();
    let mut shown = Vec::new();
    campaign
        .run(&how, &stop, |event| {
            if !matches!(event, Event::Started { .. }) {
                return;
            }
            // Locks are of open files: a second opening is as another process.
            let other = AtomicBool::new(true);
            let whole = campaign.run(&how, &other, |_| {}).expect_err("is locked");
            let single = campaign.run_one(5, &how, &other, |_| {}).expect_err("is locked");
            shown = vec![whole.to_string(), single.to_string()];
            stop.store(true, Ordering::Relaxed);
        })
        .expect("the first runs");
    let me = format!("process {}", std::process::id());
    assert_eq!(shown.len(), 2);
    assert!(shown.iter().all(|s| s.contains(&me) && s.contains("the campaign in")), "{shown:?}");
}

#[test]
fn single_runs_go_side_by_side_but_not_the_same_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = campaign(folder.path(), PLAN);
    let how = RunOptions::default();
    let stop = AtomicBool::new(false);
    let mut seen = None;
    campaign
        .run_one(0, &how, &stop, |event| {
            if !matches!(event, Event::Started { .. }) {
                return;
            }
            let halted = AtomicBool::new(true);
            let other = campaign.run_one(1, &how, &halted, |_| {}).map(|s| s.open.len());
            let go = AtomicBool::new(false);
            let same = campaign.run_one(0, &how, &go, |_| {});
            let whole = campaign.run(&how, &halted, |_| {});
            seen = Some((other, same, whole));
            stop.store(true, Ordering::Relaxed);
        })
        .expect("the first runs");
    let (other, same, whole) = seen.expect("was tried");
    assert_eq!(other.expect("another run goes beside"), 6);
    let same = same.expect_err("the same run is locked").to_string();
    assert!(same.contains("run 0 of the campaign"), "{same}");
    let whole = whole.expect_err("the campaign is locked").to_string();
    assert!(whole.contains("single runs"), "{whole}");
    let shown = campaign.run_one(6, &how, &stop, |_| {}).expect_err("no such run").to_string();
    assert!(shown.contains("runs 0 to 5"), "{shown}");
}

#[test]
fn an_altered_checkpoint_is_named_and_a_removed_one_starts_anew() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = with("[0.2, 0.5, 0.8]", "[0.2, 0.8]").replace("[50.0, 70.0]", "[60.0, 70.0]");
    let campaign = campaign(folder.path(), &plan);
    let how = RunOptions { checkpoint_every: Duration::from_millis(20), ..RunOptions::default() };
    let stop = AtomicBool::new(false);
    campaign
        .run_one(0, &how, &stop, |_| stop.store(true, Ordering::Relaxed))
        .expect("stopped at once");
    let path = folder.path().join("rows/0000.checkpoint");
    let mut bytes = std::fs::read(&path).expect("the checkpoint");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&path, bytes).expect("written");
    let go = AtomicBool::new(false);
    let summary = campaign.run_one(0, &how, &go, |_| {}).expect("runs");
    let (index, failure) = &summary.failed[0];
    assert_eq!((*index, failure.class), (0, FailureClass::Checkpoint));
    assert!(failure.reason.contains("0000.checkpoint"), "{}", failure.reason);
    assert!(failure.reason.contains("remove it, and the run starts anew"), "{}", failure.reason);
    std::fs::remove_file(&path).expect("removed");
    let summary = campaign.run_one(0, &how, &go, |_| {}).expect("runs");
    assert_eq!((summary.done, summary.failed), (vec![0], vec![]));
}

#[test]
fn a_folder_that_goes_away_is_tried_again_and_then_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let campaign = campaign(folder.path(), PLAN);
    // A folder where the checkpoint should be: it can neither be read nor replaced.
    let place = folder.path().join("rows/0000.checkpoint");
    std::fs::create_dir(&place).expect("made");
    let how = RunOptions { attempts: 2, ..RunOptions::default() };
    let go = AtomicBool::new(false);
    let summary = campaign.run_one(0, &how, &go, |_| {}).expect("runs");
    let (_, failure) = &summary.failed[0];
    assert_eq!((failure.class, failure.attempts), (FailureClass::Io, 2));
    assert!(failure.reason.contains("reading") && failure.reason.contains("0000.checkpoint"));
    // It may pass: the next call tries again.
    std::fs::remove_dir(&place).expect("removed");
    let summary = campaign.run_one(0, &how, &go, |_| {}).expect("runs");
    assert_eq!(summary.done, [0]);
    let state = campaign.state(&campaign.manifest().rows()[0]).expect("is read");
    let RowState::Ended(result) = state else { panic!("it ended") };
    assert!(matches!(result.outcome, RowOutcome::Done(_)));
    // A result that was changed is not taken.
    let path = folder.path().join("rows/0000.json");
    let text = std::fs::read_to_string(&path).expect("the result");
    std::fs::write(&path, text.replacen("\"particles\": 180", "\"particles\": 181", 1)).expect("w");
    let shown = campaign.table().expect_err("is refused").to_string();
    assert!(shown.contains("0000.json") && shown.contains("checksum"), "{shown}");
}
