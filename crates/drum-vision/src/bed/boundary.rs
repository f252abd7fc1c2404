//! The curve that parts the drum's interior into bed and background at least cost: dynamic programming.
//!
//! In coordinates turned with the line of [`super::split`], `u` along it towards the right and `v` across it
//! into the bed, the boundary is one `v` for every `u`. Its cost is the squared misfit of every
//! sample to the grey expected on its side, plus a penalty on steps from one `u` to the next. Expected
//! greys are planes over the drum, fitted to the two sides of the first result, so that
//! uneven light does not count as misfit.

use super::prepare::Prepared;
use super::split::LineSplit;
use crate::linear::solve_normal;

/// Penalty on a step of one cell between neighbouring columns, in units of a misfit cell.
const STEP_COST: f64 = 0.3;
/// Largest step, cells.
const MAX_STEP: usize = 4;
/// Cells over the radius.
const CELLS: usize = 100;

/// Axes turned with the surface: unit vectors along it and across it into the bed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurnedAxes {
    /// Centre of the drum in the plane's coordinates.
    pub center: (f64, f64),
    /// Cosine and sine of the turn.
    pub turn: (f64, f64),
}

impl TurnedAxes {
    /// Axes for a surface that rises to the right by an angle.
    #[must_use]
    pub fn new(center: (f64, f64), angle_deg: f64) -> Self {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        Self { center, turn: (cos, sin) }
    }

    /// Picture coordinates of `(u, v)`.
    #[must_use]
    #[inline]
    pub fn to_picture(&self, u: f64, v: f64) -> (f64, f64) {
        let (cos, sin) = self.turn;
        (self.center.0 + u * cos + v * sin, self.center.1 - u * sin + v * cos)
    }
}

/// The coarse boundary.
#[derive(Clone, Debug)]
pub struct Boundary {
    /// Axes in which it is a function.
    pub axes: TurnedAxes,
    /// Spacing of `u`, pixels; the first column lies at `-radius`.
    pub step_px: f64,
    /// `v` of the boundary in every column, pixels; `None` where the column holds one side only, or the rim.
    pub v_px: Vec<Option<f64>>,
    /// Expected greys: `(constant, per u, per v)` above and below the boundary, `u` and `v` in radii.
    pub levels: [[f64; 3]; 2],
    /// Fraction of the drum's interior below the boundary.
    pub fill: f64,
    /// Root mean square of the misfit, in units of the contrast.
    pub misfit: f64,
}

impl Boundary {
    /// `u` of a column.
    #[must_use]
    pub fn u_px(&self, column: usize) -> f64 {
        (column as f64 - CELLS as f64) * self.step_px
    }

    /// The two expected greys at a point.
    #[must_use]
    pub fn expected(&self, u_px: f64, v_px: f64) -> (f64, f64) {
        let r = CELLS as f64 * self.step_px;
        let at = |l: &[f64; 3]| l[0] + l[1] * u_px / r + l[2] * v_px / r;
        (at(&self.levels[0]), at(&self.levels[1]))
    }
}

/// Traces the boundary from the line split.
#[must_use]
pub fn trace(prepared: &Prepared, line: &LineSplit) -> Boundary {
    let c = prepared.circle;
    let axes = TurnedAxes::new((c.x_px, c.y_px), line.angle_deg);
    let n = 2 * CELLS + 1;
    let step = c.radius_px / CELLS as f64;
    let bin = step.round().max(1.0) as usize;
    let small = prepared.plane.binned(bin);
    let k = bin as f64;
    let hub_cells = prepared.hub_px / step + 1.0;
    let mut grey = vec![f64::NAN; n * n];
    for i in 0..n {
        for j in 0..n {
            let (u, v) = (i as f64 - CELLS as f64, j as f64 - CELLS as f64);
            let r = (u * u + v * v).sqrt();
            if r < 0.97 * CELLS as f64 && (r > hub_cells || prepared.hub_px == 0.0) {
                let (x, y) = axes.to_picture(u * step, v * step);
                if prepared.is_hidden(x, y) {
                    continue;
                }
                let binned = |p: f64| (p - 0.5 * (k - 1.0)) / k;
                grey[i * n + j] = small.sample(binned(x), binned(y));
            }
        }
    }
    let mut levels = [[line.above, 0.0, 0.0], [line.below, 0.0, 0.0]];
    let mut path = vec![0usize; n];
    let mut misfit = 0.0;
    for round in 0..3 {
        (path, misfit) = cheapest_path(&grey, n, &levels);
        if round < 2 {
            levels = fit_levels(&grey, n, &path, &levels);
        }
    }
    let (mut below, mut all) = (0usize, 0usize);
    for (i, &first) in path.iter().enumerate() {
        for j in 0..n {
            let (u, v) = (i as f64 - CELLS as f64, j as f64 - CELLS as f64);
            if (u * u + v * v).sqrt() < 0.97 * CELLS as f64 {
                all += 1;
                below += usize::from(j >= first);
            }
        }
    }
    let v_px = path
        .iter()
        .enumerate()
        .map(|(i, &j)| {
            // The boundary lies between cells j - 1 and j.
            let (u, v) = (i as f64 - CELLS as f64, j as f64 - 0.5 - CELLS as f64);
            (u.hypot(v) < 0.955 * CELLS as f64).then_some(v * step)
        })
        .collect();
    Boundary { axes, step_px: step, v_px, levels, fill: below as f64 / all.max(1) as f64, misfit }
}

/// For every column the first cell that counts as bed.
fn cheapest_path(grey: &[f64], n: usize, levels: &[[f64; 3]; 2]) -> (Vec<usize>, f64) {
    let r = CELLS as f64;
    // Cumulated gain of calling the first j cells background rather than bed.
    let mut cost = vec![0.0f64; n * (n + 1)];
    let mut floor = 0.0;
    let mut count = 0.0;
    for i in 0..n {
        let column = &mut cost[i * (n + 1)..(i + 1) * (n + 1)];
        let u = i as f64 / r - 1.0;
        let mut sum = 0.0;
        for j in 0..n {
            let g = grey[i * n + j];
            if !g.is_nan() {
                let v = j as f64 / r - 1.0;
                let at = |l: &[f64; 3]| l[0] + l[1] * u + l[2] * v;
                let (a, b) = (at(&levels[0]), at(&levels[1]));
                let contrast = if (b - a).abs() < 4.0 { 4.0 * (b - a).signum() } else { b - a };
                let s = ((g - a) / contrast).clamp(0.0, 1.0);
                sum += s * s - (1.0 - s) * (1.0 - s);
                floor += (1.0 - s) * (1.0 - s);
                count += 1.0;
            }
            column[j + 1] = sum;
        }
    }
    let width = n + 1;
    // Steps to the nearest cells of a column that are no cell count as endless; so rows are as long on either side.
    let mut total = vec![f64::INFINITY; width + 2 * MAX_STEP];
    total[MAX_STEP..MAX_STEP + width].copy_from_slice(&cost[..width]);
    let mut next = vec![0.0f64; width];
    let mut step = vec![0.0f32; n * width];
    for i in 1..n {
        next.fill(f64::INFINITY);
        let step = &mut step[i * width..(i + 1) * width];
        // Whole rows for one step after the other, the lowest cell first, so that the loop runs in lanes.
        for shift in 0..=2 * MAX_STEP {
            let d = shift as f64 - MAX_STEP as f64;
            let (penalty, own) = (STEP_COST * d * d, d as f32);
            for ((best, step), t) in next.iter_mut().zip(&mut *step).zip(&total[shift..]) {
                let value = t + penalty;
                let wins = value < *best;
                *best = if wins { value } else { *best };
                *step = if wins { own } else { *step };
            }
        }
        let column = &cost[i * width..(i + 1) * width];
        let rows = total[MAX_STEP..].iter_mut().zip(next.iter().zip(column));
        rows.for_each(|(t, (best, c))| *t = best + c);
    }
    let total = &total[MAX_STEP..MAX_STEP + width];
    let mut j =
        (0..width).min_by(|&a, &b| total[a].total_cmp(&total[b]).then(a.cmp(&b))).unwrap_or(0);
    let mut path = vec![0; n];
    for i in (0..n).rev() {
        path[i] = j;
        if i > 0 {
            j = j.saturating_add_signed(step[i * width + j] as isize);
        }
    }
    let data: f64 = path.iter().enumerate().map(|(i, &j)| cost[i * width + j]).sum();
    (path, ((floor + data).max(0.0) / f64::max(count, 1.0)).sqrt())
}

/// Planes through the greys of either side, two cells away from the boundary, robust against spots.
fn fit_levels(grey: &[f64], n: usize, path: &[usize], old: &[[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let r = CELLS as f64;
    let mut levels = *old;
    for (side, level) in levels.iter_mut().enumerate() {
        for _ in 0..3 {
            let mut normal = [[0.0; 3]; 3];
            let mut right = [0.0; 3];
            let contrast = (old[1][0] - old[0][0]).abs().max(8.0);
            for i in (0..n).step_by(2) {
                let range =
                    if side == 0 { 0..path[i].saturating_sub(2) } else { (path[i] + 2).min(n)..n };
                for j in range.step_by(2) {
                    let g = grey[i * n + j];
                    if g.is_nan() {
                        continue;
                    }
                    let row = [1.0, i as f64 / r - 1.0, j as f64 / r - 1.0];
                    let t = (g - level[0] - level[1] * row[1] - level[2] * row[2]) / contrast;
                    let w = 1.0 / (1.0 + 4.0 * t * t);
                    for p in 0..3 {
                        right[p] += w * row[p] * g;
                        for q in 0..3 {
                            normal[p][q] += w * row[p] * row[q];
                        }
                    }
                }
            }
            // A thin side does not tell its slopes: hold them near zero.
            normal[0][0] += 1e-6;
            normal[1][1] += 20.0;
            normal[2][2] += 20.0;
            if let Some(s) = solve_normal(&normal, &right) {
                *level = s;
            }
        }
    }
    levels
}
