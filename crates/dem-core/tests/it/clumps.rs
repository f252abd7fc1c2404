//! Rigid clumps: free tumbling, contacts, and equivalence with single spheres.

use dem_core::prelude::*;

use crate::scenes::{Model, bead_material, model};

fn builder(dt: f64) -> (WorldBuilder<Model>, MaterialId) {
    let mut b = WorldBuilder::new(dt);
    let m = b.material(bead_material());
    b.pair_law(m, m, model(0.5, 0.6, 0.01)).domain(DVec3::splat(-1.0), DVec3::splat(1.0));
    (b, m)
}

/// Three overlapping spheres of unlike size: an asymmetric body.
fn bent(material: MaterialId) -> Clump {
    let sphere = |x, y, z, radius| ClumpSphere { centre: DVec3::new(x, y, z) * 1e-3, radius };
    let inertia = DMat3::from_cols(
        DVec3::new(4.0, 0.3, -0.2) * 1e-10,
        DVec3::new(0.3, 9.0, 0.4) * 1e-10,
        DVec3::new(-0.2, 0.4, 11.0) * 1e-10,
    );
    ClumpSpec {
        spheres: vec![
            sphere(-2.0, 0.0, 0.1, 2e-3),
            sphere(0.5, 0.3, 0.0, 2.2e-3),
            sphere(2.5, 1.0, -0.2, 1.8e-3),
        ],
        mass: 2e-4,
        centre_of_mass: DVec3::new(0.4e-3, 0.4e-3, 0.0),
        inertia,
        material,
    }
    .try_into()
    .unwrap()
}

fn placed(shape: usize, position: DVec3) -> PlacedClump {
    PlacedClump {
        shape,
        position,
        orientation: DQuat::from_xyzw(0.2, -0.1, 0.4, 0.9),
        velocity: DVec3::ZERO,
        spin: DVec3::ZERO,
    }
}

#[test]
fn a_clump_that_tumbles_freely_keeps_energy_and_angular_momentum() {
    let (mut b, m) = builder(1e-4);
    b.allow_large_time_step();
    let shape = b.clump_shape(bent(m));
    let spin = DVec3::new(0.3, 40.0, 1.0);
    let id = b.clump(PlacedClump { spin, ..placed(shape, DVec3::ZERO) });
    let mut w = b.build().unwrap();
    let clump = bent(m);
    let momentum = |w: &World<Model>| {
        let axes = w.orientation(id) * clump.principal_axes();
        axes * ((axes.conjugate() * w.spin(id)) * clump.moments())
    };
    let (e0, l0) = (w.energy().kinetic_rotation, momentum(&w));
    let mut flips = 0;
    let mut last = 0.0;
    for _ in 0..200 {
        w.run(100).unwrap();
        let axes = w.orientation(id) * clump.principal_axes();
        // The middle axis turns over again and again (Dzhanibekov).
        let middle = (axes.conjugate() * w.spin(id)).y;
        flips += usize::from(middle * last < 0.0);
        last = middle;
    }
    assert!(flips > 10, "{flips}");
    // 20 000 steps of rounding at 2e-16 each.
    assert!((w.energy().kinetic_rotation / e0 - 1.0).abs() < 1e-11);
    assert!((momentum(&w) - l0).length() < 1e-11 * l0.length());
}

#[test]
fn dzhanibekov_flips_come_at_the_period_of_the_elliptic_integral() {
    // Spin about the middle axis, slightly off. With moments I1 < I2 < I3 and L2 = 2 E I2 nearly,
    // the body vector has period 4 K(k) / p; Landau & Lifshitz, Mechanics, section 37.
    let (i1, i2, i3) = (1.0f64, 2.0, 3.0);
    let w0 = DVec3::new(0.05, 1.0, 0.0);
    let l = w0 * DVec3::new(i1, i2, i3);
    let (e, m2) = (0.5 * l.dot(w0), l.length_squared());
    // Two cases by the sign of M^2 - 2 E I2; here it is negative: exchange 1 and 3.
    assert!(m2 < 2.0 * e * i2);
    let p = ((i2 - i1) * (2.0 * e * i3 - m2) / (i1 * i2 * i3)).sqrt();
    let k2 = (i2 - i3) * (2.0 * e * i1 - m2) / ((i2 - i1) * (2.0 * e * i3 - m2));
    let period = 4.0 * complete_elliptic(k2) / p;
    let mut q = DQuat::IDENTITY;
    let dt = 1e-3;
    let mut crossings = Vec::new();
    let mut last = 1.0;
    for step in 1..200_000u32 {
        q = dem_core::rigid::FreeRotation::turn(DVec3::new(i1, i2, i3), q, l, dt).orientation;
        let body = q.conjugate() * l;
        if last < 0.0 && body.y >= 0.0 {
            // Linear interpolation of the crossing.
            crossings.push((f64::from(step) - body.y / (body.y - last)) * dt);
        }
        last = body.y;
    }
    let n = crossings.len() - 1;
    let measured = (crossings[n] - crossings[0]) / n as f64;
    assert!(n >= 5);
    // Second order: (omega dt)^2 / 12 is 1e-7; the period depends on it through a logarithm.
    assert!((measured / period - 1.0).abs() < 1e-5, "{measured} {period}");
}

/// Complete elliptic integral of the first kind by the arithmetic-geometric mean.
fn complete_elliptic(k2: f64) -> f64 {
    let (mut a, mut g) = (1.0, (1.0 - k2).sqrt());
    for _ in 0..40 {
        (a, g) = (0.5 * (a + g), f64::sqrt(a * g));
    }
    std::f64::consts::FRAC_PI_2 / a
}

#[test]
fn a_clump_of_one_sphere_moves_like_the_sphere() {
    let run = |as_clump: bool| {
        let (mut b, m) = builder(1e-5);
        b.gravity(DVec3::NEG_Z * 9.81);
        b.wall(Wall::plane(DVec3::ZERO, DVec3::new(0.2, 0.0, 1.0), m));
        let radius = 3e-3;
        let mass = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius;
        let at = DVec3::new(0.0, 0.0, 0.01);
        let id = if as_clump {
            let spec = ClumpSpec {
                spheres: vec![ClumpSphere { centre: DVec3::ZERO, radius }],
                mass,
                centre_of_mass: DVec3::ZERO,
                inertia: DMat3::from_diagonal(DVec3::splat(0.4 * mass * radius * radius)),
                material: m,
            };
            let shape = b.clump_shape(spec.try_into().unwrap());
            b.clump(placed(shape, at))
        } else {
            b.sphere(Sphere::at(at, radius, m))
        };
        let mut w = b.build().unwrap();
        w.run(20_000).unwrap();
        (w.position(id), w.velocity(id), w.spin(id))
    };
    let (sphere, clump) = (run(false), run(true));
    assert!(sphere.2.length() > 10.0);
    // The same equations in another order of operations.
    assert!((sphere.0 - clump.0).length() < 1e-9, "{sphere:?} {clump:?}");
    assert!((sphere.1 - clump.1).length() < 1e-7);
    assert!((sphere.2 - clump.2).length() < 1e-4);
}

#[test]
fn colliding_clumps_conserve_momentum_and_settle_without_gaining_energy() {
    let (mut b, m) = builder(5e-6);
    let shape = b.clump_shape(bent(m));
    let a = b.clump(PlacedClump { velocity: DVec3::X, ..placed(shape, DVec3::X * -8e-3) });
    let c = b.clump(PlacedClump {
        velocity: DVec3::NEG_X,
        ..placed(shape, DVec3::new(8e-3, 1e-3, 0.0))
    });
    b.sphere(Sphere::at(DVec3::Y * 0.011, 2e-3, m).with_velocity(DVec3::NEG_Y));
    let mut w = b.build().unwrap();
    let moments = bent(m).moments();
    let axes0 = bent(m).principal_axes();
    let sums = |w: &World<Model>| {
        let mut p = DVec3::ZERO;
        let mut l = DVec3::ZERO;
        for id in w.particles() {
            let (mass, v) = (w.mass(id), w.velocity(id));
            p += v * mass;
            l += w.position(id).cross(v) * mass;
            l += if id == a || id == c {
                let axes = w.orientation(id) * axes0;
                axes * ((axes.conjugate() * w.spin(id)) * moments)
            } else {
                w.spin(id) * (0.4 * mass * w.radius(id).powi(2))
            };
        }
        (p, l)
    };
    w.open_ledger().unwrap();
    let ((p0, l0), e0) = (sums(&w), w.energy().mechanical());
    w.run(4000).unwrap();
    let ((p1, l1), e) = (sums(&w), w.energy());
    assert!(e.dissipated.total() > 0.1 * e0, "they met");
    assert!((p1 - p0).length() < 1e-16, "{:e}", (p1 - p0).length());
    // Kick-turn-kick keeps angular momentum but for the couple of a contact that moves within a
    // step: rounding here, since forces act at the end of each step.
    assert!((l1 - l0).length() < 1e-12 * 2e-4 * 0.01, "{:e}", (l1 - l0).length());
    assert!(e.remainder.abs() < 2e-3 * e0, "{:e}", e.remainder / e0);
}
