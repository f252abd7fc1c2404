//! Isolines and regions of fields on a regular grid, exact for the linear interpolant.
//!
//! Every cell is cut into two triangles, on which a field is linear: an isoline is then a straight
//! segment and the set where several fields lie within their bands is a convex polygon, found by
//! clipping the triangle at each bound (Sutherland and Hodgman 1974). Edges that two polygons share
//! cancel, so that a region comes out as closed loops without inner seams, however narrow it is
//! compared with a cell. Triangles have no saddle ambiguity, which squares have.

use std::collections::BTreeMap;

/// A field sampled on a regular grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grid {
    /// Count of columns (along x), at least 2 for a picture.
    pub nx: usize,
    /// Count of rows (along y), at least 2 for a picture.
    pub ny: usize,
    /// First and last x.
    pub x_range: (f64, f64),
    /// First and last y.
    pub y_range: (f64, f64),
    /// `nx * ny` values, row by row: x runs fastest, y upwards.
    pub values: Vec<f64>,
}

/// A bound on a field: `lo <= field <= hi`.
#[derive(Clone, Copy, Debug)]
pub struct Bounds<'a> {
    /// The field; its grid is that of every other field of the same region.
    pub field: &'a Grid,
    /// Lower bound, or negative infinity.
    pub lo: f64,
    /// Upper bound, or infinity.
    pub hi: f64,
}

/// A chain of points (x, y) in data units.
pub type Chain = Vec<(f64, f64)>;

impl Grid {
    /// Samples a function of (x, y).
    ///
    /// ```
    /// use calib_report::contour::Grid;
    /// // Angle of repose, degrees, of a made-up surrogate over (mu_wall, mu_pp).
    /// let angle = Grid::sample(31, 31, (0.4, 0.8), (0.1, 0.9), |_, mu| 20.0 + 12.0 * mu);
    /// assert_eq!(angle.values.len(), 31 * 31);
    /// let lines = angle.isolines(26.0);
    /// assert!(lines[0].iter().all(|(_, mu)| (mu - 0.5).abs() < 1e-12));
    /// ```
    pub fn sample(
        nx: usize,
        ny: usize,
        x_range: (f64, f64),
        y_range: (f64, f64),
        mut field: impl FnMut(f64, f64) -> f64,
    ) -> Self {
        let mut grid = Self { nx, ny, x_range, y_range, values: Vec::new() };
        grid.values.reserve(nx.saturating_mul(ny));
        for j in 0..ny {
            for i in 0..nx {
                let value = field(grid.x(i), grid.y(j));
                grid.values.push(value);
            }
        }
        grid
    }

    /// The x of a column.
    pub fn x(&self, column: usize) -> f64 {
        along(self.x_range, column, self.nx)
    }

    /// The y of a row.
    pub fn y(&self, row: usize) -> f64 {
        along(self.y_range, row, self.ny)
    }

    /// Whether the grid can be drawn: two rows and columns, proper ranges, a value for each node.
    pub fn is_drawable(&self) -> bool {
        let proper = |(a, b): (f64, f64)| a.is_finite() && b.is_finite() && b > a;
        self.nx >= 2
            && self.ny >= 2
            && proper(self.x_range)
            && proper(self.y_range)
            && self.nx.checked_mul(self.ny) == Some(self.values.len())
    }

    /// Whether another field has the same nodes.
    pub fn same_nodes(&self, other: &Grid) -> bool {
        (self.nx, self.ny, self.x_range, self.y_range)
            == (other.nx, other.ny, other.x_range, other.y_range)
    }

    /// The smallest and the largest finite value.
    pub fn value_range(&self) -> Option<(f64, f64)> {
        crate::number::extent(self.values.iter().copied())
    }

    /// The lines on which the field has a value; cells with a non-finite corner are left out.
    pub fn isolines(&self, level: f64) -> Vec<Chain> {
        let mut edges = EdgeSet::new(self);
        if self.is_drawable() && level.is_finite() {
            for corners in triangles(self.nx, self.ny) {
                let nodes = corners.map(|n| Node {
                    x: self.x(n % self.nx),
                    y: self.y(n / self.nx),
                    values: vec![self.values[n] - level],
                });
                if nodes.iter().any(|n| !n.values[0].is_finite()) {
                    continue;
                }
                let mut ends = Vec::with_capacity(2);
                for k in 0..3 {
                    let (a, b) = (&nodes[k], &nodes[(k + 1) % 3]);
                    // A node on the level counts as above it, so every line has two ends.
                    if (a.values[0] >= 0.0) != (b.values[0] >= 0.0) {
                        let point = crossing(a, b, 0, 0.0);
                        ends.push((point.x, point.y));
                    }
                }
                if let [a, b] = ends[..] {
                    edges.add(a, b);
                }
            }
        }
        edges.chains(false)
    }
}

/// The region in which all bounds hold, as closed loops for even-odd filling; empty where the grids
/// do not agree or cannot be drawn.
pub fn region(bounds: &[Bounds<'_>]) -> Vec<Chain> {
    let Some(first) = bounds.first().map(|b| b.field) else { return Vec::new() };
    let agree = bounds.iter().all(|b| b.field.is_drawable() && b.field.same_nodes(first));
    if !agree {
        return Vec::new();
    }
    let mut edges = EdgeSet::new(first);
    for corners in triangles(first.nx, first.ny) {
        let mut polygon: Vec<Node> = corners
            .iter()
            .map(|&n| Node {
                x: first.x(n % first.nx),
                y: first.y(n / first.nx),
                values: bounds.iter().map(|b| b.field.values[n]).collect(),
            })
            .collect();
        if polygon.iter().any(|n| n.values.iter().any(|v| !v.is_finite())) {
            continue;
        }
        for (k, bound) in bounds.iter().enumerate() {
            if bound.lo > f64::NEG_INFINITY {
                polygon = clipped(&polygon, k, bound.lo, 1.0);
            }
            if bound.hi < f64::INFINITY {
                polygon = clipped(&polygon, k, bound.hi, -1.0);
            }
        }
        for k in 0..polygon.len() {
            let (a, b) = (&polygon[k], &polygon[(k + 1) % polygon.len()]);
            edges.add((a.x, a.y), (b.x, b.y));
        }
    }
    edges.chains(true)
}

/// Area enclosed by loops under the even-odd rule, for loops that do not cross.
///
/// Loops of [`region`] run counter-clockwise around the region and clockwise around its holes.
pub fn area(loops: &[Chain]) -> f64 {
    loops
        .iter()
        .map(|l| {
            let pairs = l.iter().zip(l.iter().cycle().skip(1));
            0.5 * pairs.map(|((x1, y1), (x2, y2))| x1 * y2 - x2 * y1).sum::<f64>()
        })
        .sum()
}

fn along((first, last): (f64, f64), i: usize, n: usize) -> f64 {
    if i + 1 == n { last } else { first + (last - first) * i as f64 / (n.max(2) - 1) as f64 }
}

/// A corner of a polygon with the values of all fields there.
#[derive(Clone, Debug)]
struct Node {
    x: f64,
    y: f64,
    values: Vec<f64>,
}

/// Corner numbers of the two triangles of every cell, counter-clockwise.
fn triangles(nx: usize, ny: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..ny - 1).flat_map(move |j| {
        (0..nx - 1).flat_map(move |i| {
            let n = j * nx + i;
            [[n, n + 1, n + nx + 1], [n, n + nx + 1, n + nx]]
        })
    })
}

/// The part of a convex polygon where `sign * (field - bound) >= 0`.
fn clipped(polygon: &[Node], field: usize, bound: f64, sign: f64) -> Vec<Node> {
    let inside = |n: &Node| sign * (n.values[field] - bound) >= 0.0;
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for k in 0..polygon.len() {
        let (a, b) = (&polygon[k], &polygon[(k + 1) % polygon.len()]);
        if inside(a) {
            out.push(a.clone());
        }
        if inside(a) != inside(b) {
            out.push(crossing(a, b, field, bound));
        }
    }
    out
}

/// The point between two nodes where a field has a value.
///
/// The two are taken in a fixed order, so that neighbours sharing an edge find the same bits.
fn crossing(a: &Node, b: &Node, field: usize, value: f64) -> Node {
    let (a, b) = if (a.x, a.y) <= (b.x, b.y) { (a, b) } else { (b, a) };
    let t = (value - a.values[field]) / (b.values[field] - a.values[field]);
    let t = t.clamp(0.0, 1.0);
    let mix = |p: f64, q: f64| p + t * (q - p);
    Node {
        x: mix(a.x, b.x),
        y: mix(a.y, b.y),
        values: a.values.iter().zip(&b.values).map(|(p, q)| mix(*p, *q)).collect(),
    }
}

/// Position in steps of 2^-30 of the grid's extent: exact equality for shared corners.
type Key = (i64, i64);

/// Directed edges of which opposite ones cancel.
struct EdgeSet {
    origin: (f64, f64),
    step: (f64, f64),
    edges: BTreeMap<(Key, Key), usize>,
    points: BTreeMap<Key, (f64, f64)>,
}

impl EdgeSet {
    fn new(grid: &Grid) -> Self {
        let resolution = f64::from(1u32 << 30);
        Self {
            origin: (grid.x_range.0, grid.y_range.0),
            step: (
                (grid.x_range.1 - grid.x_range.0) / resolution,
                (grid.y_range.1 - grid.y_range.0) / resolution,
            ),
            edges: BTreeMap::new(),
            points: BTreeMap::new(),
        }
    }

    fn add(&mut self, a: (f64, f64), b: (f64, f64)) {
        let key = |p: (f64, f64)| {
            (
                ((p.0 - self.origin.0) / self.step.0).round() as i64,
                ((p.1 - self.origin.1) / self.step.1).round() as i64,
            )
        };
        let (ka, kb) = (key(a), key(b));
        if ka == kb {
            return;
        }
        self.points.entry(ka).or_insert(a);
        self.points.entry(kb).or_insert(b);
        if let Some(count) = self.edges.get_mut(&(kb, ka)) {
            *count -= 1;
            if *count == 0 {
                self.edges.remove(&(kb, ka));
            }
        } else {
            *self.edges.entry((ka, kb)).or_insert(0) += 1;
        }
    }

    /// Joins the edges end to start; `directed` keeps their sense, as loops of regions need it.
    fn chains(self, directed: bool) -> Vec<Chain> {
        let mut next: BTreeMap<Key, Vec<Key>> = BTreeMap::new();
        let mut open_ends: BTreeMap<Key, usize> = BTreeMap::new();
        for (a, b) in self.edges.keys() {
            next.entry(*a).or_default().push(*b);
            if !directed {
                next.entry(*b).or_default().push(*a);
                *open_ends.entry(*a).or_insert(0) += 1;
                *open_ends.entry(*b).or_insert(0) += 1;
            }
        }
        // Lines that end at the border must be begun at an end; loops may begin anywhere.
        let ends = open_ends.iter().filter(|(_, n)| **n % 2 == 1).map(|(k, _)| *k);
        let starts: Vec<Key> = ends.chain(self.edges.keys().map(|(a, _)| *a)).collect();
        let mut chains = Vec::new();
        for start in starts {
            while let Some(chain) = walk(&mut next, start, directed) {
                let points = chain.iter().filter_map(|k| self.points.get(k).copied());
                let mut points: Chain = points.collect();
                if directed {
                    points.pop(); // the closing point repeats the first
                }
                chains.push(points);
            }
        }
        chains
    }
}

/// Follows unused edges from a point until there is none or the start is reached again.
fn walk(next: &mut BTreeMap<Key, Vec<Key>>, start: Key, directed: bool) -> Option<Vec<Key>> {
    let mut chain = vec![start];
    let mut here = start;
    while let Some(there) = next.get_mut(&here).and_then(Vec::pop) {
        if !directed && let Some(back) = next.get_mut(&there) {
            back.retain(|k| *k != here);
        }
        chain.push(there);
        here = there;
        if here == start {
            break;
        }
    }
    (chain.len() > 1).then_some(chain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn isoline_of_a_paraboloid_lies_on_its_circle() {
        // Chord error of linear interpolation of r^2 with step h = 0.02: at most h^2/2/(2r) = 1e-4
        // (both directions together).
        let grid = Grid::sample(201, 201, (-2.0, 2.0), (-2.0, 2.0), |x, y| x * x + y * y);
        let lines = grid.isolines(1.0);
        assert_eq!(lines.len(), 1, "one closed line");
        assert_eq!(lines[0].first(), lines[0].last());
        assert!(lines[0].iter().all(|(x, y)| (x.hypot(*y) - 1.0).abs() < 2e-4));
    }

    #[test]
    fn isoline_of_a_plane_is_exact_and_one_piece() {
        let grid = Grid::sample(17, 23, (0.0, 1.0), (0.0, 2.0), |x, y| x + y);
        let lines = grid.isolines(0.77);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().all(|(x, y)| (x + y - 0.77).abs() < 1e-12));
    }

    #[test]
    fn level_through_nodes_gives_one_line() {
        let grid = Grid::sample(11, 11, (0.0, 1.0), (0.0, 1.0), |_, y| y);
        let lines = grid.isolines(0.5);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].len() >= 11, "it crosses every column");
    }

    #[test]
    fn region_of_a_ring_has_its_area() {
        // Polygons inscribed on a 0.02 grid: relative area error below 1e-3.
        let grid = Grid::sample(201, 201, (-2.0, 2.0), (-2.0, 2.0), |x, y| x * x + y * y);
        let ring = region(&[Bounds { field: &grid, lo: 0.5, hi: 1.5 }]);
        assert_eq!(ring.len(), 2, "an outer and an inner loop");
        assert!((area(&ring) - std::f64::consts::PI).abs() < 3e-3);
    }

    #[test]
    fn intersection_narrower_than_a_cell_is_found() {
        let a = Grid::sample(5, 5, (0.0, 1.0), (0.0, 1.0), |x, _| x);
        let b = Grid::sample(5, 5, (0.0, 1.0), (0.0, 1.0), |_, y| y);
        let small = region(&[
            Bounds { field: &a, lo: 0.30, hi: 0.31 },
            Bounds { field: &b, lo: 0.60, hi: 0.62 },
        ]);
        assert!((area(&small) - 0.01 * 0.02).abs() < 1e-12, "area {}", area(&small));
    }

    #[test]
    fn the_whole_map_is_one_rectangle() {
        let grid = Grid::sample(9, 7, (0.0, 2.0), (0.0, 1.0), |x, _| x);
        let all = region(&[Bounds { field: &grid, lo: f64::NEG_INFINITY, hi: f64::INFINITY }]);
        assert_eq!(all.len(), 1);
        assert!((area(&all) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn bad_grids_give_nothing() {
        let short = Grid { nx: 3, ny: 3, values: vec![1.0], ..Default::default() };
        assert!(short.isolines(1.0).is_empty());
        let nan = Grid::sample(4, 4, (0.0, 1.0), (0.0, 1.0), |_, _| f64::NAN);
        assert!(nan.isolines(1.0).is_empty());
        assert!(region(&[Bounds { field: &nan, lo: 0.0, hi: 1.0 }]).is_empty());
        assert!(region(&[]).is_empty());
    }
}
