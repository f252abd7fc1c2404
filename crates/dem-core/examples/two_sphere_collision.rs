//! Two glass spheres collide off centre: rebound, spin and where the energy went.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use dem_core::prelude::*;

fn main() -> Result<(), Error> {
    // Chung and Ooi's glass, with a restitution of 0.9 and friction of 0.35.
    let glass = Material { youngs_modulus: 48e9, poisson_ratio: 0.2, density: 2800.0 };
    let normal: HertzTailCut = HertzSpec { e_star: 25e9, restitution: 0.9 }.try_into()?;
    let tangential = Mindlin {
        g_star: glass.shear_modulus() / (2.0 * (2.0 - glass.poisson_ratio)),
        friction: Friction::coulomb(0.35)?,
        damping: 0.0,
    };
    let law = ContactModel { normal, tangential, rolling: FreeRolling, cohesion: Cohesionless };

    let mut builder = WorldBuilder::new(1e-8);
    let material = builder.material(glass);
    builder.pair_law(material, material, law);
    builder.domain(DVec3::splat(-0.1), DVec3::splat(0.1));
    let left = Sphere::at(DVec3::new(-0.0101, 0.0, 0.0), 0.01, material);
    let right = Sphere::at(DVec3::new(0.0101, 0.004, 0.0), 0.01, material);
    let a = builder.sphere(left.with_velocity(DVec3::X * 10.0));
    let b = builder.sphere(right.with_velocity(DVec3::X * -10.0));

    let mut world = builder.build()?;
    world.open_ledger()?;
    world.run(20_000)?;
    for id in [a, b] {
        println!(
            "sphere {id}: velocity {:.3} m/s, spin {:.1} rad/s",
            world.velocity(id),
            world.spin(id)
        );
    }
    let e = world.energy();
    println!("kinetic {:.4} J", e.kinetic_translation + e.kinetic_rotation);
    println!(
        "lost to normal damping {:.4} J, to friction {:.4} J",
        e.dissipated.normal, e.dissipated.tangential
    );
    println!("error of integration {:.1e} J", e.remainder);
    Ok(())
}
