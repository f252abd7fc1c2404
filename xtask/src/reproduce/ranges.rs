//! The 36 friction ranges that the author read from contour plots, beside ours.

use std::collections::BTreeMap;

use calib::{Basis, M0, Match, ResponseSet, Study};
use rig_schema::ErrataLevel;
use serde::Serialize;

use super::{records, study};

/// One estimate.
#[derive(Serialize, Clone)]
pub(crate) struct Ours {
    pub(crate) value: f64,
    pub(crate) lo: Option<f64>,
    pub(crate) hi: Option<f64>,
    /// Whether the estimate lies within the printed range.
    pub(crate) hit: bool,
    /// Whether the 95 % interval meets the printed range.
    pub(crate) overlaps: bool,
}

/// One range.
#[derive(Serialize)]
pub(crate) struct RangeRow {
    pub(crate) config: String,
    pub(crate) omega_rpm: f64,
    pub(crate) printed_lo: f64,
    pub(crate) printed_hi: f64,
    /// Quadratic surfaces, by the responses that are matched.
    pub(crate) ours: BTreeMap<&'static str, Ours>,
    /// Saturating surfaces: smallest and largest estimate over m0 from 0.07 to 0.4.
    pub(crate) saturating: BTreeMap<&'static str, Ours>,
    pub(crate) saturating_span: (f64, f64),
}

/// Number of the printed ranges that an estimate hits.
#[derive(Serialize)]
pub(crate) struct Hits {
    pub(crate) basis: String,
    pub(crate) responses: &'static str,
    pub(crate) hits: usize,
    pub(crate) overlaps: usize,
    pub(crate) of: usize,
}

/// The m0 in the middle of the range at which all response sets are reported.
const MIDDLE_M0: f64 = 0.2;

fn ours(m: &Match, printed: (f64, f64)) -> Ours {
    let e = &m.estimates[0];
    let (low, high) = (e.lo.unwrap_or(e.range.0), e.hi.unwrap_or(e.range.1));
    Ours {
        value: e.value,
        lo: e.lo,
        hi: e.hi,
        hit: (printed.0..=printed.1).contains(&e.value),
        overlaps: low <= printed.1 && high >= printed.0,
    }
}

fn by_set(
    study: &Study,
    omega: f64,
    printed: (f64, f64),
) -> anyhow::Result<BTreeMap<&'static str, Ours>> {
    let mut all = BTreeMap::new();
    for set in ResponseSet::ALL {
        if let Some(m) = study.at_speed(omega, set)? {
            all.insert(set.key(), ours(&m, printed));
        }
    }
    Ok(all)
}

pub(crate) fn all() -> anyhow::Result<(Vec<RangeRow>, Vec<Hits>)> {
    let mut rows = Vec::new();
    let mut config = String::new();
    let mut quadratic: Option<Study> = None;
    let mut saturating: Vec<(f64, Study)> = Vec::new();
    for r in records("mu_ranges_section5_1.csv")? {
        let (omega, printed) = (r[1].parse::<f64>()?, (r[2].parse::<f64>()?, r[3].parse::<f64>()?));
        if config != r[0] {
            config = r[0].to_owned();
            let study = study(&config, ErrataLevel::Certain)?;
            saturating.clear();
            for m0 in M0 {
                let basis = Basis::Saturating { parameter: "friction.pp".to_owned(), m0 };
                saturating.push((m0, study.with_basis(&basis)?));
            }
            quadratic = Some(study);
        }
        let Some(study) = &quadratic else { continue };
        let mut span = (f64::INFINITY, f64::NEG_INFINITY);
        let mut middle = BTreeMap::new();
        for (m0, s) in &saturating {
            if let Some(m) = s.at_speed(omega, ResponseSet::All)? {
                let value = m.estimates[0].value;
                span = (span.0.min(value), span.1.max(value));
            }
            if *m0 == MIDDLE_M0 {
                middle = by_set(s, omega, printed)?;
            }
        }
        rows.push(RangeRow {
            config: config.clone(),
            omega_rpm: omega,
            printed_lo: printed.0,
            printed_hi: printed.1,
            ours: by_set(study, omega, printed)?,
            saturating: middle,
            saturating_span: span,
        });
    }
    let mut hits = Vec::new();
    for (basis, of) in [("quadratic", 0), ("saturating, m0 0.2", 1)] {
        for set in ResponseSet::ALL {
            let column = |r: &RangeRow| {
                let map = if of == 0 { &r.ours } else { &r.saturating };
                map.get(set.key()).cloned()
            };
            let all: Vec<Ours> = rows.iter().filter_map(column).collect();
            hits.push(Hits {
                basis: basis.to_owned(),
                responses: set.key(),
                hits: all.iter().filter(|o| o.hit).count(),
                overlaps: all.iter().filter(|o| o.overlaps).count(),
                of: all.len(),
            });
        }
    }
    Ok((rows, hits))
}
