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
