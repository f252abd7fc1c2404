//! docs/validation.md.

use std::fmt::Write as _;

use dem_validation::Check;

use super::Section;
use super::faults::Row;

/// Checks that share tolerance and source in one table, in the order of their first.
fn tables(page: &mut String, checks: &[Check]) {
    let same = |a: &Check, b: &Check| {
        a.tolerance == b.tolerance
            && a.tolerance_reason == b.tolerance_reason
            && a.source == b.source
    };
    for (k, first) in checks.iter().enumerate() {
        if !checks[..k].iter().any(|c| same(c, first)) {
            let rows: Vec<&Check> = checks[k..].iter().filter(|c| same(c, first)).collect();
            table(page, &rows);
        }
    }
}

fn table(page: &mut String, checks: &[&Check]) {
    let worst = checks.iter().map(|c| c.deviation).fold(0.0, f64::max);
    let _ = writeln!(
        page,
        "Tolerance {}: {}. Source: {}. Largest deviation of {}: {}.\n",
        short(checks[0].tolerance),
        checks[0].tolerance_reason,
        checks[0].source,
        checks.len(),
        short(worst)
    );
    page.push_str("| case | quantity | reference | ours | deviation | pass |\n");
    page.push_str("|---|---|---:|---:|---:|---|\n");
    for c in checks {
        let _ = writeln!(
            page,
            "| {} | {} | {} | {} | {} | {} |",
            cell(&c.case),
            cell(&c.quantity),
            long(c.reference),
            long(c.ours),
            short(c.deviation),
            if c.pass { "yes" } else { "**NO**" }
        );
    }
    page.push('\n');
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// Six digits.
fn long(x: f64) -> String {
    digits(x, 6)
}

/// Two digits.
fn short(x: f64) -> String {
    digits(x, 2)
}

fn digits(x: f64, n: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let exponent = x.abs().log10().floor();
    if (-3.0..6.0).contains(&exponent) {
        let decimals = (n as f64 - 1.0 - exponent).max(0.0) as usize;
        let text = format!("{x:.decimals$}");
        if text.contains('.') {
            return text.trim_end_matches('0').trim_end_matches('.').to_owned();
        }
        return text;
    }
    format!("{x:.*e}", n - 1)
}

/// The whole page.
pub(crate) fn page(sections: &[Section], bulk_notes: &str, faults: &[Row]) -> String {
    let mut page = String::from(
        "# Validation of dem-core\n\n\
         Written by `cargo xtask validate`, which fails if a case fails; `--json` prints the same \
         list. Deviation and tolerance are of one kind, named with each tolerance.\n\n",
    );
    let all = || sections.iter().flat_map(|s| &s.checks);
    let passed = all().filter(|c| c.pass).count();
    let _ = writeln!(page, "**{passed} of {} checks pass.**\n", all().count());
    page.push_str("| group | checks | pass | nearest to its tolerance |\n|---|---:|---:|---:|\n");
    for s in sections {
        let pass = s.checks.iter().filter(|c| c.pass).count();
        let shares =
            s.checks.iter().filter(|c| c.tolerance > 0.0).map(|c| c.deviation / c.tolerance);
        let nearest = shares.fold(f64::NAN, f64::max);
        let nearest = if nearest.is_nan() {
            "exact or a bound".to_owned()
        } else {
            format!("{:.0} %", 100.0 * nearest)
        };
        let _ = writeln!(
            page,
            "| [{}](#{}) | {} | {pass} | {nearest} |",
            s.title,
            anchor(s.title),
            s.checks.len()
        );
    }
    page.push('\n');
    for s in sections {
        let _ = writeln!(page, "## {}\n", s.title);
        if s.name == super::bulk::NAME {
            page.push_str(bulk_notes);
        }
        for p in &s.pictures {
            let _ = writeln!(page, "![{}](img/validation/{})\n\n{}\n", p.title, p.file, p.caption);
        }
        page.push_str(&super::summaries::of(s));
        tables(&mut page, &s.checks);
    }
    page.push_str(
        "## Faults that users of other codes met\n\nEach is covered by a test; that the test \
         exists is checked when this page is written.\n\n| report | fault | where it is covered |\n|---|---|---|\n",
    );
    for f in faults {
        let _ = writeln!(page, "| {} | {} | `{}`: `{}` |", f.report, f.fault, f.file, f.test);
    }
    page.push_str(
        "\n## Not on this page\n\n\
         - Angles of glass beads in drums of 200 to 500 mm (Liu et al., thesis Table 3) and the 336 \
         runs of Tables 22 to 33 need the drum rig and its image analysis, not the engine alone; \
         what the tables allow without a run is in `reproduction.md`.\n",
    );
    page
}

/// Anchor that a Markdown viewer gives a heading.
fn anchor(title: &str) -> String {
    title
        .to_lowercase()
        .chars()
        .filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-')
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits_and_lose_their_zeros() {
        assert_eq!(long(10_696.94), "10696.9");
        assert_eq!(long(2.741e-4), "2.74100e-4");
        assert_eq!(long(-0.5), "-0.5");
        assert_eq!(long(1234567.0), "1.23457e6");
        assert_eq!(short(1.04e-5), "1.0e-5");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(f64::NAN), "NaN");
    }

    #[test]
    fn an_anchor_is_what_a_viewer_makes_of_the_heading() {
        assert_eq!(
            anchor("A dropped sphere (MFIX DEM01, DEM02)"),
            "a-dropped-sphere-mfix-dem01-dem02"
        );
    }
}
