//! Time of a particle-step on a settled, turning drum like configuration AZ1.
//!
//! 7807 beads of 6 mm in a drum of 250 x 150 mm at 17 rpm, time step 70 us; Hertz, Mindlin with
//! history, damping, constant rolling torque. Arguments: threads, steps, skin in mm, beads,
//! settling steps; the word `fused` or `roots` anywhere for those kernels.
#![expect(clippy::print_stdout, reason = "a bench reports by printing")]

use std::time::Instant;

use dem_core::prelude::*;

type Model = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;

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

/// Processor time of the calling thread, s, where the system tells it (0 elsewhere): on a machine
/// that others use, it is what the work costs.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|t| t.parse::<f64>().ok()).map_or(0.0, |ns| ns * 1e-9)
}

/// Steps in a piece of the run: about one list.
const PIECE: u64 = 20;

fn main() {
    let arguments: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let argument = |k: usize, default: f64| arguments.get(k).copied().unwrap_or(default);
    let (threads, steps) = (argument(0, 1.0) as usize, argument(1, 4000.0) as u64);
    let skin = argument(2, 1.25) * 1e-3;
    let count = argument(3, 7807.0) as usize;
    let settle = argument(4, 14000.0) as u64;
    let material = Material::from_shear_modulus(2.52e7, 0.29, 2500.0);
    let (radius, length) = (0.125, 0.150 * count as f64 / 7807.0);
    let mut b = WorldBuilder::<Model>::new(7e-5);
    let (bead, wall) = (b.material(material), b.material(material));
    b.pair_law(bead, bead, law(&material, 0.5)).pair_law(bead, wall, law(&material, 0.6));
    b.gravity(DVec3::NEG_Y * 9.81).threads(threads).skin(skin);
    let asked = |word: &str| std::env::args().any(|a| a == word);
    b.kernels(match (asked("fused"), asked("roots")) {
        (_, true) => Kernels::FastRoots,
        (true, false) => Kernels::Fused,
        _ => Kernels::Fastest,
    });
    b.domain(DVec3::new(-0.2, -0.2, -0.01), DVec3::new(0.2, 0.2, length + 0.01));
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 17.0 * std::f64::consts::TAU / 60.0);
    let drum = b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, radius, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.2, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::Z * length, DVec3::NEG_Z, 0.2, wall).with_motion(turning));
    let mut random = 42u64;
    let mut jitter = || {
        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        ((random >> 40) as f64 / (1u64 << 24) as f64 - 0.5) * 2e-4
    };
    let pitch = 6.3e-3;
    let per_row = (length / pitch) as usize;
    let mut left = count;
    'fill: for j in 0..40 {
        for i in 0..40 {
            let (x, y) = (-0.122 + pitch * i as f64, -0.122 + pitch * j as f64);
            if x.hypot(y) > radius - 3.3e-3 {
                continue;
            }
            for k in 0..per_row {
                if left == 0 {
                    break 'fill;
                }
                let z = (k as f64 + 0.5) * length / per_row as f64;
                let p = DVec3::new(x + jitter(), y + jitter(), z + jitter());
                b.sphere(Sphere::at(p, 3e-3, bead));
                left -= 1;
            }
        }
    }
    let mut world = b.build().expect("a valid drum");
    world.run(settle).expect("settling");
    let (builds, start, cpu) = (world.list_builds(), Instant::now(), cpu_seconds());
    // On a machine that others use, some pieces of a few steps run undisturbed: the fastest tenth
    // of them tells what a quiet machine would need.
    let mut pieces = Vec::new();
    for _ in 0..steps.div_ceil(PIECE) {
        let begun = Instant::now();
        world.run(PIECE).expect("turning");
        pieces.push(begun.elapsed().as_secs_f64() * 1e9 / (PIECE * world.len() as u64) as f64);
    }
    let steps = steps.div_ceil(PIECE) * PIECE;
    pieces.sort_by(f64::total_cmp);
    let (time, cpu) = (start.elapsed().as_secs_f64(), cpu_seconds() - cpu);
    println!(
        "processor time of this thread: {:.1} ns a particle-step",
        cpu * 1e9 / (steps * world.len() as u64) as f64
    );
    let n = world.len() as f64;
    println!(
        "{} particles, {threads} threads: {:.1} ns a particle-step; {:.2} list pairs, {:.2} contacts a particle, list every {:.1} steps; torque {:.4} N m",
        world.len(),
        time * 1e9 / (steps as f64 * n),
        world.list_pairs() as f64 / n,
        world.contact_count() as f64 / n,
        steps as f64 / (world.list_builds() - builds).max(1) as f64,
        world.wall_load(drum).expect("the drum").torque.z,
    );
    println!(
        "wall time of the fastest tenth, half of the pieces of {PIECE} steps: {:.1}, {:.1} ns a particle-step",
        pieces[pieces.len() / 10],
        pieces[pieces.len() / 2]
    );
}
