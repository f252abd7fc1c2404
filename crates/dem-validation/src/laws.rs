//! Materials of the benchmarks and shorthand for contact models.

use dem_core::contact::cohesion::Cohesionless;
use dem_core::contact::elasticity::{ElasticPair, Elasticity};
use dem_core::contact::friction::Friction;
use dem_core::contact::model::ContactModel;
use dem_core::contact::normal::{AttractiveTail, Hertz, hertz};
use dem_core::contact::rolling::FreeRolling;
use dem_core::contact::tangential::{Frictionless, Mindlin};

/// A material of the benchmarks.
#[derive(Clone, Copy)]
pub(crate) struct Material {
    pub(crate) name: &'static str,
    /// Young's modulus, GPa.
    pub(crate) gpa: f64,
    pub(crate) nu: f64,
    /// Density, kg/m^3.
    pub(crate) rho: f64,
}

pub(crate) const GLASS: Material = material("glass", 48.0, 0.20, 2800.0);
pub(crate) const LIMESTONE: Material = material("limestone", 20.0, 0.25, 2500.0);
pub(crate) const ALUMINIUM: Material = material("aluminium", 70.0, 0.30, 2699.0);
pub(crate) const MAGNESIUM: Material = material("magnesium alloy", 40.0, 0.35, 1800.0);
pub(crate) const ALUMINA: Material = material("Al2O3", 380.0, 0.23, 4000.0);
pub(crate) const CAST_IRON: Material = material("cast iron", 100.0, 0.25, 7000.0);
pub(crate) const ALUMINIUM_ALLOY: Material = material("aluminium alloy", 70.0, 0.33, 2700.0);
pub(crate) const STEEL: Material = material("steel", 208.0, 0.30, 7850.0);
pub(crate) const POLYETHYLENE: Material = material("polyethylene", 1.0, 0.40, 1400.0);
pub(crate) const NYLON: Material = material("nylon", 2.5, 0.40, 1000.0);
pub(crate) const COPPER: Material = material("copper", 120.0, 0.35, 8900.0);

const fn material(name: &'static str, gpa: f64, nu: f64, rho: f64) -> Material {
    Material { name, gpa, nu, rho }
}

impl Material {
    fn elasticity(&self) -> Elasticity {
        Elasticity { young_modulus: self.gpa * 1e9, poisson_ratio: self.nu }
    }

    /// Against a rigid plane.
    pub(crate) fn on_rigid(&self) -> ElasticPair {
        ElasticPair::on_rigid(&self.elasticity())
    }

    /// Against the same material.
    pub(crate) fn on_itself(&self) -> ElasticPair {
        ElasticPair::new(&self.elasticity(), &self.elasticity())
    }
}

pub(crate) type Smooth<const CUT: bool> =
    ContactModel<Hertz<CUT>, Frictionless, FreeRolling, Cohesionless>;
pub(crate) type Rough = ContactModel<Hertz<true>, Mindlin, FreeRolling, Cohesionless>;

/// Hertz without friction at the restitution `e`.
pub(crate) fn smooth<const CUT: bool>(e_star: f64, e: f64) -> Smooth<CUT> {
    ContactModel {
        normal: hertz_at(e_star, e),
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    }
}

/// Hertz (tail cut) and Mindlin (incremental), the shear dashpot with the factor of the normal one.
pub(crate) fn rough(pair: &ElasticPair, e: f64, mu: f64) -> Rough {
    let normal: Hertz<true> = hertz_at(pair.e_star, e);
    ContactModel {
        normal,
        tangential: Mindlin { g_star: pair.g_star, friction: coulomb(mu), damping: normal.damping },
        rolling: FreeRolling,
        cohesion: Cohesionless,
    }
}

fn hertz_at<const CUT: bool>(e_star: f64, e: f64) -> Hertz<CUT> {
    let tail = if CUT { AttractiveTail::Cut } else { AttractiveTail::Kept };
    Hertz {
        e_star,
        damping: hertz::damping_factor(e, tail).expect("benchmark restitutions lie in (0, 1]"),
    }
}

pub(crate) fn coulomb(mu: f64) -> Friction {
    Friction { mu_static: mu, mu_kinetic: mu, decay_speed: 0.0 }
}
