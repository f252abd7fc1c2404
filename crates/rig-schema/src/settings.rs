//! Values of the parameters in one file.

use std::collections::BTreeMap;

use crate::document::{Document, entries, nearest, number};
use crate::{Layer, Parameter, SchemaError, namespace};

/// What a rig file says of the parameters of the namespace.
///
/// Only given values are stored; [`Settings::value`] falls back on the nominal value.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Settings {
    given: BTreeMap<&'static str, f64>,
}

impl Settings {
    /// Value of a parameter: as given, else nominal, else `None`.
    pub fn value(&self, path: &str) -> Option<f64> {
        self.given.get(path).copied().or_else(|| namespace::find(path)?.nominal)
    }

    /// Value as given, without the fall-back.
    pub fn given(&self, path: &str) -> Option<f64> {
        self.given.get(path).copied()
    }

    /// Set a value; `Err` holds the declaration that refuses it, or `None` for an unknown path.
    pub fn set(&mut self, path: &str, value: f64) -> Result<(), Option<&'static Parameter>> {
        let parameter = namespace::find(path).ok_or(None)?;
        if !parameter.accepts(value) {
            return Err(Some(parameter));
        }
        self.given.insert(parameter.path, value);
        Ok(())
    }

    /// Given values, sorted by path.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.given.iter().map(|(path, value)| (*path, *value))
    }

    /// The given values of some layers.
    #[must_use]
    pub fn of_layers(&self, keep: impl Fn(Layer) -> bool) -> Self {
        let kept = |path: &str| namespace::find(path).is_some_and(|p| keep(p.layer));
        let given = self.given.iter().filter(|(path, _)| kept(path));
        Self { given: given.map(|(path, value)| (*path, *value)).collect() }
    }

    /// Take every group of the namespace from a document.
    pub(crate) fn take(doc: &mut Document<'_>) -> Result<Self, SchemaError> {
        let mut settings = Self::default();
        for group in namespace::groups() {
            let Some(entry) = doc.take_raw(group) else { continue };
            let span = entry.value.span();
            let toml::de::DeValue::Table(table) = entry.value.into_inner() else {
                return Err(doc.error(span, format!("`{group}` is not a table"), "name = number"));
            };
            for entry in entries(table) {
                let path = format!("{group}.{}", entry.key);
                let Some(parameter) = namespace::find(&path) else {
                    return Err(doc.error(
                        entry.key_span,
                        format!("unknown parameter `{path}`"),
                        format!("nearest known parameter: `{}`", nearest_in(group, &path)),
                    ));
                };
                let span = entry.value.span();
                let value = number(entry.value.get_ref())
                    .filter(|v| parameter.accepts(*v))
                    .ok_or_else(|| {
                        let (low, high) = parameter.range;
                        doc.error(
                            span.clone(),
                            format!("`{path}` is not a number in its range"),
                            format!("expected {low} to {high} {}", unit(parameter)),
                        )
                    })?;
                if path == "fill.count" && value.fract() != 0.0 {
                    let what = format!("`fill.count` is {value}");
                    return Err(doc.error(span, what, "a whole number of particles"));
                }
                settings.given.insert(parameter.path, value);
                let fill = ["fill.count", "fill.mass_kg"];
                if fill.contains(&&path[..]) && fill.iter().all(|p| settings.given(p).is_some()) {
                    let expected = "either fill.count or fill.mass_kg";
                    return Err(doc.error(entry.key_span, "the fill is given twice", expected));
                }
            }
        }
        Ok(settings)
    }
}

fn unit(parameter: &Parameter) -> &'static str {
    if parameter.unit == "1" { "(a pure number)" } else { parameter.unit }
}

/// The most alike of the paths in `group`.
fn nearest_in(group: &str, path: &str) -> &'static str {
    let known: Vec<&'static str> =
        namespace::iter().filter(|p| p.group() == group).map(|p| p.path).collect();
    nearest(path, &known)
}
