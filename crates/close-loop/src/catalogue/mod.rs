//! The catalogue: effects that a calibrated drum may lack, as data.
//!
//! An entry says which parameter departs from the rig's value, at which two strengths it is
//! simulated first, how far it can go, and which other parameters go along. Entries that cannot
//! act in a rig (end plates of a periodic drum) or that the case frees or marginalises itself are
//! left out. [`Catalogue::with`] adds entries from outside.

use calib::attribution::Layer;
use rig_schema::{CatalogueChoice, Cohesion, Ends, Rig, RollingLaw, Shape, namespace};

use entries::{Draft, drafts};

use crate::error::CloseLoopError;
use crate::scale::Scale;

mod entries;
mod range;

/// A contact law that an effect needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Needs {
    /// Nothing beyond the rig's own laws.
    Nothing,
    /// A law of rolling resistance.
    Rolling,
    /// A law of cohesion.
    Cohesion(Cohesion),
}

/// One effect, made ready for one rig.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Path of the parameter in the namespace; the effect's name.
    pub path: String,
    /// Where it acts.
    pub layer: Layer,
    /// The rig's own value: the effect is absent.
    pub null: f64,
    /// Strengths that are simulated first; the last one is the coded unit.
    pub probes: [f64; 2],
    /// Where it is looked for: what is physically possible, or what the case says.
    pub range: (f64, f64),
    /// Coordinate in which it acts about linearly.
    pub scale: Scale,
    /// How fast responses bend over the stronger of the first strengths ([`crate::Axis::roughness`]).
    pub roughness: f64,
    /// Parameters that take the same value.
    pub along: Vec<String>,
    /// Law that it needs.
    pub needs: Needs,
    /// Prior weight.
    pub prior: f64,
    /// Which experiment would show it.
    pub exposed_by: String,
    /// What it is.
    pub meaning: String,
}

impl Effect {
    /// An effect of physics that acts evenly by its path alone.
    pub(crate) fn bare(path: &str) -> Self {
        Self {
            path: path.to_owned(),
            layer: Layer::Physics,
            null: 0.0,
            probes: [0.0, 1.0],
            range: (0.0, 4.0),
            scale: Scale::Linear,
            along: Vec::new(),
            needs: Needs::Nothing,
            roughness: 1.0,
            prior: 1.0,
            exposed_by: String::new(),
            meaning: String::new(),
        }
    }

    /// Size of an error that is small where people look: a ring is found to a fraction of a percent, lines
    /// agree between readers to half a degree, a camera set by eye is level to a degree, a sieve or a caliper
    /// tells a diameter to 5 %, so that twice as much is a standard deviation. A larger error costs what it is
    /// worth against an effect that explains the data as well. `None` for what has no known size.
    pub(crate) fn strength_sd(&self) -> Option<f64> {
        match self.path.as_str() {
            "size.scale" => Some(0.1),
            // Drop tests repeat to 0.05; the speed of impact and what is taken from a like material make it 0.15.
            "restitution.pp" => Some(0.15),
            // A drive that was set wrongly, a bed that was weighed wrongly.
            "speed.scale" | "fill.scale" => Some(0.15),
            "camera.roll_deg" | "camera.pitch_deg" | "camera.yaw_deg" => Some(2.0),
            "measure.scale" => Some(0.01),
            "measure.offset_x_pct"
            | "measure.offset_y_pct"
            | "measure.bias_lin_deg"
            | "measure.bias_mid_deg" => Some(1.0),
            _ => None,
        }
    }

    /// The rig with the effect at a strength.
    ///
    /// # Errors
    /// [`CloseLoopError::Strength`] if the value is outside the parameter's range.
    pub fn apply(&self, rig: &Rig, strength: f64) -> Result<Rig, CloseLoopError> {
        let mut with = rig.clone();
        if strength == self.null {
            return Ok(with);
        }
        match self.needs {
            Needs::Nothing => {}
            Needs::Rolling if with.contact.rolling == RollingLaw::None => {
                with.contact.rolling = RollingLaw::ConstantTorque;
            }
            Needs::Rolling => {}
            Needs::Cohesion(law) => with.contact.cohesion = law,
        }
        for path in std::iter::once(&self.path).chain(&self.along) {
            set(&mut with, path, strength)?;
        }
        let given_step = rig.run.time_step_s.is_some();
        if self.path == "stiffness.scale" && strength > self.null && given_step {
            // A collision ends the sooner the stiffer the particles are.
            let step = rig.settings.value("step.scale").unwrap_or(1.0);
            set(&mut with, "step.scale", step * (self.null / strength).sqrt())?;
        }
        if self.path == "size.scale" && rig.settings.value("fill.count").is_some() {
            // Another size at the same volume: the volume is an effect of its own.
            let fill = rig.settings.value("fill.scale").unwrap_or(1.0);
            set(&mut with, "fill.scale", fill * (self.null / strength).powi(3))?;
        }
        Ok(with)
    }
}

pub(crate) fn set(rig: &mut Rig, path: &str, value: f64) -> Result<(), CloseLoopError> {
    rig.settings
        .set(path, value)
        .map_err(|_| CloseLoopError::Strength { path: path.to_owned(), value })
}

/// Effects that are asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Catalogue {
    /// In no order of merit.
    pub effects: Vec<Effect>,
    /// Effects that were left out, with the reason.
    pub left_out: Vec<(String, String)>,
}

impl Catalogue {
    /// The effects that can act in a rig. `taken` names the parameters that the case frees or
    /// marginalises; they are no candidates.
    pub fn of(rig: &Rig, taken: &[String]) -> Self {
        let mut catalogue = Self { effects: Vec::new(), left_out: Vec::new() };
        for draft in drafts(rig) {
            catalogue.add(rig, &draft, taken);
        }
        catalogue
    }

    /// Add an effect from outside.
    #[must_use]
    pub fn with(mut self, effect: Effect) -> Self {
        self.effects.push(effect);
        self
    }

    /// Leave out effects by name; a name stands for all of its group where it has no dot.
    #[must_use]
    pub fn without(mut self, names: &[String]) -> Self {
        let gone = |path: &str| names.iter().any(|n| stands_for(n, path));
        self.leave_out(gone, "the case leaves it out");
        self
    }

    /// What a case asks for.
    ///
    /// # Errors
    /// As [`Catalogue::over`]; [`CloseLoopError::NothingToTry`] if none of the effects that are asked for can be tried.
    pub fn chosen(self, choice: &CatalogueChoice) -> Result<Self, CloseLoopError> {
        let mut left = self.without(&choice.without);
        if !choice.only.is_empty() {
            left = left.only(&choice.only);
            if left.effects.is_empty() {
                let asked = |path: &str| choice.only.iter().any(|n| stands_for(n, path));
                let why = left.left_out.iter().find(|(path, _)| asked(path));
                let why = why.map_or("the catalogue has no such effect", |(_, why)| why);
                return Err(CloseLoopError::NothingToTry {
                    named: choice.only.join(", "),
                    why: why.to_owned(),
                });
            }
        }
        left.over(&choice.ranges)
    }

    fn leave_out(&mut self, gone: impl Fn(&str) -> bool, why: &str) {
        for e in self.effects.extract_if(.., |e| gone(&e.path)) {
            self.left_out.push((e.path, why.to_owned()));
        }
    }

    /// Keep only the named effects.
    #[must_use]
    pub fn only(mut self, names: &[String]) -> Self {
        let gone = |path: &str| !names.iter().any(|n| stands_for(n, path));
        self.leave_out(gone, "the case does not ask for it");
        self
    }

    fn add(&mut self, rig: &Rig, draft: &Draft<'_>, taken: &[String]) {
        let mut leave = |why: &str| self.left_out.push((draft.path.to_owned(), why.to_owned()));
        if taken.iter().any(|t| t == draft.path) {
            return leave("the case frees or marginalises it");
        }
        if let Some(why) = cannot_act(rig, draft.path) {
            return leave(why);
        }
        let fallback = match draft.path {
            "friction.end_plate" => rig.settings.value("friction.mantle"),
            "restitution.end_plate" => rig.settings.value("restitution.mantle"),
            _ => None,
        };
        let Some(null) = rig.settings.value(draft.path).or(fallback) else {
            return leave("the rig gives it no value");
        };
        let parameter = namespace::find(draft.path);
        let meaning = parameter.map_or("", |p| p.meaning);
        // What suits the size of beads and drum may be more than the parameter allows.
        let allowed = parameter.map_or((f64::NEG_INFINITY, f64::INFINITY), |p| p.range);
        let within = |x: f64| x.clamp(allowed.0, allowed.1);
        let along = draft.along.iter().filter(|a| !taken.iter().any(|t| t == *a));
        let along = along.filter(|a| rig.drum.ends != Ends::Periodic || !a.contains("end_plate"));
        self.effects.push(Effect {
            path: draft.path.to_owned(),
            layer: draft.layer,
            null,
            probes: draft.probes.map(within),
            range: (within(draft.range.0).min(null), within(draft.range.1).max(null)),
            scale: Scale::of(draft.path, draft.range.0),
            along: along.map(|a| (*a).to_owned()).collect(),
            needs: draft.needs,
            roughness: roughness(draft.path),
            prior: 1.0,
            exposed_by: draft.exposed_by.to_owned(),
            meaning: meaning.to_owned(),
        });
    }
}

/// Whether a name in a case means a path: the path itself or its group.
fn stands_for(name: &str, path: &str) -> bool {
    name == path || path.split_once('.').is_some_and(|(group, _)| group == name)
}

/// Why an effect cannot act, if it cannot.
fn cannot_act(rig: &Rig, path: &str) -> Option<&'static str> {
    let group = path.split_once('.').map_or(path, |(g, _)| g);
    let tablet = matches!(rig.particles.shape, Shape::RingTablet(_));
    let periodic = rig.drum.ends == Ends::Periodic;
    match path {
        _ if periodic && path.ends_with("end_plate") => Some("the ends are periodic"),
        "axis.inclination_deg" if periodic => Some("the ends are periodic"),
        "shape.aspect_ratio" if tablet => Some("the form of a tablet is given"),
        "wall_layer.thickness_m" if rig.drum.liner.is_some() => Some("the drum has a liner"),
        // The law of the effect itself, with the strength that the rig gives it, or none, is no other law.
        _ if group == "cohesion"
            && !matches!(rig.contact.cohesion, Cohesion::None | Cohesion::SimplifiedJkr) =>
        {
            Some("the rig has cohesion by another law")
        }
        _ => None,
    }
}

/// How fast responses bend along a parameter. Of 539 runs of fourteen effects in five drums of 560 beads (frictions 0.3 to 0.6),
/// each predicted from those of its effect that were made before it, the likelihood is the best with 1.2, 0.85, 0.85, 0.7
/// for cohesion, asphericity, a spread of sizes, rolling, with 0.25 to 0.35 for the nine others, and with 0.35 for the friction
/// between beads. Other drums may differ, so those have more.
pub(crate) fn roughness(path: &str) -> f64 {
    match path {
        "friction.pp"
        | "friction.kinetic_ratio"
        | "fill.scale"
        | "size.scale"
        | "restitution.pp"
        | "speed.scale"
        | "vibration.amplitude_m"
        | "wall_layer.thickness_m"
        | "drag.coefficient_s"
        | "stiffness.scale" => 0.5,
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::entries::drag_in_air;
    use super::*;

    fn rig(ends: &str) -> Rig {
        Rig::parse(
            "a.toml",
            &format!(
                r#"
name = "a"
drum = {{ radius_m = 0.05, length_m = 0.03, mantle = "g", end_plates = "g", ends = "{ends}" }}
particles = {{ material = "g", shape = {{ sphere = {{ diameter_m = 0.006 }} }} }}
fill.count = 90
friction = {{ pp = 0.5, mantle = 0.6 }}
restitution = {{ pp = 0.7, mantle = 0.7 }}
run = {{ speeds_rpm = [20.0] }}
[materials]
g = {{ density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 1e6 }}
"#
            ),
        )
        .unwrap()
    }

    fn names(c: &Catalogue) -> Vec<&str> {
        c.effects.iter().map(|e| e.path.as_str()).collect()
    }

    #[test]
    fn what_cannot_act_is_left_out_with_a_reason() {
        let closed = Catalogue::of(&rig("turning"), &[]);
        let open = Catalogue::of(&rig("periodic"), &[]);
        assert!(names(&closed).contains(&"axis.inclination_deg"));
        assert!(!names(&open).contains(&"axis.inclination_deg"));
        assert!(
            open.left_out
                .iter()
                .any(|(p, why)| p == "friction.end_plate" && why.contains("periodic"))
        );
    }

    #[test]
    fn a_rig_that_names_the_law_of_cohesion_can_lack_cohesion() {
        let effect = |law: Cohesion, strength: f64| {
            let mut rig = rig("turning");
            rig.contact.cohesion = law;
            if strength > 0.0 {
                rig.settings.set("cohesion.energy_density_j_m3", strength).unwrap();
            }
            let all = Catalogue::of(&rig, &[]).effects;
            all.into_iter().find(|e| e.path == "cohesion.energy_density_j_m3")
        };
        let bare = effect(Cohesion::None, 0.0).unwrap();
        assert_eq!(effect(Cohesion::SimplifiedJkr, 0.0), Some(bare.clone()));
        let given = effect(Cohesion::SimplifiedJkr, 5e3).unwrap();
        assert_eq!((given.null, given.range.0), (5e3, 0.0));
        assert_eq!(given.probes, bare.probes.map(|p| p + 5e3));
        assert_eq!(effect(Cohesion::Jkr, 0.0), None);
    }

    #[test]
    fn freed_parameters_and_groups_are_no_candidates() {
        let c = Catalogue::of(&rig("turning"), &["rolling.pp".to_owned()]);
        assert!(!names(&c).contains(&"rolling.pp"));
        let c = c.without(&["cohesion".to_owned(), "fill.scale".to_owned()]);
        assert!(!names(&c).iter().any(|n| n.starts_with("cohesion") || *n == "fill.scale"));
        assert_eq!(names(&c.only(&["camera".to_owned()])).len(), 3);
    }

    #[test]
    fn every_effect_can_be_set_over_its_whole_range() {
        let mut rig = rig("turning");
        // Air slows beads of 0.3 mm by more than the parameter allows.
        for diameter in [0.006, 0.0003] {
            if let Shape::Sphere(s) = &mut rig.particles.shape {
                s.diameter_m = diameter;
            }
            for e in Catalogue::of(&rig, &[]).effects {
                for s in [e.range.0, e.probes[0], e.null, e.probes[1], e.range.1] {
                    let with = e.apply(&rig, s).unwrap();
                    let same = s == e.null || with.settings == rig.settings;
                    assert_eq!(with == rig, same, "{}", e.path);
                    assert!(s >= e.range.0 && s <= e.range.1, "{} {s}", e.path);
                }
            }
        }
    }

    #[test]
    fn air_slows_large_beads_little_and_small_beads_much() {
        // 6 mm, 2500 kg/m3, 0.99 m/s: Re 396, 60 times less slowed than 0.3 mm (Re 20).
        let mut of = rig("turning");
        assert!((drag_in_air(&of, 0.006) / 0.0366 - 1.0).abs() < 0.01);
        assert!((drag_in_air(&of, 0.0003) / 3.12 - 1.0).abs() < 0.01);
        of.drum.radius_m = 0.2;
        assert!(
            (drag_in_air(&of, 0.006) / drag_in_air(&rig("turning"), 0.006) - 1.55).abs() < 0.02
        );
    }

    #[test]
    fn cohesion_starts_at_a_stated_multiple_of_the_weight() {
        let e = Catalogue::of(&rig("turning"), &[]).effects;
        let e = e.iter().find(|e| e.path == "cohesion.energy_density_j_m3").unwrap();
        // Beads of 6 mm and 2500 kg/m3 weigh 2.77 mN; E* is 1.41 MPa, so five weights press them
        // together by 33 um, over 0.31 mm2: 1.5 weights there are 13 kJ/m3.
        assert!((e.probes[0] - 13_300.0).abs() < 300.0, "{}", e.probes[0]);
    }
}
