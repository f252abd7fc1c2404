//! Other loads of a drum: the same particles in another amount.

use serde::Deserialize;

use crate::document::Document;
use crate::{Rig, SchemaError, namespace};

/// How much is in the drum.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Amount {
    /// Number of particles.
    Count(f64),
    /// Mass of particles, kg.
    MassKg(f64),
}

impl Amount {
    /// Path of the parameter, and its value.
    pub fn setting(self) -> (&'static str, f64) {
        match self {
            Self::Count(n) => ("fill.count", n),
            Self::MassKg(m) => ("fill.mass_kg", m),
        }
    }
}

/// Measured responses of the rig with another amount in it.
///
/// What a friction makes up for with one load it does not with another, so that two loads tell effects apart that one
/// cannot.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Load {
    /// Table of measured responses, relative to the case file.
    pub responses: String,
    /// The amount, told as the rig tells its own.
    pub fill: Amount,
    /// Independent frames in the mean of one speed, as in [`crate::Data`].
    pub n_eff: Option<f64>,
    /// Fillings that the means of one speed are averages over, as in [`crate::Data`].
    pub fillings: Option<u32>,
}

impl Load {
    /// The rig with this load; as it is where the amount is out of range, which no case that was read has.
    ///
    /// ```
    /// # let text = include_str!("../tests/data/two_loads.toml");
    /// let case = rig_schema::Case::parse("two_loads.toml", text)?;
    /// let half = case.data.loads[0].of(&case.rig);
    /// assert_eq!(half.settings.value("fill.mass_kg"), Some(0.09));
    /// # Ok::<(), rig_schema::SchemaError>(())
    /// ```
    #[must_use]
    pub fn of(&self, rig: &Rig) -> Rig {
        let mut own = rig.clone();
        let (path, value) = self.fill.setting();
        // A case is refused whose loads are out of range.
        let _ = own.settings.set(path, value);
        own
    }
}

/// Whether a drum can hold a load that tells its amount as the rig does.
pub(crate) fn check(
    doc: &Document<'_>,
    span: std::ops::Range<usize>,
    rig: &Rig,
    load: &Load,
) -> Result<(), SchemaError> {
    let (path, value) = load.fill.setting();
    if rig.settings.given(path).is_none() {
        return Err(doc.error(
            span,
            format!("a load is given by {path}, the rig by another measure"),
            "both by fill.count or both by fill.mass_kg",
        ));
    }
    if !namespace::find(path).is_some_and(|p| p.accepts(value)) {
        return Err(doc.error(
            span,
            format!("{path} = {value} is no load of a drum"),
            "an amount within the parameter's range",
        ));
    }
    if rig.settings.given(path) == Some(value) {
        let what = format!("a load of {path} = {value} is that of the rig itself");
        return Err(doc.error(span, what, "another amount, or its rows in data.responses"));
    }
    Ok(())
}
