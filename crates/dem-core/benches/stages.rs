//! Stages of a step, each in a scene in which it does most of the work, and whole steps by size.
//!
//! - `kernel`: beads on a lattice, pressed together: six contacts each, no wall, few lists;
//! - `list`: the same beads a little apart, under a skin that calls for a list every few steps;
//! - `walls`: beads side by side on a plate, apart from each other;
//! - `integration`: beads in free flight;
//! - `step`: beads of a lattice that shears and falls on a plate, 1000 to 300 000 of them.
//!
//! Scenes are made from a seed. Throughput counts particle-steps.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use dem_core::prelude::*;

type Model = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;

const RADIUS: f64 = 2e-3;

/// Numbers in -1..1 from a seed.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        2.0 * (self.0 >> 11) as f64 / (1u64 << 53) as f64 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }
}

fn law(m: &Material) -> Model {
    let nu = m.poisson_ratio;
    let e_star = m.youngs_modulus / (2.0 * (1.0 - nu * nu));
    let normal =
        HertzTailCut::try_from(HertzSpec { e_star, restitution: 0.8 }).expect("valid numbers");
    ContactModel {
        normal,
        tangential: Mindlin {
            g_star: m.shear_modulus() / (2.0 * (2.0 - nu)),
            friction: Friction::coulomb(0.5).expect("valid numbers"),
            damping: normal.damping,
        },
        rolling: ConstantTorqueSpec { coefficient: RollingCoefficient::Ratio(0.01) }
            .try_into()
            .expect("valid numbers"),
        cohesion: Cohesionless,
    }
}

/// Beads on a lattice `across` x `across` x `up`.
struct Scene {
    across: usize,
    up: usize,
    /// Distance of neighbours over the diameter.
    pitch: f64,
    /// Random part of the positions (m) and of the velocities (m/s).
    jitter: f64,
    speed: f64,
    skin: f64,
    plate: bool,
    threads: usize,
    kernels: Kernels,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            across: 22,
            up: 21,
            pitch: 0.999,
            jitter: 1e-7,
            speed: 0.0,
            skin: 5e-4,
            plate: false,
            threads: 1,
            kernels: Kernels::Fastest,
        }
    }
}

impl Scene {
    fn world(&self) -> World<Model> {
        let mut b = WorldBuilder::new(2e-5);
        let material = Material::from_shear_modulus(2.52e7, 0.29, 2500.0);
        let bead = b.material(material);
        b.pair_law(bead, bead, law(&material)).threads(self.threads).kernels(self.kernels);
        b.skin(self.skin);
        let pitch = 2.0 * RADIUS * self.pitch;
        let half = 0.5 * pitch * self.across as f64 + 0.05;
        b.domain(
            DVec3::new(-half, -half, -0.02),
            DVec3::new(half, half, pitch * self.up as f64 + 0.1),
        );
        if self.plate {
            b.gravity(DVec3::NEG_Z * 9.81).wall(Wall::plane(DVec3::ZERO, DVec3::Z, bead));
        }
        let mut random = Random(1);
        let middle = 0.5 * (self.across as f64 - 1.0);
        for k in 0..self.up {
            for j in 0..self.across {
                for i in 0..self.across {
                    let grid = DVec3::new(i as f64 - middle, j as f64 - middle, k as f64);
                    let lift = DVec3::Z * 0.9995 * RADIUS;
                    let at = grid * pitch + lift + random.vector() * self.jitter;
                    let sphere = Sphere::at(at, RADIUS, bead);
                    b.sphere(sphere.with_velocity(random.vector() * self.speed));
                }
            }
        }
        b.build().expect("a valid scene")
    }
}

fn bench(c: &mut Criterion, group: &str, name: &str, scene: &Scene, steps: u64) {
    let beads = scene.across * scene.across * scene.up;
    let mut group = c.benchmark_group(group);
    group.throughput(Throughput::Elements(steps * beads as u64));
    group.bench_function(BenchmarkId::new(name, beads), |b| {
        let mut world = scene.world();
        world.run(steps).expect("a first step");
        // From the same state every time.
        let state = world.snapshot();
        b.iter_batched_ref(
            || {
                let mut world = world.clone();
                world.restore(&state).expect("its own state");
                world.run(1).expect("a step that warms up");
                world
            },
            |world| world.run(steps).expect("steps"),
            criterion::BatchSize::PerIteration,
        );
    });
    group.finish();
}

fn stages(c: &mut Criterion) {
    for (name, kernels) in [
        ("portable", Kernels::Portable),
        ("avx2", Kernels::Avx2),
        ("exact", Kernels::Fastest),
        ("fused", Kernels::Fused),
        ("roots", Kernels::FastRoots),
    ] {
        bench(c, "kernel", name, &Scene { kernels, ..Scene::default() }, 20);
    }
    let apart = Scene { pitch: 1.05, speed: 0.5, skin: 4e-5, ..Scene::default() };
    bench(c, "list", "every few steps", &apart, 10);
    let flat = Scene { across: 100, up: 1, pitch: 1.02, plate: true, ..Scene::default() };
    bench(c, "walls", "plate", &flat, 20);
    bench(
        c,
        "integration",
        "free flight",
        &Scene { pitch: 1.6, speed: 0.01, ..Scene::default() },
        20,
    );
}

fn steps(c: &mut Criterion) {
    for (across, up) in [(10, 10), (22, 21), (47, 45), (67, 67)] {
        for threads in [1, 2] {
            let scene = Scene {
                across,
                up,
                jitter: 2e-5,
                speed: 0.02,
                plate: true,
                threads,
                ..Scene::default()
            };
            bench(c, "step", if threads == 1 { "one thread" } else { "two threads" }, &scene, 10);
        }
    }
}

criterion_group! {
    name = all;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(std::time::Duration::from_millis(200))
        .measurement_time(std::time::Duration::from_millis(800));
    targets = stages, steps
}
criterion_main!(all);
