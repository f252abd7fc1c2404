//! Laws from outside the crate, and forces across gaps.

use dem_core::contact::kinematics::{Kinematics, PairGeometry};
use dem_core::contact::law::{Memory, NormalLaw, NormalResponse};
use dem_core::material::PairTable;
use dem_core::noncontact::{Coulomb, CoulombSpec};
use dem_core::prelude::*;

use crate::scenes::{bead_material, elastic};

/// A law that this crate does not have: a spring that stiffens with every new largest overlap.
#[derive(Debug, Clone, Copy)]
struct WorkHardening {
    stiffness: f64,
    hardening: f64,
}

/// The largest overlap so far, m.
#[derive(Debug, Clone, Copy, Default)]
struct Largest(f64);

impl Memory for Largest {
    const SLOTS: usize = 1;
    fn store(&self, slots: &mut [f64]) {
        slots[0] = self.0;
    }
    fn load(slots: &[f64]) -> Self {
        Self(slots[0])
    }
    fn transport(&mut self, _: DVec3, _: f64) {}
}

impl NormalLaw for WorkHardening {
    type Memory = Largest;
    fn respond(
        &self,
        _: &PairGeometry,
        motion: &Kinematics,
        memory: &mut Largest,
    ) -> NormalResponse {
        let d = motion.overlap.max(0.0);
        memory.0 = memory.0.max(d);
        let k = self.stiffness * (1.0 + self.hardening * memory.0);
        // Unloading follows a line to the permanent deformation.
        let rest = memory.0 - memory.0 * self.stiffness / k;
        let force = if d < memory.0 { (k * (d - rest)).max(0.0) } else { self.stiffness * d };
        NormalResponse { force, friction_load: force, stiffness: k, ..NormalResponse::default() }
    }
}

#[test]
fn a_law_from_outside_runs_in_the_engine_with_its_memory() {
    let (k, hardening) = (1000.0, 2e4);
    let mut b = WorldBuilder::new(1e-6);
    let m = b.material(bead_material());
    let law = ContactModel {
        normal: WorkHardening { stiffness: k, hardening },
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    };
    b.pair_law(m, m, law).domain(DVec3::splat(-0.1), DVec3::splat(0.1));
    b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m));
    let id = b.sphere(Sphere::at(DVec3::Z * 3.001e-3, 3e-3, m).with_velocity(DVec3::Z * -0.1));
    let mut w = b.build().unwrap();
    w.run(5000).unwrap();
    // Loading stores k d^2/2; unloading returns (k d)^2 / (2 k'): e^2 = k/k'.
    let d = 0.1 * (w.mass(id) / k).sqrt();
    let e = (1.0 / (1.0 + hardening * d)).sqrt();
    assert!((w.velocity(id).z / (0.1 * e) - 1.0).abs() < 1e-3, "{}", w.velocity(id).z / (0.1 * e));
}

#[test]
fn charged_spheres_repel_as_coulomb_says_at_a_distance() {
    let mut b = WorldBuilder::new(1e-6);
    let m = b.material(bead_material());
    b.pair_law(m, m, elastic()).domain(DVec3::splat(-0.1), DVec3::splat(0.1));
    let mut table = PairTable::new(1);
    let spec = CoulombSpec { relative_permittivity: 1.0, range: 0.05 };
    table.set(m, m, Coulomb::try_from(spec).unwrap()).unwrap();
    b.non_contact(table);
    let i = b.sphere(Sphere::at(DVec3::X * -0.01, 1e-3, m));
    let j = b.sphere(Sphere::at(DVec3::X * 0.01, 1e-3, m));
    b.charge(i, 1e-9).charge(j, 2e-9);
    let mut w = b.build().unwrap();
    w.run(1).unwrap();
    let force = w.acceleration(j).x * w.mass(j);
    let expected = 8.987_551_79e9 * 2e-18 / 4e-4;
    assert_eq!(w.charge(j), 2e-9);
    // The step moves them by 1e-12 of their distance; a shifted force would differ by percents.
    assert!((force / expected - 1.0).abs() < 1e-6, "{force:e} {expected:e}");
    assert!((w.acceleration(i).x + w.acceleration(j).x).abs() < 1e-12 * w.acceleration(j).x);
}
