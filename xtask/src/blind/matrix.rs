//! Which answers were right, and what was taken for what.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use super::score::Answer;
use super::sealed::Truth;

/// Members of a class up to which it counts as an answer.
const LARGEST_CLASS: usize = 3;

/// Figures of a blind study.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Summary {
    pub(crate) cases: usize,
    /// Single effects named, alone or in a class of at most three.
    pub(crate) named: (usize, usize),
    /// Drums that lack nothing and are said to.
    pub(crate) nulls: (usize, usize),
    /// Removed effects called unknown.
    pub(crate) unknown: (usize, usize),
    /// Pairs of which both members are named.
    pub(crate) pairs: (usize, usize),
    /// Median share of the error above the noise that named effects remove at held-out speeds.
    pub(crate) removed: Option<f64>,
    pub(crate) matrix: BTreeMap<String, BTreeMap<String, usize>>,
}

/// Whether an answer is right.
pub(crate) fn right(truth: &Truth, answer: &Answer) -> bool {
    let members = &answer.members;
    let has = |path: &String| members.contains(path);
    match truth.kind.as_str() {
        "null" => answer.verdict == "none",
        "removed" => answer.verdict == "unknown",
        "pair" => answer.verdict == "class" && truth.effects.iter().all(|(p, _)| has(p)),
        _ => {
            matches!(answer.verdict.as_str(), "effect" | "class")
                && members.len() <= LARGEST_CLASS
                && truth.effects.iter().all(|(p, _)| has(p))
        }
    }
}

fn name(truth: &Truth) -> String {
    let effects: Vec<&str> = truth.effects.iter().map(|(p, _)| p.as_str()).collect();
    match truth.kind.as_str() {
        "null" => "nothing".to_owned(),
        "removed" => format!("{} (removed)", effects.join(" + ")),
        _ => effects.join(" + "),
    }
}

fn said(answer: &Answer) -> String {
    match answer.verdict.as_str() {
        "none" => "nothing".to_owned(),
        "unknown" => "unknown".to_owned(),
        _ => answer.members.join(" / "),
    }
}

pub(crate) fn summarise(pairs: &[(Truth, Answer)]) -> Summary {
    let of = |kind: &str| {
        let all: Vec<_> = pairs.iter().filter(|(t, _)| t.kind == kind).collect();
        (all.iter().filter(|(t, a)| right(t, a)).count(), all.len())
    };
    let mut removed: Vec<f64> = pairs
        .iter()
        .filter(|(t, a)| t.kind == "single" && right(t, a))
        .filter_map(|(_, a)| a.removed)
        .collect();
    removed.sort_by(f64::total_cmp);
    let mut matrix: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    for (t, a) in pairs {
        *matrix.entry(name(t)).or_default().entry(said(a)).or_default() += 1;
    }
    Summary {
        cases: pairs.len(),
        named: of("single"),
        nulls: of("null"),
        unknown: of("removed"),
        pairs: of("pair"),
        removed: removed.get(removed.len() / 2).copied(),
        matrix,
    }
}

pub(crate) fn markdown(pairs: &[(Truth, Answer)], s: &Summary) -> String {
    let mut text = String::from(
        "| case | code | truth | strength | friction | answer | p | held-out sd before, after | removed | right |\n|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (t, a) in pairs {
        let strengths: Vec<String> = t.effects.iter().map(|(_, v)| format!("{v}")).collect();
        let frictions: Vec<String> = t.frictions.iter().map(|(_, v)| format!("{v}")).collect();
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {:.3} | {:.2}, {:.2} | {} | {} |",
            t.case,
            t.code,
            name(t),
            strengths.join(", "),
            frictions.join(", "),
            said(a),
            a.p,
            a.held_out_sd.0,
            a.held_out_sd.1,
            a.removed.map_or_else(String::new, |r| format!("{:.0} %", 100.0 * r)),
            if right(t, a) { "yes" } else { "no" }
        );
    }
    let _ = writeln!(
        text,
        "\nSingle effects named: {} of {}. Drums that lack nothing: {} of {}. Removed effects called unknown: {} of {}. Pairs: {} of {}. Median share of the error above the noise removed at held-out speeds: {}.",
        s.named.0,
        s.named.1,
        s.nulls.0,
        s.nulls.1,
        s.unknown.0,
        s.unknown.1,
        s.pairs.0,
        s.pairs.1,
        s.removed.map_or_else(|| "none".to_owned(), |r| format!("{:.0} %", 100.0 * r))
    );
    text
}
