//! Spheres of each species in each quadrant, against time.

use std::fmt::Write as _;

use anyhow::Context;
use dem_core::glam::DVec3;

use super::start::species_of;

/// Quadrants seen along the axis: signs of x and z.
pub(crate) const QUADRANTS: [&str; 4] = ["+x+z", "-x+z", "-x-z", "+x-z"];

/// One moment: time (s) and `counts[species][quadrant]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    pub(crate) time: f64,
    pub(crate) counts: [[u32; 4]; 2],
}

/// Count spheres given in the order of their numbers.
pub(crate) fn count(time: f64, centres: impl Iterator<Item = (usize, DVec3)>) -> Moment {
    let mut counts = [[0; 4]; 2];
    for (number, c) in centres {
        let quadrant = match (c.x > 0.0, c.z > 0.0) {
            (true, true) => 0,
            (false, true) => 1,
            (false, false) => 2,
            (true, false) => 3,
        };
        counts[species_of(number)][quadrant] += 1;
    }
    Moment { time, counts }
}

/// Head of a table of counts.
pub(crate) fn head() -> String {
    let mut head = String::from("time_s");
    for species in ["M1", "M2"] {
        for quadrant in QUADRANTS {
            let _ = write!(head, ",{species}{quadrant}");
        }
    }
    head
}

/// Table of counts.
pub(crate) fn to_csv(moments: &[Moment]) -> String {
    let mut text = head() + "\n";
    for m in moments {
        let _ = write!(text, "{:.3}", m.time);
        for n in m.counts.as_flattened() {
            let _ = write!(text, ",{n}");
        }
        text.push('\n');
    }
    text
}

/// Read [`to_csv`] back.
pub(crate) fn parse(text: &str) -> anyhow::Result<Vec<Moment>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let mut moments = Vec::new();
    for record in reader.records() {
        let record = record?;
        let field = |k: usize| record.get(k).context("9 columns");
        let mut counts = [[0; 4]; 2];
        for (k, n) in counts.as_flattened_mut().iter_mut().enumerate() {
            *n = field(k + 1)?.parse()?;
        }
        moments.push(Moment { time: field(0)?.parse()?, counts });
    }
    Ok(moments)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dosta::case::SPECIES;

    #[test]
    fn spheres_are_counted_by_species_and_quadrant() {
        let second = SPECIES[0].count;
        let centres = [
            (0, DVec3::new(1.0, 0.0, 1.0)),
            (1, DVec3::new(-1.0, 0.0, 1.0)),
            (second, DVec3::new(-1.0, 5.0, -1.0)),
            (second + 1, DVec3::new(1.0, -5.0, -1.0)),
        ];
        let moment = count(0.25, centres.into_iter());
        assert_eq!(moment.counts, [[1, 1, 0, 0], [0, 0, 1, 1]]);
        assert_eq!(parse(&to_csv(&[moment])).unwrap(), [moment]);
        assert!(parse("time_s,M1\n0,1\n").is_err());
    }
}
