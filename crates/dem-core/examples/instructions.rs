//! A fixed piece of work whose instructions can be counted: `cargo xtask instructions` does.
//!
//! Arguments: the kernels (`portable` or `avx2`) and the number of beads. Beads fall in a turning
//! drum for some steps; then [`measured`] runs, inside which a tool may count. The work is the
//! same on every machine, so its count of instructions changes only with program and compiler.
#![expect(clippy::print_stdout, reason = "an example prints")]

use dem_core::prelude::*;

type Model = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;

/// Steps before those that are counted.
const SETTLE: u64 = 3000;
/// Steps that are counted.
const STEPS: u64 = 200;

fn law(m: &Material, friction: f64) -> Result<Model, Box<dyn std::error::Error>> {
    let nu = m.poisson_ratio;
    let e_star = m.youngs_modulus / (2.0 * (1.0 - nu * nu));
    let normal = HertzTailCut::try_from(HertzSpec { e_star, restitution: 0.8 })?;
    Ok(ContactModel {
        normal,
        tangential: Mindlin {
            g_star: m.shear_modulus() / (2.0 * (2.0 - nu)),
            friction: Friction::coulomb(friction)?,
            damping: normal.damping,
        },
        rolling: ConstantTorqueSpec { coefficient: RollingCoefficient::Ratio(0.01) }.try_into()?,
        cohesion: Cohesionless,
    })
}

/// The steps that are counted.
#[inline(never)]
fn measured(world: &mut World<Model>) -> Result<(), dem_core::error::Error> {
    world.run(STEPS)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let kernels = match arguments.next().as_deref() {
        Some("portable") => Kernels::Portable,
        Some("avx2") | None => Kernels::Avx2,
        Some(other) => return Err(format!("kernels are portable or avx2, not {other}").into()),
    };
    let count: usize = arguments.next().map_or(Ok(500), |a| a.parse())?;
    let (radius, drum, pitch) = (2e-3, 0.03, 4.05e-3);
    let length = pitch * (count as f64 / 70.0).ceil();
    let mut b = WorldBuilder::new(4e-5);
    let material = Material::from_shear_modulus(2.52e7, 0.29, 2500.0);
    let (bead, wall) = (b.material(material), b.material(material));
    b.pair_law(bead, bead, law(&material, 0.5)?).pair_law(bead, wall, law(&material, 0.6)?);
    b.gravity(DVec3::NEG_Y * 9.81).skin(8e-4).kernels(kernels);
    b.domain(DVec3::new(-0.04, -0.04, -0.01), DVec3::new(0.04, 0.04, length + 0.01));
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 3.0);
    b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, drum, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.04, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::Z * length, DVec3::NEG_Z, 0.04, wall).with_motion(turning));
    let layers = (length / pitch) as usize;
    let mut left = count;
    'fill: for j in 0..14 {
        for i in 0..14 {
            let (x, y) = ((i as f64 - 6.5) * pitch, (j as f64 - 6.5) * pitch);
            if x.hypot(y) > drum - 1.05 * radius {
                continue;
            }
            for k in 0..layers {
                if left == 0 {
                    break 'fill;
                }
                // No two rows alike, so that the lattice falls apart.
                let shift = 2e-5 * ((7 * i + 3 * j + 5 * k) % 11) as f64 - 1e-4;
                let z = (k as f64 + 0.5) * length / layers as f64;
                b.sphere(Sphere::at(DVec3::new(x + shift, y - 0.3 * shift, z), radius, bead));
                left -= 1;
            }
        }
    }
    let mut world = b.build()?;
    world.run(SETTLE)?;
    measured(&mut world)?;
    println!(
        "{} beads, {STEPS} steps, {} contacts, {} list pairs, {} lists",
        world.len(),
        world.contact_count(),
        world.list_pairs(),
        world.list_builds()
    );
    Ok(())
}
