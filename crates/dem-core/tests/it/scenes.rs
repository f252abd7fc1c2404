//! Small worlds that several tests share.

use dem_core::contact::cohesion::Sjkr;
use dem_core::prelude::*;

pub(crate) type Model = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;
pub(crate) type Cohesive = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Sjkr>;
pub(crate) type Elastic = ContactModel<HertzTailCut, Frictionless, FreeRolling, Cohesionless>;

/// Beads as soft as those of the drum runs: 65 MPa.
pub(crate) fn bead_material() -> Material {
    Material::from_shear_modulus(2.52e7, 0.29, 2500.0)
}

pub(crate) fn e_star() -> f64 {
    let m = bead_material();
    m.youngs_modulus / (2.0 * (1.0 - m.poisson_ratio.powi(2)))
}

pub(crate) fn model(friction: f64, restitution: f64, rolling: f64) -> Model {
    let m = bead_material();
    let normal: HertzTailCut = HertzSpec { e_star: e_star(), restitution }.try_into().unwrap();
    ContactModel {
        normal,
        tangential: Mindlin {
            g_star: m.shear_modulus() / (2.0 * (2.0 - m.poisson_ratio)),
            friction: Friction::coulomb(friction).unwrap(),
            damping: normal.damping,
        },
        rolling: ConstantTorqueSpec { coefficient: RollingCoefficient::Ratio(rolling) }
            .try_into()
            .unwrap(),
        cohesion: Cohesionless,
    }
}

pub(crate) fn elastic() -> Elastic {
    ContactModel {
        normal: HertzTailCut { e_star: e_star(), damping: 0.0 },
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    }
}

/// Numbers in 0..1, the same ones on every machine.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * 2.0 - DVec3::ONE
    }
}

/// A turning drum of 60 x 30 mm with `count` beads of radius 2 mm (times up to `1/ratio`).
pub(crate) fn drum(count: usize, ratio: f64, threads: usize) -> WorldBuilder<Model> {
    drum_of(count, ratio, threads, |m| m)
}

/// The same with an energy density of cohesion, J/m3.
pub(crate) fn cohesive_drum(
    count: usize,
    ratio: f64,
    threads: usize,
    energy_density: f64,
) -> WorldBuilder<Cohesive> {
    drum_of(count, ratio, threads, |Model { normal, tangential, rolling, .. }| Cohesive {
        normal,
        tangential,
        rolling,
        cohesion: Sjkr { energy_density },
    })
}

/// The same with a law made of the usual one.
pub(crate) fn drum_of<M: ContactLaw + 'static>(
    count: usize,
    ratio: f64,
    threads: usize,
    law: impl Fn(Model) -> M,
) -> WorldBuilder<M> {
    let mut b = WorldBuilder::new(2e-5f64.min(4e-5 / ratio));
    let (bead, wall) = (b.material(bead_material()), b.material(bead_material()));
    b.pair_law(bead, bead, law(model(0.5, 0.8, 0.01)));
    b.pair_law(bead, wall, law(model(0.6, 0.7, 0.02)));
    b.gravity(DVec3::NEG_Y * 9.81).threads(threads).allow_large_time_step();
    b.domain(DVec3::new(-0.04, -0.04, -0.005), DVec3::new(0.04, 0.04, 0.035));
    let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 6.0);
    b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, 0.03, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::ZERO, DVec3::Z, 0.04, wall).with_motion(turning));
    b.wall(Wall::disc(DVec3::Z * 0.03, DVec3::NEG_Z, 0.04, wall).with_motion(turning));
    let mut random = Random(7);
    let mut left = count;
    'fill: for j in 0..12 {
        for i in 0..12 {
            for k in 0..7 {
                let grid = DVec3::new(i as f64 - 5.5, j as f64 - 5.5, k as f64 + 0.5);
                let p = grid * 4.2e-3 + random.vector() * 5e-5;
                if p.truncate().length() > 0.0275 || left == 0 {
                    if left == 0 {
                        break 'fill;
                    }
                    continue;
                }
                let radius = 2e-3 * ratio.powf(-random.next());
                b.sphere(Sphere::at(p, radius, bead).with_velocity(random.vector() * 0.1));
                left -= 1;
            }
        }
    }
    b
}
