//! The experiment: drum, particles, materials, contact laws, run.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::document::{Document, nearest};
use crate::{Layer, SchemaError, Settings, namespace};

/// A drum.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drum {
    /// Inner radius, m.
    pub radius_m: f64,
    /// Inner length along the axis, m.
    pub length_m: f64,
    /// Material of the mantle, a key of `[materials]`.
    pub mantle: String,
    /// Material of the end plates, a key of `[materials]`.
    pub end_plates: String,
    /// What closes the drum at its ends.
    #[serde(default)]
    pub ends: Ends,
    /// Bars on the mantle.
    pub lifters: Option<Lifters>,
    /// Inner surface as a mesh (STL), instead of the plain mantle; path relative to the file.
    pub liner: Option<String>,
}

/// Ends of the drum.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// Plates that turn with the drum.
    #[default]
    Turning,
    /// Plates that stand still.
    Still,
    /// No plates: periodic along the axis.
    Periodic,
}

/// Straight bars along the mantle.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lifters {
    /// Number of bars, evenly spaced.
    pub count: u32,
    /// Height above the mantle, m.
    pub height_m: f64,
    /// Width along the circumference, m.
    pub width_m: f64,
}

/// Particles.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Particles {
    /// Material, a key of `[materials]`.
    pub material: String,
    /// Form of one particle.
    pub shape: Shape,
    /// Measured mass of one particle, kg; from density and volume where not given.
    pub mass_kg: Option<f64>,
}

/// Form of a particle.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// A tablet of overlapping spheres: a ring and a middle sphere.
    RingTablet(RigidRing),
}

/// A sphere.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Mean diameter, m.
    pub diameter_m: f64,
}

/// Spheres on a ring round a middle sphere.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigidRing {
    /// Number of spheres on the ring.
    pub ring_spheres: u32,
    /// Their radius, m.
    pub sphere_radius_m: f64,
    /// Radius of the ring of their centres, m.
    pub ring_radius_m: f64,
    /// Radius of the middle sphere, m; none where not given.
    pub middle_radius_m: Option<f64>,
}

/// Constants of a material.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Shear modulus, Pa.
    pub shear_modulus_pa: f64,
}

/// Contact laws by name.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Contact {
    /// Normal law.
    pub normal: NormalLaw,
    /// Tangential law.
    pub tangential: TangentialLaw,
    /// Rolling law.
    pub rolling: RollingLaw,
    /// Cohesion law.
    pub cohesion: Cohesion,
    /// Whether damping may pull (the attractive tail of equations 14-17).
    pub attractive_tail: bool,
}

/// Normal law.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NormalLaw {
    /// Hertz with damping that gives the asked restitution.
    #[default]
    Hertz,
    /// Linear spring and dashpot.
    LinearSpringDashpot,
    /// Walton and Braun's hysteretic springs.
    WaltonBraun,
}

/// Tangential law.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TangentialLaw {
    /// Mindlin no-slip, incremental.
    #[default]
    Mindlin,
    /// Mindlin no-slip as a total spring: compatible with EDEM, does not conserve energy.
    MindlinTotalSpring,
    /// Mindlin and Deresiewicz.
    MindlinDeresiewicz,
    /// Linear spring of Cundall and Strack.
    LinearSpring,
    /// Walton and Braun.
    WaltonBraun,
}

/// Rolling law.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RollingLaw {
    /// None.
    None,
    /// Constant torque on the relative rolling.
    #[default]
    ConstantTorque,
    /// Viscous, capped (Zhou).
    ViscousCapped,
    /// Elastic-plastic spring and dashpot (Iwashita and Oda).
    SpringDashpot,
    /// Zhu's modification.
    Zhu,
    /// Constant torque on the absolute spin: compatible with EDEM, not frame-indifferent.
    AbsoluteSpin,
}

/// Cohesion law.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cohesion {
    /// None.
    #[default]
    None,
    /// Johnson, Kendall and Roberts.
    Jkr,
    /// Derjaguin, Muller and Toporov.
    Dmt,
    /// Simplified JKR: energy density times contact area.
    SimplifiedJkr,
    /// Capillary bridges.
    Capillary,
}

/// Spheres on a ring, at most: the volume of a union of more takes minutes.
const MOST_SPHERES: u32 = 200;

/// How the experiment is run.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Rotation speeds, one run or stage each, rpm.
    pub speeds_rpm: Vec<f64>,
    /// Time step, s; the solver's own limit where not given.
    pub time_step_s: Option<f64>,
    /// Seed of everything random.
    #[serde(default)]
    pub seed: u64,
    /// Frames to take at each speed.
    #[serde(default = "thirty")]
    pub frames: u32,
}

fn thirty() -> u32 {
    30
}

impl Run {
    /// Speeds of drums: a turn of the slowest takes most of a day.
    const SPEEDS_RPM: std::ops::RangeInclusive<f64> = 0.001..=10_000.0;

    /// Frames of a speed, at most.
    const MOST_FRAMES: u32 = 1_000_000;

    /// Why it cannot be carried out, and what would do; `None` if it can.
    pub fn fault(&self) -> Option<(String, String)> {
        let fault = |what: &str, expected: &str| Some((what.to_owned(), expected.to_owned()));
        if self.speeds_rpm.is_empty() {
            return fault("no rotation speed is given", "at least one, rpm");
        }
        if let Some(s) = self.speeds_rpm.iter().find(|s| !Self::SPEEDS_RPM.contains(*s)) {
            return fault(&format!("a drum cannot be run at {s} rpm"), "0.001 to 10000 rpm");
        }
        let twice = |(k, s): (usize, &f64)| self.speeds_rpm[..k].contains(s).then_some(*s);
        if let Some(s) = self.speeds_rpm.iter().enumerate().find_map(twice) {
            return fault(&format!("{s} rpm stands twice"), "each speed once");
        }
        if let Some(dt) = self.time_step_s.filter(|dt| !(*dt > 0.0 && dt.is_finite())) {
            return fault(&format!("a time step of {dt} s"), "a time step above 0 s");
        }
        if !(1..=Self::MOST_FRAMES).contains(&self.frames) {
            return fault(&format!("{} frames of a speed", self.frames), "1 to 1000000 frames");
        }
        None
    }
}

/// An experiment in a rotating drum.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// Name for tables and reports.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The drum.
    pub drum: Drum,
    /// The particles.
    pub particles: Particles,
    /// Materials by name.
    pub materials: BTreeMap<String, Material>,
    /// Contact laws.
    pub contact: Contact,
    /// Speeds, time step, seed.
    pub run: Run,
    /// Values of the parameters of the namespace.
    pub settings: Settings,
}

/// Keys of a rig file that are no group of the namespace.
const STRUCTURE: [&str; 7] = ["name", "title", "drum", "particles", "materials", "contact", "run"];

impl Rig {
    /// Read a rig file; `file` is its name for errors.
    ///
    /// # Errors
    /// [`SchemaError::Invalid`] with file, line and the nearest known key.
    pub fn parse(file: &str, text: &str) -> Result<Self, SchemaError> {
        let mut doc = Document::parse(file, text)?;
        let rig = Self::take(&mut doc)?;
        doc.finish(&known_keys(&[]))?;
        Ok(rig)
    }

    /// The rig without its names and without the values of camera and reader: what its motion depends on, beside
    /// how it is sampled.
    ///
    /// ```
    /// # let text = r#"
    /// # name = "beads"
    /// # drum = { radius_m = 0.05, length_m = 0.02, mantle = "glass", end_plates = "glass" }
    /// # particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
    /// # fill.count = 900
    /// # camera.distance_m = 0.8
    /// # run = { speeds_rpm = [30.0], frames = 30 }
    /// # [materials]
    /// # glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 1e6 }
    /// # "#;
    /// let rig = rig_schema::Rig::parse("beads.toml", text)?;
    /// let mut nearer = rig.clone();
    /// nearer.settings.set("camera.distance_m", 0.5).unwrap();
    /// assert_ne!(nearer, rig);
    /// assert_eq!(nearer.motion(), rig.motion());
    /// # Ok::<(), rig_schema::SchemaError>(())
    /// ```
    #[must_use]
    pub fn motion(&self) -> Self {
        let settings = self.settings.of_layers(|layer| layer == Layer::Physics);
        Self { name: String::new(), title: String::new(), settings, ..self.clone() }
    }

    /// Take the rig's keys from a document.
    pub(crate) fn take(doc: &mut Document<'_>) -> Result<Self, SchemaError> {
        let name: toml::Spanned<String> = doc.require("name", "name = \"...\"")?;
        check_name(doc, &name)?;
        let name = name.into_inner();
        let title = doc.take("title")?.unwrap_or_else(|| name.clone());
        let materials: BTreeMap<String, toml::Spanned<Material>> = doc.require(
            "materials",
            "[materials.NAME] with density, Poisson's ratio, shear modulus",
        )?;
        let drum: toml::Spanned<Drum> =
            doc.require("drum", "[drum] with radius_m, length_m, mantle and end_plates")?;
        let particles: toml::Spanned<Particles> =
            doc.require("particles", "[particles] with material and shape")?;
        let contact = doc.take("contact")?.unwrap_or_default();
        let run: toml::Spanned<Run> = doc.require("run", "[run] with speeds_rpm")?;
        let settings = Settings::take(doc)?;
        for (name, own) in &materials {
            let m = own.get_ref();
            let fine = m.density_kg_m3 > 0.0
                && m.shear_modulus_pa > 0.0
                && (-1.0..=0.5).contains(&m.poisson_ratio);
            if !fine {
                return Err(doc.error(
                    own.span(),
                    format!("material `{name}` has an impossible constant"),
                    "density and shear modulus above 0, Poisson's ratio within -1 to 0.5",
                ));
            }
        }
        let materials = materials.into_iter().map(|(name, own)| (name, own.into_inner())).collect();
        check_drum(doc, &drum, &materials)?;
        check_particles(doc, &particles, &materials)?;
        check_run(doc, &run)?;
        if settings.given("fill.count").or(settings.given("fill.mass_kg")).is_none() {
            return Err(doc.error(
                0..0,
                "the fill is not given",
                "either fill.count or fill.mass_kg",
            ));
        }
        Ok(Self {
            name,
            title,
            drum: drum.into_inner(),
            particles: particles.into_inner(),
            materials,
            contact,
            run: run.into_inner(),
            settings,
        })
    }
}

/// All top-level keys: those of a rig, of the namespace, and `more`.
pub(crate) fn known_keys(more: &[&'static str]) -> Vec<&'static str> {
    STRUCTURE.iter().copied().chain(namespace::groups()).chain(more.iter().copied()).collect()
}

fn check_material(
    doc: &Document<'_>,
    span: std::ops::Range<usize>,
    name: &str,
    materials: &BTreeMap<String, Material>,
) -> Result<(), SchemaError> {
    if materials.contains_key(name) {
        return Ok(());
    }
    let known: Vec<&str> = materials.keys().map(String::as_str).collect();
    Err(doc.error(
        span,
        format!("material `{name}` is not in [materials]"),
        format!("nearest: `{}`", nearest(name, &known)),
    ))
}

fn check_drum(
    doc: &Document<'_>,
    drum: &toml::Spanned<Drum>,
    materials: &BTreeMap<String, Material>,
) -> Result<(), SchemaError> {
    let d = drum.get_ref();
    if !(d.radius_m > 0.0 && d.radius_m.is_finite() && d.length_m > 0.0 && d.length_m.is_finite()) {
        return Err(doc.error(
            drum.span(),
            "the drum has no volume",
            "radius_m and length_m above 0",
        ));
    }
    if let Some(l) = d.lifters
        && !(l.height_m > 0.0 && l.height_m < d.radius_m && l.width_m > 0.0 && l.count > 0)
    {
        return Err(doc.error(
            drum.span(),
            "the lifters do not fit",
            "count above 0, height_m between 0 and the radius, width_m above 0",
        ));
    }
    check_material(doc, drum.span(), &d.mantle, materials)?;
    check_material(doc, drum.span(), &d.end_plates, materials)
}

fn check_particles(
    doc: &Document<'_>,
    particles: &toml::Spanned<Particles>,
    materials: &BTreeMap<String, Material>,
) -> Result<(), SchemaError> {
    let p = particles.get_ref();
    let fine = match p.shape {
        Shape::Sphere(s) => s.diameter_m > 0.0,
        Shape::RingTablet(r) => {
            (3..=MOST_SPHERES).contains(&r.ring_spheres)
                && r.sphere_radius_m > 0.0
                && r.ring_radius_m > 0.0
                && r.middle_radius_m.is_none_or(|m| m > 0.0)
        }
    } && p.mass_kg.is_none_or(|m| m > 0.0);
    if !fine {
        return Err(doc.error(
            particles.span(),
            "the particle has no size or mass",
            format!("lengths and mass above 0, 3 to {MOST_SPHERES} spheres on a ring"),
        ));
    }
    check_material(doc, particles.span(), &p.material, materials)
}

fn check_run(doc: &Document<'_>, run: &toml::Spanned<Run>) -> Result<(), SchemaError> {
    match run.get_ref().fault() {
        Some((what, expected)) => Err(doc.error(run.span(), what, expected)),
        None => Ok(()),
    }
}

/// Results are written to a folder of that name.
fn check_name(doc: &Document<'_>, name: &toml::Spanned<String>) -> Result<(), SchemaError> {
    /// Bytes of a name, less than what file systems take, since more is added to it.
    const LONGEST: usize = 100;
    let own = name.get_ref();
    let strange = |c: char| c.is_control() || "/\\:".contains(c);
    if !own.trim().is_empty()
        && own.len() <= LONGEST
        && !own.starts_with('.')
        && !own.contains(strange)
    {
        return Ok(());
    }
    Err(doc.error(
        name.span(),
        format!("`{}` cannot be the name of a folder", own.escape_default()),
        format!(
            "1 to {LONGEST} bytes without /, \\, : and control characters, not beginning with a dot"
        ),
    ))
}
