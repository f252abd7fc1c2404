//! A plan: a rig with factors and a design.

use serde::Deserialize;

use crate::document::{Document, entries, number};
use crate::rig::known_keys;
use crate::{Rig, SchemaError, namespace};

/// One factor of a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFactor {
    /// Path of the parameter, or `run.speed_rpm`.
    pub path: String,
    /// Levels, ascending.
    pub levels: Vec<f64>,
}

/// How the runs are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DesignKind {
    /// Every combination of the levels, with replicates of the centre.
    FullFactorial {
        /// Runs at the centre point beyond the factorial's own.
        #[serde(default)]
        centre_points: u32,
    },
    /// Optimised Latin hypercube between lowest and highest level.
    LatinHypercube {
        /// Number of runs.
        runs: u32,
    },
}

/// A rig with factors: a table of runs to make.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The experiment at its base.
    pub rig: Rig,
    /// What is varied.
    pub factors: Vec<PlanFactor>,
    /// How the runs are chosen.
    pub design: DesignKind,
}

/// Runs that a design may ask for.
const MOST_RUNS: u32 = 10_000;

/// The path by which rotation speed is a factor.
pub(crate) const SPEED: &str = "run.speed_rpm";

impl Plan {
    /// Read a plan file; `file` is its name for errors.
    ///
    /// # Errors
    /// [`SchemaError::Invalid`] with file, line and the nearest known key.
    pub fn parse(file: &str, text: &str) -> Result<Self, SchemaError> {
        let mut doc = Document::parse(file, text)?;
        let design: toml::Spanned<DesignKind> = doc
            .require("design", "[design] full_factorial = {} or latin_hypercube = { runs = N }")?;
        let (DesignKind::FullFactorial { centre_points: runs }
        | DesignKind::LatinHypercube { runs }) = *design.get_ref();
        if runs > MOST_RUNS {
            return Err(doc.error(
                design.span(),
                format!("a design of {runs} runs"),
                format!("at most {MOST_RUNS}"),
            ));
        }
        let design = design.into_inner();
        let factors = take_factors(&mut doc)?;
        let rig = Rig::take(&mut doc)?;
        doc.finish(&known_keys(&["factors", "design"]))?;
        Ok(Self { rig, factors, design })
    }
}

fn take_factors(doc: &mut Document<'_>) -> Result<Vec<PlanFactor>, SchemaError> {
    let hint = "[factors] friction.pp = [0.1, 0.5, 0.9]";
    let Some(entry) = doc.take_raw("factors") else {
        return Err(doc.error(0..0, "`factors` is missing", hint));
    };
    let mut factors = Vec::new();
    for leaf in leaves(doc, entry)? {
        let span = leaf.value.span();
        let levels = match leaf.value.get_ref() {
            toml::de::DeValue::Array(a) => {
                a.iter().map(|v| number(v.get_ref())).collect::<Option<Vec<f64>>>()
            }
            _ => None,
        };
        let Some(mut levels) = levels.filter(|l| l.len() >= 2) else {
            return Err(doc.error(span, format!("`{}` has no levels", leaf.key), hint));
        };
        let accepted = levels.iter().all(|l| match namespace::find(&leaf.key) {
            Some(p) => p.accepts(*l),
            None => l.is_finite() && *l > 0.0,
        });
        levels.sort_by(f64::total_cmp);
        if !accepted || levels.windows(2).any(|w| w[0] == w[1]) {
            return Err(doc.error(
                span,
                format!("a level of `{}` is out of range or stands twice", leaf.key),
                "different numbers within the parameter's range",
            ));
        }
        factors.push(PlanFactor { path: leaf.key, levels });
    }
    Ok(factors)
}

/// The parameters below a table of groups: `friction.pp = ...` with its full path as key.
pub(crate) fn leaves<'i>(
    doc: &Document<'i>,
    entry: crate::document::Entry<'i>,
) -> Result<Vec<crate::document::Entry<'i>>, SchemaError> {
    let hint = "group.name = ..., for instance friction.pp";
    let span = entry.value.span();
    let toml::de::DeValue::Table(groups) = entry.value.into_inner() else {
        return Err(doc.error(span, format!("`{}` is not a table", entry.key), hint));
    };
    let mut found = Vec::new();
    for group in entries(groups) {
        let span = group.value.span();
        let toml::de::DeValue::Table(names) = group.value.into_inner() else {
            return Err(doc.error(span, format!("`{}` is not a group", group.key), hint));
        };
        for mut leaf in entries(names) {
            leaf.key = format!("{}.{}", group.key, leaf.key);
            if leaf.key != SPEED && namespace::find(&leaf.key).is_none() {
                return Err(doc.error(
                    leaf.key_span,
                    format!("unknown parameter `{}`", leaf.key),
                    format!("nearest known parameter: `{}`", namespace::nearest(&leaf.key)),
                ));
            }
            found.push(leaf);
        }
    }
    Ok(found)
}
