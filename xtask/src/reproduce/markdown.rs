//! The reproduction as a page.

use std::fmt::Write;

use super::Reproduction;
use super::materials::Material;
use super::ranges::Ours;

pub(super) fn open(value: Option<f64>) -> String {
    value.map_or_else(|| "open".to_owned(), |v| format!("{v:.2}"))
}

fn cell(ours: Option<&Ours>) -> String {
    ours.map_or_else(String::new, |o| {
        let mark = if o.hit { "**" } else { "" };
        format!("{mark}{:.2}{mark} ({} to {})", o.value, open(o.lo), open(o.hi))
    })
}

/// The whole page.
pub(crate) fn page(all: &Reproduction) -> String {
    let mut s = String::from(
        "# Reproduction of the thesis's tables\n\nWritten by `cargo xtask reproduce`; the same numbers are in `reproduction.json`. Errata tagged certain are applied unless a section says otherwise.\n",
    );
    for (title, rows) in &all.tables {
        let _ = writeln!(
            s,
            "\n## {title}\n\n| item | printed | ours | agree | note |\n|---|---|---|---|---|"
        );
        for r in rows {
            let agree = if r.agree { "yes" } else { "no" };
            let _ =
                writeln!(s, "| {} | {} | {} | {agree} | {} |", r.item, r.printed, r.ours, r.why);
        }
    }
    fits(&mut s, all);
    ranges(&mut s, all);
    materials(&mut s, all);
    s
}

fn fits(s: &mut String, all: &Reproduction) {
    s.push_str("\n## 48 response surfaces, and whether the wall matters\n\nFull quadratic in speed, wall and particle friction. The thesis says that wall friction has no influence; the F test asks whether all terms with it are zero. The effect is the change of the response from wall friction 0.4 to 0.8 at 17 rpm and particle friction 0.5.\n\n| configuration | response | R2 | R2adj | Q2 | rmse | p (wall) | effect of the wall |\n|---|---|---|---|---|---|---|---|\n");
    for f in &all.fits {
        let q2 = f.q2.map_or_else(|| "undefined".to_owned(), |q| format!("{q:.4}"));
        let _ = writeln!(
            s,
            "| {} | {} | {:.4} | {:.4} | {q2} | {:.3} | {:.1e} | {:+.2} |",
            f.config, f.response, f.r2, f.r2adj, f.rmse, f.p_wall, f.wall_effect
        );
    }
    let significant = all.fits.iter().filter(|f| f.p_wall < 0.05).count();
    let largest = all.fits.iter().map(|f| f.wall_effect.abs()).fold(0.0, f64::max);
    let _ = writeln!(
        s,
        "\nThe claim does not hold: in {significant} of {} fits the wall terms are significant at 5 % (2 or 3 would be by chance). The largest effect over the range is {largest:.1} (degrees or % R); it is small beside that of particle friction, and it is not zero.",
        all.fits.len()
    );
    s.push_str("\n## Misprints that surface by themselves (tables as printed)\n\n| file | row | column | found | how |\n|---|---|---|---|---|\n");
    for o in &all.outliers {
        let found = if o.found { "yes" } else { "no" };
        let _ = writeln!(s, "| {} | {} | {} | {found} | {} |", o.file, o.row, o.column, o.note);
    }
    let _ = writeln!(s, "\n{} other cells are flagged as well.\n", all.other_outliers);
    for d in &all.duplicates {
        let _ = writeln!(s, "- {d}");
    }
}

fn ranges(s: &mut String, all: &Reproduction) {
    s.push_str("\n## 36 friction ranges (section 5.1)\n\nEstimate and 95 % interval from the measured responses at one speed (interpolated between the neighbours where 17 rpm was not measured); bold where the estimate lies within the printed range.\n\n| configuration | rpm | printed | all | angles | aor_lin | aor_mid | cen_x | cen_y | saturating, all | over m0 .07 to .4 |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    for r in &all.ranges {
        let _ = write!(
            s,
            "| {} | {} | {:.2} to {:.2} |",
            r.config, r.omega_rpm, r.printed_lo, r.printed_hi
        );
        for key in ["all", "angles", "aor_lin", "aor_mid", "cen_x", "cen_y"] {
            let _ = write!(s, " {} |", cell(r.ours.get(key)));
        }
        let _ = writeln!(
            s,
            " {} | {:.2} to {:.2} |",
            cell(r.saturating.get("all")),
            r.saturating_span.0,
            r.saturating_span.1
        );
    }
    s.push_str("\n| basis | responses | estimate within the printed range | interval meets it | of |\n|---|---|---|---|---|\n");
    for h in &all.hits {
        let _ = writeln!(
            s,
            "| {} | {} | {} | {} | {} |",
            h.basis, h.responses, h.hits, h.overlaps, h.of
        );
    }
    s.push_str("\nThe author read the ranges by eye from contour plots of all four responses, allowed the centre of area a shift chosen by eye, and did not weight by the errors. Where a response alone misses, its table carries a constant shift (reference circle) or another definition of the line; the fits by all four marginalise both.\n");
}

fn materials(s: &mut String, all: &Reproduction) {
    s.push_str("\n## One particle friction a material\n\nThe same particles on two walls and at two fills share one friction. Fitted on all four configurations; then on three, the fourth predicted.\n");
    for m in &all.materials {
        material(s, m);
    }
}

/// One friction for several configurations.
pub(super) fn material(s: &mut String, m: &Material) {
    let _ = writeln!(
        s,
        "\n### {}\n\nOne friction for all: {:.3} ({} to {}), chi-square {:.0} for {} degrees of freedom; p of the tie {:.1e}.\n\n| configuration | alone | cost of the tie |\n|---|---|---|",
        m.name,
        m.value,
        open(m.lo),
        open(m.hi),
        m.chi2,
        m.dof,
        m.tie_p
    );
    for (name, alone, strain) in &m.members {
        let _ = writeln!(s, "| {name} | {alone:.3} | {strain:.1} |");
    }
    s.push_str("\n| predicted | friction of the others | own best | chi-square | at own best | dof | rmse aor_lin, aor_mid (deg), cen_x, cen_y (% R) |\n|---|---|---|---|---|---|---|\n");
    for w in &m.withheld {
        let rmse: Vec<String> = w.rmse.iter().map(|(_, v)| format!("{v:.2}")).collect();
        let _ = writeln!(
            s,
            "| {} | {:.3} | {:.3} | {:.0} | {:.0} | {} | {} |",
            w.config,
            w.from_others,
            w.own,
            w.chi2,
            w.own_chi2,
            w.dof,
            rmse.join(", ")
        );
    }
}

/// What is printed at the end.
pub(crate) fn digest(all: &Reproduction) -> String {
    let mut s = String::new();
    for (title, rows) in &all.tables {
        let agree = rows.iter().filter(|r| r.agree).count();
        let _ = writeln!(s, "{title}: {agree} of {} agree", rows.len());
    }
    let wall = all.fits.iter().filter(|f| f.p_wall < 0.05).count();
    let _ = writeln!(s, "wall terms significant in {wall} of {} fits", all.fits.len());
    let found = all.outliers.iter().filter(|o| o.found).count();
    let _ = writeln!(
        s,
        "certain misprints found: {found} of {}; other cells flagged: {}",
        all.outliers.len(),
        all.other_outliers
    );
    for d in &all.duplicates {
        let _ = writeln!(s, "{d}");
    }
    for h in &all.hits {
        let _ = writeln!(
            s,
            "{:<20} {:<8} hits {:>2}, meets {:>2} of {}",
            h.basis, h.responses, h.hits, h.overlaps, h.of
        );
    }
    for m in &all.materials {
        let _ = writeln!(
            s,
            "{}: one friction {:.3} ({} to {}), tie p {:.1e}",
            m.name,
            m.value,
            open(m.lo),
            open(m.hi),
            m.tie_p
        );
    }
    s
}
