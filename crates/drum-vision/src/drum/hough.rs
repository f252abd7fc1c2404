//! Circular Hough transform with the radius coded in the phase of one complex accumulator.
//!
//! Every edge pixel votes along its gradient for centres at all radii of the range; the vote for radius `r` is
//! `exp(i phi(r)) / r` with `phi = 2 pi (ln r - ln r_min) / (ln r_max - ln r_min)`. Votes for one circle arrive
//! with one phase and add up, others cancel; the phase at the peak tells the radius
//! (T. J. Atherton, D. J. Kerbyson, Image Vis. Comput. 17 (1999) 795, doi:10.1016/S0262-8856(98)00160-7).
//! MATLAB's `imfindcircles` uses the same method.

use crate::filter::gradient::sobel;
use crate::frame::Plane;

/// Which way the gradient points on the circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contrast {
    /// Outwards: the disc is darker than its surroundings.
    DarkDisc,
    /// Inwards: the disc is lighter.
    LightDisc,
}

/// A circle as the transform sees it, in pixels of the plane searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoughCircle {
    /// Centre column.
    pub x: f64,
    /// Centre row.
    pub y: f64,
    /// Radius.
    pub radius: f64,
    /// Fraction of 180 sectors of the circumference with an edge pixel within one and a half pixels whose
    /// gradient points along the radius.
    pub support: f64,
    /// Sense of the gradient.
    pub contrast: Contrast,
}

/// An edge pixel: position, unit gradient and its strength.
struct EdgePixel {
    x: f64,
    y: f64,
    nx: f64,
    ny: f64,
}

/// Circles with a radius in `range`, strongest first, at most `count` of them with different centres.
///
/// `edge_fraction` is the least gradient of an edge pixel over the largest gradient of the plane.
#[must_use]
pub fn find_circles(
    plane: &Plane,
    range: (f64, f64),
    contrast: Contrast,
    edge_fraction: f64,
    count: usize,
) -> Vec<HoughCircle> {
    let edges = edge_pixels(plane, edge_fraction);
    let (r_min, r_max) = range;
    if edges.len() < 16 || r_min < 2.0 || r_max <= r_min {
        return Vec::new();
    }
    let sign = match contrast {
        Contrast::DarkDisc => -1.0,
        Contrast::LightDisc => 1.0,
    };
    let (w, h) = (plane.width, plane.height);
    let (mut re, mut im) = (vec![0.0f64; w * h], vec![0.0f64; w * h]);
    let steps = ((r_max - r_min) / 0.5).ceil().max(1.0) as usize;
    let code: Vec<(f64, f64, f64)> = (0..=steps)
        .map(|k| {
            let r = r_min + (r_max - r_min) * k as f64 / steps as f64;
            let phi = std::f64::consts::TAU * (r / r_min).ln() / (r_max / r_min).ln();
            (r, phi.cos() / r, phi.sin() / r)
        })
        .collect();
    let (right, bottom) = (w as f64, h as f64);
    for e in &edges {
        for &(r, c, s) in &code {
            let (x, y) = (e.x + sign * r * e.nx + 0.5, e.y + sign * r * e.ny + 0.5);
            if x >= 0.0 && y >= 0.0 && x < right && y < bottom {
                let k = y as u32 as usize * w + x as u32 as usize;
                re[k] += c;
                im[k] += s;
            }
        }
    }
    let power = blurred_power(&re, &im, w, h);
    let mut peaks: Vec<usize> = (0..power.len()).filter(|&k| is_peak(&power, w, h, k)).collect();
    peaks.sort_by(|&a, &b| power[b].total_cmp(&power[a]).then(a.cmp(&b)));
    let circle = |&k: &usize| radius_at(&edges, (k % w) as f64, (k / w) as f64, range, contrast);
    let strong = peaks.iter().take(8 * count).take_while(|&&k| power[k] >= 0.05 * power[peaks[0]]);
    let mut all: Vec<HoughCircle> = strong.filter_map(circle).collect();
    all.sort_by(|a, b| b.support.total_cmp(&a.support));
    // By support, not by power: normals of a coarse mask spread the votes, and a peak beside the centre may be higher than
    // the one in it.
    let mut found: Vec<HoughCircle> = Vec::new();
    for circle in all {
        let apart = |c: &HoughCircle| (c.x - circle.x).hypot(c.y - circle.y) >= 0.15 * r_min;
        if found.len() < count && found.iter().all(apart) {
            found.push(circle);
        }
    }
    found
}

fn edge_pixels(plane: &Plane, edge_fraction: f64) -> Vec<EdgePixel> {
    let (gx, gy) = sobel(plane);
    let strength: Vec<f32> =
        gx.data.iter().zip(&gy.data).map(|(a, b)| (a * a + b * b).sqrt()).collect();
    let top = strength.iter().fold(0.0f32, |a, &b| a.max(b));
    let least = (top * edge_fraction as f32).max(0.5);
    let mut edges = Vec::new();
    for (k, &s) in strength.iter().enumerate() {
        if s > least {
            edges.push(EdgePixel {
                x: (k % plane.width) as f64,
                y: (k / plane.width) as f64,
                nx: f64::from(gx.data[k] / s),
                ny: f64::from(gy.data[k] / s),
            });
        }
    }
    edges
}

/// Weights of the blur.
const BINOMIAL: [f64; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];

/// Squared modulus of the accumulator after a 5 x 5 binomial blur. Only the five rows in use are kept: planes of a size
/// that the system takes back and clears anew would cost more than the arithmetic.
fn blurred_power(re: &[f64], im: &[f64], w: usize, h: usize) -> Vec<f64> {
    let mut power = vec![0.0; re.len()];
    let mut rows = [re, im].map(|_| vec![0.0; 5 * w]);
    let mut sums = [re, im].map(|_| vec![0.0; w]);
    for below in 0..h + 2 {
        if below < h {
            for (rows, plane) in rows.iter_mut().zip([re, im]) {
                let of = &plane[below * w..][..w];
                blur_row(of, &mut rows[below % 5 * w..][..w]);
            }
        }
        let Some(y) = below.checked_sub(2) else { continue };
        for (rows, sum) in rows.iter().zip(&mut sums) {
            sum.fill(0.0);
            for d in (0..5).filter(|&d| (2..h + 2).contains(&(y + d))) {
                let row = &rows[(y + d - 2) % 5 * w..][..w];
                sum.iter_mut().zip(row).for_each(|(s, v)| *s += BINOMIAL[d] * v);
            }
        }
        let both = sums[0].iter().zip(&sums[1]);
        let own = power[y * w..][..w].iter_mut();
        own.zip(both).for_each(|(p, (a, b))| *p = a * a + b * b);
    }
    power
}

/// One row blurred along itself; what lies outside counts nothing.
fn blur_row(of: &[f64], to: &mut [f64]) {
    let w = of.len();
    let at = |x: usize| -> f64 {
        let inside = (0..5).filter(|&d| (2..w + 2).contains(&(x + d)));
        inside.map(|d| BINOMIAL[d] * of[x + d - 2]).sum()
    };
    for x in (0..w.min(2)).chain(w.saturating_sub(2).max(2)..w) {
        to[x] = at(x);
    }
    for (window, to) in of.windows(5).zip(to.iter_mut().skip(2)) {
        *to = BINOMIAL.iter().zip(window).map(|(k, v)| k * v).sum();
    }
}

fn is_peak(power: &[f64], w: usize, h: usize, k: usize) -> bool {
    let (x, y) = (k % w, k / w);
    power[k] > 0.0
        && (y.saturating_sub(1)..(y + 2).min(h)).all(|yy| {
            (x.saturating_sub(1)..(x + 2).min(w)).all(|xx| {
                let j = yy * w + xx;
                power[j] < power[k] || (power[j] == power[k] && j >= k)
            })
        })
}

/// The radius about a centre: of the radii with at least 0.85 of the best support the smallest, refined by the
/// mean distance of its edge pixels; the centre is shifted to the mean of theirs.
fn radius_at(
    edges: &[EdgePixel],
    x: f64,
    y: f64,
    range: (f64, f64),
    contrast: Contrast,
) -> Option<HoughCircle> {
    const SECTORS: usize = 180;
    let bins = (range.1 - range.0).ceil() as usize + 1;
    let sign = if contrast == Contrast::DarkDisc { 1.0 } else { -1.0 };
    let mut seen = vec![[false; SECTORS]; bins];
    let mut near: Vec<(f64, usize)> = Vec::new();
    for e in edges {
        let (dx, dy) = (e.x - x, e.y - y);
        let r = (dx * dx + dy * dy).sqrt();
        if r < range.0 - 1.0 || r > range.1 + 1.0 || sign * (e.nx * dx + e.ny * dy) < 0.85 * r {
            continue;
        }
        let turn = (dy.atan2(dx) / std::f64::consts::TAU + 1.0).fract();
        let sector = ((turn * SECTORS as f64) as usize).min(SECTORS - 1);
        near.push((r, sector));
        let b = r - range.0;
        let first = (b - 1.5).max(0.0) as usize;
        for (k, bin) in seen.iter_mut().enumerate().skip(first).take(5) {
            if (k as f64 - b).abs() <= 1.5 {
                bin[sector] = true;
            }
        }
    }
    let support: Vec<f64> =
        seen.iter().map(|s| s.iter().filter(|&&b| b).count() as f64 / SECTORS as f64).collect();
    let best = support.iter().fold(0.0f64, |a, &b| a.max(b));
    if best <= 0.0 {
        return None;
    }
    let first = support.iter().position(|&s| s >= 0.85 * best)?;
    // The crest of that group of radii.
    let mut k = first;
    while k + 1 < bins && support[k + 1] >= support[k] {
        k += 1;
    }
    let coarse = range.0 + k as f64;
    let (mut sum, mut n) = (0.0, 0.0);
    for &(r, _) in near.iter().filter(|(r, _)| (r - coarse).abs() <= 2.0) {
        sum += r;
        n += 1.0;
    }
    let radius = if n > 0.0 { sum / n } else { coarse };
    Some(HoughCircle { x, y, radius, support: support[k], contrast })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blur_by_rows_is_the_sum_over_the_square_at_any_size() {
        for (w, h) in [(1, 1), (2, 7), (3, 3), (4, 2), (5, 5), (9, 6)] {
            let plane = |seed: usize| -> Vec<f64> {
                (0..w * h).map(|k| ((7 * k + seed) % 11) as f64 - 5.0).collect()
            };
            let (re, im) = (plane(1), plane(4));
            let power = blurred_power(&re, &im, w, h);
            let sum = |of: &[f64], x: usize, y: usize| -> f64 {
                let weight = |a: usize, b: usize| match a.abs_diff(b) {
                    0 => 6.0,
                    1 => 4.0,
                    2 => 1.0,
                    _ => 0.0,
                };
                (0..w * h).map(|k| weight(k % w, x) * weight(k / w, y) * of[k]).sum()
            };
            for (k, p) in power.iter().enumerate() {
                // Whole numbers: no rounding.
                let direct = sum(&re, k % w, k / w).powi(2) + sum(&im, k % w, k / w).powi(2);
                assert_eq!(*p, direct, "{w} x {h} at {k}");
            }
        }
    }
}
