//! A rig as other codes see it: what they know of it, in their terms.

use drum_rig::dem_core::contact::normal::AttractiveTail;
use drum_rig::dem_core::contact::normal::restitution::{damping_ratio, restitution_of};
use drum_rig::dem_core::glam::{DQuat, DVec3};
use drum_rig::{Experiment, GRAVITY};
use rig_schema::{Cohesion, Ends, NormalLaw, Rig, RollingLaw, Shape, TangentialLaw, namespace};

use super::Code;
use crate::CampaignError;

/// Angle by which gravity is tilted while the bed settles, degrees: that of the rig's own start.
const SETTLING_TILT_DEG: f64 = 25.0;

/// One value each for beads with each other, the mantle and the end plates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PerPair {
    pub(super) pp: f64,
    pub(super) mantle: f64,
    pub(super) end_plate: f64,
}

impl PerPair {
    /// In the order of the types: beads, mantle, end plates.
    pub(super) fn all(&self) -> [f64; 3] {
        [self.pp, self.mantle, self.end_plate]
    }
}

/// Young's modulus and Poisson's ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Elastic {
    pub(super) young: f64,
    pub(super) poisson: f64,
}

impl Elastic {
    /// Effective moduli `E*` and `G*` of a pair, Pa.
    pub(super) fn with(&self, other: &Self) -> (f64, f64) {
        let plane = |e: &Self| (1.0 - e.poisson * e.poisson) / e.young;
        let shear = |e: &Self| 2.0 * (2.0 - e.poisson) * (1.0 + e.poisson) / e.young;
        (1.0 / (plane(self) + plane(other)), 1.0 / (shear(self) + shear(other)))
    }
}

/// Least restitution that LIGGGHTS takes; LAMMPS is held to the same.
const LEAST_RESTITUTION: f64 = 0.05;

impl PerPair {
    /// The restitution that a code is asked for where a rig has these. LIGGGHTS and LAMMPS work out their damping
    /// as if it could pull; where it may not, beads leave each other sooner and rebound faster. YADE's own formula
    /// knows that.
    fn asked_of(&self, code: Code, tail: bool) -> Result<Self, CampaignError> {
        if tail || code == Code::Yade {
            return Ok(*self);
        }
        let one = |e: f64| {
            let ratio = damping_ratio(e, AttractiveTail::Cut).map_err(drum_rig::Error::from)?;
            let kept = restitution_of(ratio, AttractiveTail::Kept);
            if kept < LEAST_RESTITUTION {
                return Err(CampaignError::NotExported {
                    code: code.name(),
                    what: format!("a restitution of {e} by damping that never pulls"),
                    expected: "0.22 or more, or contact.attractive_tail = true",
                });
            }
            Ok(kept)
        };
        let (pp, mantle, end_plate) = (one(self.pp)?, one(self.mantle)?, one(self.end_plate)?);
        Ok(Self { pp, mantle, end_plate })
    }
}

/// What a deck is made of.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scene {
    pub(super) name: String,
    pub(super) radius: f64,
    pub(super) length: f64,
    pub(super) ends: Ends,
    /// Beads, mantle, end plates.
    pub(super) elastic: [Elastic; 3],
    pub(super) friction: PerPair,
    pub(super) rolling: PerPair,
    /// What the code is asked for, so that it damps as the rig does.
    pub(super) restitution: PerPair,
    pub(super) rolls: bool,
    /// Cohesion energy density, J/m3; `None` without cohesion.
    pub(super) cohesion: Option<PerPair>,
    /// Whether damping may pull.
    pub(super) tail: bool,
    /// Gravity, m/s2, and while the bed settles.
    pub(super) gravity: DVec3,
    pub(super) settling_gravity: DVec3,
    pub(super) speed_scale: f64,
}

impl Scene {
    pub(super) fn of(rig: &Rig, code: Code) -> Result<Self, CampaignError> {
        refuse(rig, code)?;
        let value = |path: &'static str| -> Result<f64, CampaignError> {
            rig.settings.value(path).ok_or_else(|| {
                let meaning = namespace::find(path).map_or("a value", |p| p.meaning);
                drum_rig::Error::Missing { path, meaning }.into()
            })
        };
        let pair = |pp, mantle, end_plate: &str| -> Result<PerPair, CampaignError> {
            let mantle = value(mantle)?;
            let end_plate = rig.settings.value(end_plate).unwrap_or(mantle);
            Ok(PerPair { pp: value(pp)?, mantle, end_plate })
        };
        let mut friction = pair("friction.pp", "friction.mantle", "friction.end_plate")?;
        friction.mantle *= value("wall_layer.friction_ratio")?;
        let elastic = |name: &str, role: &'static str, scale: f64| {
            let m = rig
                .materials
                .get(name)
                .ok_or_else(|| drum_rig::Error::UnknownMaterial { role, name: name.to_owned() })?;
            let young = 2.0 * (1.0 + m.poisson_ratio) * m.shear_modulus_pa * scale;
            Ok::<_, CampaignError>(Elastic { young, poisson: m.poisson_ratio })
        };
        let rolls = rig.contact.rolling != RollingLaw::None;
        let rolling = if rolls {
            pair("rolling.pp", "rolling.mantle", "rolling.end_plate")?
        } else {
            PerPair { pp: 0.0, mantle: 0.0, end_plate: 0.0 }
        };
        let cohesion = if rig.contact.cohesion == Cohesion::SimplifiedJkr {
            let pp = value("cohesion.energy_density_j_m3")?;
            let wall = pp * value("cohesion.wall_ratio")?;
            Some(PerPair { pp, mantle: wall, end_plate: wall })
        } else {
            None
        };
        let restitution = pair("restitution.pp", "restitution.mantle", "restitution.end_plate")?;
        let lean = value("axis.inclination_deg")?.to_radians();
        let gravity = -GRAVITY * DVec3::new(0.0, lean.cos(), lean.sin());
        let tilt = DQuat::from_rotation_z(SETTLING_TILT_DEG.to_radians());
        Ok(Self {
            name: rig.name.replace(['\n', '\r'], " "),
            radius: rig.drum.radius_m - value("wall_layer.thickness_m")?,
            length: rig.drum.length_m,
            ends: rig.drum.ends,
            elastic: [
                elastic(&rig.particles.material, "particles", value("stiffness.scale")?)?,
                elastic(&rig.drum.mantle, "mantle", 1.0)?,
                elastic(&rig.drum.end_plates, "end plates", 1.0)?,
            ],
            friction,
            rolling,
            restitution: restitution.asked_of(code, rig.contact.attractive_tail)?,
            rolls,
            cohesion,
            tail: rig.contact.attractive_tail,
            gravity,
            settling_gravity: tilt * gravity,
            speed_scale: value("speed.scale")?,
        })
    }

    /// Drag of the settling bed, 1/s: that of the rig's own start.
    pub(super) fn settling_drag(&self) -> f64 {
        (GRAVITY / self.radius).sqrt()
    }

    /// Half of the box: across, along. Periodic ends are the box's own.
    pub(super) fn half_box(&self, largest: f64) -> (f64, f64) {
        let margin = 2.0 * largest;
        let along = 0.5 * self.length;
        let periodic = self.ends == Ends::Periodic;
        (self.radius + margin, if periodic { along } else { along + margin })
    }

    /// Positions at the start: atom style `granular` of LIGGGHTS, `sphere` of LAMMPS.
    pub(super) fn data(&self, drum: &Experiment) -> String {
        let beads: Vec<_> = drum.exposure().balls(drum.grains()).collect();
        let largest = beads.iter().map(|b| b.radius).fold(0.0, f64::max);
        let (across, along) = self.half_box(largest);
        let mut text = format!(
            "# {}: filled drum, axis z, y up (id type diameter density x y z)\n\n{} atoms\n3 atom types\n\n\
             {} {across} xlo xhi\n{} {across} ylo yhi\n{} {along} zlo zhi\n\nAtoms\n\n",
            self.name,
            beads.len(),
            -across,
            -across,
            -along
        );
        for b in &beads {
            let mass = drum.grains().mass(b.particle as usize);
            let density = mass / (4.0 / 3.0 * std::f64::consts::PI * b.radius.powi(3));
            let c = b.centre;
            // Periodic positions stay inside their box.
            let z = if self.ends == Ends::Periodic {
                c.z - self.length * (c.z / self.length + 0.5).floor()
            } else {
                c.z
            };
            text.push_str(&format!(
                "{} 1 {} {density} {} {} {z}\n",
                b.particle + 1,
                2.0 * b.radius,
                c.x,
                c.y
            ));
        }
        text
    }
}

/// Refuse what a code does not know.
fn refuse(rig: &Rig, code: Code) -> Result<(), CampaignError> {
    let c = &rig.contact;
    let set = |path: &str| {
        let nominal = namespace::find(path).and_then(|p| p.nominal);
        rig.settings.given(path).is_some_and(|v| nominal != Some(v))
    };
    let liggghts = code == Code::Liggghts;
    let cohesive = if liggghts {
        !matches!(c.cohesion, Cohesion::None | Cohesion::SimplifiedJkr)
    } else {
        c.cohesion != Cohesion::None
    };
    let faults: [(bool, &'static str, &'static str); 12] = [
        (!matches!(rig.particles.shape, Shape::Sphere(_)), "particles are clumps", "spheres"),
        (set("shape.aspect_ratio"), "`shape.aspect_ratio` makes clumps", "spheres"),
        (rig.drum.lifters.is_some(), "the drum has lifters", "a plain mantle"),
        (rig.drum.liner.is_some(), "the drum has a liner", "a plain mantle"),
        (c.normal != NormalLaw::Hertz, "its normal law", "contact.normal = \"hertz\""),
        (
            c.tangential != TangentialLaw::Mindlin,
            "its tangential law",
            "contact.tangential = \"mindlin\"",
        ),
        (
            !matches!(c.rolling, RollingLaw::None | RollingLaw::ConstantTorque),
            "its rolling law",
            "contact.rolling = \"none\" or \"constant_torque\"",
        ),
        (
            cohesive,
            "its cohesion",
            if liggghts {
                "contact.cohesion = \"none\" or \"simplified_jkr\""
            } else {
                "contact.cohesion = \"none\""
            },
        ),
        (
            set("friction.kinetic_ratio"),
            "`friction.kinetic_ratio` below 1",
            "one friction, at rest and in motion",
        ),
        (
            code == Code::Yade && c.attractive_tail,
            "`contact.attractive_tail`",
            "contact.attractive_tail = false",
        ),
        (set("vibration.amplitude_m"), "`vibration.amplitude_m`", "no vibration"),
        (set("drag.coefficient_s"), "`drag.coefficient_s`", "no drag"),
    ];
    for (fault, what, expected) in faults {
        if fault {
            return Err(CampaignError::NotExported {
                code: code.name(),
                what: what.to_owned(),
                expected,
            });
        }
    }
    Ok(())
}
