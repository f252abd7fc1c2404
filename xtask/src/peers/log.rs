//! What LAMMPS and LIGGGHTS say on the screen about the timed run.

use anyhow::Context;

/// Printed by the decks before the timed run.
const MARK: &str = "timed run begins";

/// What a code tells about its timed run.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Told {
    /// First line: name and version.
    pub(crate) version: String,
    /// Wall time of the loop, s.
    pub(crate) loop_s: f64,
    /// Mean over the run of the pairs in contact.
    pub(crate) contacts: f64,
    /// Pairs in the list at the end.
    pub(crate) list_pairs: f64,
    /// Lists made during the run.
    pub(crate) builds: f64,
}

/// Read the screen of a run of one of the decks.
pub(crate) fn read(screen: &str) -> anyhow::Result<Told> {
    let (before, after) = screen
        .split_once(MARK)
        .context("the run ended before its timed part; see its screen.log under target/peers")?;
    let version = before.lines().find(|l| l.contains("LAMMPS (") || l.contains("LIGGGHTS ("));
    let number = |head: &str| -> anyhow::Result<f64> {
        let line = after.lines().find(|l| l.trim_start().starts_with(head));
        let line = line.with_context(|| format!("no line `{head}` in the screen output"))?;
        let rest = line.trim_start()[head.len()..].trim_start_matches([' ', '=', ':']);
        let word = rest.split_whitespace().next().unwrap_or_default();
        word.parse().with_context(|| format!("`{line}`: no number after `{head}`"))
    };
    // Ends of contacts, counted at every particle, in the last column; the first row is the state
    // before the run.
    let rows = after
        .lines()
        .skip_while(|l| !l.trim_start().starts_with("Step"))
        .skip(1)
        .take_while(|l| !l.starts_with("Loop time"));
    let ends: Vec<f64> =
        rows.filter_map(|l| l.split_whitespace().last()?.parse().ok()).skip(1).collect();
    anyhow::ensure!(!ends.is_empty(), "no row of numbers in the screen output");
    Ok(Told {
        version: version.unwrap_or("unknown version").trim().to_owned(),
        loop_s: number("Loop time of")?,
        contacts: 0.5 * ends.iter().sum::<f64>() / ends.len() as f64,
        list_pairs: number("Total # of neighbors")?,
        builds: number("Neighbor list builds")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: &str = "LAMMPS (22 Jul 2025 - Update 4)\nLoop time of 9 on 1 procs\n\
        timed run begins\n   Step          Atoms         KinEng       c_contacts\n\
        0 100 0.5 999\n 10 100 0.5 400\n 20 100 0.5 420\n\
        Loop time of 0.25 on 1 procs for 20 steps with 100 atoms\n\
        Total # of neighbors = 470\nNeighbor list builds = 3\n\
        Loop time of 7 on 1 procs for 0 steps\n";

    #[test]
    fn the_timed_run_alone_is_read() {
        let told = read(SCREEN).unwrap();
        assert_eq!(told.version, "LAMMPS (22 Jul 2025 - Update 4)");
        assert_eq!((told.loop_s, told.contacts), (0.25, 205.0));
        assert_eq!((told.list_pairs, told.builds), (470.0, 3.0));
    }

    #[test]
    fn a_run_that_broke_off_is_an_error() {
        let error = read("LAMMPS (x)\nERROR: Lost atoms\n").unwrap_err().to_string();
        assert!(error.contains("before its timed part"), "{error}");
    }
}
