//! Where measured bands meet: the largest sets of responses with a common region.

use super::CalibrationMap;
use crate::contour::{Bounds, Chain, area, region};
use crate::number::extent;

/// The region common to most of the measured bands.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlap {
    /// Numbers of the responses whose bands meet here.
    pub responses: Vec<usize>,
    /// Closed loops around the region, data units.
    pub loops: Vec<Chain>,
    /// Smallest and largest value of the horizontal factor within the region.
    pub x_range: (f64, f64),
    /// Intervals of the vertical factor that the region's pieces take up, ascending.
    pub y_ranges: Vec<(f64, f64)>,
    /// Area of the region in units of both factors.
    pub area: f64,
}

impl CalibrationMap {
    /// The regions in which the largest number of measured bands overlap, largest area first.
    ///
    /// Sets of bands are tried from all of them down to two; the first size at which any set has a
    /// common region is returned, every such set with its region. With more than twelve measured
    /// responses only the set of all is tried.
    pub fn overlaps(&self) -> Vec<Overlap> {
        let measured: Vec<usize> = (0..self.responses.len())
            .filter(|&i| self.band(i).is_some() && self.responses[i].field.is_drawable())
            .collect();
        let smallest = if measured.len() > 12 { measured.len() } else { 2 };
        for size in (smallest..=measured.len()).rev() {
            let mut found: Vec<Overlap> = subsets(&measured, size)
                .into_iter()
                .filter_map(|set| {
                    let bounds: Vec<Bounds<'_>> = set
                        .iter()
                        .filter_map(|&i| {
                            let (lo, hi) = self.band(i)?;
                            Some(Bounds { field: &self.responses[i].field, lo, hi })
                        })
                        .collect();
                    overlap_of(set, region(&bounds))
                })
                .collect();
            if !found.is_empty() {
                found.sort_by(|a, b| b.area.total_cmp(&a.area));
                return found;
            }
        }
        Vec::new()
    }
}

fn overlap_of(responses: Vec<usize>, loops: Vec<Chain>) -> Option<Overlap> {
    let x_range = extent(loops.iter().flatten().map(|p| p.0))?;
    let mut pieces: Vec<(f64, f64)> =
        loops.iter().filter_map(|l| extent(l.iter().map(|p| p.1))).collect();
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut y_ranges: Vec<(f64, f64)> = Vec::new();
    for (lo, hi) in pieces {
        match y_ranges.last_mut() {
            // Holes lie within their piece, so that merging what overlaps takes them in.
            Some(last) if lo <= last.1 => last.1 = last.1.max(hi),
            _ => y_ranges.push((lo, hi)),
        }
    }
    let area = area(&loops);
    Some(Overlap { responses, loops, x_range, y_ranges, area })
}

fn subsets(of: &[usize], size: usize) -> Vec<Vec<usize>> {
    if size == 0 {
        return vec![Vec::new()];
    }
    let mut out = Vec::new();
    for (k, first) in of.iter().enumerate() {
        for mut rest in subsets(&of[k + 1..], size - 1) {
            rest.insert(0, *first);
            out.push(rest);
        }
    }
    out
}
