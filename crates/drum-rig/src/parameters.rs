//! Values of the physics parameters, and what cannot act in a given rig.

use rig_schema::{Cohesion, Ends, NormalLaw, Rig, RollingLaw, Shape, namespace};

use crate::error::Error;

/// One value for each kind of pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PerPair {
    pub(crate) pp: f64,
    pub(crate) mantle: f64,
    pub(crate) end_plate: f64,
}

/// Every physics parameter of the namespace, with its value in this rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Physics {
    pub(crate) friction: PerPair,
    pub(crate) kinetic_ratio: f64,
    /// 0: an immediate drop.
    pub(crate) decay_speed: f64,
    pub(crate) rolling: PerPair,
    pub(crate) restitution: PerPair,
    pub(crate) stiffness_scale: f64,
    pub(crate) surface_energy: f64,
    pub(crate) energy_density: f64,
    pub(crate) liquid_fraction: f64,
    pub(crate) surface_tension: f64,
    pub(crate) cohesion_wall_ratio: f64,
    pub(crate) size_scale: f64,
    pub(crate) size_spread: f64,
    pub(crate) aspect_ratio: f64,
    pub(crate) fill: Fill,
    pub(crate) inclination_rad: f64,
    pub(crate) speed_scale: f64,
    /// m; 0: none.
    pub(crate) vibration_amplitude: f64,
    pub(crate) vibration_frequency: f64,
    pub(crate) wall_layer: f64,
    pub(crate) drag: f64,
    pub(crate) step_scale: f64,
}

/// How much is filled in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fill {
    /// Number of particles before rounding.
    Count(f64),
    /// Their mass, kg.
    Mass(f64),
}

impl Physics {
    /// The values of a rig.
    ///
    /// # Errors
    /// [`Error::Missing`] without a nominal value, [`Error::Inactive`] for what cannot act,
    /// [`Error::Contradiction`] for choices that exclude each other.
    pub(crate) fn of(rig: &Rig) -> Result<Self, Error> {
        check_choices(rig)?;
        check_active(rig)?;
        let value = |path| value(rig, path);
        let pair = |pp, mantle, end_plate: &'static str| -> Result<PerPair, Error> {
            let mantle = value(mantle)?;
            let end_plate = rig.settings.value(end_plate).unwrap_or(mantle);
            Ok(PerPair { pp: value(pp)?, mantle, end_plate })
        };
        let mut friction = pair("friction.pp", "friction.mantle", "friction.end_plate")?;
        friction.mantle *= value("wall_layer.friction_ratio")?;
        let scale = value("fill.scale")?;
        let fill = match (rig.settings.value("fill.count"), rig.settings.value("fill.mass_kg")) {
            (Some(count), None) => Fill::Count(count * scale),
            (None, Some(mass)) => Fill::Mass(mass * scale),
            (Some(_), Some(_)) => {
                return Err(Error::Contradiction {
                    first: "fill.count",
                    second: "fill.mass_kg",
                    because: "the fill is given by number or by mass",
                });
            }
            (None, None) => return Err(missing("fill.count")),
        };
        Ok(Self {
            friction,
            kinetic_ratio: value("friction.kinetic_ratio")?,
            decay_speed: value("friction.decay_speed_m_s")?,
            rolling: pair("rolling.pp", "rolling.mantle", "rolling.end_plate")?,
            restitution: pair("restitution.pp", "restitution.mantle", "restitution.end_plate")?,
            stiffness_scale: value("stiffness.scale")?,
            surface_energy: value("cohesion.surface_energy_j_m2")?,
            energy_density: value("cohesion.energy_density_j_m3")?,
            liquid_fraction: value("cohesion.liquid_fraction")?,
            surface_tension: value("cohesion.surface_tension_n_m")?,
            cohesion_wall_ratio: value("cohesion.wall_ratio")?,
            size_scale: value("size.scale")?,
            size_spread: value("size.spread")?,
            aspect_ratio: value("shape.aspect_ratio")?,
            fill,
            inclination_rad: value("axis.inclination_deg")?.to_radians(),
            speed_scale: value("speed.scale")?,
            vibration_amplitude: value("vibration.amplitude_m")?,
            vibration_frequency: value("vibration.frequency_hz")?,
            wall_layer: value("wall_layer.thickness_m")?,
            drag: value("drag.coefficient_s")?,
            step_scale: value("step.scale")?,
        })
    }
}

/// Value of a parameter as given, else nominal.
pub(crate) fn value(rig: &Rig, path: &'static str) -> Result<f64, Error> {
    rig.settings.value(path).ok_or_else(|| missing(path))
}

fn missing(path: &'static str) -> Error {
    let meaning = namespace::find(path).map_or("a value", |p| p.meaning);
    Error::Missing { path, meaning }
}

/// Choices that exclude each other.
fn check_choices(rig: &Rig) -> Result<(), Error> {
    let c = &rig.contact;
    let refuse = |first, second, because| Err(Error::Contradiction { first, second, because });
    if matches!(c.cohesion, Cohesion::Jkr | Cohesion::Dmt) && c.normal != NormalLaw::Hertz {
        return refuse(
            "cohesion by JKR or DMT",
            "a normal law other than Hertz",
            "they are Hertz's law with adhesion, not a pull to be added to another",
        );
    }
    if c.attractive_tail && c.normal == NormalLaw::WaltonBraun {
        return refuse("attractive_tail = true", "normal = walton_braun", "it has no damping");
    }
    if rig.drum.lifters.is_some() && rig.drum.liner.is_some() {
        return refuse("lifters", "a liner", "the liner is the whole inner surface");
    }
    let inclined = rig.settings.value("axis.inclination_deg").is_some_and(|a| a != 0.0);
    if inclined && rig.drum.ends == Ends::Periodic {
        return refuse(
            "an inclined axis",
            "periodic ends",
            "nothing would hold the bed along the axis",
        );
    }
    Ok(())
}

/// Parameters that are given with an effect but cannot have one.
fn check_active(rig: &Rig) -> Result<(), Error> {
    let is = |path: &str, neutral: f64| rig.settings.value(path).is_none_or(|v| v == neutral);
    let c = rig.contact.cohesion;
    let adhesive = matches!(c, Cohesion::Jkr | Cohesion::Dmt);
    let pull = match c {
        Cohesion::None => "",
        Cohesion::Jkr | Cohesion::Dmt => "cohesion.surface_energy_j_m2",
        Cohesion::SimplifiedJkr => "cohesion.energy_density_j_m3",
        Cohesion::Capillary => "cohesion.liquid_fraction",
    };
    let periodic = "the ends are periodic: there are no end plates";
    let no_ends = rig.drum.ends == Ends::Periodic;
    let no_rolling = rig.contact.rolling == RollingLaw::None;
    let rolls = "contact.rolling is none";
    let tablet = matches!(rig.particles.shape, Shape::RingTablet(_));
    let no_liquid = c != Cohesion::Capillary || is("cohesion.liquid_fraction", 0.0);
    let rules: [(bool, &'static str, &'static str); 17] = [
        (no_ends, "friction.end_plate", periodic),
        (no_ends, "rolling.end_plate", periodic),
        (no_ends, "restitution.end_plate", periodic),
        (
            is("friction.kinetic_ratio", 1.0),
            "friction.decay_speed_m_s",
            "friction.kinetic_ratio is 1, so friction does not change with speed",
        ),
        (no_rolling, "rolling.pp", rolls),
        (no_rolling, "rolling.mantle", rolls),
        (no_rolling, "rolling.end_plate", rolls),
        (!adhesive, "cohesion.surface_energy_j_m2", "contact.cohesion is neither jkr nor dmt"),
        (
            c != Cohesion::SimplifiedJkr,
            "cohesion.energy_density_j_m3",
            "contact.cohesion is not simplified_jkr",
        ),
        (c != Cohesion::Capillary, "cohesion.liquid_fraction", "contact.cohesion is not capillary"),
        (
            no_liquid,
            "cohesion.surface_tension_n_m",
            "no capillary bridges: contact.cohesion is not capillary or cohesion.liquid_fraction is 0",
        ),
        (
            c == Cohesion::None || is(pull, 0.0),
            "cohesion.wall_ratio",
            "there is no adhesion between particles that it could be a share of",
        ),
        (tablet, "shape.aspect_ratio", "the particles are tablets, whose form is given"),
        (is("vibration.amplitude_m", 0.0), "vibration.frequency_hz", "vibration.amplitude_m is 0"),
        (is("vibration.frequency_hz", 0.0), "vibration.amplitude_m", "vibration.frequency_hz is 0"),
        (
            rig.drum.liner.is_some(),
            "wall_layer.thickness_m",
            "the drum has a liner, whose form is given",
        ),
        (
            is("friction.mantle", 0.0),
            "wall_layer.friction_ratio",
            "friction.mantle is 0, of which it would be a factor",
        ),
    ];
    for (off, path, because) in rules {
        let Some(value) = rig.settings.given(path) else { continue };
        let nominal = namespace::find(path).and_then(|p| p.nominal);
        if off && nominal != Some(value) {
            return Err(Error::Inactive { path, value, because });
        }
    }
    Ok(())
}
