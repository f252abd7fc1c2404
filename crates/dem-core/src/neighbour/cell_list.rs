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
use crate::threads::{PART, Team, cut, part};

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
    /// Bodies by level and cell, with room for one more vector at the end.
    order: Vec<u32>,
    /// Their positions and bounding radii in that order.
    pub(crate) sorted: Column<Record>,
    /// The same, coordinate by coordinate, with room for one more vector at the end.
    pub(crate) columns: [Column<f64>; 4],
    level_of: Vec<u8>,
    key: Vec<u32>,
    /// Of the bodies of each chunk of work.
    bounds: Vec<Bounds>,
    /// Axes, the fastest first; a periodic one is never the fastest.
    axes: [usize; 3],
}

/// Least and largest of each field of some records.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: [f64; 4],
    high: [f64; 4],
}

impl Bounds {
    const NONE: Self = Self { low: [f64::INFINITY; 4], high: [f64::NEG_INFINITY; 4] };

    #[inline(always)]
    fn of(p: &Record) -> Self {
        let fields = [p.x, p.y, p.z, p.w];
        Self { low: fields, high: fields }
    }

    /// Those of both. Nobody is where no number is: that was asked before.
    #[inline(always)]
    fn with(mut self, other: &Self) -> Self {
        for k in 0..4 {
            self.low[k] = if other.low[k] < self.low[k] { other.low[k] } else { self.low[k] };
            self.high[k] = if other.high[k] > self.high[k] { other.high[k] } else { self.high[k] };
        }
        self
    }

    /// Least and largest coordinates.
    #[inline(always)]
    fn corners(&self) -> [[f64; 3]; 2] {
        [self.low, self.high].map(|[x, y, z, _]| [x, y, z])
    }
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
    pub(crate) fn sort(
        &mut self,
        position: &[Record],
        range: f64,
        period: Option<Period>,
        team: &Team,
    ) {
        let n = position.len();
        let chunks = n.div_ceil(PART);
        self.axes = match period.map(|p| p.axis) {
            Some(0) => [1, 2, 0],
            Some(1) => [0, 2, 1],
            _ => [0, 1, 2],
        };
        self.order.clear();
        self.order.resize(n + LANES, 0);
        self.key.resize(n, 0);
        self.bounds.resize(chunks, Bounds::NONE);
        team.each(chunks, cut(&mut self.bounds, 1), |c, bounds| {
            let own = &position[part(c, n)];
            bounds[0] = own.iter().fold(Bounds::NONE, |all, p| all.with(&Bounds::of(p)));
        });
        let all = self.bounds.iter().fold(Bounds::NONE, |all, part| all.with(part));
        let ([mut low, mut high], largest) = (all.corners(), all.high[3].max(0.0));
        if let Some(p) = period {
            (low[p.axis], high[p.axis]) = (p.min, p.min + p.length);
        }
        let levels = if n == 0 { 0 } else { 1 + (largest / all.low[3]).log2() as usize };
        while self.levels.len() < levels {
            self.levels.push(Level::default());
        }
        self.used_levels = levels;
        self.level_of.clear();
        // Nobody asks for the level where there is but one.
        if levels > 1 {
            self.level_of.extend(position.iter().map(|p| (largest / p.w).log2() as u8));
        }
        let mut begin = 0;
        for l in 0..levels {
            let alone = (levels == 1).then_some(largest);
            begin = self.sort_level(l, begin, position, range, (low, high, alone), period, team);
        }
        self.sorted.make_room(n, Record::default());
        for column in &mut self.columns {
            column.make_room(n + LANES, 0.0);
            column[n..].fill(0.0);
        }
        let order = &self.order;
        let columns = self.columns.each_mut().map(|column| cut(&mut column[..n], PART));
        team.each(chunks, (cut(&mut self.sorted, PART), columns), |c, (sorted, [x, y, z, w])| {
            let own = &order[part(c, n)];
            for (k, (to, from)) in sorted.iter_mut().zip(own).enumerate() {
                *to = position[*from as usize];
                (x[k], y[k], z[k], w[k]) = (to.x, to.y, to.z, to.w);
            }
        });
    }

    /// Sort the bodies of a level; `alone` is the largest radius if it is the only one.
    fn sort_level(
        &mut self,
        l: usize,
        begin: usize,
        position: &[Record],
        range: f64,
        (low, high, alone): ([f64; 3], [f64; 3], Option<f64>),
        period: Option<Period>,
        team: &Team,
    ) -> usize {
        let (level, level_of, key) = (&mut self.levels[l], &self.level_of, &mut self.key);
        let belongs = |k: usize| alone.is_some() || usize::from(level_of[k]) == l;
        let (mut count, mut largest) = (position.len(), alone.unwrap_or_default());
        if alone.is_none() {
            let own = || position.iter().enumerate().filter(|(k, _)| belongs(*k)).map(|(_, p)| p);
            count = own().count();
            largest = own().fold(0.0, |most, p| most.max(p.w));
        }
        level.largest_radius = largest;
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
        let axes = self.axes;
        {
            let level = &*level;
            team.each(position.len().div_ceil(PART), cut(key, PART), |c, keys| {
                let own = part(c, position.len());
                for ((key, p), k) in keys.iter_mut().zip(&position[own.clone()]).zip(own) {
                    if belongs(k) {
                        *key = level.index(axes, level.cell([p.x, p.y, p.z])) as u32;
                    }
                }
            });
        }
        level.start.clear();
        // The number of cells changes with the bodies' extent: have room for the most.
        level.start.reserve(CELLS_PER_BODY * count.max(8) + 2);
        // Counted two cells on: while bodies are put in their places, the entry of the next cell goes from this one's beginning
        // to its end.
        level.start.resize(cells + 2, 0);
        let own = || key.iter().enumerate().filter(|(k, _)| belongs(*k));
        for (_, key) in own() {
            level.start[*key as usize + 2] += 1;
        }
        let mut sum = begin as u32;
        for start in &mut level.start {
            sum += *start;
            *start = sum;
        }
        for (k, key) in own() {
            let place = &mut level.start[*key as usize + 1];
            self.order[*place as usize] = k as u32;
            *place += 1;
        }
        level.start.truncate(cells + 1);
        level.begin = begin;
        level.end = begin + count;
        level.end
    }

    /// The bodies by level and cell.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order[..self.sorted.len()]
    }

    /// The same, and a vector of places more.
    pub(crate) fn order_and_more(&self) -> &[u32] {
        &self.order
    }

    /// The bodies from sorted place `begin` on, before `end`, that lie in one cell; in a period of few cells, where the rows of one
    /// begin elsewhere than those of the next, the first of them alone.
    #[inline(always)]
    pub(crate) fn together(&self, begin: usize, end: usize, period: Option<Period>) -> Together {
        let levels = &self.levels[..self.used_levels];
        let own = levels.iter().position(|level| begin < level.end);
        let own = own.expect("the last level ends behind all bodies");
        let level = &levels[own];
        if period.is_some_and(|p| levels.len() > 1 || level.cells[p.axis] <= 3) {
            return Together { places: begin..begin + 1, level: own, cell: None };
        }
        let p = &self.sorted[begin];
        let cell = level.cell([p.x, p.y, p.z]);
        let end = (level.start[level.index(self.axes, cell) + 1] as usize).min(end);
        Together { places: begin..end, level: own, cell: Some(cell) }
    }

    /// Call `found` for every row of sorted places that may hold some whose gap to one of these bodies is below `range`, at most that
    /// for which they were sorted, and that lie behind the first of them; and whether they are of a coarser level, where all count,
    /// and not only those behind each body. The caller measures the gaps.
    #[inline(always)]
    pub(crate) fn for_each_row(
        &self,
        bodies: &Together,
        range: f64,
        period: Option<Period>,
        mut found: impl FnMut(std::ops::Range<usize>, bool),
    ) {
        let axes = self.axes;
        for (l, level) in self.levels[..=bodies.level].iter().enumerate() {
            let coarser = l != bodies.level;
            let least = if coarser { 0 } else { bodies.places.start + 1 };
            let cell = bodies.cell.filter(|_| !coarser);
            let spans = if let Some(cell) = cell {
                level.around(axes, cell, period)
            } else {
                let mut bounds = Bounds::NONE;
                for p in &self.sorted[bodies.places.clone()] {
                    bounds = bounds.with(&Bounds::of(p));
                }
                let reach = bounds.high[3] + level.largest_radius + range;
                level.within_reach(axes, bounds.corners(), reach, period)
            };
            level.rows(
                axes,
                spans,
                (period, cell),
                #[inline(always)]
                |row| {
                    let row = row.start.max(least)..row.end;
                    if !row.is_empty() {
                        found(row, coarser);
                    }
                },
            );
        }
    }
}

/// Bodies that are searched for partners together.
#[derive(Debug, Clone)]
pub(crate) struct Together {
    /// Their sorted places.
    pub(crate) places: std::ops::Range<usize>,
    level: usize,
    /// That of all of them; none of one that goes alone.
    cell: Option<[usize; 3]>,
}

impl Together {
    /// Whether this is one body that goes alone.
    pub(crate) fn is_alone(&self) -> bool {
        self.cell.is_none()
    }
}

/// First and last cell along an axis; those of a period may lie a period beyond it.
type Span = (isize, isize);

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
    #[inline(always)]
    fn cell(&self, x: [f64; 3]) -> [usize; 3] {
        std::array::from_fn(|k| self.cell_along(k, x[k]))
    }

    #[inline(always)]
    fn cell_along(&self, k: usize, x: f64) -> usize {
        (((x - self.origin[k]) * self.inverse_size[k]).max(0.0) as usize).min(self.cells[k] - 1)
    }

    #[inline(always)]
    fn index(&self, axes: [usize; 3], c: [usize; 3]) -> usize {
        let [f, m, s] = axes;
        (c[s] * self.cells[m] + c[m]) * self.cells[f] + c[f]
    }

    /// Cells next to one and itself, along the axes of rows, layers and the last one: they are as wide as bodies of the level reach,
    /// and more than three along a period.
    #[inline(always)]
    fn around(&self, axes: [usize; 3], cell: [usize; 3], period: Option<Period>) -> [Span; 3] {
        let mut spans = [(0, 0); 3];
        for (span, k) in spans.iter_mut().zip(axes) {
            let (own, last) = (cell[k] as isize, self.cells[k] as isize - 1);
            *span = if period.is_none_or(|p| p.axis != k) {
                ((own - 1).max(0), (own + 1).min(last))
            } else {
                (own - 1, own + 1)
            };
        }
        spans
    }

    /// Cells within `reach` of a box from `low` to `high`, along the same axes.
    #[inline(always)]
    fn within_reach(
        &self,
        axes: [usize; 3],
        [low, high]: [[f64; 3]; 2],
        reach: f64,
        period: Option<Period>,
    ) -> [Span; 3] {
        let mut spans = [(0, 0); 3];
        for (span, k) in spans.iter_mut().zip(axes) {
            let (low, high) = (low[k] - reach, high[k] + reach);
            if period.is_none_or(|p| p.axis != k) {
                *span = (self.cell_along(k, low) as isize, self.cell_along(k, high) as isize);
                continue;
            }
            let [low, high] = [low, high].map(
                #[inline(always)]
                |x| ((x - self.origin[k]) * self.inverse_size[k]).floor() as isize,
            );
            let all = self.cells[k] as isize;
            *span = if high - low + 1 >= all { (0, all - 1) } else { (low, high) };
        }
        spans
    }

    /// The rows of these cells, as ranges of sorted places; where only those `behind` a cell count, few others.
    #[inline(always)]
    fn rows(
        &self,
        axes: [usize; 3],
        [(f0, f1), (m0, m1), (mut s0, s1)]: [Span; 3],
        (period, behind): (Option<Period>, Option<[usize; 3]>),
        mut row: impl FnMut(std::ops::Range<usize>),
    ) {
        let [f, m, s] = axes;
        // Beyond the end of a period rows begin anew.
        let behind = behind.filter(|_| !period.is_some_and(|p| p.axis == m || p.axis == s));
        let [own_m, own_s] =
            behind.map_or([m0, s0 - 1], |cell| [cell[m] as isize, cell[s] as isize]);
        s0 = s0.max(own_s);
        for cs in s0..=s1 {
            let m0 = if cs == own_s { own_m } else { m0 };
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
        let team = Team::new(2);
        team.enter(|| cells.sort(p, range, period, &team));
        let mut out = Vec::new();
        let mut begin = 0;
        while begin < p.len() {
            let bodies = cells.together(begin, p.len(), period);
            begin = bodies.places.end;
            cells.for_each_row(&bodies, range, period, |row, coarser| {
                for k in bodies.places.clone() {
                    for m in row.clone().filter(|m| coarser || *m > k) {
                        let (a, b) = (cells.sorted[k], cells.sorted[m]);
                        let d = Period::shortest(period, b.vector() - a.vector());
                        if d.length() < a.w + b.w + range {
                            let (i, j) = (cells.order[k], cells.order[m]);
                            out.push((i.min(j), i.max(j)));
                        }
                    }
                }
            });
        }
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
                let p = cloud(1500, ratio);
                let mut cells = CellList::default();
                assert_eq!(pairs(&mut cells, &p, 0.1, period), brute(&p, 0.1, period));
            }
        }
    }

    #[test]
    fn pairs_across_a_period_of_few_cells_are_found_once() {
        for (cells, length) in [(2, 2.5), (3, 3.5), (4, 4.5)] {
            let period = Some(Period { axis: 2, min: 0.0, length });
            let mut p = cloud(800, 1.0);
            p.iter_mut().for_each(|p| p.z *= length / 6.0);
            let mut list = CellList::default();
            assert_eq!(pairs(&mut list, &p, 0.1, period), brute(&p, 0.1, period), "{cells}");
            assert_eq!(list.levels[0].cells[2], cells);
            // Their rows begin elsewhere for each.
            assert_eq!(list.together(0, p.len(), period).is_alone(), cells < 4);
        }
    }
}
