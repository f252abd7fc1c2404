//! Bad input is an error that says what, where and what was expected.

use drum_rig::dem_core::error::Error as Mechanics;
use drum_rig::{Error, Experiment, Flow, Options};

use crate::rigs::{small, with};

fn refused(rig: &drum_rig::rig_schema::Rig, options: &Options) -> Error {
    Experiment::new(rig, options).expect_err("a rig that should be refused")
}

#[test]
fn particles_that_do_not_fit_are_refused() {
    // More solid than the drum holds at all, and more than can be pushed apart.
    for count in [100_000_000, 3000, 1250] {
        let error = refused(&small(count), &Options::default());
        match error {
            Error::DoesNotFit { count: named, solid_m3, drum_m3, .. } => {
                assert_eq!(named, count as usize);
                assert!(solid_m3 > 0.5 * drum_m3);
            }
            other => panic!("{other}"),
        }
    }
}

#[test]
fn a_fill_that_rounds_to_nothing_is_refused() {
    let error = refused(&with(&small(1), &[("fill.scale", 0.3)]), &Options::default());
    assert_eq!(error, Error::NoParticles { wanted: 0.3 });
}

#[test]
fn a_time_step_above_the_rayleigh_time_is_refused() {
    let error = refused(&with(&small(10), &[("step.scale", 4.0)]), &Options::default());
    match error {
        Error::Mechanics(Mechanics::TimeStepTooLarge { time_step, limit, .. }) => {
            assert_eq!(time_step, 4.0 * 8e-5);
            assert!((limit - 2.14e-4).abs() < 1e-6);
        }
        other => panic!("{other}"),
    }
}

#[test]
fn walls_that_leave_no_room_are_refused() {
    let mut thin = small(10);
    thin.drum.radius_m = 0.019;
    let error = refused(&with(&thin, &[("wall_layer.thickness_m", 0.02)]), &Options::default());
    assert!(matches!(error, Error::NoRoom { what: "a wall layer", .. }), "{error}");
    let mut short = small(10);
    short.drum.length_m = 0.003;
    let error = refused(&short, &Options::default());
    assert!(matches!(error, Error::NoRoom { what: "a particle", .. }), "{error}");
}

#[test]
fn options_out_of_range_are_refused() {
    for options in [
        Options { threads: 0, ..Options::default() },
        Options { sub_frames: 0, ..Options::default() },
        Options { exposure_s: f64::NAN, ..Options::default() },
        Options { frame_interval_s: Some(0.0), ..Options::default() },
        Options { window_turns: 0.1, ..Options::default() },
        Options { least_window_s: Some(-1.0), ..Options::default() },
        Options { longest_turns: 0.1, ..Options::default() },
    ] {
        assert!(matches!(refused(&small(10), &options), Error::Option { .. }), "{options:?}");
    }
}

#[test]
fn an_unknown_material_is_named() {
    let mut rig = small(10);
    rig.drum.end_plates = "brass".into();
    assert_eq!(
        refused(&rig, &Options::default()).to_string(),
        "material of the end plates: `brass` is not in [materials]"
    );
}

#[test]
fn a_motion_that_never_becomes_stationary_is_given_up() {
    // A drum that swings by 10 mm in three seconds: every window sees another height.
    let swing = [("vibration.amplitude_m", 0.01), ("vibration.frequency_hz", 0.3)];
    let mut drum = Experiment::new(&with(&small(40), &swing), &Options::default()).unwrap();
    // 2.2 turns of 1.5 s and a few windows more.
    let options = Options { longest_turns: 1.5, ..Options::default() };
    let mut short = Experiment::new(&with(&small(40), &swing), &options).unwrap();
    match short.run(|_, _| Flow::Go) {
        Err(Error::NotSteady { speed_rpm, sigmas, .. }) => {
            assert_eq!(speed_rpm, 40.0);
            assert!(sigmas > 2.0);
        }
        other => panic!("{other:?}"),
    }
    assert!(short.sampled().is_empty());
    // Stopping instead loses nothing.
    drum.run(|_, p| if p.turns > 0.1 { Flow::Stop } else { Flow::Go }).unwrap();
    assert!(drum.sampled().is_empty());
}
