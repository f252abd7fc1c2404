//! The engine on a sphere that slips, rolls and comes to rest: MFIX DEM04, incline, rolling decay.

use dem_core::prelude::*;

use crate::{Check, Held};

type Rough = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;

const SLIP: Held = Held {
    tolerance: 5e-3,
    reason: "relative; the shear spring winds up over a few hundredths of the slip",
    source: "slip ends at 2 u0/(7 mu g), then u = R omega = 5/7 u0 (MFIX DEM04)",
};
const ROLL: Held = Held {
    tolerance: 5e-3,
    reason: "relative; the shear spring lets the start lag by its period",
    source: "rigid-body mechanics: a = 5/7 g sin(angle) for a solid sphere that rolls",
};
const DECAY: Held = Held {
    tolerance: 5e-3,
    reason: "relative; as above",
    source: "rigid-body mechanics: a = 5/7 mu_r g for a rolling torque mu_r R N",
};

const G: f64 = 9.8;

/// A world with one sphere of radius `r` on the plane z = 0, at rest under its weight.
fn on_plane(
    (r, density): (f64, f64),
    (mu, rolling): (f64, f64),
    gravity: DVec3,
    (velocity, spin): (f64, f64),
    dt: f64,
) -> (World<Rough>, ParticleId) {
    let glass = Material::from_shear_modulus(1e7, 0.3, density);
    let e_star = glass.youngs_modulus / (1.0 - 0.09);
    let normal: HertzTailCut =
        HertzSpec { e_star, restitution: 0.3 }.try_into().expect("a valid law");
    let coefficient = RollingCoefficient::Ratio(rolling);
    let law = ContactModel {
        normal,
        tangential: Mindlin {
            g_star: glass.shear_modulus() / (2.0 - 0.3),
            friction: Friction::coulomb(mu).expect("a valid coefficient"),
            damping: normal.damping,
        },
        rolling: ConstantTorqueSpec { coefficient }.try_into().expect("a valid law"),
        cohesion: Cohesionless,
    };
    let mass = density * 4.0 / 3.0 * std::f64::consts::PI * r * r * r;
    let overlap = dem_core::contact::normal::hertz::overlap_under(-mass * gravity.z, e_star, r);
    let mut b = WorldBuilder::new(dt);
    let m = b.material(glass);
    b.pair_law(m, m, law).gravity(gravity).domain(DVec3::splat(-2.0), DVec3::splat(2.0));
    b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m));
    let sphere = Sphere::at(DVec3::Z * (r - overlap), r, m).with_velocity(DVec3::X * velocity);
    let id = b.sphere(sphere.with_spin(DVec3::Y * spin));
    (b.build().expect("a valid case"), id)
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    let mut checks = Vec::new();
    for mu in [0.2, 0.5, 1.0] {
        let (r, u0, dt) = (0.5e-3, 0.1, 1e-6);
        let fall = DVec3::NEG_Z * G;
        let (mut world, id) = on_plane((r, 1e4), (mu, 0.0), fall, (u0, 0.0), dt);
        let expected = 2.0 * u0 / (7.0 * mu * G);
        let case = format!("engine, MFIX DEM04, slip on a rough plane, mu = {mu}");
        while world.velocity(id).x > 1.001 * r * world.spin(id).y {
            world.run(1).expect("no fault");
        }
        checks.push(SLIP.relative(&case, "end of slip, s", expected, world.time()));
        world.run(20_000).expect("no fault");
        let u = world.velocity(id).x;
        checks.push(SLIP.relative(&case, "velocity, m/s", 5.0 / 7.0 * u0, u));
        checks.push(SLIP.relative(&case, "R omega, m/s", 5.0 / 7.0 * u0, r * world.spin(id).y));
    }
    let angle = 15f64.to_radians();
    let along = DVec3::new(angle.sin(), 0.0, -angle.cos()) * G;
    let (mut world, id) = on_plane((3e-3, 2500.0), (0.5, 0.0), along, (0.0, 0.0), 1e-5);
    world.run(100_000).expect("no fault");
    let case = "engine, incline of 15 deg, mu = 0.5";
    let expected = 5.0 / 7.0 * G * angle.sin();
    checks.push(ROLL.relative(case, "velocity at 1 s, m/s", expected, world.velocity(id).x));
    let (mu_r, u0, r) = (0.01, 0.2, 3e-3);
    let fall = DVec3::NEG_Z * G;
    let (mut world, id) = on_plane((r, 2500.0), (0.5, mu_r), fall, (u0, u0 / r), 1e-5);
    world.run(100_000).expect("no fault");
    let lost = u0 - world.velocity(id).x;
    let case = "engine, rolling decay under a constant torque, mu_r = 0.01";
    checks.push(DECAY.relative(case, "velocity lost in 1 s, m/s", 5.0 / 7.0 * mu_r * G, lost));
    checks
}
