//! Cells of several sizes: each sphere size class has its own grid.
//!
//! Level 0 holds the largest bodies; a body whose bounding radius is at most half the largest
//! goes one level down, and so on. A body looks for partners in its own grid and in all coarser
//! ones, so every pair is found once, from its smaller member, and a small body never has to
//! look through cells made for large ones to find its like. Bodies are sorted by level and cell;
//! the bodies of a row of cells lie side by side.
//! Ogarko & Luding, Comput. Phys. Commun. 183 (2012) 931, doi:10.1016/j.cpc.2011.12.019.

use super::Period;
use super::verlet_list::LANES;
use crate::particles::{Column, Record};

/// Largest number of cells a level may have, per body in it.
const CELLS_PER_BODY: usize = 8;

#[derive(Debug, Clone, Default)]
struct Level {
    /// Range of `order` that belongs to the level.
    begin: usize,
    end: usize,
    largest_radius: f64,
    origin: [f64; 3],
    inverse_size: [f64; 3],
    cells: [usize; 3],
    /// Place in `order` at which each cell begins, one more than there are cells.
    start: Vec<u32>,
}

/// The grids and the bodies sorted into them.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellList {
    levels: Vec<Level>,
    used_levels: usize,
    /// Bodies by level and cell.
    pub(crate) order: Vec<u32>,
    /// Their positions and bounding radii in that order.
    pub(crate) sorted: Column<Record>,
    /// The same, coordinate by coordinate, with room for one more vector at the end.
    pub(crate) columns: [Column<f64>; 4],
    level_of: Vec<u8>,
    key: Vec<u32>,
    /// Axes, the fastest first; a periodic one is never the fastest.
    axes: [usize; 3],
}

/// Records field by field, with room for one more vector at the end.
pub(crate) fn columns_of(records: &[Record], columns: &mut [Column<f64>; 4]) {
    let fields: [fn(&Record) -> f64; 4] = [|r| r.x, |r| r.y, |r| r.z, |r| r.w];
    for (column, field) in columns.iter_mut().zip(fields) {
        column.clear();
        column.extend(records.iter().map(field));
        column.resize(records.len() + LANES, 0.0);
    }
}

impl CellList {
    /// Sort the bodies at `position` (bounding radius in `w`) for a search up to gaps of `range`.
    pub(crate) fn sort(&mut self, position: &[Record], range: f64, period: Option<Period>) {
        let n = position.len();
        self.axes = match period.map(|p| p.axis) {
            Some(0) => [1, 2, 0],
            Some(1) => [0, 2, 1],
            _ => [0, 1, 2],
        };
        self.order.resize(n, 0);
        self.sorted.resize(n, Record::default());
        self.level_of.resize(n, 0);
        self.key.resize(n, 0);
        let (mut largest, mut smallest) = (0.0f64, f64::INFINITY);
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in position {
            largest = largest.max(p.w);
            smallest = smallest.min(p.w);
            for (k, x) in [p.x, p.y, p.z].into_iter().enumerate() {
                low[k] = low[k].min(x);
                high[k] = high[k].max(x);
            }
        }
        if let Some(p) = period {
            (low[p.axis], high[p.axis]) = (p.min, p.min + p.length);
        }
        let levels = if n == 0 { 0 } else { 1 + (largest / smallest).log2() as usize };
        while self.levels.len() < levels {
            self.levels.push(Level::default());
        }
        self.used_levels = levels;
        for (k, p) in position.iter().enumerate() {
            self.level_of[k] = if levels > 1 { (largest / p.w).log2() as u8 } else { 0 };
        }
        let mut begin = 0;
        for l in 0..levels {
            begin = self.sort_level(l, begin, position, range, low, high, period);
        }
        columns_of(&self.sorted, &mut self.columns);
    }

    fn sort_level(
        &mut self,
        l: usize,
        begin: usize,
        position: &[Record],
        range: f64,
        low: [f64; 3],
        high: [f64; 3],
        period: Option<Period>,
    ) -> usize {
        let level = &mut self.levels[l];
        let mut count = 0usize;
        level.largest_radius = 0.0;
        for (p, &of) in position.iter().zip(&self.level_of) {
            if usize::from(of) == l {
                count += 1;
                level.largest_radius = level.largest_radius.max(p.w);
            }
        }
        let mut size = 2.0 * level.largest_radius + range;
        loop {
            for k in 0..3 {
                let cells = ((high[k] - low[k]) / size).floor().max(1.0);
                level.cells[k] = cells as usize;
                // Beyond the last full cell the remainder joins it, except in a period.
                let repeats = period.is_some_and(|p| p.axis == k);
                level.inverse_size[k] =
                    if repeats { cells / (high[k] - low[k]) } else { 1.0 / size };
            }
            let cells = level.cells.iter().map(|&c| c as f64).product::<f64>();
            if cells <= (CELLS_PER_BODY * count.max(8)) as f64 {
                break;
            }
            size *= 1.26;
        }
        level.origin = low;
        let cells: usize = level.cells.iter().product();
        level.start.clear();
        // The number of cells changes with the bodies' extent: have room for the most.
        level.start.reserve(CELLS_PER_BODY * count.max(8) + 1);
        level.start.resize(cells + 1, 0);
        for (k, p) in position.iter().enumerate() {
            if usize::from(self.level_of[k]) == l {
                let c = level.cell([p.x, p.y, p.z]);
                let key = level.index(self.axes, c);
                self.key[k] = key as u32;
                level.start[key + 1] += 1;
            }
        }
        level.start[0] = begin as u32;
        for c in 0..cells {
            level.start[c + 1] += level.start[c];
        }
        for (k, p) in position.iter().enumerate() {
            if usize::from(self.level_of[k]) == l {
                let place = &mut level.start[self.key[k] as usize];
                self.order[*place as usize] = k as u32;
                self.sorted[*place as usize] = *p;
                *place += 1;
            }
        }
        // Each entry now holds its cell's end, which is the next one's beginning.
        for c in (0..cells).rev() {
            level.start[c + 1] = level.start[c];
        }
        level.start[0] = begin as u32;
        level.begin = begin;
        level.end = begin + count;
        level.end
    }

    /// Call `found(k, m)` for every pair of sorted places whose gap may be below `range(k)`, where
    /// `k` runs over `places`; the caller measures the gap.
    #[inline(always)]
    pub(crate) fn for_each_candidate(
        &self,
        places: std::ops::Range<usize>,
        range: impl Fn(usize) -> f64,
        period: Option<Period>,
        mut found: impl FnMut(usize, std::ops::Range<usize>),
    ) {
        for own in 0..self.used_levels {
            let (begin, end) = (self.levels[own].begin, self.levels[own].end);
            for k in places.start.max(begin)..places.end.min(end) {
                let p = &self.sorted[k];
                for l in 0..=own {
                    let level = &self.levels[l];
                    let reach = p.w + level.largest_radius + range(k);
                    let least = if l == own { k + 1 } else { 0 };
                    level.rows(
                        self.axes,
                        [p.x, p.y, p.z],
                        reach,
                        (period, l == own),
                        #[inline(always)]
                        |row| {
                            let row = row.start.max(least)..row.end;
                            if !row.is_empty() {
                                found(k, row);
                            }
                        },
                    );
                }
            }
        }
    }
}

/// A cell's number within its period, for one that lies a period beyond it at most.
#[inline(always)]
fn within(cell: isize, cells: usize) -> usize {
    let all = cells as isize;
    (if cell < 0 {
        cell + all
    } else if cell >= all {
        cell - all
    } else {
        cell
    }) as usize
}

impl Level {
    fn cell(&self, x: [f64; 3]) -> [usize; 3] {
        std::array::from_fn(|k| self.cell_along(k, x[k]))
    }

    #[inline(always)]
    fn cell_along(&self, k: usize, x: f64) -> usize {
        (((x - self.origin[k]) * self.inverse_size[k]).max(0.0) as usize).min(self.cells[k] - 1)
    }

    fn index(&self, axes: [usize; 3], c: [usize; 3]) -> usize {
        let [f, m, s] = axes;
        (c[s] * self.cells[m] + c[m]) * self.cells[f] + c[f]
    }

    /// The rows of cells within `reach` of `x`, as ranges of sorted places; where only those `behind` the cell of `x`
    /// count, few others.
    #[inline(always)]
    fn rows(
        &self,
        axes: [usize; 3],
        x: [f64; 3],
        reach: f64,
        (period, behind): (Option<Period>, bool),
        mut row: impl FnMut(std::ops::Range<usize>),
    ) {
        let [f, m, s] = axes;
        let span = |k: usize| -> (isize, isize) {
            if period.is_some_and(|p| p.axis == k) {
                let low = ((x[k] - reach - self.origin[k]) * self.inverse_size[k]).floor() as isize;
                let high =
                    ((x[k] + reach - self.origin[k]) * self.inverse_size[k]).floor() as isize;
                let all = self.cells[k] as isize;
                if high - low + 1 >= all { (0, all - 1) } else { (low, high) }
            } else {
                (
                    self.cell_along(k, x[k] - reach) as isize,
                    self.cell_along(k, x[k] + reach) as isize,
                )
            }
        };
        let (f0, f1) = span(f);
        let (m0, m1) = span(m);
        let (mut s0, s1) = span(s);
        let (own_m, own_s) = (self.cell_along(m, x[m]) as isize, self.cell_along(s, x[s]) as isize);
        // Beyond the end of a period rows begin anew.
        let behind = behind && !period.is_some_and(|p| p.axis == m || p.axis == s);
        if behind {
            s0 = own_s;
        }
        for cs in s0..=s1 {
            let m0 = if behind && cs == own_s { own_m } else { m0 };
            let cs = within(cs, self.cells[s]);
            for cm in m0..=m1 {
                let cm = within(cm, self.cells[m]);
                let base = (cs * self.cells[m] + cm) * self.cells[f];
                let begin = self.start[base + f0 as usize] as usize;
                let end = self.start[base + f1 as usize + 1] as usize;
                row(begin..end);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn cloud(n: usize, ratio: f64) -> Vec<Record> {
        let mut state = 12345u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..n)
            .map(|_| {
                let r = 0.5 * ratio.powf(-random());
                Record { x: 10.0 * random(), y: 8.0 * random(), z: 6.0 * random(), w: r }
            })
            .collect()
    }

    fn pairs(
        cells: &mut CellList,
        p: &[Record],
        range: f64,
        period: Option<Period>,
    ) -> Vec<(u32, u32)> {
        cells.sort(p, range, period);
        let mut out = Vec::new();
        cells.for_each_candidate(
            0..p.len(),
            |_| range,
            period,
            |k, row| {
                for m in row {
                    let (a, b) = (cells.sorted[k], cells.sorted[m]);
                    let d = Period::shortest(period, b.vector() - a.vector());
                    if d.length() < a.w + b.w + range {
                        let (i, j) = (cells.order[k], cells.order[m]);
                        out.push((i.min(j), i.max(j)));
                    }
                }
            },
        );
        out.sort_unstable();
        out
    }

    fn brute(p: &[Record], range: f64, period: Option<Period>) -> Vec<(u32, u32)> {
        let mut out = Vec::new();
        for i in 0..p.len() {
            for j in i + 1..p.len() {
                let d: DVec3 = Period::shortest(period, p[j].vector() - p[i].vector());
                if d.length() < p[i].w + p[j].w + range {
                    out.push((i as u32, j as u32));
                }
            }
        }
        out
    }

    #[test]
    fn every_pair_is_found_exactly_once_for_size_ratios_up_to_ten() {
        for ratio in [1.0, 1.5, 3.0, 10.0] {
            for period in [
                None,
                Some(Period { axis: 2, min: 0.0, length: 6.0 }),
                Some(Period { axis: 0, min: 0.0, length: 10.0 }),
                Some(Period { axis: 1, min: 0.0, length: 8.0 }),
            ] {
                let p = cloud(700, ratio);
                let mut cells = CellList::default();
                assert_eq!(pairs(&mut cells, &p, 0.1, period), brute(&p, 0.1, period));
            }
        }
    }
}
