//! Largest distance of a point of a solid from a union of spheres, between two bounds.
//!
//! The distance from the union, `f(q) = min_i |q - c_i| - r_i`, changes by no more than `q` moves.
//! So a cube of half diagonal `d` about `m` holds no value above `f(m) + d`, and cubes are halved
//! in the order of that bound until the best value found is near enough.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use crate::solids::SolidOfRevolution;
use crate::sphere::Sphere;

/// Cubes after which the bounds are returned as they are.
const MAX_CUBES: usize = 400_000;

struct Cube {
    bound: f64,
    number: usize,
    center: DVec3,
    half: f64,
}

impl Ord for Cube {
    fn cmp(&self, other: &Self) -> Ordering {
        // The elder first among equals, so that the order is one and the same in every run.
        self.bound.total_cmp(&other.bound).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Cube {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Cube {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cube {}

/// A distance that is reached and one that is not exceeded, `tolerance` apart if all goes well; the
/// solid lies wholly in the spheres if both are zero.
pub(super) fn uncovered_depth(
    spheres: &[Sphere],
    solid: &impl SolidOfRevolution,
    tolerance: f64,
) -> (f64, f64) {
    let distance =
        |q: DVec3| spheres.iter().map(|s| s.signed_distance(q)).fold(f64::INFINITY, f64::min);
    let mut best: f64 = 0.0;
    let mut number = 0;
    let mut heap = BinaryHeap::new();
    let half = solid.half_height().max(solid.radius_at(0.0));
    let mut look_at = |center: DVec3, half: f64, best: &mut f64, heap: &mut BinaryHeap<Cube>| {
        let reach = half * 3.0_f64.sqrt();
        let outside = solid.signed_distance(center);
        if outside > reach {
            return;
        }
        let here = distance(center);
        // A point of the solid is at most `outside` away.
        *best = best.max(here - outside.max(0.0));
        number += 1;
        if here + reach > *best {
            heap.push(Cube { bound: here + reach, number, center, half });
        }
    };
    look_at(DVec3::ZERO, half, &mut best, &mut heap);
    let mut seen = 1;
    while let Some(cube) = heap.pop() {
        if cube.bound <= best + tolerance || seen >= MAX_CUBES {
            return (best, cube.bound.max(best));
        }
        let quarter = 0.5 * cube.half;
        for k in 0..8_u32 {
            let sign = |bit: u32| if k & bit == 0 { -quarter } else { quarter };
            let center = cube.center + DVec3::new(sign(1), sign(2), sign(4));
            look_at(center, quarter, &mut best, &mut heap);
            seen += 1;
        }
    }
    (best, best)
}
