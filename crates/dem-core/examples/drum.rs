//! A thousand spheres in a turning drum: power drawn and centre of mass.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use dem_core::prelude::*;

fn main() -> Result<(), Error> {
    let glass = Material::from_shear_modulus(2.52e7, 0.29, 2500.0);
    let e_star = glass.youngs_modulus / (2.0 * (1.0 - 0.29 * 0.29));
    let law = |friction: f64| -> Result<_, Error> {
        let normal: HertzTailCut = HertzSpec { e_star, restitution: 0.9 }.try_into()?;
        let g_star = glass.shear_modulus() / (2.0 * (2.0 - 0.29));
        let friction = Friction::coulomb(friction)?;
        let tangential = Mindlin { g_star, friction, damping: normal.damping };
        let coefficient = RollingCoefficient::Ratio(0.01);
        let rolling: ConstantTorque = ConstantTorqueSpec { coefficient }.try_into()?;
        Ok(ContactModel { normal, tangential, rolling, cohesion: Cohesionless })
    };
    let mut builder = WorldBuilder::new(7e-5);
    let (bead, steel) = (builder.material(glass), builder.material(glass));
    builder.pair_law(bead, bead, law(0.5)?).pair_law(bead, steel, law(0.6)?);
    builder.gravity(DVec3::NEG_Y * 9.81).threads(2);
    builder.domain(DVec3::new(-0.13, -0.13, -0.01), DVec3::new(0.13, 0.13, 0.04));
    // Drum of 250 mm, 30 mm long, at 17 rpm; the end plates turn with it.
    let rate = 17.0 * std::f64::consts::TAU / 60.0;
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, rate);
    let walls = [
        Wall::drum(DVec3::ZERO, DVec3::Z, 0.125, steel),
        Wall::disc(DVec3::ZERO, DVec3::Z, 0.125, steel),
        Wall::disc(DVec3::Z * 0.03, DVec3::NEG_Z, 0.125, steel),
    ]
    .map(|wall| builder.wall(wall.with_motion(turning)));
    let grid = (0..38).flat_map(|j| (0..38).map(move |i| (i, j)));
    let cells = grid.map(|(i, j)| (f64::from(i) * 6.4e-3 - 0.1184, f64::from(j) * 6.4e-3 - 0.1184));
    let inside: Vec<_> = cells.filter(|(x, y)| x.hypot(*y) < 0.121).take(250).collect();
    for (n, (x, y)) in inside.into_iter().enumerate() {
        for k in 0..4 {
            let z = 3.75e-3 + 7.5e-3 * f64::from(k) + 1e-4 * f64::from((n % 7) as u8);
            builder.sphere(Sphere::at(DVec3::new(x, y, z), 3e-3, bead));
        }
    }
    let mut world = builder.build()?;
    for _ in 0..8 {
        world.run(5000)?;
        let mut torque = 0.0;
        for wall in walls {
            torque += world.wall_load(wall)?.torque.z;
        }
        let centre: DVec3 = world.particles().map(|p| world.position(p)).sum();
        let centre = 1e3 * centre / world.len() as f64;
        println!(
            "{:.2} s: torque {torque:.4} N m, centre ({:.1}, {:.1}) mm",
            world.time(),
            centre.x,
            centre.y
        );
    }
    Ok(())
}
