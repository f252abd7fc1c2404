//! The 48 response surfaces, whether the wall matters in them, and what the tables give away.

use calib::{
    Basis, Study, Surrogate, duplicate_rows, duplicate_tables, measured_outliers,
    simulated_outliers,
};
use rig_schema::{Action, Errata, ErrataLevel, Response, SimulatedTable, Tag};
use serde::Serialize;

use super::{fixture, study, tables};

/// One surface.
#[derive(Serialize)]
pub(crate) struct FitRow {
    pub(crate) config: String,
    pub(crate) response: &'static str,
    pub(crate) r2: f64,
    pub(crate) r2adj: f64,
    pub(crate) q2: Option<f64>,
    pub(crate) rmse: f64,
    /// F test that every term with the wall's friction is zero.
    pub(crate) p_wall: f64,
    /// Largest change of the response over the wall's range, other factors at their centre.
    pub(crate) wall_effect: f64,
}

/// A certain misprint of a mean, and whether the outlier test finds it.
#[derive(Serialize)]
pub(crate) struct CertainMisprint {
    pub(crate) file: String,
    pub(crate) row: String,
    pub(crate) column: String,
    pub(crate) found: bool,
    pub(crate) note: String,
}

type All = (Vec<FitRow>, Vec<CertainMisprint>, usize, Vec<String>);

pub(crate) fn all() -> anyhow::Result<All> {
    let mut rows = Vec::new();
    for name in tumble_fixtures::CASES {
        let study = study(name, ErrataLevel::Certain)?;
        for r in Response::ALL {
            let fit = study.surrogate.fit(r);
            let wall = fit.model().positions_involving("friction.mantle");
            let s = fit.summary();
            let mean = |wall: f64| study.surrogate.mean(r, 17.0, &[0.5, wall]);
            rows.push(FitRow {
                config: name.to_owned(),
                response: r.column(),
                r2: s.r2,
                r2adj: s.r2_adjusted,
                q2: s.q2,
                rmse: s.rmse,
                p_wall: fit.f_test(&wall)?.p,
                wall_effect: mean(0.8) - mean(0.4),
            });
        }
    }
    let (misprints, others) = misprints()?;
    Ok((rows, misprints, others, duplicates()?))
}

/// Which certain misprints the tables as printed give away by themselves.
fn misprints() -> anyhow::Result<(Vec<CertainMisprint>, usize)> {
    let errata = Errata::parse("errata.csv", fixture("thesis/errata.csv")?)?;
    // (file, row, column, description) of everything that is flagged in the tables as printed.
    let mut flagged: Vec<(String, String, String, String)> = Vec::new();
    for name in tumble_fixtures::CASES {
        let (_, measured, _) = tables(name, ErrataLevel::None)?;
        for o in measured_outliers(&measured) {
            flagged.push((
                measured.file.clone(),
                format!("omega={}", o.omega_rpm),
                o.response.column().to_owned(),
                format!(
                    "{} where {:.2} is expected, {:.0} typical distances",
                    o.value, o.expected, o.z
                ),
            ));
        }
        let study = study(name, ErrataLevel::None)?;
        for o in simulated_outliers(study.table(), &study.surrogate)? {
            flagged.push((
                study.table().file.clone(),
                format!("N{}", o.run),
                o.response.column().to_owned(),
                format!("{} where {:.2} is expected, t = {:.1}", o.value, o.expected, o.t),
            ));
        }
    }
    let mut misprints = Vec::new();
    let mut matched = 0;
    let cells = errata.items.iter().filter(|e| {
        e.tag == Tag::Certain
            && e.action == Action::Replace
            && Response::from_column(&e.column).is_some()
    });
    for e in cells {
        let hit = flagged.iter().find(|f| (&f.0, &f.1, &f.2) == (&e.file, &e.row, &e.column));
        matched += usize::from(hit.is_some());
        misprints.push(CertainMisprint {
            file: e.file.clone(),
            row: e.row.clone(),
            column: e.column.clone(),
            found: hit.is_some(),
            note: hit.map_or_else(|| "not flagged".to_owned(), |f| f.3.clone()),
        });
    }
    Ok((misprints, flagged.len() - matched))
}

fn duplicates() -> anyhow::Result<Vec<String>> {
    let mut all: Vec<(SimulatedTable, Surrogate)> = Vec::new();
    for name in tumble_fixtures::CASES {
        let (case, _, simulated) = tables(name, ErrataLevel::None)?;
        let columns = Study::columns(&case)?;
        let pairs: Vec<(&str, &str)> =
            columns.iter().map(|(c, p)| (c.as_str(), p.as_str())).collect();
        let surrogate = Surrogate::from_table(&simulated, &pairs, &Basis::Quadratic)?;
        all.push((simulated, surrogate));
    }
    let pairs: Vec<(&SimulatedTable, &Surrogate)> = all.iter().map(|(t, s)| (t, s)).collect();
    let mut found: Vec<String> = duplicate_tables(&pairs)
        .into_iter()
        .map(|d| {
            format!(
                "`{}` is `{}` measured again: {} of {} rows agree in both angles within 0.06 deg; the rest, after a shift of {:+.2} and {:+.2} % R in the centre of area, differs by {:.0} % of independent runs",
                d.second, d.first, d.equal_rows.0, d.equal_rows.1, d.shift[2], d.shift[3], 100.0 * d.ratio
            )
        })
        .collect();
    let all: Vec<&SimulatedTable> = all.iter().map(|(t, _)| t).collect();
    found.extend(duplicate_rows(&all).into_iter().map(|d| {
        format!(
            "run N{} is the same in `{}` and `{}`: {} of 8 printed numbers are equal",
            d.run, d.first, d.second, d.equal
        )
    }));
    Ok(found)
}
