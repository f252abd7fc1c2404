//! A case: a rig with measured data, free parameters, nuisances and a simulator.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::document::Document;
use crate::load::{self, Load};
use crate::plan::{SPEED, leaves};
use crate::rig::known_keys;
use crate::{Rig, SchemaError, namespace};

/// What `data.code_differences` says where the data are of the code that fits them.
pub const NO_DIFFERENCES: &str = "none";

/// Parameters that may be free at a time: they are searched on a grid.
const MOST_FREE: usize = 3;

/// Where the measured responses are.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Data {
    /// Table of measured responses, relative to the case file.
    pub responses: String,
    /// Independent frames in the mean of one speed (the printed scatter is that of all frames);
    /// 15 where neither the file nor the table says.
    pub n_eff: Option<f64>,
    /// Fillings of the drum that the means of one speed are averages over, 1 where the file does not say: from one
    /// filling to the next a bed lies otherwise than its frames scatter.
    pub fillings: Option<u32>,
    /// Table of what another code says of drums that are alike, relative to the case file, or [`NO_DIFFERENCES`]: the
    /// data may differ from any simulation by as much.
    pub code_differences: Option<String>,
    /// The same drum with other amounts of the same particles.
    #[serde(default)]
    pub loads: Vec<Load>,
}

/// A parameter that is fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Free {
    /// Path.
    pub path: String,
    /// Lowest and highest value that is tried.
    pub range: (f64, f64),
    /// Label of the cases that share this value (same beads on two walls).
    pub shared: Option<String>,
}

/// An uncertain known with a normal prior.
#[derive(Debug, Clone, PartialEq)]
pub struct Nuisance {
    /// Path.
    pub path: String,
    /// Prior mean.
    pub mean: f64,
    /// Prior standard deviation.
    pub sd: f64,
    /// Where the prior comes from.
    pub reason: String,
}

/// Speeds that are not used to fit.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Holdout {
    /// Speeds named one by one, rpm.
    pub speeds_rpm: Vec<f64>,
    /// Every n-th measured speed, counted from the second.
    pub every: Option<u32>,
    /// The lowest and highest speed.
    pub ends: bool,
}

/// Terms of the surrogate over a table of simulated runs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum TableBasis {
    /// Full quadratic in all factors.
    #[default]
    Quadratic,
    /// 1, mu, exp(-mu/m0) in the first free friction; quadratic in the others.
    Saturating {
        /// Friction over which the response saturates.
        m0: f64,
    },
}

/// A table of simulated responses that stands for the simulator.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableSimulator {
    /// The table, relative to the case file.
    pub file: String,
    /// Column of the table to path of the parameter; `omega_rpm` is always the speed.
    pub columns: BTreeMap<String, String>,
    /// Terms of the surrogate.
    #[serde(default)]
    pub basis: TableBasis,
}

/// What stands for the simulator.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Simulator {
    /// A table of given simulated responses.
    Table(TableSimulator),
    /// Our own simulation of the rig.
    Rig {
        /// Simulate a coarse stand-in of the rig.
        #[serde(default)]
        coarse: bool,
    },
}

/// Measured data to be matched by a simulator.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// The experiment.
    pub rig: Rig,
    /// The measured responses.
    pub data: Data,
    /// What is fitted.
    pub free: Vec<Free>,
    /// What is uncertain but known.
    pub nuisance: Vec<Nuisance>,
    /// What is kept aside.
    pub holdout: Holdout,
    /// What predicts responses.
    pub simulator: Simulator,
    /// Which effects are tried when a loop is closed.
    pub catalogue: CatalogueChoice,
}

/// Which effects of the catalogue are tried; a name is a path or a group of paths.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CatalogueChoice {
    /// Only these, where any are named.
    pub only: Vec<String>,
    /// All but these.
    pub without: Vec<String>,
    /// Lowest and highest strength at which an effect is looked for, by its path, where the catalogue's own will not do.
    pub ranges: BTreeMap<String, (f64, f64)>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct CatalogueSpec {
    only: Option<Vec<String>>,
    without: Vec<String>,
    range: BTreeMap<String, BTreeMap<String, Ends>>,
}

/// Lowest and highest value: an array of exactly two numbers. (A tuple takes no notice of a third.)
#[derive(Clone, Copy, Deserialize)]
#[serde(try_from = "Vec<f64>")]
struct Ends(f64, f64);

impl TryFrom<Vec<f64>> for Ends {
    type Error = String;

    fn try_from(all: Vec<f64>) -> Result<Self, String> {
        match all[..] {
            [low, high] => Ok(Self(low, high)),
            _ => Err(format!("a range of {} numbers, expected two, [low, high]", all.len())),
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FreeSpec {
    range: Ends,
    shared: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct NuisanceSpec {
    mean: Option<f64>,
    sd: f64,
    reason: String,
}

impl Case {
    /// Read a case file; `file` is its name for errors.
    ///
    /// # Errors
    /// [`SchemaError::Invalid`] with file, line and the nearest known key.
    pub fn parse(file: &str, text: &str) -> Result<Self, SchemaError> {
        let mut doc = Document::parse(file, text)?;
        let data: toml::Spanned<Data> = doc.require("data", "[data] responses = \"table.csv\"")?;
        let loads = || data.get_ref().loads.iter();
        let n_eff = loads().map(|l| l.n_eff).chain([data.get_ref().n_eff]);
        if n_eff.flatten().any(|n| !(n >= 1.0 && n.is_finite())) {
            return Err(doc.error(data.span(), "n_eff is not a number of frames", "1 or more"));
        }
        let simulator: toml::Spanned<Simulator> = doc.require(
            "simulator",
            "[simulator] table = { file = ..., columns = ... } or rig = {}",
        )?;
        check_simulator(&doc, &simulator)?;
        let table = matches!(simulator.get_ref(), Simulator::Table { .. });
        for fillings in loads().map(|l| l.fillings).chain([data.get_ref().fillings]).flatten() {
            if fillings == 0 {
                return Err(doc.error(
                    data.span(),
                    "fillings is no number of fillings",
                    "1 or more",
                ));
            }
            if table {
                let what = "a table of simulated runs does not say how fillings of a drum differ";
                return Err(doc.error(data.span(), what, "[simulator.rig], or no fillings"));
            }
        }
        if table && loads().len() > 0 {
            let what = "a table of simulated runs is of one load";
            return Err(doc.error(data.span(), what, "[simulator.rig], or no data.loads"));
        }
        let free = take_free(&mut doc)?;
        let nuisance = take_nuisance(&mut doc)?;
        let holdout = take_holdout(&mut doc)?;
        let catalogue = take_catalogue(&mut doc)?;
        let rig = Rig::take(&mut doc)?;
        for own in &data.get_ref().loads {
            load::check(&doc, data.span(), &rig, own)?;
        }
        doc.finish(&known_keys(&[
            "data",
            "free",
            "nuisance",
            "holdout",
            "simulator",
            "catalogue",
        ]))?;
        Ok(Self {
            rig,
            data: data.into_inner(),
            free,
            nuisance,
            holdout,
            simulator: simulator.into_inner(),
            catalogue,
        })
    }

    /// What keeps these measured speeds from being parted as [`Case::holdout`] asks: one that is named and was not measured, or
    /// none that is left to fit.
    pub fn holdout_fault(&self, speeds_rpm: &[f64]) -> Option<String> {
        let known = |s: &f64| speeds_rpm.iter().any(|m| (m - s).abs() < SAME_SPEED);
        if let Some(other) = self.holdout.speeds_rpm.iter().find(|s| !known(s)) {
            let known: Vec<String> = speeds_rpm.iter().map(f64::to_string).collect();
            let known = known.join(", ");
            return Some(format!(
                "`holdout` names {other} rpm, which was not measured: expected one of {known}"
            ));
        }
        let count = speeds_rpm.len();
        let aside = |(k, s): (usize, &f64)| self.holds_out(k, count, *s);
        (count > 0 && speeds_rpm.iter().enumerate().all(aside))
            .then(|| format!("`holdout` leaves none of {count} measured speeds to fit"))
    }

    /// Whether a measured speed is kept aside; `index` counts the measured speeds from 0.
    pub fn holds_out(&self, index: usize, count: usize, omega_rpm: f64) -> bool {
        let every =
            self.holdout.every.is_some_and(|n| n > 0 && index % n as usize == 1 % n as usize);
        let end = self.holdout.ends && (index == 0 || index + 1 == count);
        every || end || self.holdout.speeds_rpm.iter().any(|s| (s - omega_rpm).abs() < SAME_SPEED)
    }
}

/// Difference of two speeds that are one, rpm.
const SAME_SPEED: f64 = 1e-9;

fn take_holdout(doc: &mut Document<'_>) -> Result<Holdout, SchemaError> {
    let Some(holdout) = doc.take::<toml::Spanned<Holdout>>("holdout")? else {
        return Ok(Holdout::default());
    };
    let own = holdout.get_ref();
    if !own.speeds_rpm.iter().all(|s| s.is_finite() && *s > 0.0) {
        let what = "a speed that is kept aside is none";
        return Err(doc.error(holdout.span(), what, "speeds above 0 rpm"));
    }
    if own.every.is_some_and(|n| n < 2) {
        let what = "`every` leaves no speed to fit, or keeps none aside";
        return Err(doc.error(holdout.span(), what, "2 or more: every second speed, every third"));
    }
    Ok(holdout.into_inner())
}

fn check_simulator(
    doc: &Document<'_>,
    simulator: &toml::Spanned<Simulator>,
) -> Result<(), SchemaError> {
    let Simulator::Table(table) = simulator.get_ref() else { return Ok(()) };
    for path in table.columns.values() {
        if namespace::find(path).is_none() {
            return Err(doc.error(
                simulator.span(),
                format!("unknown parameter `{path}`"),
                format!("nearest known parameter: `{}`", namespace::nearest(path)),
            ));
        }
    }
    if let TableBasis::Saturating { m0 } = table.basis
        && !(m0 > 0.0 && m0.is_finite())
    {
        return Err(doc.error(simulator.span(), "m0 is not a friction", "a number above 0"));
    }
    Ok(())
}

fn take_catalogue(doc: &mut Document<'_>) -> Result<CatalogueChoice, SchemaError> {
    let Some(choice) = doc.take::<toml::Spanned<CatalogueSpec>>("catalogue")? else {
        return Ok(CatalogueChoice::default());
    };
    let mut ranges = BTreeMap::new();
    for (group, own) in &choice.get_ref().range {
        for (name, Ends(low, high)) in own {
            ranges.insert(format!("{group}.{name}"), (*low, *high));
        }
    }
    let CatalogueSpec { only, without, .. } = choice.get_ref();
    if only.as_ref().is_some_and(Vec::is_empty) {
        return Err(doc.error(
            choice.span(),
            "`only` names no effect",
            "at least one, or no `only`: then all are tried",
        ));
    }
    let both = only.iter().flatten().find(|n| without.contains(n));
    if let Some(name) = both {
        return Err(doc.error(
            choice.span(),
            format!("`{name}` is asked for and left out"),
            "an effect in `only` or in `without`",
        ));
    }
    let named = only.iter().flatten().chain(without);
    let named = named.chain(ranges.keys());
    let known = |name: &String| {
        namespace::find(name).is_some() || namespace::groups().contains(&name.as_str())
    };
    if let Some(name) = named.into_iter().find(|n| !known(n)) {
        return Err(doc.error(
            choice.span(),
            format!("unknown effect `{name}`"),
            format!(
                "a parameter or a group; the nearest parameter is `{}`",
                namespace::nearest(name)
            ),
        ));
    }
    for (path, (low, high)) in &ranges {
        let accepted = namespace::find(path).is_some_and(|p| p.accepts(*low) && p.accepts(*high));
        if !(low < high && accepted) {
            return Err(doc.error(
                choice.span(),
                format!("the effect `{path}` cannot be looked for from {low} to {high}"),
                "range.group.name = [low, high], both within the parameter's own range",
            ));
        }
    }
    let CatalogueSpec { only, without, .. } = choice.into_inner();
    Ok(CatalogueChoice { only: only.unwrap_or_default(), without, ranges })
}

fn take_free(doc: &mut Document<'_>) -> Result<Vec<Free>, SchemaError> {
    let hint = "[free] friction.pp = { range = [0.1, 0.9] }";
    let Some(entry) = doc.take_raw("free") else {
        return Err(doc.error(0..0, "`free` is missing", hint));
    };
    let whole = entry.key_span.clone();
    let mut free = Vec::new();
    for leaf in leaves(doc, entry)? {
        let span = leaf.value.span();
        let spec: FreeSpec = doc.convert(leaf.value)?;
        let Ends(low, high) = spec.range;
        let accepted = leaf.key != SPEED
            && namespace::find(&leaf.key).is_some_and(|p| p.accepts(low) && p.accepts(high));
        if !(low < high && accepted) {
            return Err(doc.error(
                span,
                format!("`{}` cannot be fitted in this range", leaf.key),
                "range = [low, high], both within the parameter's own range",
            ));
        }
        free.push(Free { path: leaf.key, range: (low, high), shared: spec.shared });
    }
    if !(1..=MOST_FREE).contains(&free.len()) {
        return Err(doc.error(
            whole,
            format!("{} parameters are free", free.len()),
            format!("1 to {MOST_FREE}, for instance {hint}"),
        ));
    }
    Ok(free)
}

fn take_nuisance(doc: &mut Document<'_>) -> Result<Vec<Nuisance>, SchemaError> {
    let Some(entry) = doc.take_raw("nuisance") else { return Ok(Vec::new()) };
    let mut nuisance = Vec::new();
    for leaf in leaves(doc, entry)? {
        let span = leaf.value.span();
        let spec: NuisanceSpec = doc.convert(leaf.value)?;
        let parameter = namespace::find(&leaf.key);
        let mean = spec.mean.or(parameter.and_then(|p| p.nominal)).unwrap_or(0.0);
        let possible = parameter.map_or(mean.is_finite(), |p| p.accepts(mean));
        if !(spec.sd > 0.0 && spec.sd.is_finite() && possible) {
            return Err(doc.error(
                span,
                format!("the prior of `{}` cannot be", leaf.key),
                "a mean within the parameter's range and sd above 0",
            ));
        }
        nuisance.push(Nuisance { path: leaf.key, mean, sd: spec.sd, reason: spec.reason });
    }
    Ok(nuisance)
}
