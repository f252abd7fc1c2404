//! A TOML file taken apart key by key, so that every error knows its place.

use std::ops::Range;

use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

use crate::{Diagnostic, SchemaError};

/// How alike a key must be to one that is missing to be taken for it, of 1.
const ALIKE: f64 = 0.7;

/// One key of a table with its place.
#[derive(Debug, Clone)]
pub(crate) struct Entry<'i> {
    pub(crate) key: String,
    pub(crate) key_span: Range<usize>,
    pub(crate) value: Spanned<DeValue<'i>>,
}

/// A parsed file whose top-level keys are taken one after another.
pub(crate) struct Document<'i> {
    file: &'i str,
    text: &'i str,
    entries: Vec<Entry<'i>>,
}

impl<'i> Document<'i> {
    pub(crate) fn parse(file: &'i str, text: &'i str) -> Result<Self, SchemaError> {
        let table = DeTable::parse(text).map_err(|e| {
            Diagnostic::new(file, text, e.span().unwrap_or(0..0), e.message(), "valid TOML")
        })?;
        Ok(Self { file, text, entries: entries(table.into_inner()) })
    }

    /// An error at `span`.
    pub(crate) fn error(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> SchemaError {
        Diagnostic::new(self.file, self.text, span, message, expected).into()
    }

    /// Take the raw value of a top-level key.
    pub(crate) fn take_raw(&mut self, key: &str) -> Option<Entry<'i>> {
        let at = self.entries.iter().position(|e| e.key == key)?;
        Some(self.entries.remove(at))
    }

    /// Take a top-level key as `T`, if it is there.
    pub(crate) fn take<T: DeserializeOwned>(
        &mut self,
        key: &str,
    ) -> Result<Option<T>, SchemaError> {
        self.take_raw(key).map(|entry| self.convert(entry.value)).transpose()
    }

    /// Take a top-level key as `T`; its absence is an error that says what it is for.
    pub(crate) fn require<T: DeserializeOwned>(
        &mut self,
        key: &str,
        expected: &str,
    ) -> Result<T, SchemaError> {
        if let Some(value) = self.take(key)? {
            return Ok(value);
        }
        // Misspelt rather than missing?
        let alike = |e: &&Entry<'_>| strsim::normalized_damerau_levenshtein(key, &e.key) > ALIKE;
        Err(match self.entries.iter().find(alike) {
            Some(entry) => self.error(
                entry.key_span.clone(),
                format!("unknown key `{}`, and `{key}` is missing", entry.key),
                format!("`{key}`: {expected}"),
            ),
            None => self.error(0..0, format!("`{key}` is missing"), expected),
        })
    }

    /// Convert a value, with the place of what is wrong in it.
    pub(crate) fn convert<T: DeserializeOwned>(
        &self,
        value: Spanned<DeValue<'i>>,
    ) -> Result<T, SchemaError> {
        let whole = value.span();
        T::deserialize(ValueDeserializer::from(value)).map_err(|e| {
            let (message, expected) = readable(e.message());
            self.error(e.span().unwrap_or(whole), message, expected)
        })
    }

    /// Fail if any top-level key was not taken: it would be silently ignored otherwise.
    pub(crate) fn finish(self, known: &[&str]) -> Result<(), SchemaError> {
        let Some(first) = self.entries.first() else { return Ok(()) };
        Err(self.error(
            first.key_span.clone(),
            format!("unknown key `{}`", first.key),
            format!("nearest known key: `{}`", nearest(&first.key, known)),
        ))
    }
}

/// The entries of a table in the order of their keys.
pub(crate) fn entries(table: DeTable<'_>) -> Vec<Entry<'_>> {
    table
        .into_iter()
        .map(|(key, value)| Entry {
            key_span: key.span(),
            key: key.into_inner().into_owned(),
            value,
        })
        .collect()
}

/// A number, from an integer or a float of TOML.
pub(crate) fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(f) => f.as_str().parse().ok(),
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|i| i as f64),
        _ => None,
    }
}

/// The most alike of `known`.
pub(crate) fn nearest<'k>(key: &str, known: &[&'k str]) -> &'k str {
    let key = key.to_lowercase();
    let alike = |k: &&str| strsim::normalized_damerau_levenshtein(&key, &k.to_lowercase());
    known.iter().copied().max_by(|a, b| alike(a).total_cmp(&alike(b))).unwrap_or("(none)")
}

/// Split serde's message into what is wrong and what was expected; name the nearest of the
/// fields or variants that it lists.
fn readable(message: &str) -> (String, String) {
    let Some((wrong, expected)) = message.split_once(", expected ") else {
        return (message.to_owned(), "a value of the schema".to_owned());
    };
    let quoted = |text: &str| -> Vec<String> {
        text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
    };
    let is_name = wrong.starts_with("unknown field") || wrong.starts_with("unknown variant");
    if let (true, Some(given)) = (is_name, quoted(wrong).first()) {
        let known = quoted(expected);
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        let wrong = wrong
            .replace("unknown field", "unknown key")
            .replace("unknown variant", "unknown choice");
        return (
            wrong,
            format!("nearest known: `{}` (all: {})", nearest(given, &known), known.join(", ")),
        );
    }
    (wrong.to_owned(), format!("expected {expected}"))
}
