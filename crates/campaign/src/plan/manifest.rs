//! The frozen plan: one row a run, with everything that its result depends on.

use std::collections::BTreeMap;
use std::path::Path;

use drum_rig::{Coarsening, Outline, coarse, outline};
use rig_schema::{Layer, Plan, Rig, namespace};
use serde::{Deserialize, Serialize};

use super::design::{SPEED, points};
use super::file;
use crate::laboratory::key;
use crate::{CampaignError, Observatory, Resolution};

/// Version of the format of a manifest.
const FORMAT: u32 = 1;

/// A coarse stand-in, as it is stored.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coarse {
    /// Factor on the size of the particles.
    pub size: f64,
    /// Length of the slice over the diameter of the enlarged particles.
    pub diameters: f64,
}

impl From<Coarsening> for Coarse {
    fn from(by: Coarsening) -> Self {
        Self { size: by.size, diameters: by.diameters }
    }
}

impl From<Coarse> for Coarsening {
    fn from(by: Coarse) -> Self {
        Self { size: by.size, diameters: by.diameters }
    }
}

/// What is fixed beside the plan when it is frozen.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Freeze {
    /// Size of the frames.
    pub resolution: Resolution,
    /// Simulate coarse stand-ins of the rigs.
    pub coarse: Option<Coarsening>,
}

/// One run: one simulation through one or more speeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Number of the run, from 0.
    pub index: u64,
    /// Values of the factors, in the manifest's order.
    pub values: Vec<f64>,
    /// Speeds, rpm, ascending.
    pub speeds_rpm: Vec<f64>,
    /// Seed: that of the rig plus the number of the motion, so that replicates are independent; runs that differ in
    /// camera or reader alone are of one motion.
    pub seed: u64,
    /// Every parameter that the plan or its factors give, by path.
    pub parameters: BTreeMap<String, f64>,
    /// BLAKE3 of the rig with this row's values, the size of the frames and the version.
    pub hash: String,
}

/// What a manifest stores.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Content {
    format: u32,
    version: String,
    name: String,
    plan: String,
    width_px: u32,
    most_sub_frames: u32,
    coarse: Option<Coarse>,
    factors: Vec<String>,
    rows: Vec<Row>,
}

/// A frozen plan.
///
/// ```
/// use campaign::plan::{Freeze, Manifest};
/// let plan = r#"
/// name = "beads"
/// factors.friction.pp = [0.2, 0.8]
/// factors.run.speed_rpm = [30.0, 60.0]
/// design.full_factorial = { centre_points = 1 }
/// drum = { radius_m = 0.02, length_m = 0.02, mantle = "glass", end_plates = "glass" }
/// particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
/// fill.count = 90
/// friction.mantle = 0.6
/// restitution = { pp = 0.7, mantle = 0.7 }
/// rolling = { pp = 0.01, mantle = 0.01 }
/// run = { speeds_rpm = [60.0] }
/// [materials]
/// glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e6 }
/// "#;
/// let manifest = Manifest::freeze("beads.toml", plan, &Freeze::default())?;
/// assert_eq!(manifest.rows().len(), 5); // 2 x 2 and the centre
/// assert_eq!(manifest.rows()[4].speeds_rpm, [45.0]);
/// # Ok::<(), campaign::CampaignError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    content: Content,
    checksum: String,
    plan: Plan,
}

impl Manifest {
    /// Freeze the text of a plan; `file` is its name for errors.
    ///
    /// # Errors
    /// [`CampaignError::Schema`] with the line of a fault, [`CampaignError::Design`],
    /// [`CampaignError::Row`] for a run whose rig cannot be simulated or filmed.
    pub fn freeze(file: &str, text: &str, how: &Freeze) -> Result<Self, CampaignError> {
        let plan = Plan::parse(file, text)?;
        let frozen = Self::derive(plan, text, how)?;
        for row in frozen.rows() {
            frozen.outline(row).map_err(|e| frozen.of_row(row, e))?;
        }
        Ok(frozen)
    }

    fn derive(plan: Plan, text: &str, how: &Freeze) -> Result<Self, CampaignError> {
        let (factors, points) = points(&plan)?;
        let content = Content {
            format: FORMAT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            name: plan.rig.name.clone(),
            plan: text.to_owned(),
            width_px: how.resolution.width_px,
            most_sub_frames: how.resolution.most_sub_frames,
            coarse: how.coarse.map(Coarse::from),
            factors: factors.into_iter().map(|f| f.path).collect(),
            rows: Vec::new(),
        };
        let mut manifest = Self { content, checksum: String::new(), plan };
        let numbers = motions(&manifest.content.factors, &points);
        for (index, (values, number)) in points.into_iter().zip(numbers).enumerate() {
            let mut row = Row {
                index: index as u64,
                seed: manifest.plan.rig.run.seed.wrapping_add(number),
                values,
                speeds_rpm: Vec::new(),
                parameters: BTreeMap::new(),
                hash: String::new(),
            };
            let rig = manifest.rig(&row).map_err(|e| manifest.of_row(&row, e))?;
            row.speeds_rpm.clone_from(&rig.run.speeds_rpm);
            row.speeds_rpm.sort_by(f64::total_cmp);
            row.parameters = rig.settings.iter().map(|(p, v)| (p.to_owned(), v)).collect();
            let c = &manifest.content;
            let all =
                format!("{FORMAT} {} {} {} {rig:?}", c.version, c.width_px, c.most_sub_frames);
            row.hash = blake3::hash(all.as_bytes()).to_hex().to_string();
            manifest.content.rows.push(row);
        }
        manifest.checksum = file::checksum(&manifest.content)?;
        Ok(manifest)
    }

    /// Read a manifest and derive it anew from the plan that it holds.
    ///
    /// # Errors
    /// [`CampaignError::NoManifest`]; [`CampaignError::Altered`] for a checksum that does not match, another
    /// version, or rows that do not follow from the plan.
    pub fn read(path: &Path) -> Result<Self, CampaignError> {
        let Some(bytes) = file::read(path)? else {
            let folder = path.parent().unwrap_or(path);
            return Err(CampaignError::NoManifest { path: folder.display().to_string() });
        };
        let altered = |problem: String| CampaignError::Altered {
            path: path.display().to_string(),
            problem,
            remedy: "restore the file, or start in another folder",
        };
        let (content, _) = file::unseal::<Content>(path, &bytes)?;
        let ours = env!("CARGO_PKG_VERSION");
        if content.format != FORMAT || content.version != ours {
            return Err(altered(format!(
                "it is of version {} (format {}), this is {ours} (format {FORMAT})",
                content.version, content.format
            )));
        }
        let how = Freeze {
            resolution: Resolution {
                width_px: content.width_px,
                most_sub_frames: content.most_sub_frames,
            },
            coarse: content.coarse.map(Coarsening::from),
        };
        let plan = Plan::parse(&path.display().to_string(), &content.plan)?;
        let anew = Self::derive(plan, &content.plan, &how)?;
        if let Some(difference) = anew.difference(&content) {
            return Err(altered(format!("it does not follow from its own plan: {difference}")));
        }
        Ok(anew)
    }

    /// The manifest as a text with its checksum.
    pub(crate) fn text(&self) -> Result<String, CampaignError> {
        file::seal(&self.content)
    }

    /// First difference to another manifest, `None` for the same runs.
    pub(crate) fn differs_from(&self, other: &Self) -> Option<String> {
        self.difference(&other.content)
    }

    /// First difference to a stored manifest; the plan's comments do not count.
    fn difference(&self, other: &Content) -> Option<String> {
        let ours = &self.content;
        let differ = |what: &str, a: &dyn std::fmt::Debug, b: &dyn std::fmt::Debug| {
            Some(format!("{what} {a:?}, there {b:?}"))
        };
        if ours.factors != other.factors {
            return differ("factors", &ours.factors, &other.factors);
        }
        if (ours.width_px, ours.most_sub_frames) != (other.width_px, other.most_sub_frames) {
            return differ("width of the frames", &ours.width_px, &other.width_px);
        }
        if ours.coarse != other.coarse {
            return differ("coarse stand-in", &ours.coarse, &other.coarse);
        }
        if ours.rows.len() != other.rows.len() {
            return differ("number of runs", &ours.rows.len(), &other.rows.len());
        }
        for (a, b) in ours.rows.iter().zip(&other.rows) {
            if a.values != b.values {
                return differ(&format!("values of run {}", a.index), &a.values, &b.values);
            }
            if a != b {
                let because = a
                    .parameters
                    .iter()
                    .find(|(path, value)| b.parameters.get(*path) != Some(value))
                    .map_or_else(|| "its rig".to_owned(), |(path, _)| format!("`{path}`"));
                return Some(format!("run {} differs in {because}", a.index));
            }
        }
        None
    }

    /// Name of the rig.
    pub fn name(&self) -> &str {
        &self.content.name
    }

    /// BLAKE3 of everything that the manifest holds.
    pub fn checksum(&self) -> &str {
        &self.checksum
    }

    /// Version of the program that froze it.
    pub fn version(&self) -> &str {
        &self.content.version
    }

    /// Paths of the factors.
    pub fn factors(&self) -> &[String] {
        &self.content.factors
    }

    /// The runs.
    pub fn rows(&self) -> &[Row] {
        &self.content.rows
    }

    /// One run by its number.
    ///
    /// # Errors
    /// [`CampaignError::NoSuchRun`].
    pub fn row(&self, index: u64) -> Result<&Row, CampaignError> {
        let last = self.rows().len().saturating_sub(1) as u64;
        let row = usize::try_from(index).ok().and_then(|i| self.rows().get(i));
        row.ok_or(CampaignError::NoSuchRun { index, last })
    }

    /// Size of the frames.
    pub fn resolution(&self) -> Resolution {
        let (width_px, most_sub_frames) = (self.content.width_px, self.content.most_sub_frames);
        Resolution { width_px, most_sub_frames }
    }

    /// The rig of a run.
    ///
    /// # Errors
    /// [`CampaignError::Level`] for a value that its parameter does not take, [`CampaignError::Rig`] where a
    /// rig has no coarse stand-in.
    pub fn rig(&self, row: &Row) -> Result<Rig, CampaignError> {
        let mut rig = self.plan.rig.clone();
        rig.run.seed = row.seed;
        for (path, &value) in self.content.factors.iter().zip(&row.values) {
            if path == SPEED {
                rig.run.speeds_rpm = vec![value];
                continue;
            }
            rig.settings.set(path, value).map_err(|refused| CampaignError::Level {
                path: path.clone(),
                value,
                expected: match refused {
                    Some(p) => format!("{} to {} {}", p.range.0, p.range.1, p.unit),
                    None => format!("a known parameter, such as {}", namespace::nearest(path)),
                },
            })?;
        }
        Ok(match self.content.coarse {
            Some(by) => coarse(&rig, by.into())?,
            None => rig,
        })
    }

    /// Runs of one motion, in their order: they differ in camera or reader alone, so one simulation serves them.
    ///
    /// # Errors
    /// As [`Manifest::rig`], and those of a camera that cannot be set up.
    pub(crate) fn of_one_motion(&self, row: &Row) -> Result<Vec<&Row>, CampaignError> {
        let seeded: Vec<&Row> = self.rows().iter().filter(|r| r.seed == row.seed).collect();
        if seeded.len() == 1 {
            return Ok(seeded);
        }
        // An exposure is the camera's, but decides at which instants a motion is sampled.
        let own = self.motion(row)?;
        let mut same = Vec::new();
        for other in seeded {
            if self.motion(other)? == own {
                same.push(other);
            }
        }
        Ok(same)
    }

    fn motion(&self, row: &Row) -> Result<blake3::Hash, CampaignError> {
        let rig = self.rig(row)?;
        let options = Observatory::new(&rig, self.resolution())?.options(1);
        Ok(key::motion(&rig, &options))
    }

    /// Size of a run's simulation, and whether it can be simulated and filmed at all.
    ///
    /// # Errors
    /// Parameters that cannot act, no particle, particles that do not fit, a camera that does not see
    /// the drum.
    pub fn outline(&self, row: &Row) -> Result<Outline, CampaignError> {
        let rig = self.rig(row)?;
        let observatory = Observatory::new(&rig, self.resolution())?;
        Ok(outline(&rig, &observatory.options(1))?)
    }

    /// Values of a run's factors for people.
    pub fn describe(&self, row: &Row) -> String {
        let pairs = self.factors().iter().zip(&row.values);
        pairs.map(|(path, value)| format!("{path} = {value}")).collect::<Vec<_>>().join(", ")
    }

    fn of_row(&self, row: &Row, source: CampaignError) -> CampaignError {
        let values = self.describe(row);
        CampaignError::Row { index: row.index, values, source: Box::new(source) }
    }
}

/// Number of each point's motion: points that differ in camera or reader alone have one, those that are equal in
/// everything are replicates.
fn motions(factors: &[String], points: &[Vec<f64>]) -> Vec<u64> {
    let moves: Vec<bool> = factors
        .iter()
        .map(|path| namespace::find(path).is_none_or(|p| p.layer == Layer::Physics))
        .collect();
    let mut seen: BTreeMap<Vec<u64>, u64> = BTreeMap::new();
    let mut numbers: BTreeMap<(Vec<u64>, u64), u64> = BTreeMap::new();
    let number = |values: &Vec<f64>| {
        let bits: Vec<u64> = values.iter().map(|v| v.to_bits()).collect();
        let physics = bits.iter().zip(&moves).filter(|(_, m)| **m).map(|(b, _)| *b).collect();
        let replicate = seen.entry(bits).and_modify(|n| *n += 1).or_insert(0);
        let next = numbers.len() as u64;
        *numbers.entry((physics, *replicate)).or_insert(next)
    };
    points.iter().map(number).collect()
}
