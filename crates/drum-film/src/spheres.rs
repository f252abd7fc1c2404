//! Spheres as impostors: each pixel's ray is met exactly with each sphere, and the nearest one wins (z-buffer).
//!
//! For a ray through the pinhole with direction `d = (x, y, 1)` in camera axes (right, up, depth) and a sphere of centre c and
//! radius r, the nearer meeting has the depth
//!
//! ```text
//! t = (b - sqrt(b^2 - a (|c|^2 - r^2))) / a,      a = |d|^2,  b = d . c
//! ```
//!
//! so that outlines, depths and the seams of overlapping spheres (clumps) are exact. A pixel is the mean of
//! n x n points. Tiles of the picture are independent and spheres are sorted once, so that any number of threads gives the same bits.

use glam::DVec3;
use rayon::prelude::*;

use crate::camera::{Projection, View};
use crate::canvas::{Color, scaled};
use crate::error::Error;
use crate::light::{Lamp, Light};

/// Side of a tile in pixels.
const TILE: u32 = 32;
/// No sphere here.
const NONE: u32 = u32::MAX;

/// A sphere to be drawn; a clump is several of them with the same `body`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sphere {
    /// Centre, m; the drum's axis is z through the origin.
    pub center: DVec3,
    /// Radius, m.
    pub radius_m: f64,
    /// Spheres of the same body share their shade of grey.
    pub body: u32,
    /// Its colour; `None` takes that of the film's texture.
    pub color: Option<Color>,
}

impl Sphere {
    /// A sphere in the film's own colour.
    #[must_use]
    pub fn new(center: DVec3, radius_m: f64) -> Self {
        Self { center, radius_m, body: 0, color: None }
    }
}

/// Shutter steps between two snapshots of the same spheres: each sphere on the straight line between its places.
///
/// Returns `steps` moments, the first half a step after `from`, the last half a step before `to`.
///
/// # Errors
/// [`Error::NoFrame`] when the snapshots hold different numbers of spheres or `steps` is 0.
pub fn between(from: &[Sphere], to: &[Sphere], steps: u32) -> Result<Vec<Vec<Sphere>>, Error> {
    if from.len() != to.len() || steps == 0 {
        return Err(Error::NoFrame {
            what: "two snapshots of the same spheres and at least one step",
        });
    }
    Ok((0..steps)
        .map(|i| {
            let share = (f64::from(i) + 0.5) / f64::from(steps);
            from.iter()
                .zip(to)
                .map(|(a, b)| Sphere { center: a.center.lerp(b.center, share), ..*a })
                .collect()
        })
        .collect())
}

/// A layer of drawn spheres: colour times coverage, and coverage, of each pixel.
pub(crate) struct Layer {
    /// Red, green, blue (times coverage), coverage.
    pub(crate) pixels: Vec<[f32; 4]>,
}

/// How spheres are painted.
pub(crate) struct Paint<'a> {
    pub(crate) lamp: Lamp,
    pub(crate) light: &'a Light,
    pub(crate) color: &'a (dyn Fn(usize, &Sphere) -> Color + Sync),
    /// Depth of the front plate and of the rear wall, m, for the loss of light in between.
    pub(crate) depths: (f64, f64),
    pub(crate) samples: u32,
}

/// A sphere in camera axes with its box of pixels.
struct Placed {
    c: DVec3,
    r2: f64,
    near: f64,
    index: u32,
    color: Color,
    /// First and last column and row whose centres may lie within half a pixel of the outline.
    columns: (u32, u32),
    rows: (u32, u32),
}

impl Placed {
    /// Where rays of one height meet the sphere, in the coordinate across; `None` where none does.
    ///
    /// In perspective the discriminant `(b0 + x cx)^2 - (a0 + x^2) (|c|^2 - r^2)` is a parabola in x that opens downwards where the
    /// camera lies outside of the sphere's tangent planes across, which is where its outline is an ellipse.
    fn chord<const PERSPECTIVE: bool>(&self, y: f64) -> Option<(f64, f64)> {
        if !PERSPECTIVE {
            let half2 = self.r2 - (y - self.c.y).powi(2);
            return (half2 > 0.0).then(|| (self.c.x - half2.sqrt(), self.c.x + half2.sqrt()));
        }
        let (b0, a0) = (y * self.c.y + self.c.z, y * y + 1.0);
        let cc = self.c.length_squared() - self.r2;
        let (p, q, s) = (cc - self.c.x * self.c.x, b0 * self.c.x, b0 * b0 - a0 * cc);
        if p <= 0.0 {
            return Some((f64::NEG_INFINITY, f64::INFINITY));
        }
        let root = q * q + p * s;
        (root > 0.0).then(|| ((q - root.sqrt()) / p, (q + root.sqrt()) / p))
    }
}

/// Draws spheres into an empty layer.
pub(crate) fn draw(view: &View, spheres: &[Sphere], paint: &Paint<'_>) -> Result<Layer, Error> {
    let mut placed = place(view, spheres, paint.color)?;
    placed.sort_by(|a, b| a.near.total_cmp(&b.near).then(a.index.cmp(&b.index)));
    let tiles_x = view.width_px.div_ceil(TILE);
    let tiles_y = view.height_px.div_ceil(TILE);
    let mut bins = vec![Vec::new(); (tiles_x * tiles_y) as usize];
    for (k, p) in placed.iter().enumerate() {
        for ty in p.rows.0 / TILE..=p.rows.1 / TILE {
            for tx in p.columns.0 / TILE..=p.columns.1 / TILE {
                bins[(ty * tiles_x + tx) as usize].push(k as u32);
            }
        }
    }
    let width = view.width_px as usize;
    let mut pixels = vec![[0.0_f32; 4]; width * view.height_px as usize];
    // A row of tiles owns whole rows of the picture.
    pixels.par_chunks_mut(width * TILE as usize).enumerate().for_each(|(ty, rows)| {
        let bins = &bins[ty * tiles_x as usize..(ty + 1) * tiles_x as usize];
        let mut tile = Tile::new(paint.samples);
        for (tx, bin) in bins.iter().enumerate() {
            if !bin.is_empty() {
                tile.fill(view, tx as u32 * TILE, ty as u32 * TILE, &placed, bin);
                tile.paint(view, &placed, paint, rows);
            }
        }
    });
    Ok(Layer { pixels })
}

fn place(
    view: &View,
    spheres: &[Sphere],
    color: &(dyn Fn(usize, &Sphere) -> Color + Sync),
) -> Result<Vec<Placed>, Error> {
    let mut placed = Vec::with_capacity(spheres.len());
    for (index, s) in spheres.iter().enumerate() {
        if !(s.center.is_finite() && s.radius_m.is_finite() && s.radius_m > 0.0) {
            return Err(Error::BadSphere {
                index,
                center: s.center.to_array(),
                radius_m: s.radius_m,
            });
        }
        let c = view.to_camera(s.center);
        let r = s.radius_m;
        let near = c.z - r;
        if near < 1e-3 * view.distance_m {
            return Err(Error::SphereAtCamera { index, depth_m: near });
        }
        let f = view.principal_px;
        // Tangents of the outline in one axis: exact for a pinhole (Mara and McGuire 2013 bound the same way).
        let range = |x: f64| match view.projection {
            Projection::Perspective => {
                let root = r * (x * x + near * (c.z + r)).sqrt();
                let below = near * (c.z + r);
                (f * (x * c.z - root) / below, f * (x * c.z + root) / below)
            }
            Projection::Orthographic => {
                let k = f / view.distance_m;
                (k * (x - r), k * (x + r))
            }
        };
        let (left, right) = range(c.x);
        let (down, up) = range(c.y);
        let columns = pixels(view.center_px.x + left, view.center_px.x + right, view.width_px);
        let rows = pixels(view.center_px.y - up, view.center_px.y - down, view.height_px);
        if let (Some(columns), Some(rows)) = (columns, rows) {
            let (r2, color) = (r * r, color(index, s));
            placed.push(Placed { c, r2, near, index: index as u32, color, columns, rows });
        }
    }
    Ok(placed)
}

/// Whole pixels that reach into a range; `None` outside the picture.
fn pixels(from: f64, to: f64, count: u32) -> Option<(u32, u32)> {
    let first = (from - 0.5).ceil().max(0.0);
    let last = (to + 0.5).floor().min(f64::from(count) - 1.0);
    (first <= last).then_some((first as u32, last as u32))
}

/// Depth and winner of every point of a tile, rows of points of `side` each.
struct Tile {
    samples: usize,
    side: usize,
    depth: Vec<f64>,
    winner: Vec<u32>,
    u0: u32,
    v0: u32,
}

impl Tile {
    fn new(samples: u32) -> Self {
        let samples = samples as usize;
        let side = TILE as usize * samples;
        Self {
            samples,
            side,
            depth: vec![f64::INFINITY; side * side],
            winner: vec![NONE; side * side],
            u0: 0,
            v0: 0,
        }
    }

    /// Coordinate of a point along one axis in the picture.
    fn coordinate(&self, origin: u32, k: usize) -> f64 {
        f64::from(origin) + (k as f64 + 0.5) / self.samples as f64 - 0.5
    }

    fn fill(&mut self, view: &View, u0: u32, v0: u32, placed: &[Placed], bin: &[u32]) {
        (self.u0, self.v0) = (u0, v0);
        self.depth.fill(f64::INFINITY);
        self.winner.fill(NONE);
        let mut farthest = f64::INFINITY;
        for (count, &k) in bin.iter().enumerate() {
            // Spheres come nearest first: none behind the farthest point can show.
            if count % 16 == 15 {
                farthest = self.depth.iter().copied().fold(0.0, f64::max);
            }
            let p = &placed[k as usize];
            if p.near > farthest {
                break;
            }
            match view.projection {
                Projection::Perspective => self.add::<true>(view, k, p),
                Projection::Orthographic => self.add::<false>(view, k, p),
            }
        }
    }

    fn add<const PERSPECTIVE: bool>(&mut self, view: &View, k: u32, p: &Placed) {
        let n = self.samples;
        let span = |range: (u32, u32), origin: u32| {
            let first = range.0.max(origin) - origin;
            let last = range.1.min(origin + TILE - 1) - origin;
            (first as usize * n, (last as usize + 1) * n)
        };
        let (i0, i1) = span(p.columns, self.u0);
        let (j0, j1) = span(p.rows, self.v0);
        let inverse = 1.0 / view.principal_px;
        let unit = if PERSPECTIVE { 1.0 } else { view.distance_m };
        let step = inverse * unit / n as f64;
        let x0 = (self.coordinate(self.u0, 0) - view.center_px.x) * inverse * unit;
        for j in j0..j1 {
            let y = -(self.coordinate(self.v0, j) - view.center_px.y) * inverse * unit;
            let Some((left, right)) = p.chord::<PERSPECTIVE>(y) else { continue };
            // A point more at either end, for rounding.
            let point = |x: f64| ((x - x0) / step).clamp(i0 as f64, i1 as f64);
            let (i0, i1) = (point(left) as usize, (point(right + 2.0 * step) as usize).min(i1));
            let depth = &mut self.depth[j * self.side + i0..j * self.side + i1];
            // What is nearer all along hides it.
            if depth.iter().fold(0.0, |far, d| if *d > far { *d } else { far }) <= p.near {
                continue;
            }
            let winner = &mut self.winner[j * self.side + i0..j * self.side + i1];
            if PERSPECTIVE {
                // Conditions as comparisons on whole rows, so that the loop runs in lanes.
                let b0 = y * p.c.y + p.c.z;
                let a0 = y * y + 1.0;
                let cc = p.c.length_squared() - p.r2;
                for (i, (d, w)) in depth.iter_mut().zip(winner).enumerate() {
                    let x = x0 + step * (i0 + i) as f64;
                    let b = b0 + x * p.c.x;
                    let a = a0 + x * x;
                    let disc = b * b - a * cc;
                    let t = (b - disc.max(0.0).sqrt()) / a;
                    let wins = disc > 0.0 && t < *d;
                    *d = if wins { t } else { *d };
                    *w = if wins { k } else { *w };
                }
            } else {
                let dy2 = (y - p.c.y).powi(2);
                for (i, (d, w)) in depth.iter_mut().zip(winner).enumerate() {
                    let x = x0 + step * (i0 + i) as f64;
                    let disc = p.r2 - dy2 - (x - p.c.x).powi(2);
                    let t = p.c.z - disc.max(0.0).sqrt();
                    let wins = disc > 0.0 && t < *d;
                    *d = if wins { t } else { *d };
                    *w = if wins { k } else { *w };
                }
            }
        }
    }

    fn paint(&self, view: &View, placed: &[Placed], paint: &Paint<'_>, rows: &mut [[f32; 4]]) {
        let n = self.samples;
        let weight = 1.0 / (n * n) as f32;
        let columns = (view.width_px - self.u0).min(TILE) as usize;
        let row_count = (view.height_px - self.v0).min(TILE) as usize;
        for row in 0..row_count {
            for column in 0..columns {
                let target = &mut rows[row * view.width_px as usize + self.u0 as usize + column];
                let first = self.winner[row * n * self.side + column * n];
                let mut points = (row * n..(row + 1) * n).flat_map(|j| {
                    self.winner[j * self.side + column * n..j * self.side + (column + 1) * n].iter()
                });
                if points.all(|&k| k == first) {
                    // A pixel on one sphere alone shows the shade in its middle.
                    if first != NONE {
                        let (u, v) = (f64::from(self.u0), f64::from(self.v0));
                        let (u, v) = (u + column as f64, v + row as f64);
                        let c = shade(view, u, v, &placed[first as usize], paint);
                        *target = [c[0], c[1], c[2], 1.0];
                    }
                    continue;
                }
                let mut sum = [0.0_f32; 4];
                for j in row * n..(row + 1) * n {
                    let line = j * self.side;
                    let mut i = column * n;
                    while i < (column + 1) * n {
                        let k = self.winner[line + i];
                        if k == NONE {
                            i += 1;
                            continue;
                        }
                        // Neighbours on the same sphere share one shade, in their middle.
                        let mut end = i + 1;
                        while end < (column + 1) * n && self.winner[line + end] == k {
                            end += 1;
                        }
                        let u =
                            0.5 * (self.coordinate(self.u0, i) + self.coordinate(self.u0, end - 1));
                        let v = self.coordinate(self.v0, j);
                        let c = shade(view, u, v, &placed[k as usize], paint);
                        let w = weight * (end - i) as f32;
                        for q in 0..3 {
                            sum[q] += w * c[q];
                        }
                        sum[3] += w;
                        i = end;
                    }
                }
                *target = sum;
            }
        }
    }
}

/// Colour of a placed sphere at a pixel coordinate.
fn shade(view: &View, u: f64, v: f64, p: &Placed, paint: &Paint<'_>) -> Color {
    let color = p.color;
    if paint.light.is_flat() {
        return color;
    }
    let x = (u - view.center_px.x) / view.principal_px;
    let y = -(v - view.center_px.y) / view.principal_px;
    // Point of meeting and direction of sight in camera axes.
    let (point, sight) = match view.projection {
        Projection::Perspective => {
            let d = DVec3::new(x, y, 1.0);
            let (a, b) = (d.length_squared(), d.dot(p.c));
            let disc = b * b - a * (p.c.length_squared() - p.r2);
            (d * ((b - disc.max(0.0).sqrt()) / a), d)
        }
        Projection::Orthographic => {
            let (x, y) = (x * view.distance_m, y * view.distance_m);
            let disc = p.r2 - (x - p.c.x).powi(2) - (y - p.c.y).powi(2);
            (DVec3::new(x, y, p.c.z - disc.max(0.0).sqrt()), DVec3::Z)
        }
    };
    let world = |w: DVec3| view.right * w.x + view.up * w.y - view.backward * w.z;
    let normal = world((point - p.c).normalize_or(-DVec3::Z));
    let lit = paint.lamp.shade(color, normal, world(-sight).normalize());
    let (front, rear) = paint.depths;
    let share = ((point.z - front) / (rear - front).max(1e-12)).clamp(0.0, 1.0);
    scaled(lit, (1.0 - paint.light.depth_loss * share) as f32)
}
