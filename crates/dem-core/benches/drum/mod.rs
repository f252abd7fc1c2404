//! What the benches of drums share: laws, the turning drum, and how a run is timed.

use std::time::Instant;

use dem_core::prelude::*;

pub(crate) type Model = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;

/// Steps in a piece of the run: some lists. The last step of each call keeps what a look at the world would ask for, and
/// takes longer than the others.
const PIECE: u64 = 100;

/// Radius of the drum, m.
pub(crate) const RADIUS: f64 = 0.125;

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

/// The number at a place of the command line, words left out.
pub(crate) fn argument(place: usize, default: f64) -> f64 {
    let mut numbers = std::env::args().skip(1).filter_map(|a| a.parse().ok());
    numbers.nth(place).unwrap_or(default)
}

/// How many threads: the first number.
fn threads() -> usize {
    argument(0, 1.0) as usize
}

/// A drum of this length (m) that turns at 17 rpm, with a time step of `dt` (s) and a skin (m): the builder, what its
/// particles are made of, and its shell. Kernels and threads are those that
/// the command line names.
pub(crate) fn turning(
    material: Material,
    length: f64,
    dt: f64,
    skin: f64,
) -> (WorldBuilder<Model>, MaterialId, usize) {
    let mut b = WorldBuilder::<Model>::new(dt);
    let (grain, wall) = (b.material(material), b.material(material));
    b.pair_law(grain, grain, law(&material, 0.5)).pair_law(grain, wall, law(&material, 0.6));
    b.gravity(DVec3::NEG_Y * 9.81).threads(threads()).skin(skin);
    let asked = |word: &str| std::env::args().any(|a| a == word);
    b.kernels(match (asked("fused"), asked("roots")) {
        (_, true) => Kernels::FastRoots,
        (true, false) => Kernels::Fused,
        _ => Kernels::Fastest,
    });
    let reach = RADIUS + 0.015;
    b.domain(DVec3::new(-reach, -reach, -0.01), DVec3::new(reach, reach, length + 0.01));
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 17.0 * std::f64::consts::TAU / 60.0);
    let drum = b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, RADIUS, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, reach, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::Z * length, DVec3::NEG_Z, reach, wall).with_motion(turning));
    (b, grain, drum)
}

/// Numbers in -0.5..0.5 from a seed.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64 - 0.5
    }
}

/// Processor time of the calling thread, s, where the system tells it (0 elsewhere): on a machine
/// that others use, it is what the work costs.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|t| t.parse::<f64>().ok()).map_or(0.0, |ns| ns * 1e-9)
}

/// Run `settle` steps, then time `steps` of them and report: one of these is called so.
pub(crate) fn timed(world: &mut World<Model>, drum: usize, [settle, steps]: [u64; 2], one: &str) {
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
    let n = world.len() as f64;
    println!(
        "processor time of this thread: {:.1} ns a {one}-step",
        cpu * 1e9 / (steps as f64 * n)
    );
    println!(
        "{} {one}s, {} threads: {:.1} ns a {one}-step; {:.2} list pairs, {:.2} contacts a {one}, list every {:.1} steps; torque {:.4} N m",
        world.len(),
        threads(),
        time * 1e9 / (steps as f64 * n),
        world.list_pairs() as f64 / n,
        world.contact_count() as f64 / n,
        steps as f64 / (world.list_builds() - builds).max(1) as f64,
        world.wall_load(drum).expect("the drum").torque.z,
    );
    println!(
        "wall time of the fastest tenth, half of the pieces of {PIECE} steps: {:.1}, {:.1} ns a {one}-step",
        pieces[pieces.len() / 10],
        pieces[pieces.len() / 2]
    );
}
