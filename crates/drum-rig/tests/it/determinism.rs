//! The same bits for any number of threads, and across stop and restart.

use drum_rig::{Error, Experiment, Flow, Options, Outcome};

use crate::rigs::{finished, small, with};

fn options(threads: usize) -> Options {
    Options {
        threads,
        exposure_s: 0.02,
        sub_frames: 3,
        frame_interval_s: Some(0.05),
        ..Options::default()
    }
}

fn rig() -> drum_rig::rig_schema::Rig {
    let mut rig = with(&small(90), &[("vibration.amplitude_m", 5e-5)]);
    rig.run.speeds_rpm = vec![120.0, 90.0];
    rig
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let (a, one) = finished(&rig(), &options(1));
    let (b, two) = finished(&rig(), &options(2));
    assert_eq!(a.state_hash(), b.state_hash());
    assert_eq!(one, two);
    assert_eq!(one.iter().map(|s| s.speed_rpm).collect::<Vec<_>>(), [90.0, 120.0]);
}

#[test]
fn a_run_stopped_at_any_point_goes_on_bit_by_bit() {
    let rig = rig();
    let (whole, expected) = finished(&rig, &options(1));
    let mut ticks = 0;
    Experiment::new(&rig, &options(1))
        .unwrap()
        .run(|_, _| {
            ticks += 1;
            Flow::Go
        })
        .unwrap();
    // In the settling, the approach, and between two sub-frames of either speed.
    for stop in [1, ticks / 5, ticks / 3, ticks * 2 / 5, ticks * 3 / 4, ticks - 2] {
        let mut drum = Experiment::new(&rig, &options(1)).unwrap();
        let mut count = 0;
        let outcome = drum.run(|_, _| {
            count += 1;
            if count == stop { Flow::Stop } else { Flow::Go }
        });
        assert_eq!(outcome, Ok(Outcome::Stopped));
        let bytes = drum.checkpoint();
        let mut resumed = Experiment::resume(&rig, &options(2), &bytes).unwrap();
        assert_eq!(resumed.state_hash(), drum.state_hash());
        assert_eq!(resumed.checkpoint(), bytes);
        assert_eq!(resumed.run(|_, _| Flow::Go), Ok(Outcome::Finished));
        assert_eq!(resumed.state_hash(), whole.state_hash(), "stopped after {stop} of {ticks}");
        assert_eq!(resumed.sampled(), expected);
    }
}

#[test]
fn a_checkpoint_cut_short_altered_or_of_another_rig_is_refused() {
    let rig = rig();
    let drum = Experiment::new(&rig, &options(1)).unwrap();
    let bytes = drum.checkpoint();
    let resume = |bytes: &[u8]| Experiment::resume(&rig, &options(1), bytes).map(|_| ());
    assert_eq!(resume(&bytes), Ok(()));
    for cut in [0, 7, 8, 60, bytes.len() / 2, bytes.len() - 1] {
        assert!(matches!(resume(&bytes[..cut]), Err(Error::Checkpoint { .. })), "{cut}");
    }
    for at in [0, 7, 9, 50, bytes.len() / 2, bytes.len() - 1] {
        let mut altered = bytes.clone();
        altered[at] ^= 4;
        assert!(matches!(resume(&altered), Err(Error::Checkpoint { .. })), "{at}");
    }
    let other = with(&rig, &[("friction.pp", 0.51)]);
    let refused = Experiment::resume(&other, &options(1), &bytes).map(|_| ());
    assert!(matches!(refused, Err(Error::OtherRig { .. })));
    let longer = Options { exposure_s: 0.03, ..options(1) };
    let refused = Experiment::resume(&rig, &longer, &bytes).map(|_| ());
    assert!(matches!(refused, Err(Error::OtherRig { .. })));
}

#[test]
fn another_seed_gives_another_bed() {
    let mut other = rig();
    other.run.seed = 4;
    let hash = |rig| Experiment::new(rig, &options(1)).unwrap().state_hash();
    assert_ne!(hash(&rig()), hash(&other));
}

#[test]
fn every_frame_is_announced_once_at_every_speed() {
    let mut drum = Experiment::new(&rig(), &options(1)).unwrap();
    let mut announced = Vec::new();
    drum.run(|drum, p| {
        announced.extend(p.new_frame.then(|| drum.time()));
        Flow::Go
    })
    .unwrap();
    let sampled = drum.sampled();
    assert_eq!(sampled.len(), 2);
    for speed in &sampled {
        assert_eq!(speed.frames.len(), rig().run.frames as usize);
        for frame in &speed.frames {
            // The exposures lie in the middle of three parts of 20 ms: the last is 6.7 ms after.
            let closes = frame.exposures[2].time_s;
            assert_eq!(announced.iter().filter(|t| **t == closes).count(), 1, "{closes}");
        }
    }
}

#[test]
fn frames_are_those_of_the_steady_windows_and_evenly_spaced() {
    let (_, sampled) = finished(&rig(), &options(1));
    for speed in &sampled {
        let opens = |k: usize| speed.frames[k].time_s - 0.01;
        let late = opens(0) - speed.steady_from_s;
        // The first one opens within one interval of the start of the steady state, unless more than are
        // wanted fit into its windows.
        assert!(late > -1e-9, "{late}");
        let step = 0.05;
        for k in 1..speed.frames.len() {
            assert!((opens(k) - opens(k - 1) - step).abs() < 1e-3, "{k}");
        }
    }
}
