//! Time of a tablet-step on a settled, turning drum like configuration AZ4.
//!
//! 5997 coated tablets of ten spheres (nine of 1.87 mm on a ring, one of 2.3 mm in the middle) in a drum of 250 x 150 mm at
//! 17 rpm, time step 50 us; Hertz, Mindlin with history, damping, constant rolling torque. Arguments: threads, steps, skin in
//! mm, settling steps, tablets (the drum is as long as they need); the word `fused` or `roots` anywhere for those kernels.
#![expect(clippy::print_stdout, reason = "a bench reports by printing")]

use std::time::Instant;

use dem_core::prelude::*;

type Model = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;

/// Steps in a piece of the run.
const PIECE: u64 = 20;
/// Mass (kg) and moments about the centre (kg m2) of a disc of 8.6 mm with a density of 1350 kg/m3: near those of the clump.
const MASS: f64 = 2.6e-4;
const MOMENTS: DVec3 = DVec3::new(1.6e-9, 1.6e-9, 2.5e-9);

fn law(material: &Material, friction: f64) -> Model {
    let (e, nu) = (material.youngs_modulus, material.poisson_ratio);
    let g = material.shear_modulus();
    let spec = HertzSpec { e_star: e / (2.0 * (1.0 - nu * nu)), restitution: 0.9 };
    let normal = HertzTailCut::try_from(spec).expect("valid");
    ContactModel {
        normal,
        tangential: Mindlin {
            g_star: g / (2.0 * (2.0 - nu)),
            friction: dem_core::contact::friction::Friction::coulomb(friction).expect("valid"),
            damping: normal.damping,
        },
        rolling: ConstantTorqueSpec { coefficient: RollingCoefficient::Ratio(0.01) }
            .try_into()
            .expect("valid"),
        cohesion: Cohesionless,
    }
}

fn tablet(material: MaterialId) -> Clump {
    let ring = |n: usize| {
        let at = n as f64 * std::f64::consts::TAU / 9.0;
        ClumpSphere {
            centre: DVec3::new(2.418e-3 * at.cos(), 2.418e-3 * at.sin(), 0.0),
            radius: 1.87e-3,
        }
    };
    let mut spheres: Vec<ClumpSphere> = (0..9).map(ring).collect();
    spheres.push(ClumpSphere { centre: DVec3::ZERO, radius: 2.3e-3 });
    let inertia = DMat3::from_diagonal(MOMENTS);
    ClumpSpec { spheres, mass: MASS, centre_of_mass: DVec3::ZERO, inertia, material }
        .try_into()
        .expect("a tablet")
}

fn main() {
    let arguments: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let argument = |k: usize, default: f64| arguments.get(k).copied().unwrap_or(default);
    let (threads, steps) = (argument(0, 1.0) as usize, argument(1, 1000.0) as u64);
    let (skin, settle) = (argument(2, 0.8) * 1e-3, argument(3, 3000.0) as u64);
    let material = Material::from_shear_modulus(2.92e6, 0.29, 1350.0);
    let count = argument(4, 5997.0) as usize;
    let (radius, length) = (0.125, 0.150 * count as f64 / 5997.0);
    let mut b = WorldBuilder::<Model>::new(5e-5);
    let (body, wall) = (b.material(material), b.material(material));
    b.pair_law(body, body, law(&material, 0.5)).pair_law(body, wall, law(&material, 0.6));
    b.gravity(DVec3::NEG_Y * 9.81).threads(threads).skin(skin);
    let asked = |word: &str| std::env::args().any(|a| a == word);
    b.kernels(match (asked("fused"), asked("roots")) {
        (_, true) => Kernels::FastRoots,
        (true, false) => Kernels::Fused,
        _ => Kernels::Fastest,
    });
    b.domain(DVec3::new(-0.14, -0.14, -0.01), DVec3::new(0.14, 0.14, length + 0.01));
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 17.0 * std::f64::consts::TAU / 60.0);
    let drum = b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, radius, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.14, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::Z * length, DVec3::NEG_Z, 0.14, wall).with_motion(turning));
    let shape = b.clump_shape(tablet(body));
    let mut random = 42u64;
    let mut uniform = || {
        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (random >> 40) as f64 / (1u64 << 24) as f64 - 0.5
    };
    let (reach, mut left) = (4.3e-3, count);
    let pitch = 2.0 * reach;
    let (across, along) = ((2.0 * radius / pitch) as usize, (length / pitch) as usize);
    'fill: for j in 0..across {
        for i in 0..across {
            let place = |n: usize| (n as f64 + 0.5) * pitch - radius;
            let (x, y) = (place(i), place(j));
            if x.hypot(y) > radius - reach {
                continue;
            }
            for k in 0..along {
                if left == 0 {
                    break 'fill;
                }
                left -= 1;
                let turn = DQuat::from_xyzw(uniform(), uniform(), uniform(), uniform());
                b.clump(PlacedClump {
                    shape,
                    position: DVec3::new(x, y, (k as f64 + 0.5) * length / along as f64),
                    orientation: turn.normalize(),
                    velocity: DVec3::ZERO,
                    spin: DVec3::ZERO,
                });
            }
        }
    }
    let mut world = b.build().expect("a valid drum");
    world.run(settle).expect("settling");
    let (builds, start) = (world.list_builds(), Instant::now());
    let mut pieces = Vec::new();
    for _ in 0..steps.div_ceil(PIECE) {
        let begun = Instant::now();
        world.run(PIECE).expect("turning");
        pieces.push(begun.elapsed().as_secs_f64() * 1e9 / (PIECE * world.len() as u64) as f64);
    }
    let (steps, time) = (steps.div_ceil(PIECE) * PIECE, start.elapsed().as_secs_f64());
    pieces.sort_by(f64::total_cmp);
    let n = world.len() as f64;
    println!(
        "{} tablets, {threads} threads: {:.0} ns a tablet-step; {:.2} list pairs, {:.2} contacts a tablet, list every {:.1} steps; torque {:.4} N m",
        world.len(),
        time * 1e9 / (steps as f64 * n),
        world.list_pairs() as f64 / n,
        world.contact_count() as f64 / n,
        steps as f64 / (world.list_builds() - builds).max(1) as f64,
        world.wall_load(drum).expect("the drum").torque.z,
    );
    println!(
        "wall time of the fastest tenth, half of the pieces of {PIECE} steps: {:.0}, {:.0} ns a tablet-step",
        pieces[pieces.len() / 10],
        pieces[pieces.len() / 2]
    );
}
