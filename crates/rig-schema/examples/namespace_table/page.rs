//! The namespace of parameters as a page of Markdown.

use std::fmt::Write;

use rig_schema::{Parameter, Sign, namespace};

const HEAD: &str = "\
# The namespace of parameters

Everything that can vary has one path. It is the key in a rig file (`[friction]` `pp = 0.5`), the
name of a factor of a plan, of a free parameter or nuisance of a case, and what a column of a
table of simulated runs is mapped to. This page is printed from the declarations
(`cargo run --release -p rig-schema --example namespace_table`); a test keeps it equal to them.

- *nominal*: the value where a file gives none; \"none\": no value unless a file gives one.
- *range*: lowest and highest value that is accepted; anything else is an error.
- *departs*: the side of the nominal value to which nature can depart from it.
- unit `1`: a pure number; `% R`: percent of the drum's radius.
";

/// The whole page.
pub(crate) fn markdown() -> String {
    let mut page = HEAD.to_owned();
    let layers = [
        ("Physics: what moves the particles", namespace::PHYSICS),
        ("Camera: what changes the picture of a motion", namespace::CAMERA),
        ("Measurement: what changes the reading of a picture", namespace::MEASUREMENT),
    ];
    for (title, parameters) in layers {
        // Writing to a string cannot fail.
        let _ = writeln!(page, "\n## {title}\n");
        page.push_str("| path | unit | nominal | range | departs | stands for |\n");
        page.push_str("|---|---|---|---|---|---|\n");
        for p in parameters {
            page.push_str(&row(p));
        }
    }
    page
}

fn row(p: &Parameter) -> String {
    let nominal = p.nominal.map_or_else(|| "none".to_owned(), |v| v.to_string());
    let departs = match p.sign {
        Sign::Positive => "up",
        Sign::Negative => "down",
        Sign::Either => "either way",
    };
    let (low, high) = p.range;
    format!(
        "| `{}` | {} | {nominal} | {low} to {high} | {departs} | {} |\n",
        p.path, p.unit, p.meaning
    )
}
