//! The drum of Dosta et al. (2024), soft variant: what is in it and how things touch.
//!
//! Comput. Phys. Commun. 296 (2024) 109066, case "rotating drum".
//! Axis along Y, gravity along -Z, mantle and end plates turn together about +Y.

use anyhow::Context;
use dem_core::contact::elasticity::{ElasticPair, Elasticity};
use dem_core::contact::law::TangentialLaw;
use dem_core::contact::tangential::MindlinTotalSpring;
use dem_core::prelude::*;

/// Radius of the drum, m.
pub(crate) const RADIUS: f64 = 0.1;
/// Length of the drum, m.
pub(crate) const LENGTH: f64 = 0.06;
/// Rate of turning, rad/s.
pub(crate) const RATE: f64 = 2.0;
/// Acceleration of gravity, m/s2.
pub(crate) const GRAVITY: f64 = 9.81;
/// Time step, s: half of the 1e-4 s of the published soft variant. At 1e-4 s (0.53 of the Rayleigh
/// time) a resting bed never rests: its spins are driven by the step to some 27 rad/s. At this
/// one it does.
pub(crate) const STEP: f64 = 5e-5;
/// Duration, s.
pub(crate) const DURATION: f64 = 5.0;
/// Steps between two counts.
pub(crate) const EVERY: u64 = 1000;
/// Poisson's ratio of everything.
const NU: f64 = 0.2;

/// One species of spheres.
pub(crate) struct Species {
    pub(crate) count: usize,
    /// Radius, m.
    pub(crate) radius: f64,
    /// Young's modulus, Pa.
    pub(crate) modulus: f64,
    /// Density, kg/m3.
    pub(crate) density: f64,
}

/// M1 and M2.
pub(crate) const SPECIES: [Species; 2] = [
    Species { count: 30_000, radius: 1e-3, modulus: 2e6, density: 2500.0 },
    Species { count: 8_000, radius: 2e-3, modulus: 1e6, density: 2000.0 },
];

/// Steel: Young's modulus, Pa; density, kg/m3.
const STEEL: (f64, f64) = (210e9, 7200.0);

/// Restitution and friction by pair; the last row and column is the wall.
const RESTITUTION: [[f64; 3]; 3] = [[0.5, 0.45, 0.4], [0.45, 0.4, 0.4], [0.4, 0.4, 0.4]];
const FRICTION: [[f64; 3]; 3] = [[0.3, 0.2, 0.2], [0.2, 0.4, 0.2], [0.2, 0.2, 0.2]];

/// Contact model: Hertz with its tail, a shear law, no rolling friction.
pub(crate) type Model<T> = ContactModel<HertzTailKept, T, FreeRolling, Cohesionless>;

/// A shear law that is made from Mindlin's parameters.
pub(crate) trait Shear: TangentialLaw + 'static {
    fn of(mindlin: Mindlin) -> Self;
}

impl Shear for Mindlin {
    fn of(mindlin: Mindlin) -> Self {
        mindlin
    }
}

impl Shear for MindlinTotalSpring {
    fn of(mindlin: Mindlin) -> Self {
        Self(mindlin)
    }
}

/// The drum without spheres; the ids of M1 and M2.
pub(crate) fn drum<T: Shear>(
    turning: bool,
) -> anyhow::Result<(WorldBuilder<Model<T>>, [MaterialId; 2])> {
    let material =
        |(youngs_modulus, density)| Material { youngs_modulus, poisson_ratio: NU, density };
    let kinds = SPECIES.map(|s| (s.modulus, s.density)).into_iter().chain([STEEL]).map(material);
    let kinds: Vec<Material> = kinds.collect();
    let mut builder = WorldBuilder::new(STEP);
    let ids: Vec<MaterialId> = kinds.iter().map(|m| builder.material(*m)).collect();
    for a in 0..3 {
        for b in a..3 {
            let elasticity = |m: &Material| Elasticity::new(m.youngs_modulus, m.poisson_ratio);
            let pair = ElasticPair::new(&elasticity(&kinds[a])?, &elasticity(&kinds[b])?);
            let spec = HertzSpec { e_star: pair.e_star, restitution: RESTITUTION[a][b] };
            let normal: HertzTailKept = spec.try_into()?;
            let friction = Friction::coulomb(FRICTION[a][b])?;
            let mindlin = Mindlin { g_star: pair.g_star, friction, damping: normal.damping };
            let law = ContactModel {
                normal,
                tangential: T::of(mindlin),
                rolling: FreeRolling,
                cohesion: Cohesionless,
            };
            builder.pair_law(ids[a], ids[b], law);
        }
    }
    builder.gravity(DVec3::NEG_Z * GRAVITY);
    let half = DVec3::new(RADIUS, 0.5 * LENGTH, RADIUS);
    builder.domain(-half * 1.05, half * 1.05);
    let rate = if turning { RATE } else { 0.0 };
    let motion = Motion::rotating(DVec3::ZERO, DVec3::Y, rate);
    let end = DVec3::Y * (0.5 * LENGTH);
    for wall in [
        Wall::drum(DVec3::ZERO, DVec3::Y, RADIUS, ids[2]),
        Wall::disc(-end, DVec3::Y, RADIUS, ids[2]),
        Wall::disc(end, DVec3::NEG_Y, RADIUS, ids[2]),
    ] {
        builder.wall(wall.with_motion(motion));
    }
    Ok((builder, [ids[0], ids[1]]))
}

/// Largest share of the Rayleigh time that the step is.
pub(crate) fn rayleigh_share() -> anyhow::Result<f64> {
    let share = |s: &Species| -> anyhow::Result<f64> {
        let elasticity = Elasticity::new(s.modulus, NU).context("species")?;
        Ok(STEP / dem_core::timestep::rayleigh_time(s.radius, s.density, &elasticity))
    };
    Ok(share(&SPECIES[0])?.max(share(&SPECIES[1])?))
}
