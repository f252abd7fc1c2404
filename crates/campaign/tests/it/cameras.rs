//! Runs that differ in camera or reader alone are filmed, not simulated again.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use campaign::plan::{Campaign, Event, RowOutcome, RowState, RunOptions, Simulated};

use crate::small::{campaign, run, with};

/// Two drums seen from two distances, for so long that what these change stands out.
fn plan() -> String {
    with("factors.run.speed_rpm = [50.0, 70.0]", "factors.camera.distance_m = [0.1, 0.2]")
        .replace("[0.2, 0.5, 0.8]", "[0.2, 0.8]")
        .replace("frames = 4", "frames = 24")
}

fn shown(campaign: &Campaign, index: u64) -> Simulated {
    let row = campaign.manifest().row(index).expect("the run");
    match campaign.state(row).expect("the result is read") {
        RowState::Ended(result) => match result.outcome {
            RowOutcome::Done(simulated) => simulated,
            RowOutcome::Failed(failure) => panic!("run {index}: {failure:?}"),
        },
        other => panic!("run {index} has not ended: {other:?}"),
    }
}

/// Carry out one run; whether anything was simulated for it.
fn one(campaign: &Campaign, index: u64) -> bool {
    let mut simulated = false;
    let how = RunOptions::default();
    let heard = |e: &Event| simulated |= matches!(e, Event::Progress { .. });
    campaign.run_one(index, &how, &AtomicBool::new(false), heard).expect("the run runs");
    simulated
}

fn motion(folder: &Path) -> std::path::PathBuf {
    folder.join("rows/0000.motion")
}

#[test]
fn two_cameras_share_a_motion_and_see_what_each_would_alone() {
    let folder = tempfile::tempdir().expect("a folder");
    let all = campaign(folder.path(), &plan());
    let values: Vec<Vec<f64>> = all.manifest().rows().iter().map(|r| r.values.clone()).collect();
    assert_eq!(all.manifest().factors(), ["camera.distance_m", "friction.pp"]);
    assert_eq!(values, [[0.1, 0.2], [0.2, 0.2], [0.1, 0.8], [0.2, 0.8]]);
    let seeds: Vec<u64> = all.manifest().rows().iter().map(|r| r.seed).collect();
    assert_eq!(seeds, [11, 11, 12, 12]);
    let _ = one(&all, 0);
    assert!(motion(folder.path()).exists());
    assert!(!one(&all, 1), "the second camera had its drum simulated again");
    assert!(!motion(folder.path()).exists(), "nobody needs it any more");
    run(&all, 2);
    let left = std::fs::read_dir(folder.path().join("rows")).expect("the rows").count();
    assert_eq!(left, 4, "results and nothing else");

    let alone = tempfile::tempdir().expect("a folder");
    let second = campaign(alone.path(), &plan());
    // A motion that was altered is made anew.
    std::fs::write(motion(alone.path()), b"tumbrun").expect("written");
    let _ = one(&second, 1);
    assert_eq!(shown(&second, 1), shown(&all, 1));

    let (near, far) = (shown(&all, 0), shown(&all, 1));
    assert_eq!((near.steps, near.particles), (far.steps, far.particles));
    let (near, far) = (&near.speeds[0], &far.speeds[0]);
    assert_eq!(near.torque_n_m.to_bits(), far.torque_n_m.to_bits());
    // From 0.1 m more of the surface is seen along the drum's 7.5 mm than from 0.2 m, so the centre of area is higher: by
    // half of what the rear edge moves, 7.5 / 100 - 7.5 / 200 of its own height of some 20 % of R, which is 0.4 % of R.
    let height = |s: &campaign::plan::SpeedResult| s.responses.expect("measured").cen_y_pct.mean;
    assert!(height(near) < height(far) - 0.2, "{} {}", height(near), height(far));
}
