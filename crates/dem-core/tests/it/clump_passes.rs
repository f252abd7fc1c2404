//! Clumps in one pass, by any number of threads, move as in single steps.

use dem_core::prelude::*;

use crate::scenes::{Model, Random, bead_material, model};

/// A tube of 44 by 252 mm that turns, or a length of one without ends, with some six hundred dumb-bells and bent rods and, among
/// them, single beads if there are `beads`.
fn tube(threads: usize, periodic: bool, beads: bool, kernels: Kernels) -> WorldBuilder<Model> {
    let (length, radius) = (0.252, 0.022);
    let mut b = WorldBuilder::new(2e-5);
    let m = b.material(bead_material());
    b.pair_law(m, m, model(0.5, 0.8, 0.01)).gravity(DVec3::NEG_Y * 50.0);
    b.threads(threads).kernels(kernels).skin(4e-4).allow_large_time_step();
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 9.0);
    b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, radius, m).with_motion(turning));
    if periodic {
        b.domain(DVec3::new(-0.03, -0.03, 0.0), DVec3::new(0.03, 0.03, length)).periodic(Axis::Z);
    } else {
        b.domain(DVec3::new(-0.03, -0.03, -0.01), DVec3::new(0.03, 0.03, length + 0.01));
        b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.03, m));
        b.wall(Wall::disc(DVec3::Z * length, DVec3::NEG_Z, 0.03, m));
    }
    let row = |places: &[f64], bend: f64| {
        let sphere = |&x: &f64| ClumpSphere {
            centre: DVec3::new(x, bend * x * x, 0.0) * 1e-3,
            radius: 1.4e-3,
        };
        let spheres = places.iter().map(sphere).collect();
        let inertia = DMat3::from_diagonal(DVec3::new(1.0, 2.0, 2.4)) * 1e-10;
        let centre_of_mass = DVec3::Y * 1e-4;
        Clump::try_from(ClumpSpec { spheres, mass: 8e-5, centre_of_mass, inertia, material: m })
    };
    let shapes = [row(&[-0.8, 0.8], 0.0), row(&[-1.0, 0.0, 1.0], 0.3)];
    let shapes = shapes.map(|clump| b.clump_shape(clump.unwrap()));
    let mut random = Random(3);
    for k in 0..48 {
        for (i, j) in (0..5).flat_map(|i| (0..4).map(move |j| (i, j))) {
            let grid = DVec3::new(i as f64 - 2.0, j as f64 - 2.4, k as f64 + 0.5);
            let position = grid * 5.2e-3 + random.vector() * 5e-5;
            if position.truncate().length() > 0.018 {
                continue;
            }
            let velocity = random.vector() * 0.1;
            if beads && (i + k) % 7 == 0 {
                b.sphere(Sphere::at(position, 2e-3, m).with_velocity(velocity));
                continue;
            }
            b.clump(PlacedClump {
                shape: shapes[(i + j + k) % 2],
                position,
                orientation: DQuat::from_scaled_axis(random.vector() * 2.0),
                velocity,
                spin: random.vector() * 40.0,
            });
        }
    }
    b
}

#[test]
fn strips_of_clumps_agree_with_one_pass_and_two_stages_bit_by_bit() {
    for (periodic, beads, kernels) in [
        (false, true, Kernels::Fastest),
        (true, true, Kernels::Fastest),
        (false, true, Kernels::Portable),
        (false, true, Kernels::Fused),
        (true, false, Kernels::Fastest),
        (false, false, Kernels::Portable),
        (false, false, Kernels::Fused),
    ] {
        let build = |threads| tube(threads, periodic, beads, kernels).build().unwrap();
        let (mut one, mut apart) = (build(1), build(1));
        let mut threads = [build(2), build(3), build(4)];
        // They fall together.
        let worlds = [&mut one, &mut apart].into_iter().chain(&mut threads);
        worlds.for_each(|w| w.run(1200).unwrap());
        for piece in 0..12 {
            one.run(100).unwrap();
            (0..100).for_each(|_| apart.run(1).unwrap());
            let hash = one.state_hash();
            assert_eq!(hash, apart.state_hash(), "{periodic}, {beads}, {kernels:?}, {piece}");
            for world in &mut threads {
                // Cut elsewhere: lists are made in the middle of runs.
                world.run(37).unwrap();
                world.run(63).unwrap();
                assert_eq!(hash, world.state_hash(), "{periodic}, {beads}, {kernels:?}, {piece}");
                assert_eq!(one.wall_load(0).unwrap(), world.wall_load(0).unwrap());
            }
        }
        assert!(one.len() > 600 && one.contact_count() > 100, "{}", one.contact_count());
        assert!(one.list_builds() > 10, "{}", one.list_builds());
        assert!(one.snapshot() == threads[0].snapshot() && one.snapshot() == threads[2].snapshot());
    }
}

#[test]
fn a_restart_between_strips_of_clumps_changes_no_bit() {
    for beads in [true, false] {
        let build = || tube(2, true, beads, Kernels::Fastest).build().unwrap();
        let (mut straight, mut stopped, mut resumed) = (build(), build(), build());
        straight.run(800).unwrap();
        stopped.run(431).unwrap();
        resumed.restore(&stopped.snapshot()).unwrap();
        resumed.run(800 - 431).unwrap();
        assert!(straight.snapshot() == resumed.snapshot(), "{beads}");
    }
}

#[test]
fn a_fault_in_a_strip_of_clumps_leaves_them_where_it_was_found() {
    // Blows at the front, where strips meet and at the end; clumps alone do not keep their velocities.
    for (place, beads) in [(0.02, true), (0.125, true), (0.24, true), (0.02, false), (0.125, false)]
    {
        let run = |threads: usize, steps_at_once: u64| {
            let mut b = tube(threads, false, beads, Kernels::Fastest);
            let mut w = b.largest_overlap(0.1).build().unwrap();
            w.run(1000).unwrap();
            let off = |p: &ParticleId| (w.position(*p) - DVec3::Z * place).length();
            let hit = w.particles().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            w.set_velocity(hit, DVec3::new(0.0, -20.0, 3.0), DVec3::X * 300.0).unwrap();
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
                // Put back by what they had moved and turned: rounding is left.
                let off = (together.position(p) - apart.position(p)).length();
                assert!(off < 1e-15, "{p}, {threads} threads: {off:e} m");
                let turned = together.orientation(p) * apart.orientation(p).conjugate();
                let off = turned.xyz().length();
                assert!(off < 1e-15, "{p}, {threads} threads: turned by {off:e}");
                let off = (together.acceleration(p) - apart.acceleration(p)).length();
                assert!(off < 1e-9, "{p}, {threads} threads: {off:e} m/s2");
                let off = (together.velocity(p) - apart.velocity(p)).length();
                assert!(off < 1e-14, "{p}, {threads} threads: {off:e} m/s");
                // Of spins of some hundred a second.
                let off = (together.spin(p) - apart.spin(p)).length();
                assert!(off < 1e-11, "{p}, {threads} threads: {off:e} rad/s");
            }
        }
    }
}
