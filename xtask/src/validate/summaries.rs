//! Tables that show many checks at a glance.

use std::fmt::Write as _;

use dem_validation::Check;

use super::Section;

/// What stands before the tables of a section; empty for most.
pub(crate) fn of(section: &Section) -> String {
    match section.name {
        "contact_restitution" => steps(&section.checks),
        "contact_rolling" => facts(&section.checks),
        _ => String::new(),
    }
}

/// Restitution found against steps a contact.
fn steps(checks: &[Check]) -> String {
    let mut text = String::from(
        "Restitution found in contacts of few steps, mean over 50 places of first touch. The engine's \
         damping sees the rate foretold for the end of the step; in brackets what a rate half a step late \
         would give.\n\n| asked, tail | 5 steps | 10 | 20 | 50 |\n|---|---|---|---|---|\n",
    );
    let found = |case: &str, rate: &str| {
        checks
            .iter()
            .find(|c| c.case == case && c.quantity.ends_with(rate))
            .map_or_else(|| "-".to_owned(), |c| format!("{:.4}", c.ours))
    };
    for e in [0.5, 0.7, 0.9, 1.0] {
        for tail in ["cut", "kept"] {
            let _ = write!(text, "| {e}, {tail} |");
            for n in [5.0, 10.0, 20.0, 50.0] {
                let case = format!("Hertz, {n} steps a contact, e = {e}, tail {tail}");
                let (end, middle) =
                    (found(&case, "rate at the end"), found(&case, "rate at the middle"));
                let _ = write!(text, " {end} ({middle}) |");
            }
            text.push('\n');
        }
    }
    text + "\n"
}

/// Which rolling law obeys which of Zhu's facts.
fn facts(checks: &[Check]) -> String {
    const PREFIX: &str = "Zhu's facts, rolling law: ";
    let mut text = String::from(
        "Zhu's three facts about a sphere on a plane (thesis appendix 7.2), found by running each law.\n\n\
         | rolling law | rest is an equilibrium | a slow sphere comes to rest | rolls without slip while it is slowed |\n\
         |---|---|---|---|\n",
    );
    let mut rest: Vec<&Check> = checks.iter().filter(|c| c.case.starts_with(PREFIX)).collect();
    while let Some(first) = rest.first() {
        let case = first.case.clone();
        let (row, later): (Vec<&Check>, Vec<&Check>) =
            rest.into_iter().partition(|c| c.case == case);
        let cells: Vec<&str> =
            row.iter().map(|c| if c.ours == 1.0 { "yes" } else { "no" }).collect();
        let _ = writeln!(text, "| {} | {} |", &case[PREFIX.len()..], cells.join(" | "));
        rest = later;
    }
    text + "\n"
}
