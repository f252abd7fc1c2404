//! What is simulated in place of a rig that would take too long.

use campaign::drum_rig::{self, Coarsening, coarse, soft};
use rig_schema::Rig;

/// How near to the rig the simulations are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Fidelity {
    /// As the case asks: the rig itself, or, with `coarse = true`, its coarse and soft stand-in beside the rig itself.
    #[default]
    Case,
    /// The rig with softer particles.
    Soft,
    /// A coarse stand-in with softer particles, shifted by what it is off from a few runs of the soft rig.
    Coarse,
}

/// Overlap over diameter that softer particles have under a bed as deep as the drum's radius.
pub(crate) const OVERLAP: f64 = 0.02;

/// Particles of a coarse stand-in, at most, where the drum leaves the choice.
const PARTICLES: usize = 1000;

/// Particles, at most, of what it is anchored to where a budget is short.
const ANCHORED: usize = 10_000;

/// A change of the rig before it is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct StandIn {
    /// Softer particles.
    pub(crate) soft: bool,
    /// Larger particles, in a slice of the drum where it is long.
    pub(crate) coarse: Option<Coarsening>,
}

impl StandIn {
    /// The rig itself.
    pub(crate) const NONE: Self = Self { soft: false, coarse: None };
    /// Softer particles.
    pub(crate) const SOFT: Self = Self { soft: true, coarse: None };

    /// Softer and larger particles.
    fn coarse(rig: &Rig) -> Result<Self, drum_rig::Error> {
        Ok(Self { soft: true, coarse: Some(Coarsening::default().until(rig, PARTICLES)?) })
    }

    /// Softer particles, and larger ones in the whole drum where there are very many.
    fn finer(rig: &Rig) -> Result<Self, drum_rig::Error> {
        let by = Coarsening { size: 1.0, diameters: 1e9 }.until(rig, ANCHORED)?;
        Ok(Self { soft: true, coarse: (by.size > 1.0).then_some(by) })
    }

    /// What is simulated for a rig, effects included: strengths are those of the rig, and are scaled with it.
    pub(crate) fn of(self, rig: &Rig) -> Result<Rig, drum_rig::Error> {
        let mut with = if self.soft { soft(rig, OVERLAP)? } else { rig.clone() };
        if let Some(by) = self.coarse {
            with = coarse(&with, by)?;
        }
        Ok(with)
    }
}

/// What stands in for what.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cast {
    /// What is simulated.
    pub(crate) everyday: StandIn,
    /// What the everyday runs are shifted to agree with, where they are a coarse stand-in.
    pub(crate) whole: Option<StandIn>,
    /// Runs of the whole rig after the first calibration, the second and the third.
    pub(crate) anchors: [usize; 3],
    /// Whether fresh runs are of the whole rig.
    pub(crate) confirm_whole: bool,
}

impl Cast {
    pub(crate) fn of(
        fidelity: Fidelity,
        asks_coarse: bool,
        rig: &Rig,
    ) -> Result<Self, drum_rig::Error> {
        let alone =
            |everyday| Self { everyday, whole: None, anchors: [0; 3], confirm_whole: false };
        Ok(match fidelity {
            Fidelity::Case if !asks_coarse => alone(StandIn::NONE),
            Fidelity::Case => Self {
                everyday: StandIn::coarse(rig)?,
                whole: Some(StandIn::NONE),
                anchors: [2, 2, 2],
                confirm_whole: true,
            },
            Fidelity::Soft => alone(StandIn::SOFT),
            Fidelity::Coarse => Self {
                everyday: StandIn::coarse(rig)?,
                whole: Some(StandIn::finer(rig)?),
                anchors: [1, 0, 1],
                confirm_whole: false,
            },
        })
    }

    /// Runs of the whole rig to anchor the stand-in.
    pub(crate) fn anchored(&self) -> usize {
        if self.whole.is_some() { self.anchors.iter().sum() } else { 0 }
    }

    /// What a report has to say of it.
    pub(crate) fn assumed(&self) -> Option<String> {
        let share = 100.0 * OVERLAP;
        let softer = format!(
            "softer particles (overlap {share:.0} % of the diameter under a bed as deep as the drum's radius)"
        );
        let size = self.everyday.coarse.map_or(1.0, |by| by.size);
        match self.whole {
            None if self.everyday == StandIn::NONE => None,
            None => Some(format!("The rig was simulated with {softer}.")),
            Some(whole) => {
                let of = match whole {
                    StandIn::NONE => "the rig itself".to_owned(),
                    StandIn { coarse: Some(by), .. } => {
                        format!("the whole drum with softer particles {} times as large", by.size)
                    }
                    StandIn { .. } => "the rig with softer particles".to_owned(),
                };
                let fresh = if self.confirm_whole {
                    "fresh runs are of the rig itself"
                } else {
                    "fresh runs are of the stand-in as well"
                };
                Some(format!(
                    "Effects were simulated on a stand-in with particles {size} times as large and {softer}, shifted by its difference from {} runs of {of} near the calibrated point; {fresh}.",
                    self.anchored()
                ))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig() -> Rig {
        Rig::parse(
            "drum.toml",
            r#"
name = "drum"
contact = { cohesion = "simplified_jkr" }
drum = { radius_m = 0.125, length_m = 0.15, mantle = "soft", end_plates = "glass" }
particles = { material = "glass", shape = { sphere = { diameter_m = 0.006 } } }
fill.count = 7807
friction = { pp = 0.5, mantle = 0.6 }
restitution = { pp = 0.9, mantle = 0.85 }
cohesion = { energy_density_j_m3 = 1e4 }
run = { speeds_rpm = [20.0], time_step_s = 7e-5 }
[materials]
glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e7 }
soft = { density_kg_m3 = 1190.0, poisson_ratio = 0.37, shear_modulus_pa = 1e5 }
"#,
        )
        .unwrap()
    }

    #[test]
    fn a_stand_in_keeps_the_bond_number_and_the_share_of_the_rayleigh_time() {
        let given = rig();
        let soft = StandIn::SOFT.of(&given).unwrap();
        let [stiff, softer] = [&given, &soft].map(|r| r.materials["glass"].shear_modulus_pa);
        assert!((stiff / softer - 21.9).abs() < 0.1, "{}", stiff / softer);
        // Nothing is made stiffer than it is.
        assert_eq!(soft.materials["soft"], given.materials["soft"]);
        // The given step, two thirds of the Rayleigh time, would become 0.33 ms; the solver's own is a fifth,
        // and 0.7 of that where grains cohere.
        let step = soft.run.time_step_s.unwrap();
        assert!((step / (0.7 * 95e-6) - 1.0).abs() < 0.01, "{step}");
        let mut short = given.clone();
        short.run.time_step_s = Some(1e-5);
        let step = StandIn::SOFT.of(&short).unwrap().run.time_step_s.unwrap();
        assert!((step / 1e-5 - (stiff / softer).sqrt()).abs() < 1e-12);
        // Under one load overlaps, and with them contact areas, grow by 21.9^(2/3).
        let energy = |r: &Rig| r.settings.value("cohesion.energy_density_j_m3").unwrap();
        assert!((energy(&given) / energy(&soft) - 21.9_f64.powf(2.0 / 3.0)).abs() < 0.05);
        let coarse = StandIn::coarse(&given).unwrap().of(&given).unwrap();
        // 7807 x 0.56 / 1.75^3 = 816 beads.
        assert!((energy(&coarse) / energy(&soft) - 1.75).abs() < 1e-12);
        assert_eq!(StandIn::NONE.of(&given).unwrap(), given);
    }

    #[test]
    fn what_stands_in_is_said() {
        assert_eq!(Cast::of(Fidelity::Case, false, &rig()).unwrap().assumed(), None);
        let asked = Cast::of(Fidelity::Case, true, &rig()).unwrap();
        assert_eq!(asked.anchored(), 6);
        assert!(asked.assumed().unwrap().contains("fresh runs are of the rig itself"));
        let cheap = Cast::of(Fidelity::Coarse, false, &rig()).unwrap();
        assert_eq!(cheap.anchored(), 2);
        assert!(cheap.assumed().unwrap().contains("of the stand-in"));
        assert_eq!(Cast::of(Fidelity::Soft, true, &rig()).unwrap().anchored(), 0);
    }
}
