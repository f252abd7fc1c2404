//! Faults stop a run and name particle, partner, step and cause; bad input is refused.

use dem_core::contact::law::NormalResponse;
use dem_core::error::{Cause, Error, Fault, FaultKind, Partner};
use dem_core::prelude::*;

use crate::scenes::{Model, bead_material, drum, elastic, model};

fn fault(error: Error) -> Fault {
    match error {
        Error::Fault(fault) => fault,
        other => panic!("expected a fault, got {other}"),
    }
}

fn one_material(dt: f64) -> (WorldBuilder<Model>, MaterialId) {
    let mut b = WorldBuilder::new(dt);
    let m = b.material(bead_material());
    b.pair_law(m, m, model(0.5, 0.9, 0.0)).domain(DVec3::splat(-0.1), DVec3::splat(0.1));
    (b, m)
}

#[test]
fn a_particle_that_leaves_the_domain_is_named() {
    let (mut b, m) = one_material(1e-5);
    b.sphere(Sphere::at(DVec3::ZERO, 1e-3, m));
    let runaway = b.sphere(Sphere::at(DVec3::X * 0.05, 1e-3, m).with_velocity(DVec3::X));
    let mut w = b.build().unwrap();
    let fault = fault(w.run(10_000).unwrap_err());
    assert_eq!((fault.kind, fault.particle), (FaultKind::Lost, runaway));
    assert_eq!(fault.cause, Cause::OpenBoundary);
    // 0.05 m at 1 m/s, seen at the next list: within half a skin of 0.125 mm.
    assert!((fault.time - 0.05).abs() < 2e-4, "{fault}");
}

#[test]
fn when_a_clump_leaves_the_domain_the_others_have_the_velocities_of_that_step() {
    let run = |steps: u64| {
        let (mut b, m) = one_material(1e-5);
        let sphere = |x| ClumpSphere { centre: DVec3::X * x, radius: 1e-3 };
        let spec = ClumpSpec {
            spheres: vec![sphere(-0.8e-3), sphere(0.8e-3)],
            mass: 2e-5,
            centre_of_mass: DVec3::ZERO,
            inertia: DMat3::from_diagonal(DVec3::new(1.0, 2.0, 2.0) * 1e-11),
            material: m,
        };
        let shape = b.clump_shape(spec.try_into().unwrap());
        let mut clump = |position, velocity| {
            let (orientation, spin) = (DQuat::IDENTITY, DVec3::new(30.0, 20.0, 10.0));
            b.clump(PlacedClump { shape, position, orientation, velocity, spin })
        };
        // Two that are in touch when the third leaves.
        let hit = clump(DVec3::Y * 2.055e-3, DVec3::Y * -0.5);
        let other = clump(DVec3::ZERO, DVec3::ZERO);
        let runaway = clump(DVec3::X * 0.09995, DVec3::X);
        let mut w = b.gravity(DVec3::Y * -0.1).build().unwrap();
        let fault = loop {
            if let Err(error) = w.run(steps) {
                break fault(error);
            }
        };
        assert_eq!((fault.kind, fault.particle), (FaultKind::Lost, runaway));
        let of = |p| [w.position(p), w.velocity(p), w.acceleration(p), w.spin(p)];
        (fault.step, [hit, other, runaway].map(of))
    };
    let ((step, together), (single, apart)) = (run(10_000), run(1));
    assert_eq!(step, single);
    for (together, apart) in together.into_iter().flatten().zip(apart.into_iter().flatten()) {
        // Of accelerations a difference of velocities over half a step is left, rounded.
        let off = (together - apart).length();
        assert!(off < 1e-9 * (1.0 + apart.length()), "{together} and {apart}");
    }
    assert!(together[0][2].length() > 1.0, "no blow: {:?}", together[0]);
}

#[test]
fn spheres_placed_into_one_another_are_named_with_their_partner() {
    use Kernels::{FastRoots, Fastest, Fused, Portable};
    for kernels in [Fastest, Fused, FastRoots, Portable] {
        // At one place, too, where reciprocals of their distance have no end.
        for (apart, overlap) in [(0.5e-3, 1.5), (0.0, 2.0)] {
            let (mut b, m) = one_material(1e-5);
            b.kernels(kernels);
            b.sphere(Sphere::at(DVec3::ZERO, 1e-3, m));
            b.sphere(Sphere::at(DVec3::X * apart, 1e-3, m));
            let mut w = b.build().unwrap();
            let fault = fault(w.run(1).unwrap_err());
            assert_eq!(fault.particle, ParticleId(0));
            assert_eq!(fault.partner, Some(Partner::Particle(ParticleId(1))));
            assert_eq!(fault.cause, Cause::Placement);
            let FaultKind::Overlap { fraction, .. } = fault.kind else {
                panic!("{kernels:?}: {fault}");
            };
            assert!((fraction - overlap).abs() < 1e-12, "{kernels:?}: {fraction}");
        }
    }
}

#[test]
fn too_fast_an_impact_blames_the_time_step() {
    let (mut b, m) = one_material(2e-5);
    b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m));
    b.sphere(Sphere::at(DVec3::Z * 5e-3, 1e-3, m).with_velocity(DVec3::Z * -40.0));
    let mut w = b.build().unwrap();
    let fault = fault(w.run(1000).unwrap_err());
    assert_eq!(fault.partner, Some(Partner::Wall(0)));
    assert!(matches!(fault.cause, Cause::TimeStep { radii_per_step } if radii_per_step > 0.1));
    let text = fault.to_string();
    assert!(text.contains("particle 0") && text.contains("wall 0"), "{text}");
}

/// A law that returns nonsense.
#[derive(Debug, Clone, Copy)]
struct Broken;

impl dem_core::contact::law::NormalLaw for Broken {
    type Memory = ();
    fn respond(
        &self,
        _: &dem_core::contact::kinematics::PairGeometry,
        _: &dem_core::contact::kinematics::Kinematics,
        (): &mut (),
    ) -> NormalResponse {
        NormalResponse { force: f64::NAN, ..NormalResponse::default() }
    }
}

#[test]
fn a_law_that_returns_nan_is_blamed() {
    let law = ContactModel {
        normal: Broken,
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    };
    let mut b = WorldBuilder::new(1e-5);
    let m = b.material(bead_material());
    b.pair_law(m, m, law).domain(DVec3::splat(-0.1), DVec3::splat(0.1));
    b.sphere(Sphere::at(DVec3::ZERO, 1e-3, m));
    b.sphere(Sphere::at(DVec3::X * 1.999e-3, 1e-3, m));
    let mut w = b.build().unwrap();
    let fault = fault(w.run(10).unwrap_err());
    assert_eq!((fault.kind, fault.cause), (FaultKind::NotFinite, Cause::Law));
    assert_eq!(fault.partner, Some(Partner::Particle(ParticleId(1))));
    assert!(fault.step <= 2);
}

#[test]
fn bad_input_is_refused_with_the_value_and_what_was_expected() {
    let text = |b: &WorldBuilder<Model>| b.build().unwrap_err().to_string();
    let (mut b, m) = one_material(1e-5);
    b.sphere(Sphere::at(DVec3::ZERO, -1e-3, m));
    assert!(text(&b).contains("sphere radius (m) = -0.001"), "{}", text(&b));

    let (mut b, _) = one_material(1e-5);
    b.sphere(Sphere::at(DVec3::ZERO, 1e-3, MaterialId(4)));
    assert!(text(&b).contains("material 4 is not declared"));

    let (mut b, m) = one_material(1e-5);
    b.sphere(Sphere::at(DVec3::X, 1e-3, m));
    assert!(text(&b).contains("outside the domain"));

    let (mut b, m) = one_material(1e-3);
    b.sphere(Sphere::at(DVec3::ZERO, 1e-3, m));
    assert!(text(&b).contains("Rayleigh"), "{}", text(&b));
    b.allow_large_time_step();
    assert!(b.build().is_ok());

    let (mut b, m) = one_material(1e-5);
    let other = b.material(bead_material());
    b.sphere(Sphere::at(DVec3::ZERO, 1e-3, m));
    b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, other));
    assert!(text(&b).contains("no contact law for materials 0 and 1"));

    let (mut b, m) = one_material(1e-5);
    b.wall(Wall::plane(DVec3::ZERO, DVec3::ZERO, m));
    assert!(text(&b).contains("plane normal"));

    let (mut b, m) = one_material(1e-5);
    b.sphere(Sphere::at(DVec3::ZERO, 1e-3, m)).0.to_string();
    b.sphere(Sphere::at(DVec3::Y * 0.05, 0.02, m)).0.to_string();
    b.domain(DVec3::splat(-0.1), DVec3::new(0.1, 0.1, -0.05)).periodic(Axis::Z);
    b.domain(DVec3::splat(-0.1), DVec3::new(0.1, 0.1, -0.05));
    assert!(b.build().is_err());

    let (mut b, m) = one_material(1e-5);
    b.sphere(Sphere::at(DVec3::ZERO, 0.03, m));
    b.domain(DVec3::splat(-0.04), DVec3::splat(0.04)).periodic(Axis::Z);
    assert!(text(&b).contains("periodic length 0.08"), "{}", text(&b));

    let none: WorldBuilder<Model> = WorldBuilder::new(1e-5);
    assert!(text(&none).contains("set it with `domain`"));
    let elastic_world = WorldBuilder::<crate::scenes::Elastic>::new(f64::NAN);
    assert!(elastic_world.build().is_err());
    let _ = elastic();
}

#[test]
fn unknown_numbers_are_refused_after_building() {
    let mut w = drum(10, 1.0, 1).build().unwrap();
    assert!(w.set_velocity(ParticleId(10), DVec3::ZERO, DVec3::ZERO).is_err());
    assert!(w.set_wall_motion(3, Motion::default()).is_err());
    assert!(w.wall_load(3).is_err());
    let bad = Motion::rotating(DVec3::ZERO, DVec3::ZERO, 1.0);
    assert!(w.set_wall_motion(0, bad).is_err());
}

#[test]
fn the_time_step_is_limited_by_what_particles_are_made_of_not_by_walls() {
    // A step that soft beads allow; in steel of their size the Rayleigh time is 50 times shorter.
    let steel = Material { youngs_modulus: 210e9, poisson_ratio: 0.3, density: 7800.0 };
    let (mut b, m) = one_material(7e-5);
    let wall = b.material(steel);
    b.pair_law(m, wall, model(0.5, 0.9, 0.0)).pair_law(wall, wall, model(0.5, 0.9, 0.0));
    b.wall(Wall::plane(DVec3::NEG_Z * 0.05, DVec3::Z, wall));
    b.sphere(Sphere::at(DVec3::ZERO, 3e-3, m));
    assert!(b.build().is_ok());
    // Each material counts with its own smallest sphere.
    b.sphere(Sphere::at(DVec3::X * 0.05, 6e-3, wall));
    assert!(b.build().unwrap_err().to_string().contains("Rayleigh"));
}
