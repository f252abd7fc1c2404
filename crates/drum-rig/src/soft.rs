//! A rig with softer particles, for quick work.
//!
//! The time step of a simulation is set by the stiffest particle, the motion of a bed hardly is, as long as overlaps
//! stay small. So elastic moduli are lowered until a bed as deep as the drum's radius presses its
//! lowest particles together by a stated share of their diameter.
//!
//! A collision at a given speed ends later in softer particles, but by less than the Rayleigh time grows (powers 2/5 and 1/2 of
//! compliance), so that a long step, stable before, would not be after: the solver's own is the limit then.
//!
//! By Hertz, two spheres of diameter `d` pressed by `p d^2` overlap by `d (9/4)^(1/3) (p/E*)^(2/3)`; here `p = density g R`,
//! and `E* = G/(1 - nu)` of two spheres of one material. What is changed along:
//!
//! | quantity | change | what stays the same |
//! |---|---|---|
//! | shear modulus of every material | lowered where above the limit | Poisson's ratio, restitution |
//! | time step, where given | root of the particles' change, at most the solver's own | share of the Rayleigh time |
//! | cohesion energy density | two thirds power of the particles' change | pull over weight at a given load |

use rig_schema::Rig;

use crate::GRAVITY;
use crate::coarse::set;
use crate::error::Error;
use crate::options::Options;
use crate::outline::outline;

/// The rig with moduli as low as an overlap of `overlap` diameters allows; one that is softer already comes back as it is.
///
/// ```
/// let rig = drum_rig::rig_schema::Rig::parse("drum.toml", r#"
/// name = "glass"
/// drum = { radius_m = 0.125, length_m = 0.15, mantle = "glass", end_plates = "glass" }
/// particles = { material = "glass", shape = { sphere = { diameter_m = 0.006 } } }
/// fill.count = 7807
/// friction = { pp = 0.5, mantle = 0.6 }
/// restitution = { pp = 0.9, mantle = 0.9 }
/// run = { speeds_rpm = [17.0], frames = 30 }
/// [materials]
/// glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e7 }
/// "#)?;
/// let soft = drum_rig::soft(&rig, 0.01)?;
/// // 3066 Pa, E* 1500 times as much, G = 0.71 E*: 3.3 MPa, steps 2.8 times as long.
/// assert!((soft.materials["glass"].shear_modulus_pa / 3.26e6 - 1.0).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::Option`] for an overlap outside 0 to 0.1, [`Error::UnknownMaterial`] if the particles' material is not described,
/// [`Error::Range`] when a scaled parameter leaves its range, those of [`outline`] where a time step is given.
pub fn soft(rig: &Rig, overlap: f64) -> Result<Rig, Error> {
    if !(overlap > 0.0 && overlap <= 0.1) {
        return Err(Error::Option {
            name: "overlap",
            value: overlap,
            expected: "above 0, at most 0.1",
        });
    }
    let unknown =
        || Error::UnknownMaterial { role: "particles", name: rig.particles.material.clone() };
    let own = rig.materials.get(&rig.particles.material).ok_or_else(unknown)?;
    let pressure = own.density_kg_m3 * GRAVITY * rig.drum.radius_m;
    let e_star = 1.5 * pressure / overlap.powf(1.5);
    let mut soft = rig.clone();
    for material in soft.materials.values_mut() {
        let limit = e_star * (1.0 - material.poisson_ratio);
        material.shear_modulus_pa = material.shear_modulus_pa.min(limit);
    }
    let now = soft.materials.get(&rig.particles.material).ok_or_else(unknown)?;
    let change = now.shear_modulus_pa / own.shear_modulus_pa;
    if let Some(dt) = rig.run.time_step_s
        && change < 1.0
    {
        let scaled = dt / change.sqrt();
        soft.run.time_step_s = None;
        let limit = outline(&soft, &Options::default())?.time_step_s;
        soft.run.time_step_s = Some(scaled.min(limit));
    }
    const ENERGY: &str = "cohesion.energy_density_j_m3";
    if let Some(energy) = rig.settings.given(ENERGY) {
        set(&mut soft.settings, ENERGY, energy * change.powf(2.0 / 3.0))?;
    }
    Ok(soft)
}
