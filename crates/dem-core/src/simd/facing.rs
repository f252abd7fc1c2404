//! How spheres meet analytic walls and move on them, operation by operation as `touch_wall` of `forces.rs` and the shapes'
//! `nearest`.

use glam::DVec3;

use super::hertz_mindlin::{Motion, Pressing};
use super::lanes::{Mask, Numbers, V3};
use crate::geometry::{PlacedShape, PlacedWall, RigidVelocity, Side};

/// `geometry::Nearest` of several spheres.
#[derive(Clone, Copy)]
pub(super) struct Near<V> {
    pub(super) normal: V3<V>,
    pub(super) distance: V,
    pub(super) wall_radius: V,
}

#[inline(always)]
fn splat<V: Numbers>(v: DVec3) -> V3<V> {
    V3 { x: V::splat(v.x), y: V::splat(v.y), z: V::splat(v.z) }
}

/// `RigidVelocity::at`.
#[inline(always)]
fn velocity_at<V: Numbers>(v: &RigidVelocity, x: V3<V>) -> V3<V> {
    splat::<V>(v.spin).cross_plus(x - splat::<V>(v.point), splat::<V>(v.velocity))
}

/// Nearest points of a wall to spheres at `x`, of which only `valid` ones matter; nothing where each has to ask the shape
/// by itself.
#[inline(always)]
pub(super) fn nearest<V: Numbers>(wall: &PlacedWall, x: V3<V>, valid: V::Mask) -> Option<Near<V>> {
    let zero = V::splat(0.0);
    let flat = V::splat(f64::INFINITY);
    match &wall.shape {
        PlacedShape::Plane(p) => {
            let distance = (x - splat(p.point)).dot(splat(p.normal));
            return Some(Near { normal: -splat::<V>(p.normal), distance, wall_radius: flat });
        }
        PlacedShape::Disc(c) => {
            let normal = splat::<V>(c.normal);
            let d = x - splat(c.centre);
            let height = d.dot(normal);
            let radial = d.less_times(normal, height);
            let rho_squared = radial.dot(radial);
            let beyond = V::splat(c.radius * c.radius).less(rho_squared)
                | rho_squared.less(V::splat(c.hole_radius * c.hole_radius));
            if (beyond & valid).is_empty() {
                let behind = height.less(zero);
                let normal = normal.select(behind, -normal);
                return Some(Near { normal, distance: height.abs(), wall_radius: flat });
            }
        }
        PlacedShape::Cylinder(c) if c.length.is_none() && c.side == Side::Inside => {
            let axis = splat::<V>(c.axis);
            let d = x - splat(c.point);
            let radial = d.less_times(axis, d.dot(axis));
            let rho = radial.dot(radial).sqrt();
            if (valid & !zero.less(rho)).is_empty() {
                return Some(Near {
                    normal: radial * (V::splat(1.0) / rho),
                    distance: V::splat(c.radius) - rho,
                    wall_radius: V::splat(-2.0 * c.radius),
                });
            }
        }
        _ => {}
    }
    None
}

/// Normal, distance and radius of the wall nearest to a sphere by the shape's own function, if it knows of one.
#[cold]
pub(super) fn nearest_alone(wall: &PlacedWall, x: DVec3) -> Option<[f64; 5]> {
    let n = wall.nearest(x)?;
    let normal = n.normal_to_wall;
    Some([normal.x, normal.y, normal.z, n.distance, n.wall_radius])
}

/// How spheres meet a wall.
#[derive(Clone, Copy)]
pub(super) struct Faced<V: Numbers> {
    pub(super) touching: V::Mask,
    /// Those that overlap too deeply.
    pub(super) deep: V::Mask,
    pub(super) pressing: Pressing<V>,
}

/// Where a contact lies.
#[inline(always)]
fn point<V: Numbers>(near: &Near<V>, x: V3<V>) -> V3<V> {
    near.normal.times_plus(near.distance, x)
}

/// Spheres at `x`, of these radii and masses, whose velocities at the end of the step are given and of which only `valid`
/// ones matter: an overlap of more than `limit` of the radius is too deep.
#[inline(always)]
pub(super) fn face<V: Numbers>(
    wall: &PlacedWall,
    near: &Near<V>,
    (x, end): (V3<V>, V3<V>),
    [radius, mass]: [V; 2],
    valid: V::Mask,
    limit: f64,
) -> Faced<V> {
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    let overlap = radius - near.distance;
    let touching = zero.less(overlap) & overlap.less(V::splat(2.0) * radius) & valid;
    let deep = (V::splat(limit) * radius).less(overlap) & touching;
    let r_star = one / (one / radius + one / near.wall_radius);
    let rate = (end - velocity_at(&wall.velocity, point(near, x))).dot(near.normal);
    Faced { touching, deep, pressing: Pressing { overlap, rate, r_star, m_star: mass } }
}

/// How spheres at `x`, of these mean velocities and spins, move on a wall in a step, and by how much the contacts turn, rad.
#[inline(always)]
pub(super) fn brush<V: Numbers>(
    wall: &PlacedWall,
    near: &Near<V>,
    (x, radius): (V3<V>, V),
    [v, w]: [V3<V>; 2],
    pressing: &Pressing<V>,
    dt: f64,
) -> (Motion<V>, V) {
    let (n, lever_i) = (near.normal, near.distance);
    let spin = splat::<V>(wall.mean_velocity.spin);
    let approach = v - velocity_at(&wall.mean_velocity, point(near, x));
    let back = V::splat(0.5 * dt) * approach.dot(n);
    let relative = (w * (lever_i + back)).cross_plus(n, approach);
    let motion = Motion {
        normal: n,
        slip: relative.less_times(n, relative.dot(n)),
        rolling: (w - spin).less_times(n, (w - spin).dot(n)),
        spin_i: w,
        spin_j: spin,
        lever_i,
        lever_j: V::splat(0.0),
        overlap: pressing.overlap,
        r_star: pressing.r_star,
        radius_i: radius,
        radius_j: near.wall_radius,
    };
    (motion, V::splat(0.5) * (w + spin).dot(n) * V::splat(dt))
}
