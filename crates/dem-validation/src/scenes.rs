//! Small worlds of the engine's cases: soft beads of 65 MPa as in drum runs.

use dem_core::contact::elasticity::{ElasticPair, Elasticity};
use dem_core::contact::normal::hertz;
use dem_core::contact::normal::restitution::AttractiveTail;
use dem_core::prelude::*;

use crate::laws::coulomb;

pub(crate) type Model = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;

pub(crate) fn bead() -> Material {
    Material::from_shear_modulus(2.52e7, 0.29, 2500.0)
}

pub(crate) fn bead_pair() -> ElasticPair {
    let m = bead();
    let e = Elasticity { young_modulus: m.youngs_modulus, poisson_ratio: m.poisson_ratio };
    ElasticPair::new(&e, &e)
}

/// Hertz with its tail cut, Mindlin, constant rolling torque.
pub(crate) fn model(mu: f64, restitution: f64, rolling: f64) -> Model {
    let pair = bead_pair();
    let damping = hertz::damping_factor(restitution, AttractiveTail::Cut)
        .expect("restitutions of the cases lie in (0, 1]");
    ContactModel {
        normal: HertzTailCut { e_star: pair.e_star, damping },
        tangential: Mindlin { g_star: pair.g_star, friction: coulomb(mu), damping },
        rolling: ConstantTorque {
            arm: dem_core::contact::rolling::RollingArm { length: 0.0, ratio: rolling },
        },
        cohesion: Cohesionless,
    }
}

/// A world of one material under `law`.
pub(crate) fn one_material<M: ContactLaw + 'static>(
    dt: f64,
    law: M,
) -> (WorldBuilder<M>, MaterialId) {
    let mut b = WorldBuilder::new(dt);
    let m = b.material(bead());
    b.pair_law(m, m, law).domain(DVec3::splat(-1.0), DVec3::splat(1.0));
    b.allow_large_time_step();
    (b, m)
}

/// Numbers in 0..1, the same ones on every machine.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * 2.0 - DVec3::ONE
    }
}

/// 64 spheres that fly into one another.
pub(crate) fn cloud<M: ContactLaw + 'static>(dt: f64, law: M) -> WorldBuilder<M> {
    let (mut b, m) = one_material(dt, law);
    let mut random = Random(3);
    for k in 0..64u32 {
        let corner = DVec3::new(f64::from(k % 4), f64::from(k / 4 % 4), f64::from(k / 16));
        let p = (corner - 1.5) * 6.5e-3;
        let v = -p * 20.0 + random.vector() * 0.2;
        let radius = 2e-3 + 1e-3 * random.next();
        let s = Sphere::at(p, radius, m).with_velocity(v);
        b.sphere(s.with_spin(random.vector() * 50.0));
    }
    b
}
