//! What a run will take, known before its bed is filled.

use rig_schema::{Ends, Rig};

use crate::assemble::time_step;
use crate::error::Error;
use crate::fill::Room;
use crate::grains::Grains;
use crate::options::Options;
use crate::parameters::Physics;
use crate::schedule::Stage;

/// Size of an experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    /// Number of particles.
    pub particles: usize,
    /// Spheres in one particle.
    pub spheres_per_particle: usize,
    /// Time step, s.
    pub time_step_s: f64,
    /// Fewest steps: a lower bound, since settling comes first and the steady state may take longer.
    pub least_steps: u64,
}

/// Solid over volume beyond which nothing packs: that of equal spheres at their densest.
const DENSEST: f64 = 0.7405;

/// Size of the experiment of a rig, without filling its drum.
///
/// It refuses early what [`crate::Experiment::new`] would refuse after a while: parameters that are missing or
/// cannot act, no particle at all, more solid than the drum holds.
///
/// ```
/// let rig = drum_rig::rig_schema::Rig::parse("drum.toml", r#"
/// name = "a handful of beads"
/// drum = { radius_m = 0.02, length_m = 0.02, mantle = "glass", end_plates = "glass" }
/// particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
/// fill.count = 90
/// friction = { pp = 0.5, mantle = 0.6 }
/// restitution = { pp = 0.7, mantle = 0.7 }
/// rolling = { pp = 0.01, mantle = 0.01 }
/// run = { speeds_rpm = [60.0], frames = 5 }
/// [materials]
/// glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e6 }
/// "#)?;
/// let outline = drum_rig::outline(&rig, &drum_rig::Options::default())?;
/// assert_eq!(outline.particles, 90);
/// // A fifth of the Rayleigh time of a 4 mm bead: 43 us.
/// assert!((outline.time_step_s - 43e-6).abs() < 1e-6);
/// # Ok::<(), drum_rig::Error>(())
/// ```
///
/// # Errors
/// Those of [`crate::Experiment::new`] that need no bed.
pub fn outline(rig: &Rig, options: &Options) -> Result<Outline, Error> {
    options.check()?;
    let physics = Physics::of(rig)?;
    let grains = Grains::of(rig, &physics)?;
    let radius = rig.drum.radius_m - physics.wall_layer;
    let bounding = 2.0 * grains.largest_bounding_radius();
    for room_m in [2.0 * radius, rig.drum.length_m] {
        if !(room_m >= bounding) {
            return Err(Error::NoRoom { what: "a particle", size_m: bounding, room_m });
        }
    }
    let periodic = rig.drum.ends == Ends::Periodic;
    let room = Room { radius, length: rig.drum.length_m, periodic };
    let solid_m3 = grains.solid_volume();
    if solid_m3 > DENSEST * room.volume() {
        return Err(Error::DoesNotFit {
            count: grains.len(),
            solid_m3,
            drum_m3: room.volume(),
            rounds: 0,
            overlap: 1.0,
        });
    }
    let time_step_s = time_step(rig, &physics, &grains)?;
    let scales = (time_step_s, radius);
    let least_steps = rig
        .run
        .speeds_rpm
        .iter()
        .map(|&rpm| {
            Stage::new(rpm, physics.speed_scale, scales, rig.run.frames, options).least_steps()
        })
        .sum();
    Ok(Outline {
        particles: grains.len(),
        spheres_per_particle: grains.spheres_per_particle(),
        time_step_s,
        least_steps,
    })
}
