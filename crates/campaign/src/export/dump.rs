//! Dumps of LAMMPS and LIGGGHTS as tables of positions.

use crate::CampaignError;

/// The columns that a table of positions needs.
const WANTED: [&str; 5] = ["id", "x", "y", "z", "radius"];

/// Positions of a text dump as CSV `frame,x,y,z,radius`, as the film reads them: frames from 0 in
/// the order of the dump, beads by number.
///
/// ```
/// let dump = "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n\
///             ITEM: ATOMS id type x y z radius\n1 1 0.1 0.2 0.3 0.003\n";
/// let csv = campaign::export::positions("frames.dump", dump)?;
/// assert_eq!(csv, "frame,x,y,z,radius\n0,0.1,0.2,0.3,0.003\n");
/// # Ok::<(), campaign::CampaignError>(())
/// ```
///
/// # Errors
/// [`CampaignError::Dump`] with the line of what is missing, cut short or no number.
pub fn positions(file: &str, text: &str) -> Result<String, CampaignError> {
    let mut reader = Reader { file, lines: text.lines().collect(), at: 0 };
    let mut out = String::from("frame,x,y,z,radius\n");
    let mut frame = 0;
    while reader.at < reader.lines.len() {
        reader.title("ITEM: TIMESTEP")?;
        reader.next("a time step")?;
        reader.title("ITEM: NUMBER OF ATOMS")?;
        let count: usize = reader.number("a number of atoms")?;
        // Some versions write a line more here; the columns are what matters.
        let columns = loop {
            let line = reader.next("ITEM: ATOMS id type x y z radius")?;
            if let Some(columns) = line.strip_prefix("ITEM: ATOMS") {
                break columns;
            }
        };
        let columns: Vec<&str> = columns.split_whitespace().collect();
        let mut places = [0; WANTED.len()];
        for (place, wanted) in places.iter_mut().zip(WANTED) {
            let found = columns.iter().position(|c| *c == wanted);
            *place = found.ok_or_else(|| {
                reader.fault(format!("no column `{wanted}`"), "columns id, x, y, z and radius")
            })?;
        }
        let mut beads = Vec::new();
        for _ in 0..count {
            let line = reader.next("one line an atom")?;
            let fields: Vec<&str> = line.split_whitespace().collect();
            let field = |k: usize| fields.get(places[k]).copied().unwrap_or_default();
            let id: u64 = field(0).parse().map_err(|_| {
                reader.fault(format!("`{}` is no number of an atom", field(0)), "1, 2, 3, ...")
            })?;
            let mut values = [0.0; 4];
            for (k, value) in values.iter_mut().enumerate() {
                let text = field(k + 1);
                let number = text.parse::<f64>().ok().filter(|v| v.is_finite());
                *value = number.ok_or_else(|| {
                    reader.fault(format!("`{text}` for {}", WANTED[k + 1]), "a finite number")
                })?;
            }
            beads.push((id, values));
        }
        beads.sort_by_key(|b| b.0);
        for (_, [x, y, z, radius]) in beads {
            out.push_str(&format!("{frame},{x},{y},{z},{radius}\n"));
        }
        frame += 1;
    }
    if frame == 0 {
        return Err(reader.fault("an empty file".to_owned(), "one frame or more"));
    }
    Ok(out)
}

struct Reader<'a> {
    file: &'a str,
    lines: Vec<&'a str>,
    at: usize,
}

impl<'a> Reader<'a> {
    fn next(&mut self, expected: &'static str) -> Result<&'a str, CampaignError> {
        let line = self.lines.get(self.at).copied();
        self.at += 1;
        line.ok_or_else(|| self.fault("the file ends".to_owned(), expected))
    }

    fn title(&mut self, expected: &'static str) -> Result<(), CampaignError> {
        let line = self.next(expected)?;
        if line.trim_end() == expected {
            return Ok(());
        }
        Err(self.fault(format!("`{}`", line.chars().take(40).collect::<String>()), expected))
    }

    fn number<T: std::str::FromStr>(&mut self, what: &'static str) -> Result<T, CampaignError> {
        let line = self.next(what)?;
        line.trim().parse().map_err(|_| self.fault(format!("`{line}`"), what))
    }

    fn fault(&self, problem: String, expected: &'static str) -> CampaignError {
        CampaignError::Dump { file: self.file.to_owned(), line: self.at, problem, expected }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DUMP: &str = "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff pp\n0 1\n0 1\n0 1\n\
        ITEM: ATOMS id type x y z radius \n2 1 0.4 0.5 0.6 0.002\n1 1 0.1 0.2 0.3 0.001\n\
        ITEM: TIMESTEP\n20\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS ff ff pp\n0 1\n0 1\n0 1\n\
        ITEM: ATOMS x y z radius id\n1 2 3 4 7\n";

    #[test]
    fn frames_are_numbered_and_beads_sorted() {
        let csv = positions("d", DUMP).unwrap();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines[1], "0,0.1,0.2,0.3,0.001");
        assert_eq!(lines[3], "1,1,2,3,4");
        assert_eq!(lines.len(), 4);
    }

    #[test]
    fn what_is_cut_short_or_altered_names_its_line() {
        let shown = |text: &str| positions("d.dump", text).unwrap_err().to_string();
        let cut: String = DUMP.lines().take(10).map(|l| format!("{l}\n")).collect();
        assert!(shown(&cut).contains("line 11"), "{}", shown(&cut));
        let wrong = shown(&DUMP.replace("0.4 0.5", "0.4 nan"));
        assert!(wrong.contains("line 10") && wrong.contains("for y"), "{wrong}");
        assert!(shown(&DUMP.replace("z radius \n", "z\n")).contains("no column `radius`"));
        assert!(shown("hello\n").contains("ITEM: TIMESTEP"));
        assert!(shown("").contains("empty"));
    }
}
