//! 5000 spheres run out of a silo through a hole in its floor.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use dem_core::prelude::*;

fn main() -> Result<(), Error> {
    let material = Material::from_shear_modulus(2e7, 0.3, 2500.0);
    let e_star = material.youngs_modulus / (2.0 * (1.0 - 0.3 * 0.3));
    let normal: HertzTailCut = HertzSpec { e_star, restitution: 0.6 }.try_into()?;
    let g_star = material.shear_modulus() / (2.0 * (2.0 - 0.3));
    let tangential = Mindlin { g_star, friction: Friction::coulomb(0.4)?, damping: normal.damping };
    let rolling = ConstantTorqueSpec { coefficient: RollingCoefficient::Ratio(0.02) }.try_into()?;
    let law: ContactModel<_, _, ConstantTorque, _> =
        ContactModel { normal, tangential, rolling, cohesion: Cohesionless };

    let mut builder = WorldBuilder::new(4e-5);
    let m = builder.material(material);
    builder.pair_law(m, m, law).gravity(DVec3::NEG_Z * 9.81).threads(2);
    builder.domain(DVec3::new(-0.1, -0.1, -1.0), DVec3::new(0.1, 0.1, 0.5));
    // A silo of 120 mm with a hole of 50 mm in its floor, closed by a lid.
    builder.wall(Wall::drum(DVec3::ZERO, DVec3::Z, 0.06, m));
    let ring = Disc { centre: DVec3::ZERO, normal: DVec3::Z, radius: 0.06, hole_radius: 0.025 };
    builder.wall(Wall { shape: Shape::Disc(ring), material: m, motion: Motion::default() });
    let lid = builder.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.025, m));
    let grid = (0..18).flat_map(|i| (0..18).map(move |j| (i, j)));
    let places =
        grid.map(|(i, j)| DVec3::new(f64::from(i) - 8.5, f64::from(j) - 8.5, 0.0) * 6.2e-3);
    let layer: Vec<_> = places.filter(|p| p.length() < 0.0565).collect();
    for n in 0..5000 {
        let (k, at) = (n / layer.len(), layer[n % layer.len()]);
        let shift = DVec3::new((n % 7) as f64, (n % 5) as f64, 0.0) * 1e-5;
        let height = DVec3::Z * (3.1e-3 + 6.2e-3 * k as f64);
        builder.sphere(Sphere::at(at + shift + height, 3e-3, m));
    }
    let mut world = builder.build()?;
    world.run(10_000)?;
    println!("closed: the lid carries {:.2} N", -world.wall_load(lid)?.force.z);
    // Pull the lid away and let it run.
    world.set_wall_motion(lid, Motion::translating(DVec3::NEG_Z * 3.0))?;
    for _ in 0..5 {
        world.run(1250)?;
        let out = world.particles().filter(|&id| world.position(id).z < -3e-3).count();
        println!("{:.2} s: {out} spheres are out", world.time());
    }
    Ok(())
}
