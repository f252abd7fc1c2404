//! Heights at which the section of a union of spheres changes its pattern of arcs.
//!
//! Between two such heights every arc's ends move smoothly, so the area of the section is analytic.
//! The pattern changes where a sphere begins or ends, where two circles touch (the extreme heights
//! of the circle in which two spheres meet), and where three circles pass through one point (the
//! points common to three spheres). A change that lies well inside another sphere is not seen.

use glam::DVec3;

use crate::sphere::Sphere;

/// A point is hidden if it lies deeper in a sphere than this share of the radius. One that is less
/// deep is not seen either, but what happens there still bends the arcs that are.
const HIDDEN: f64 = 0.05;

/// Largest ratio of the widths of neighbouring intervals, see [`graded`].
const GRADING: f64 = 16.0;

/// Heights nearer than this, in units of the largest radius, are one.
const MERGED: f64 = 1e-13;

/// Heights in ascending order, first and last being the extremes of the union.
pub(crate) fn breakpoints(spheres: &[Sphere]) -> Vec<f64> {
    let mut heights = Vec::new();
    let mut largest: f64 = 0.0;
    for s in spheres {
        largest = largest.max(s.radius);
        let tip = DVec3::new(0.0, 0.0, s.radius);
        push_if_seen(spheres, s.center + tip, &mut heights);
        push_if_seen(spheres, s.center - tip, &mut heights);
    }
    for i in 0..spheres.len() {
        // Partners of `i`, each pair once.
        let partners: Vec<Meeting> =
            spheres[i + 1..].iter().filter_map(|other| Meeting::of(&spheres[i], other)).collect();
        for (k, meeting) in partners.iter().enumerate() {
            push_extremes(spheres, meeting, &mut heights);
            for other in &partners[k + 1..] {
                push_common_points(spheres, meeting, other, &mut heights);
            }
        }
    }
    heights.sort_unstable_by(f64::total_cmp);
    heights.dedup_by(|next, kept| *next - *kept <= MERGED * largest);
    graded(&heights)
}

/// The heights and others between them, so that no interval is much wider than its neighbours.
///
/// A change of pattern just beyond the end of a wide interval bends the integrand within it over a
/// length no larger than the distance, which the points of a rule for the whole width would miss.
fn graded(heights: &[f64]) -> Vec<f64> {
    let mut all = heights.to_vec();
    let mut from_below = |at: &[f64], sign: f64| {
        for triple in at.windows(3) {
            let (beside, width) = (triple[1] - triple[0], triple[2] - triple[1]);
            let mut offset = beside * (GRADING - 1.0);
            while (offset * GRADING).abs() < width.abs() {
                all.push(sign * (triple[1] + offset));
                offset *= GRADING;
            }
        }
    };
    from_below(heights, 1.0);
    let mirrored: Vec<f64> = heights.iter().rev().map(|z| -z).collect();
    from_below(&mirrored, -1.0);
    all.sort_unstable_by(f64::total_cmp);
    all
}

/// The circle in which two spheres meet.
struct Meeting {
    center: DVec3,
    normal: DVec3,
    radius: f64,
}

impl Meeting {
    fn of(a: &Sphere, b: &Sphere) -> Option<Self> {
        let offset = b.center - a.center;
        let distance = offset.length();
        if distance == 0.0 || distance >= a.radius + b.radius {
            return None;
        }
        let along = 0.5 * (distance + (a.radius - b.radius) * ((a.radius + b.radius) / distance));
        let squared = (a.radius - along) * (a.radius + along);
        (squared > 0.0).then(|| {
            let normal = offset / distance;
            Self { center: a.center + along * normal, normal, radius: squared.sqrt() }
        })
    }
}

fn push_if_seen(spheres: &[Sphere], point: DVec3, heights: &mut Vec<f64>) {
    if !spheres.iter().any(|s| s.signed_distance(point) < -HIDDEN * s.radius) {
        heights.push(point.z);
    }
}

fn push_extremes(spheres: &[Sphere], meeting: &Meeting, heights: &mut Vec<f64>) {
    let n = meeting.normal;
    // The vertical less its part along the normal, without cancellation for level circles.
    let uphill = DVec3::new(-n.x * n.z, -n.y * n.z, n.x * n.x + n.y * n.y);
    match uphill.try_normalize() {
        Some(uphill) => {
            push_if_seen(spheres, meeting.center + meeting.radius * uphill, heights);
            push_if_seen(spheres, meeting.center - meeting.radius * uphill, heights);
        }
        // A level circle: it changes the pattern all at once, whatever part of it is seen.
        None => heights.push(meeting.center.z),
    }
}

/// The points of the first circle that lie in the plane of the second: both circles are on one
/// sphere, so these are on all three.
fn push_common_points(spheres: &[Sphere], a: &Meeting, b: &Meeting, heights: &mut Vec<f64>) {
    let Some(direction) = a.normal.cross(b.normal).try_normalize() else { return };
    // Within the plane of `a`, from its centre towards the plane of `b`.
    let towards = direction.cross(a.normal);
    let slope = towards.dot(b.normal);
    if slope.abs() < 1e-14 {
        return;
    }
    let along = (b.center - a.center).dot(b.normal) / slope;
    let squared = a.radius * a.radius - along * along;
    if squared >= 0.0 {
        let foot = a.center + along * towards;
        let reach = squared.sqrt() * direction;
        push_if_seen(spheres, foot + reach, heights);
        push_if_seen(spheres, foot - reach, heights);
    }
}
