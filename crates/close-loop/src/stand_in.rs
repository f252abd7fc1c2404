//! What is simulated in place of a rig that would take too long.

use campaign::drum_rig::{self, Coarsening, Options, coarse, soft};
use rig_schema::{Ends, Rig};

/// How near to the rig the simulations are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Fidelity {
    /// As the case asks: the rig itself, or, with `coarse = true`, its coarse stand-in, shifted by what it is off from the rig itself.
    #[default]
    Case,
    /// The rig with softer particles, shifted by what it is off from the rig itself unless that takes very many steps.
    Soft,
    /// A coarse stand-in, shifted by what it is off from the rig itself, or from a soft one where that takes very many steps.
    Coarse,
}

/// Overlap over diameter that softer particles have under a bed as deep as the drum's radius.
pub(crate) const OVERLAP: f64 = 0.02;

/// Particles of a coarse stand-in, at most, where the drum leaves the choice.
const PARTICLES: usize = 1000;

/// Length of a drum that is not cut, diameters.
const WHOLE: f64 = 1e9;

/// Particles, at most, of what it is anchored to where a budget is short.
const ANCHORED: usize = 10_000;

/// Steps of a rig over those of its soft stand-in up to which it is what that is held against.
const DEAR: f64 = 4.0;

/// The same from which on softer particles are worth what they change: in the drum of the thesis, at a friction of 0.5 and 17 rpm,
/// both lines read 1.6 and 1.5 deg lower with an overlap of 2 % than with one of 0.26 %.
const WORTH: f64 = 1.5;

/// A change of the rig before it is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct StandIn {
    /// Softer particles.
    pub(crate) soft: bool,
    /// Larger particles, in a slice of a long drum with periodic ends.
    pub(crate) coarse: Option<Coarsening>,
}

impl StandIn {
    /// The rig itself.
    pub(crate) const NONE: Self = Self { soft: false, coarse: None };
    /// Softer particles.
    pub(crate) const SOFT: Self = Self { soft: true, coarse: None };

    /// Larger particles, softer where that saves steps (`saved`, rig over soft). A drum with ends keeps them, and its length: in the drum of the thesis at a
    /// friction of 0.3 the middle line of a slice without them reads 6 to 16 deg lower, that of beads twice as large
    /// -0.2 to 3 deg higher.
    fn coarse(rig: &Rig, saved: f64) -> Result<Self, drum_rig::Error> {
        let by = Coarsening::default();
        let diameters = if rig.drum.ends == Ends::Periodic { by.diameters } else { WHOLE };
        let by = Coarsening { diameters, ..by }.until(rig, PARTICLES)?;
        Ok(Self { soft: saved >= WORTH, coarse: Some(by) })
    }

    /// What a coarse stand-in is held against: the rig itself, with softer particles where it takes very many steps,
    /// and larger ones where there are very many.
    fn finer(rig: &Rig, saved: f64) -> Result<Self, drum_rig::Error> {
        let by = Coarsening { size: 1.0, diameters: WHOLE }.until(rig, ANCHORED)?;
        let coarse = (by.size > 1.0).then_some(by);
        Ok(Self { soft: saved > DEAR, coarse })
    }

    /// Its particles, in words.
    fn described(self) -> String {
        let softer = format!(
            "softer particles (overlap {:.0} % of the diameter under a bed as deep as the drum's radius)",
            100.0 * OVERLAP
        );
        match (self.coarse, self.soft) {
            (Some(by), true) => format!("{softer}, {} times as large", by.size),
            (Some(by), false) => format!("particles {} times as large", by.size),
            (None, true) => softer,
            (None, false) => "particles as they are".to_owned(),
        }
    }

    /// Steps of a rig over those with softer particles.
    fn steps_saved(rig: &Rig) -> Result<f64, drum_rig::Error> {
        let steps = |of: Self| {
            let outline = drum_rig::outline(&of.of(rig)?, &Options::default())?;
            Ok::<_, drum_rig::Error>(outline.least_steps as f64)
        };
        Ok(steps(Self::NONE)? / steps(Self::SOFT)?)
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
    /// What the everyday runs are shifted to agree with, and fresh ones are of.
    pub(crate) whole: Option<StandIn>,
    /// Runs of the whole rig after the first calibration, the second and the third.
    pub(crate) anchors: [usize; 3],
    /// Fillings of fresh runs, where they are fewer than the plan's.
    pub(crate) fresh: Option<usize>,
}

impl Cast {
    pub(crate) fn of(
        fidelity: Fidelity,
        asks_coarse: bool,
        rig: &Rig,
    ) -> Result<Self, drum_rig::Error> {
        let alone = |everyday| Self { everyday, whole: None, anchors: [0; 3], fresh: None };
        let anchored = |everyday, whole| Self {
            everyday,
            whole: Some(whole),
            anchors: [1, 1, 1],
            // Of many particles, so that one filling is much like the next.
            fresh: Some(1),
        };
        if fidelity == Fidelity::Case && !asks_coarse {
            return Ok(alone(StandIn::NONE));
        }
        let saved = StandIn::steps_saved(rig)?;
        Ok(match fidelity {
            Fidelity::Case => Self {
                everyday: StandIn::coarse(rig, saved)?,
                whole: Some(StandIn::NONE),
                anchors: [2, 2, 2],
                fresh: None,
            },
            Fidelity::Soft if saved <= DEAR => anchored(StandIn::SOFT, StandIn::NONE),
            Fidelity::Soft => alone(StandIn::SOFT),
            Fidelity::Coarse => anchored(StandIn::coarse(rig, saved)?, StandIn::finer(rig, saved)?),
        })
    }

    /// Runs of the whole rig to anchor the stand-in.
    pub(crate) fn anchored(&self) -> usize {
        if self.whole.is_some() { self.anchors.iter().sum() } else { 0 }
    }

    /// Runs of the whole rig that are likely: those that anchor, and fresh ones of the base, of three effects that come
    /// closest and of the winner.
    pub(crate) fn whole_runs(&self) -> usize {
        self.anchored() + 5 * self.fresh.unwrap_or(0)
    }

    /// What a report has to say of it.
    pub(crate) fn assumed(&self) -> Option<String> {
        if self.everyday == StandIn::NONE {
            return None;
        }
        let everyday = self.everyday.described();
        let Some(whole) = self.whole else {
            return Some(format!("The rig was simulated with {everyday}."));
        };
        let of = match whole {
            StandIn::NONE => "the rig itself".to_owned(),
            finer => format!("the whole drum with {}", finer.described()),
        };
        let runs = self.anchored();
        Some(format!(
            "Effects were simulated on a stand-in with {everyday}, shifted by its difference from {runs} runs of {of} near the calibrated point; fresh runs are of {of}."
        ))
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
        let standing_for = |rig: &Rig| {
            StandIn::coarse(rig, StandIn::steps_saved(rig).unwrap()).unwrap().of(rig).unwrap()
        };
        let coarse = standing_for(&given);
        // 7807 / 2^3 = 976 beads, in the whole drum with its ends.
        // Softer ones would take as many steps here, so that they are as stiff as they were.
        assert!((energy(&coarse) / energy(&given) - 2.0).abs() < 1e-12);
        assert_eq!(coarse.materials, given.materials);
        assert_eq!((coarse.drum.length_m, coarse.drum.ends), (0.15, Ends::Turning));
        let mut endless = given.clone();
        endless.drum.ends = Ends::Periodic;
        // 7807 x 0.56 / 1.75^3 = 816 beads in a slice of eight diameters.
        let slice = standing_for(&endless);
        assert!((slice.drum.length_m - 0.084).abs() < 1e-12);
        assert_eq!(StandIn::NONE.of(&given).unwrap(), given);
    }

    #[test]
    fn what_stands_in_is_said() {
        assert_eq!(Cast::of(Fidelity::Case, false, &rig()).unwrap().assumed(), None);
        let asked = Cast::of(Fidelity::Case, true, &rig()).unwrap();
        assert_eq!(asked.anchored(), 6);
        assert!(asked.assumed().unwrap().contains("fresh runs are of the rig itself"));
        let cheap = Cast::of(Fidelity::Coarse, false, &rig()).unwrap();
        assert_eq!((cheap.anchored(), cheap.whole_runs()), (3, 8));
        // Its step is long for its stiffness: softer particles save nothing.
        assert!(cheap.assumed().unwrap().contains("fresh runs are of the rig itself"));
        let mut stiff = rig();
        stiff.run.time_step_s = None;
        stiff.materials.get_mut("glass").unwrap().shear_modulus_pa = 2.5e10;
        let cheap = Cast::of(Fidelity::Coarse, false, &stiff).unwrap();
        assert!(cheap.assumed().unwrap().contains("fresh runs are of the whole drum with softer"));
        assert_eq!(Cast::of(Fidelity::Soft, true, &stiff).unwrap().anchored(), 0);
    }
}
