//! How pairs of spheres meet and move on each other, operation by operation as `forces.rs` does it in exact kernels.

use super::carried::{Before, Remembered};
use super::lanes::{Numbers, V3};

/// Where spheres meet.
#[derive(Clone, Copy)]
pub(super) struct Meeting<V: Numbers> {
    pub(super) touching: V::Mask,
    /// Those that overlap too deeply.
    pub(super) deep: V::Mask,
    /// One over the distance of centres.
    pub(super) inverse: V,
    pub(super) overlap: V,
    pub(super) before: Before<V>,
}

/// Spheres of these radii, the second `apart` from the first, of which only `valid` lanes matter: an overlap of more
/// than `limit` of the smaller radius is too deep.
#[inline(always)]
pub(super) fn meet<V: Numbers>(
    apart: V3<V>,
    [ri, rj]: [V; 2],
    old: &Remembered<V>,
    valid: V::Mask,
    limit: f64,
) -> Meeting<V> {
    let (distance_squared, sum) = (apart.dot(apart), ri + rj);
    let touching = distance_squared.less(sum * sum) & valid;
    let (distance, inverse, before) = apart_by(apart, distance_squared, old);
    let overlap = sum - distance;
    let deep = too_deep([ri, rj], limit).less(overlap) & touching;
    Meeting { touching, deep, inverse, overlap, before }
}

/// What overlaps of spheres of these radii may not exceed.
#[inline(always)]
pub(super) fn too_deep<V: Numbers>([ri, rj]: [V; 2], limit: f64) -> V {
    V::splat(limit) * ri.min(rj)
}

/// Distance of centres and one over it, and what fused kernels know of springs beforehand.
#[inline(always)]
fn apart_by<V: Numbers>(apart: V3<V>, square: V, old: &Remembered<V>) -> (V, V, Before<V>) {
    if V::FAST {
        // Of centres at one place, too, so that they are found to overlap too deeply.
        let inverse = square.max(V::splat(f64::MIN_POSITIVE)).reciprocal_root();
        let before = Before::by_itself(old, old.spring.dot(apart * inverse));
        return (square * inverse, inverse, before);
    }
    let distance = square.sqrt();
    if V::FUSED {
        let along = old.spring.dot(apart);
        let (before, over) = Before::fused(
            old,
            square,
            #[inline(always)]
            |over| along * (distance * over),
        );
        return (distance, distance * over, before);
    }
    (distance, V::splat(1.0) / distance, Before::nothing())
}

/// The line of centres, which vectors are held against.
#[derive(Clone, Copy)]
pub(super) struct Line<V> {
    apart: V3<V>,
    inverse: V,
    pub(super) normal: V3<V>,
}

impl<V: Numbers> Line<V> {
    #[inline(always)]
    pub(super) fn of(apart: V3<V>, inverse: V) -> Self {
        Self { apart, inverse, normal: apart * inverse }
    }

    /// The part of a vector along the line; fused kernels do not wait for the normal, unless it is soon there.
    #[inline(always)]
    pub(super) fn along(&self, v: V3<V>) -> V {
        if V::FUSED && !V::FAST { v.dot(self.apart) * self.inverse } else { v.dot(self.normal) }
    }
}

/// How surfaces slide, roll and twist on each other.
#[derive(Clone, Copy)]
pub(super) struct Slide<V> {
    pub(super) slip: V3<V>,
    /// Part of the difference of spins across the normal.
    pub(super) rolling: V3<V>,
    /// By how much the contact turns in a step, rad.
    pub(super) twist: V,
}

/// How both spheres spin.
#[derive(Clone, Copy)]
pub(super) struct Spins<V> {
    pub(super) each: [V3<V>; 2],
    pub(super) sum: V3<V>,
    /// Of the first less that of the second.
    pub(super) difference: V3<V>,
}

impl<V: Numbers> Spins<V> {
    #[inline(always)]
    pub(super) fn of([i, j]: [V3<V>; 2]) -> Self {
        Self { each: [i, j], sum: i + j, difference: i - j }
    }
}

/// By the first sphere's velocity against the second's, both spins and levers, of spheres that are `ALIKE` or of any
/// two.
#[inline(always)]
pub(super) fn slide<V: Numbers, const ALIKE: bool>(
    line: &Line<V>,
    approach: V3<V>,
    spins: &Spins<V>,
    [lever_i, lever_j]: [V; 2],
    dt: f64,
) -> Slide<V> {
    let n = line.normal;
    let (approaching, spin_sum) = (line.along(approach), line.along(spins.sum));
    let quarter = V::splat(0.25 * dt);
    let turning = if V::FUSED && ALIKE {
        spins.sum * quarter.times_plus(approaching, lever_i)
    } else {
        let (back, [wi, wj]) = (quarter * approaching, spins.each);
        wi.times_plus(lever_i + back, wj * (lever_j + back))
    };
    let slip = if V::FUSED {
        turning.cross_plus(n, approach.less_times(n, approaching))
    } else {
        let relative = turning.cross_plus(n, approach);
        relative.less_times(n, relative.dot(n))
    };
    let spin = spins.difference;
    Slide {
        slip,
        rolling: spin.less_times(n, line.along(spin)),
        twist: if V::FUSED {
            spin_sum * V::splat(0.5 * dt)
        } else {
            V::splat(0.5) * spin_sum * V::splat(dt)
        },
    }
}
