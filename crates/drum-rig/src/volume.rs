//! How much solid a filling holds, and by how much the next one may differ.

use rig_schema::Rig;

use crate::error::Error;
use crate::grains::Grains;
use crate::parameters::{Fill, Physics};

/// Solid volume of one filling of a drum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolidVolume {
    /// Volume of the particles that this seed draws, m3.
    pub drawn_m3: f64,
    /// Mean over all seeds, m3.
    pub expected_m3: f64,
    /// Standard deviation over seeds, as a part of the mean.
    pub relative_sd: f64,
}

impl SolidVolume {
    /// What this filling has more than is expected, as a part of that.
    pub fn excess(&self) -> f64 {
        self.drawn_m3 / self.expected_m3 - 1.0
    }
}

/// Solid volume of a rig's particles, without filling its drum.
///
/// Particles that are counted have a volume by chance where their sizes are spread: diameters are log-normal with
/// relative standard deviation `s`, so that a mean volume is `(1 + s^2)^3` times that of the mean diameter and the sum of N
/// volumes has the relative variance `((1 + s^2)^9 - 1) / N` (moments of the log-normal distribution). Particles that are weighed have
/// the volume asked for to half of the last one.
///
/// ```
/// let rig = drum_rig::rig_schema::Rig::parse("drum.toml", r#"
/// name = "counted beads"
/// drum = { radius_m = 0.05, length_m = 0.034, mantle = "glass", end_plates = "glass", ends = "periodic" }
/// particles = { material = "glass", shape = { sphere = { diameter_m = 0.006 } } }
/// size = { spread = 0.12 }
/// fill.count = 560
/// friction = { pp = 0.5, mantle = 0.6 }
/// restitution = { pp = 0.7, mantle = 0.7 }
/// rolling = { pp = 0.01, mantle = 0.01 }
/// run = { speeds_rpm = [60.0], frames = 5 }
/// [materials]
/// glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e6 }
/// "#)?;
/// let volume = drum_rig::solid_volume(&rig)?;
/// // 560 beads of 6 mm, 4.4 % more for the spread; another handful has 1.6 % more or less.
/// assert!((volume.expected_m3 * 1e6 - 66.1).abs() < 0.1);
/// assert!((volume.relative_sd - 0.0157).abs() < 1e-4);
/// assert!(volume.excess().abs() < 4.0 * volume.relative_sd);
/// # Ok::<(), drum_rig::Error>(())
/// ```
///
/// # Errors
/// Those of [`crate::Experiment::new`] that concern its particles.
pub fn solid_volume(rig: &Rig) -> Result<SolidVolume, Error> {
    let physics = Physics::of(rig)?;
    let grains = Grains::of(rig, &physics)?;
    let drawn_m3 = grains.solid_volume();
    let one_m3 = grains.mean_volume();
    let widen = 1.0 + physics.size_spread * physics.size_spread;
    Ok(match physics.fill {
        Fill::Count(_) => {
            let count = grains.len() as f64;
            SolidVolume {
                drawn_m3,
                expected_m3: count * one_m3 * widen.powi(3),
                relative_sd: ((widen.powi(9) - 1.0) / count).sqrt(),
            }
        }
        Fill::Mass(total) => SolidVolume {
            drawn_m3,
            expected_m3: total / grains.density,
            // Uniform over the last particle, which is the larger the more of the volume such particles hold.
            relative_sd: (widen.powi(33) / 12.0).sqrt() * one_m3 * grains.density / total,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig(fill: &str, seed: u64) -> Rig {
        let text = format!(
            r#"name = "volumes"
drum = {{ radius_m = 0.05, length_m = 0.034, mantle = "glass", end_plates = "glass", ends = "periodic" }}
particles = {{ material = "glass", shape = {{ sphere = {{ diameter_m = 0.006 }} }} }}
size = {{ spread = 0.2 }}
{fill}
friction = {{ pp = 0.5, mantle = 0.6 }}
restitution = {{ pp = 0.7, mantle = 0.7 }}
rolling = {{ pp = 0.01, mantle = 0.01 }}
run = {{ speeds_rpm = [60.0], frames = 5, seed = {seed} }}
[materials]
glass = {{ density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e6 }}
"#
        );
        Rig::parse("volumes.toml", &text).unwrap()
    }

    #[test]
    fn fillings_scatter_as_the_sizes_that_they_are_drawn_from_say() {
        let all: Vec<SolidVolume> =
            (0..400).map(|seed| solid_volume(&rig("fill.count = 300", seed)).unwrap()).collect();
        let n = all.len() as f64;
        let mean = all.iter().map(SolidVolume::excess).sum::<f64>() / n;
        let sd = (all.iter().map(|v| v.excess().powi(2)).sum::<f64>() / n).sqrt();
        // Four standard errors of a mean and of a standard deviation of 400.
        assert!(mean.abs() < 4.0 * all[0].relative_sd / n.sqrt(), "{mean}");
        assert!((sd / all[0].relative_sd - 1.0).abs() < 4.0 / (2.0 * n).sqrt(), "{sd}");
    }

    #[test]
    fn what_is_weighed_has_the_volume_asked_for() {
        for seed in 0..20 {
            let volume = solid_volume(&rig("fill.mass_kg = 0.1", seed)).unwrap();
            assert!((volume.expected_m3 - 0.1 / 2500.0).abs() < 1e-12);
            assert!(volume.excess().abs() < 5.0 * volume.relative_sd, "{volume:?}");
        }
    }
}
