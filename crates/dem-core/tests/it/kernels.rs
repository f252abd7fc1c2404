//! Vector kernels give the bits of the portable one.

use dem_core::contact::rolling::AbsoluteSpin;
use dem_core::contact::tangential::MindlinTotalSpring;
use dem_core::prelude::*;

use crate::scenes::{Model, cohesive_drum, drum, drum_of, model};

fn hashes(ratio: f64, kernels: Kernels, periodic: bool) -> Vec<u64> {
    let mut b = drum(400, ratio, 1);
    b.kernels(kernels);
    if periodic {
        b.domain(DVec3::new(-0.04, -0.04, 0.0), DVec3::new(0.04, 0.04, 0.03)).periodic(Axis::Z);
    }
    let mut world = b.build().unwrap();
    let steps = 0..40;
    steps
        .map(|_| {
            world.run(100).unwrap();
            world.state_hash()
        })
        .collect()
}

#[test]
fn simd_and_portable_kernels_agree_bit_by_bit() {
    for (ratio, periodic) in [(1.0, false), (2.0, false), (1.3, true)] {
        let portable = hashes(ratio, Kernels::Portable, periodic);
        assert_eq!(portable, hashes(ratio, Kernels::Avx2, periodic), "AVX2, {ratio}");
        assert_eq!(portable, hashes(ratio, Kernels::Fastest, periodic), "fastest, {ratio}");
    }
}

/// Three spheres in a bent row, or two.
fn clump(spheres: &[[f64; 3]], material: MaterialId) -> Clump {
    let sphere = |c: &[f64; 3]| ClumpSphere { centre: DVec3::from(*c) * 1e-3, radius: 1.5e-3 };
    ClumpSpec {
        spheres: spheres.iter().map(sphere).collect(),
        mass: 1e-4,
        centre_of_mass: DVec3::new(0.2e-3, 0.1e-3, 0.0),
        inertia: DMat3::from_diagonal(DVec3::new(1.0, 3.0, 3.5)) * 1e-10,
        material,
    }
    .try_into()
    .unwrap()
}

#[test]
fn clumps_move_alike_by_all_kernels_threads_and_lengths_of_runs() {
    let hashes = |kernels: Kernels, threads: usize, at_once: u64| {
        let mut b = drum(0, 1.0, threads);
        let bead = MaterialId(0);
        b.kernels(kernels);
        let shapes = [
            clump(&[[-2.0, 0.0, 0.0], [0.0, 0.5, 0.2], [2.0, 0.0, 0.0]], bead),
            clump(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], bead),
        ]
        .map(|c| b.clump_shape(c));
        for k in 0..75 {
            let (i, j, layer) = (k % 5, k / 5 % 5, k / 25);
            let cell = DVec3::new(f64::from(i) - 2.0, f64::from(j) - 2.0, f64::from(layer));
            let position = cell * 9e-3 + DVec3::Z * 6e-3;
            if position.truncate().length() > 0.025 {
                continue;
            }
            if k % 11 == 0 {
                b.sphere(Sphere::at(position, 2e-3, bead));
                continue;
            }
            let turn = DVec3::new(f64::from(k).sin(), f64::from(k).cos(), 0.4);
            b.clump(PlacedClump {
                shape: shapes[usize::from(k % 13 == 0)],
                position,
                orientation: DQuat::from_scaled_axis(turn * 2.0),
                velocity: turn * 0.2,
                spin: turn * 50.0,
            });
        }
        let mut world = b.build().unwrap();
        let each = |_| {
            for _ in 0..200 / at_once {
                world.run(at_once).unwrap();
            }
            world.state_hash()
        };
        (0..25).map(each).collect::<Vec<u64>>()
    };
    let portable = hashes(Kernels::Portable, 1, 200);
    assert_eq!(portable, hashes(Kernels::Avx2, 1, 200), "AVX2");
    assert_eq!(portable, hashes(Kernels::Fastest, 1, 200), "fastest");
    assert_eq!(portable, hashes(Kernels::Fastest, 2, 200), "two threads");
    assert_eq!(portable, hashes(Kernels::Fastest, 1, 1), "step by step");
}

#[test]
fn cohesive_kernels_agree_bit_by_bit() {
    let hashes = |kernels: Kernels, energy_density: f64, ratio: f64| {
        let mut b = cohesive_drum(400, ratio, 1, energy_density);
        let mut world = b.kernels(kernels).build().unwrap();
        let each = |_| {
            world.run(100).unwrap();
            world.state_hash()
        };
        (0..30).map(each).collect::<Vec<u64>>()
    };
    for ratio in [1.0, 1.6] {
        let portable = hashes(Kernels::Portable, 4e5, ratio);
        assert_eq!(portable, hashes(Kernels::Avx2, 4e5, ratio), "AVX2, {ratio}");
        assert_eq!(portable, hashes(Kernels::Fastest, 4e5, ratio), "fastest, {ratio}");
        // Where nothing pulls, the bits are those of the law without cohesion; else they are not.
        let free = hashes(Kernels::Fastest, 0.0, ratio);
        assert_ne!(portable.last(), free.last());
        let mut world = drum(400, ratio, 1).build().unwrap();
        world.run(3000).unwrap();
        assert_eq!(free.last(), Some(&world.state_hash()), "{ratio}");
    }
}

/// Hashes of a drum under a law made of the usual one.
fn hashes_of<M: ContactLaw + 'static>(
    kernels: Kernels,
    ratio: f64,
    law: impl Fn(Model) -> M,
) -> Vec<u64> {
    let mut world = drum_of(400, ratio, 1, law).kernels(kernels).build().unwrap();
    let each = |_| {
        world.run(100).unwrap();
        world.state_hash()
    };
    (0..30).map(each).collect()
}

/// Under `law` all kernels give one result, which is not that of the usual law.
fn kernels_agree<M: ContactLaw + 'static>(name: &str, law: impl Fn(Model) -> M + Copy) {
    for ratio in [1.0, 1.6] {
        let portable = hashes_of(Kernels::Portable, ratio, law);
        assert_eq!(portable, hashes_of(Kernels::Avx2, ratio, law), "{name}: AVX2, {ratio}");
        assert_eq!(portable, hashes_of(Kernels::Fastest, ratio, law), "{name}: fastest, {ratio}");
        assert_ne!(portable, hashes_of(Kernels::Fastest, ratio, |m| m), "{name}: {ratio}");
    }
}

#[test]
fn static_and_kinetic_friction_agree_bit_by_bit() {
    kernels_agree("kinetic", |mut m| {
        m.tangential.friction.mu_kinetic = 0.6 * m.tangential.friction.mu_static;
        m
    });
}

#[test]
fn compatibility_laws_agree_bit_by_bit() {
    kernels_agree("total spring", |Model { normal, tangential, rolling, cohesion }| ContactModel {
        normal,
        tangential: MindlinTotalSpring(tangential),
        rolling,
        cohesion,
    });
    kernels_agree("absolute spin", |Model { normal, tangential, rolling, cohesion }| {
        ContactModel { normal, tangential, rolling: AbsoluteSpin { arm: rolling.arm }, cohesion }
    });
    kernels_agree("EDEM", |Model { normal, tangential, rolling, cohesion }| ContactModel {
        normal,
        tangential: MindlinTotalSpring(tangential),
        rolling: AbsoluteSpin { arm: rolling.arm },
        cohesion,
    });
}

/// What is asked of kernels that round otherwise than the portable one: after a step accelerations are off by less than
/// `bound` of the largest.
fn keeps_the_physics_and_its_bits(kernels: Kernels, bound: f64) {
    let run = |kernels, threads, ledger: bool| {
        let mut world = drum(400, 1.0, threads).kernels(kernels).build().unwrap();
        if ledger {
            world.open_ledger().unwrap();
        }
        world.run(3000).unwrap();
        world
    };
    let fast = run(kernels, 1, false);
    let booked = run(kernels, 2, true);
    assert_eq!(fast.state_hash(), booked.state_hash());
    assert!(booked.energy().remainder.abs() < 0.05 * booked.energy().dissipated.total());
    // One step from the same state: a few units in the last place of the largest acceleration.
    let state = run(Kernels::Fastest, 1, false).snapshot();
    let step = |kernels| {
        let mut world = drum(400, 1.0, 1).kernels(kernels).build().unwrap();
        world.restore(&state).unwrap();
        world.run(1).unwrap();
        world
    };
    let (exact, fast) = (step(Kernels::Fastest), step(kernels));
    let largest = exact.particles().map(|p| exact.acceleration(p).length()).fold(0.0, f64::max);
    for p in exact.particles() {
        let off = (exact.acceleration(p) - fast.acceleration(p)).length();
        assert!(off < bound * largest, "{kernels:?}: {:e}", off / largest);
    }
}

#[test]
fn fast_roots_keep_the_physics_and_the_bits_over_threads_and_ledgers() {
    // The overlap is a difference of lengths a thousand times larger: 1e-16 becomes 1e-13.
    keeps_the_physics_and_its_bits(Kernels::FastRoots, 1e-11);
}

#[test]
fn fused_kernels_keep_the_physics_and_the_bits_over_threads_and_ledgers() {
    keeps_the_physics_and_its_bits(Kernels::Fused, 1e-11);
}

/// Chung and Ooi's benchmark impacts, restitution, energy and threads, with the kernels given.
fn key_claims(kernels: Kernels) {
    // Glass on glass, 10 mm, 10 m/s each: peak force 10 697 N (Chung & Ooi 2011, test 1).
    let e_star = 25e9;
    let material = Material { youngs_modulus: 48e9, poisson_ratio: 0.2, density: 2800.0 };
    let law = |restitution: f64| -> Model {
        let normal: HertzTailCut = HertzSpec { e_star, restitution }.try_into().unwrap();
        Model { normal, ..model(0.35, restitution, 0.0) }
    };
    for restitution in [1.0, 0.9, 0.6] {
        let mut b = WorldBuilder::new(2e-8);
        let glass = b.material(material);
        b.pair_law(glass, glass, law(restitution)).kernels(kernels);
        b.domain(DVec3::splat(-0.1), DVec3::splat(0.1));
        // Eight pairs that differ in direction, so that every lane has work.
        let mut pairs = Vec::new();
        for k in 0..8 {
            let angle = 0.35 * k as f64;
            let n = DVec3::new(angle.cos(), angle.sin(), 0.0);
            let at = DVec3::new(0.0, 0.0, 0.022 * k as f64 - 0.08);
            let mut sphere = |s: f64| {
                let p = Sphere::at(at + n * (s * 0.010_000_1), 0.01, glass);
                b.sphere(p.with_velocity(n * (-10.0 * s)))
            };
            pairs.push((sphere(-1.0), sphere(1.0), n));
        }
        let mut world = b.build().unwrap();
        let mut peak = 0.0f64;
        for _ in 0..400 {
            world.run(10).unwrap();
            for &(a, _, n) in &pairs {
                peak = peak.max(-world.acceleration(a).dot(n) * world.mass(a));
            }
        }
        for &(a, b, n) in &pairs {
            let rebound = (world.velocity(b) - world.velocity(a)).dot(n) / 20.0;
            // 2000 steps a contact: second order leaves 1e-5.
            assert!((rebound / restitution - 1.0).abs() < 2e-4, "{kernels:?}: {rebound}");
        }
        if restitution == 1.0 {
            assert!((peak / 10_697.0 - 1.0).abs() < 2e-3, "{kernels:?}: {peak} N");
        }
    }
    let run = |threads: usize, ledger: bool| {
        let mut world = drum(600, 1.5, threads).kernels(kernels).build().unwrap();
        if ledger {
            world.open_ledger().unwrap();
        }
        world.run(4000).unwrap();
        world
    };
    let one = run(1, true);
    let e = one.energy();
    assert!(e.remainder.abs() < 0.05 * e.dissipated.total(), "{kernels:?}: {e:?}");
    for (threads, ledger) in [(1, false), (2, false), (4, true)] {
        assert_eq!(one.state_hash(), run(threads, ledger).state_hash(), "{kernels:?}, {threads}");
    }
}

#[test]
fn impacts_energy_and_bits_over_threads_hold_in_the_exact_mode() {
    key_claims(Kernels::Fastest);
}

#[test]
fn impacts_energy_and_bits_over_threads_hold_in_the_fast_mode() {
    key_claims(Kernels::FastRoots);
}

#[test]
fn impacts_energy_and_bits_over_threads_hold_in_the_fused_mode() {
    key_claims(Kernels::Fused);
}
