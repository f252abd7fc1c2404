//! A law written outside `dem-core` takes part in a contact model like those inside.

use dem_core::contact::cohesion::Cohesionless;
use dem_core::contact::kinematics::{Kinematics, PairGeometry};
use dem_core::contact::law::{NormalLaw, NormalResponse};
use dem_core::contact::model::ContactModel;
use dem_core::contact::rolling::FreeRolling;
use dem_core::contact::tangential::Frictionless;
use dem_core::glam::DVec3;
use dem_core::impact::{Body, Partner, Settings, collide};

/// `F = k delta^2`.
#[derive(Clone, Copy)]
struct Quadratic {
    k: f64,
}

impl NormalLaw for Quadratic {
    type Memory = ();
    fn respond(&self, _: &PairGeometry, motion: &Kinematics, (): &mut ()) -> NormalResponse {
        let delta = motion.overlap.max(0.0);
        let force = self.k * delta * delta;
        NormalResponse {
            force,
            friction_load: force,
            stiffness: 2.0 * self.k * delta,
            contact_radius: delta,
            elastic_energy: force * delta / 3.0,
            dissipated_power: 0.0,
        }
    }
}

#[test]
fn a_law_from_outside_the_crate_collides_and_conserves_energy() {
    let model = ContactModel {
        normal: Quadratic { k: 1e9 },
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    };
    let body = Body::solid_sphere(3e-3, 2500.0).with_velocity(DVec3::X);
    let hit = collide(model, body, Partner::Plane, Settings::new(1e-7)).unwrap();
    // k d^3/3 = m v^2/2
    let peak = (1.5 * body.mass / 1e9).cbrt();
    // some 1500 steps a contact, second order: 1e-5
    assert!((hit.restitution - 1.0).abs() < 1e-5);
    assert!((hit.peak_overlap / peak - 1.0).abs() < 1e-5);
}
