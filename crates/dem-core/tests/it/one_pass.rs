//! Contacts and bodies in one pass give the bits of two stages.
//!
//! A run without a ledger goes in one pass, but for its last step, which keeps every wrench:
//! observers may ask for it. So runs of one step each go in two stages. Several threads go in strips where the bed is
//! long enough that few beads lie where two strips meet.

use dem_core::prelude::*;

use crate::scenes::{Model, Random, bead_material, drum, model};

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
        for kernels in [Kernels::Fastest, Kernels::Fused, Kernels::Portable] {
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
        // Put back by what they had moved, and slowed down to what they had: rounding is left, of metres and of 20 m/s.
        assert!((together.position(p) - apart.position(p)).length() < 1e-16, "{p}");
        assert!((together.velocity(p) - apart.velocity(p)).length() < 1e-14, "{p}");
    }
}

/// A tube of 44 by 252 mm that turns, or a length of one without ends: some thirty beads in each of sixty layers.
fn tube(ratio: f64, threads: usize, periodic: bool, kernels: Kernels) -> WorldBuilder<Model> {
    let (length, radius) = (0.252, 0.022);
    let mut b = WorldBuilder::new(2e-5);
    let bead = b.material(bead_material());
    b.pair_law(bead, bead, model(0.5, 0.8, 0.01)).gravity(DVec3::NEG_Y * 9.81);
    b.threads(threads).kernels(kernels).allow_large_time_step();
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 9.0);
    b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, radius, bead).with_motion(turning));
    if periodic {
        b.domain(DVec3::new(-0.03, -0.03, 0.0), DVec3::new(0.03, 0.03, length)).periodic(Axis::Z);
    } else {
        b.domain(DVec3::new(-0.03, -0.03, -0.01), DVec3::new(0.03, 0.03, length + 0.01));
        b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.03, bead));
        b.wall(Wall::disc(DVec3::Z * length, DVec3::NEG_Z, 0.03, bead));
    }
    let mut random = Random(3);
    for k in 0..60 {
        for i in 0..9 {
            for j in 0..7 {
                let grid = DVec3::new(i as f64 - 4.0, j as f64 - 4.5, k as f64 + 0.5);
                let p = grid * 4.2e-3 + random.vector() * 5e-5;
                if p.truncate().length() < 0.0195 {
                    let radius = 2e-3 * ratio.powf(-random.next());
                    let v = random.vector() * 0.1;
                    b.sphere(Sphere::at(p, radius, bead).with_velocity(v));
                }
            }
        }
    }
    b
}

#[test]
fn strips_agree_with_one_pass_and_two_stages_bit_by_bit() {
    for (ratio, periodic) in [(1.0, false), (1.5, true), (3.0, false)] {
        for kernels in [Kernels::Fastest, Kernels::Portable] {
            let build = |threads| tube(ratio, threads, periodic, kernels).build().unwrap();
            let (mut one, mut apart) = (build(1), build(1));
            let mut threads = [build(2), build(3), build(4)];
            for piece in 0..12 {
                one.run(100).unwrap();
                (0..100).for_each(|_| apart.run(1).unwrap());
                let hash = one.state_hash();
                assert_eq!(hash, apart.state_hash(), "{ratio}, {periodic}, {kernels:?}, {piece}");
                for world in &mut threads {
                    // Cut elsewhere: lists are made in the middle of runs.
                    world.run(37).unwrap();
                    world.run(63).unwrap();
                    assert_eq!(hash, world.state_hash(), "{ratio}, {periodic}, {kernels:?}");
                    assert_eq!(one.wall_load(0).unwrap(), world.wall_load(0).unwrap());
                }
            }
            assert!(one.contact_count() > 5, "{}", one.contact_count());
            assert!(one.list_builds() > 10, "{}", one.list_builds());
            assert_eq!(one.snapshot(), threads[0].snapshot());
            assert_eq!(one.snapshot(), threads[2].snapshot());
        }
    }
}

/// Small enough for Miri, which checks who reads and writes what:
/// `MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-deterministic-floats" cargo +nightly miri test -p dem-core --test it a_row`
/// (without the second flag it scatters the last digits of sines, and so the bits).
#[test]
fn a_row_of_beads_in_strips_keeps_its_bits() {
    let hash = |threads| {
        let mut b = WorldBuilder::new(2e-5);
        let bead = b.material(bead_material());
        b.pair_law(bead, bead, model(0.5, 0.8, 0.01)).threads(threads).allow_large_time_step();
        b.domain(DVec3::splat(-0.1), DVec3::splat(2.5));
        b.wall(Wall::plane(DVec3::Y * -1.9e-3, DVec3::Y, bead));
        let mut random = Random(5);
        for k in 0..450 {
            let p = DVec3::new(0.0, 0.0, 3.95e-3 * k as f64);
            b.sphere(Sphere::at(p, 2e-3, bead).with_velocity(random.vector() * 0.1));
        }
        let mut w = b.build().unwrap();
        w.run(3).unwrap();
        assert!(w.contact_count() > 400, "{}", w.contact_count());
        w.state_hash()
    };
    let one = hash(1);
    assert_eq!([hash(2), hash(3)], [one; 2]);
}

#[test]
fn a_restart_between_strips_changes_no_bit() {
    let build = || tube(1.2, 2, true, Kernels::Fastest).build().unwrap();
    let (mut straight, mut stopped, mut resumed) = (build(), build(), build());
    straight.run(800).unwrap();
    stopped.run(431).unwrap();
    resumed.restore(&stopped.snapshot()).unwrap();
    resumed.run(800 - 431).unwrap();
    assert_eq!(straight.state_hash(), resumed.state_hash());
    assert_eq!(straight.snapshot(), resumed.snapshot());
}

#[test]
fn a_fault_in_a_strip_leaves_the_world_where_it_was_found() {
    // Blows at the front, where strips meet and at the end.
    for place in [0.02, 0.125, 0.24] {
        let run = |threads: usize, steps_at_once: u64| {
            let mut b = tube(1.0, threads, false, Kernels::Fastest);
            let mut w = b.largest_overlap(0.1).build().unwrap();
            w.run(1000).unwrap();
            let off = |p: &ParticleId| (w.position(*p) - DVec3::Z * place).length();
            let hit = w.particles().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            w.set_velocity(hit, DVec3::new(0.0, -20.0, 3.0), DVec3::ZERO).unwrap();
            for _ in 0..4000 / steps_at_once {
                if let Err(error) = w.run(steps_at_once) {
                    return (error.to_string(), w);
                }
            }
            panic!("nothing was hit");
        };
        let (single, apart) = run(1, 1);
        for threads in 1..=4 {
            let (whole, together) = run(threads, 4000);
            assert_eq!(whole, single, "{place}, {threads} threads");
            assert_eq!(together.step_number(), apart.step_number());
            for p in apart.particles() {
                // Put back by what they had moved, and slowed down to what they had: rounding is left.
                let off = (together.position(p) - apart.position(p)).length();
                assert!(off < 1e-15, "{p}, {threads} threads: {off:e}");
                let off = (together.velocity(p) - apart.velocity(p)).length();
                assert!(off < 1e-14, "{p}, {threads} threads: {off:e}");
            }
        }
    }
}
