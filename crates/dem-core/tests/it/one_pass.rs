//! Contacts and bodies in one pass give the bits of two stages.
//!
//! One thread without a ledger goes in one pass, but for the last step of a run, which keeps every wrench:
//! observers may ask for it. So runs of one step each go in two stages.

use dem_core::prelude::*;

use crate::scenes::{Model, drum};

/// A drum of spheres between walls or, more of them, in a slice between periodic ends.
fn scene(ratio: f64, threads: usize, periodic: bool, kernels: Kernels) -> World<Model> {
    let mut b = drum(400, ratio, threads);
    b.kernels(kernels);
    if periodic {
        b.domain(DVec3::new(-0.04, -0.04, 0.0), DVec3::new(0.04, 0.04, 0.03)).periodic(Axis::Z);
    }
    b.build().unwrap()
}

#[test]
fn one_pass_and_two_stages_agree_bit_by_bit() {
    // Of one size and of several, on one grid and on two.
    for (ratio, periodic) in [(1.0, false), (1.5, true), (3.0, false)] {
        for kernels in [Kernels::Fastest, Kernels::Portable] {
            let mut together = scene(ratio, 1, periodic, kernels);
            let mut apart = scene(ratio, 1, periodic, kernels);
            let mut threads = scene(ratio, 3, periodic, kernels);
            for piece in 0..60 {
                together.run(50).unwrap();
                threads.run(50).unwrap();
                for _ in 0..50 {
                    apart.run(1).unwrap();
                }
                let hash = together.state_hash();
                assert_eq!(hash, apart.state_hash(), "{ratio}, {periodic}, {kernels:?}, {piece}");
                assert_eq!(hash, threads.state_hash(), "{ratio}, {periodic}, threads, {piece}");
            }
            assert!(together.contact_count() > 5, "{}", together.contact_count());
            assert!(together.list_builds() > 20, "{}", together.list_builds());
        }
    }
}

#[test]
fn a_restart_in_the_middle_of_passes_changes_no_bit() {
    let mut straight = scene(1.5, 1, true, Kernels::Fastest);
    let mut stopped = scene(1.5, 1, true, Kernels::Fastest);
    straight.run(1700).unwrap();
    stopped.run(977).unwrap();
    let state = stopped.snapshot();
    let mut resumed = scene(1.5, 1, true, Kernels::Fastest);
    resumed.restore(&state).unwrap();
    resumed.run(1700 - 977).unwrap();
    assert_eq!(straight.state_hash(), resumed.state_hash());
    assert_eq!(straight.snapshot(), resumed.snapshot());
}

#[test]
fn a_fault_in_a_pass_leaves_the_world_where_it_was_found() {
    // A blow late in memory: most beads have moved on when it is found.
    let run = |steps_at_once: u64| {
        let mut b = drum(400, 1.0, 1);
        let mut w = b.largest_overlap(0.1).build().unwrap();
        w.run(3000).unwrap();
        let last = w.particles().max_by(|a, b| w.position(*a).z.total_cmp(&w.position(*b).z));
        w.set_velocity(last.unwrap(), DVec3::new(0.0, -20.0, -10.0), DVec3::ZERO).unwrap();
        for _ in 0..4000 / steps_at_once {
            if let Err(error) = w.run(steps_at_once) {
                return (error.to_string(), w);
            }
        }
        panic!("nothing was hit");
    };
    let ((whole, together), (single, apart)) = (run(4000), run(1));
    assert_eq!(whole, single);
    assert!(whole.contains("particle") && !whole.contains("wall"), "{whole}");
    assert_eq!(together.step_number(), apart.step_number());
    for p in apart.particles() {
        // Put back by what they had moved: rounding of the coordinate is left.
        assert!((together.position(p) - apart.position(p)).length() < 1e-16, "{p}");
        assert_eq!(together.velocity(p), apart.velocity(p), "{p}");
    }
}
