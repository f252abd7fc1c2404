//! Area and moments of a union of discs in a plane, exactly.
//!
//! The boundary of the union is made of those arcs of the circles that lie in no other disc. By
//! Green's theorem, for a function `f` that is homogeneous of degree `k`,
//!
//! ```text
//! integral of f over the union = 1/(k + 2) * sum over arcs of integral of f (x dy - y dx)
//! ```
//!
//! where every arc runs counter-clockwise about its own circle: holes come out right by themselves.
//! On the arc `x = c_x + s cos t`, `y = c_y + s sin t` all integrals are polynomials in `sin t` and
//! `cos t` at the two ends.

use std::f64::consts::TAU;

/// Discs nearer to each other than this share of the larger radius are treated as one inside the
/// other: below it their crossings cannot be told from rounding, and the area at stake is as small.
const COINCIDENCE: f64 = 1e-13;

/// A disc, cut from a sphere by a level plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Disc {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) radius: f64,
    /// Height of the sphere's centre.
    pub(crate) sphere_z: f64,
    /// Radius of the sphere: the weight that free arcs count with.
    pub(crate) sphere_radius: f64,
}

impl Disc {
    /// Difference of the squared radii of two discs at height `z`.
    ///
    /// From the spheres, because for spheres that nearly coincide the discs' own radii have no
    /// digits of it left.
    fn squares_above(&self, other: &Self, z: f64) -> f64 {
        (self.sphere_radius - other.sphere_radius) * (self.sphere_radius + other.sphere_radius)
            - (other.sphere_z - self.sphere_z) * (2.0 * z - self.sphere_z - other.sphere_z)
    }
}

/// Area and moments about the origin of the plane.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SliceMoments {
    pub(crate) area: f64,
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) xx: f64,
    pub(crate) xy: f64,
    pub(crate) yy: f64,
    /// Sum over the free arcs of angle times the sphere's radius.
    pub(crate) weighted_arc: f64,
}

/// Buffers that are used again from plane to plane.
#[derive(Debug, Default)]
pub(crate) struct SliceScratch {
    kept: Vec<Disc>,
    covered: Vec<Vec<(f64, f64)>>,
}

/// Moments of the union of `discs` at height `z`; their order is changed.
pub(crate) fn slice_moments(
    discs: &mut [Disc],
    z: f64,
    scratch: &mut SliceScratch,
) -> SliceMoments {
    keep_uncovered(discs, z, &mut scratch.kept);
    let kept = &scratch.kept;
    let covered = &mut scratch.covered;
    if covered.len() < kept.len() {
        covered.resize_with(kept.len(), Vec::new);
    }
    covered.iter_mut().for_each(Vec::clear);
    for i in 0..kept.len() {
        for j in i + 1..kept.len() {
            cover_pair(kept, z, i, j, covered);
        }
    }
    let mut sum = SliceMoments::default();
    for (disc, intervals) in kept.iter().zip(covered) {
        intervals.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let mut from = 0.0;
        for &(start, end) in intervals.iter() {
            if start > from {
                add_arc(disc, from, start, &mut sum);
            }
            from = f64::max(from, end);
        }
        if from < TAU {
            add_arc(disc, from, TAU, &mut sum);
        }
    }
    sum
}

/// Largest first, without those that lie in one that was kept before: no cycle of near-equal discs
/// can remove all of them.
fn keep_uncovered(discs: &mut [Disc], z: f64, kept: &mut Vec<Disc>) {
    discs.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    kept.clear();
    for disc in discs.iter().filter(|d| d.radius > 0.0) {
        let inside = kept.iter().any(|k| {
            let distance = f64::hypot(k.x - disc.x, k.y - disc.y);
            let room = k.squares_above(disc, z) / (k.radius + disc.radius);
            distance <= room + k.radius * COINCIDENCE
        });
        if !inside {
            kept.push(*disc);
        }
    }
}

/// Notes which angles of either circle lie in the other disc.
fn cover_pair(kept: &[Disc], z: f64, i: usize, j: usize, covered: &mut [Vec<(f64, f64)>]) {
    let (a, b) = (&kept[i], &kept[j]);
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let distance = f64::hypot(dx, dy);
    if distance >= a.radius + b.radius || distance == 0.0 {
        return;
    }
    // Both circles get their angles from the same two points, so that the boundary stays closed
    // however badly the crossing is conditioned.
    let along = 0.5 * (distance + a.squares_above(b, z) / distance);
    let across = ((a.radius - along) * (a.radius + along)).max(0.0).sqrt();
    let (ux, uy) = (dx / distance, dy / distance);
    let left = (along * ux - across * uy, along * uy + across * ux);
    let right = (along * ux + across * uy, along * uy - across * ux);
    let angle = |y: f64, x: f64| {
        let t = y.atan2(x);
        if t < 0.0 { t + TAU } else { t }
    };
    cover(&mut covered[i], angle(right.1, right.0), angle(left.1, left.0));
    cover(&mut covered[j], angle(left.1 - dy, left.0 - dx), angle(right.1 - dy, right.0 - dx));
}

fn cover(intervals: &mut Vec<(f64, f64)>, start: f64, end: f64) {
    if start <= end {
        intervals.push((start, end));
    } else {
        intervals.push((start, TAU));
        intervals.push((0.0, end));
    }
}

fn add_arc(disc: &Disc, from: f64, to: f64, sum: &mut SliceMoments) {
    let (p, q, s) = (disc.x, disc.y, disc.radius);
    let ((s0, c0), (s1, c1)) = (from.sin_cos(), to.sin_cos());
    let angle = to - from;
    // Integrals of the products of cosine (c) and sine (s).
    let c = s1 - s0;
    let n = c0 - c1;
    let cn = 0.5 * (s1 - s0) * (s1 + s0);
    let wave = 0.5 * (s1 * c1 - s0 * c0);
    let (cc, nn) = (0.5 * angle + wave, 0.5 * angle - wave);
    let (sss, ccc) = (s1.powi(3) - s0.powi(3), c0.powi(3) - c1.powi(3));
    let (c3, n3) = (c - sss / 3.0, n - ccc / 3.0);
    let (ccn, cnn) = (ccc / 3.0, sss / 3.0);

    // x dy - y dx = s (s + p cos t + q sin t) dt; `times` integrates it with a power product.
    let times = |one: f64, by_c: f64, by_n: f64| s * (s * one + p * by_c + q * by_n);
    let of_1 = times(angle, c, n);
    let of_c = times(c, cc, cn);
    let of_n = times(n, cn, nn);
    let of_cc = times(cc, c3, ccn);
    let of_cn = times(cn, ccn, cnn);
    let of_nn = times(nn, cnn, n3);
    sum.area += of_1 / 2.0;
    sum.x += (p * of_1 + s * of_c) / 3.0;
    sum.y += (q * of_1 + s * of_n) / 3.0;
    sum.xx += (p * p * of_1 + 2.0 * p * s * of_c + s * s * of_cc) / 4.0;
    sum.xy += (p * q * of_1 + s * (p * of_n + q * of_c) + s * s * of_cn) / 4.0;
    sum.yy += (q * q * of_1 + 2.0 * q * s * of_n + s * s * of_nn) / 4.0;
    sum.weighted_arc += angle * disc.sphere_radius;
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn moments(discs: &[(f64, f64, f64)]) -> SliceMoments {
        let mut discs: Vec<Disc> = discs
            .iter()
            .map(|&(x, y, radius)| Disc { x, y, radius, sphere_z: 0.0, sphere_radius: radius })
            .collect();
        slice_moments(&mut discs, 0.0, &mut SliceScratch::default())
    }

    #[test]
    fn one_disc_has_its_textbook_moments() {
        let m = moments(&[(2.0, -1.0, 0.5)]);
        let area = PI * 0.25;
        let own = area * 0.25 / 4.0;
        // Rounding of sums of numbers of order ten.
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} against {b}");
        close(m.area, area);
        close(m.x, 2.0 * area);
        close(m.y, -area);
        close(m.xx, 4.0 * area + own);
        close(m.xy, -2.0 * area);
        close(m.yy, area + own);
        close(m.weighted_arc, 0.5 * TAU);
    }

    #[test]
    fn two_discs_lack_their_lens() {
        let (d, r) = (1.2_f64, 1.0_f64);
        let lens = 2.0 * r * r * (d / (2.0 * r)).acos() - 0.5 * d * (4.0 * r * r - d * d).sqrt();
        let m = moments(&[(0.3, 0.4, r), (0.3, 0.4 + d, r)]);
        assert!((m.area - (2.0 * PI - lens)).abs() < 1e-14);
        assert!((m.y / m.area - (0.4 + d / 2.0)).abs() < 1e-14);
    }

    #[test]
    fn a_hole_between_discs_is_no_area() {
        // Eight discs whose neighbours overlap around a hole: inclusion-exclusion needs pairs only.
        let (n, ring, r) = (8, 3.0, 1.3);
        let discs: Vec<_> = (0..n)
            .map(|k| {
                let t = TAU * f64::from(k) / f64::from(n);
                (ring * t.cos(), ring * t.sin(), r)
            })
            .collect();
        let d = 2.0 * ring * (PI / f64::from(n)).sin();
        let lens = 2.0 * r * r * (d / (2.0 * r)).acos() - 0.5 * d * (4.0 * r * r - d * d).sqrt();
        let m = moments(&discs);
        assert!((m.area - f64::from(n) * (PI * r * r - lens)).abs() < 1e-12);
        assert!(m.x.abs() < 1e-12 && m.xy.abs() < 1e-12);
    }

    #[test]
    fn nearly_equal_discs_count_once() {
        for shift in [0.0, 1e-17, 1e-15, 1e-13, 3e-13, 1e-11, 1e-9] {
            let m = moments(&[(1.0, 1.0, 1.0), (1.0 + shift, 1.0 - shift, 1.0), (1.0, 1.0, 1.0)]);
            // The area grows by twice the radius times the shift.
            assert!((m.area - PI).abs() < 4.0 * shift + 1e-13, "{shift}: {}", m.area - PI);
        }
    }

    #[test]
    fn a_disc_inside_another_and_one_that_touches_from_inside_change_nothing() {
        let alone = moments(&[(0.0, 0.0, 1.0)]).area;
        assert_eq!(moments(&[(0.0, 0.0, 1.0), (0.2, 0.1, 0.5)]).area, alone);
        assert_eq!(moments(&[(0.0, 0.0, 1.0), (0.5, 0.0, 0.5)]).area, alone);
        let apart = moments(&[(0.0, 0.0, 1.0), (1.5, 0.0, 0.5)]).area;
        assert!((apart - 1.25 * PI).abs() < 1e-14);
    }
}
