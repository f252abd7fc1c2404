//! Vector kernels give the bits of the portable one.

use dem_core::prelude::*;

use crate::scenes::drum;

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

#[test]
fn fast_roots_keep_the_physics_and_the_bits_over_threads_and_ledgers() {
    let run = |kernels, threads, ledger: bool| {
        let mut world = drum(400, 1.0, threads).kernels(kernels).build().unwrap();
        if ledger {
            world.open_ledger().unwrap();
        }
        world.run(3000).unwrap();
        world
    };
    let fast = run(Kernels::FastRoots, 1, false);
    let booked = run(Kernels::FastRoots, 2, true);
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
    let (exact, fast) = (step(Kernels::Fastest), step(Kernels::FastRoots));
    let largest = exact.particles().map(|p| exact.acceleration(p).length()).fold(0.0, f64::max);
    for p in exact.particles() {
        let off = (exact.acceleration(p) - fast.acceleration(p)).length();
        // The overlap is a difference of lengths a thousand times larger: 1e-16 becomes 1e-13.
        assert!(off < 1e-11 * largest, "{:e}", off / largest);
    }
}
