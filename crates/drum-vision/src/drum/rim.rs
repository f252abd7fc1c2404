//! Points of the drum's rim between pixels, along rays from the centre found by the Hough transform.

use super::circle_fit::Circle;
use super::hough::Contrast;
use crate::frame::Plane;

/// Redness that the ring must exceed its inside by, grey levels.
const MIN_REDNESS: f64 = 20.0;

/// Number of rays for a radius: one every two pixels of the circumference, 180 to 1440.
#[must_use]
pub fn ray_count(radius_px: f64) -> usize {
    ((std::f64::consts::PI * radius_px) as usize).clamp(180, 1440)
}

/// Inner edge of the red ring: on each ray the point where redness has risen half-way from the level
/// inside of the ring to its crest.
///
/// `redness` is [`crate::frame::Frame::redness`], zero for grey of any brightness, so that neither bed nor background
/// shifts the edge; mixing of colours in a blurred edge is linear in it.
#[must_use]
pub fn ring_points(redness: &Plane, near: Circle, reach: f64) -> Vec<(f64, f64)> {
    let rays = ray_count(near.radius_px);
    let n = (4.0 * reach).ceil() as usize + 1;
    let mut points = Vec::with_capacity(rays);
    let mut profile = vec![0.0; n];
    for (cos, sin) in directions(rays) {
        let at = |k: f64| near.radius_px - reach + 0.5 * k;
        if !ray_inside(redness, near, at((n - 1) as f64), cos, sin) {
            continue;
        }
        for (k, p) in profile.iter_mut().enumerate() {
            let r = at(k as f64);
            *p = redness.sample(near.x_px + r * cos, near.y_px + r * sin);
        }
        let Some(crest) = (0..n).max_by(|&a, &b| profile[a].total_cmp(&profile[b]).then(b.cmp(&a)))
        else {
            continue;
        };
        let mut inside: Vec<f64> = profile[..(crest / 2).max(1)].to_vec();
        let base = crate::statistics::median_in_place(&mut inside).unwrap_or(0.0);
        if profile[crest] - base < MIN_REDNESS {
            continue;
        }
        let half = 0.5 * (profile[crest] + base);
        if let Some(k) = (1..=crest).rev().find(|&k| profile[k - 1] < half && profile[k] >= half) {
            let t = (half - profile[k - 1]) / (profile[k] - profile[k - 1]);
            let r = at(k as f64 - 1.0 + t);
            points.push((near.x_px + r * cos, near.y_px + r * sin));
        }
    }
    points
}

/// The drum's outline: on each ray the steepest grey step of the given sense, between pixels by a parabola.
///
/// Steps far from the expected radius count less: their steepness is weighed with a Gaussian of half the reach.
#[must_use]
pub fn outline_points(
    grey: &Plane,
    near: Circle,
    reach: f64,
    contrast: Contrast,
) -> Vec<(f64, f64)> {
    let rays = ray_count(near.radius_px);
    let sign = if contrast == Contrast::DarkDisc { 1.0 } else { -1.0 };
    let n = (4.0 * reach).ceil() as usize + 1;
    let mut found: Vec<(f64, (f64, f64))> = Vec::with_capacity(rays);
    let mut profile = vec![0.0; n];
    let mut steep = vec![0.0; n];
    for (cos, sin) in directions(rays) {
        let at = |k: f64| near.radius_px - reach + 0.5 * k;
        if !ray_inside(grey, near, near.radius_px, cos, sin) {
            continue;
        }
        for (k, p) in profile.iter_mut().enumerate() {
            let r = at(k as f64);
            *p = grey.sample(near.x_px + r * cos, near.y_px + r * sin);
        }
        for k in 2..n - 2 {
            let t = (at(k as f64) - near.radius_px) / (0.5 * reach);
            // Central differences over one and two pixels: a step of one pixel's blur gives a single peak.
            let slope = (profile[k + 1] - profile[k - 1]) + 0.5 * (profile[k + 2] - profile[k - 2]);
            steep[k] = sign * slope * (-0.5 * t * t).exp();
        }
        let Some(k) = (2..n - 2).max_by(|&a, &b| steep[a].total_cmp(&steep[b]).then(b.cmp(&a)))
        else {
            continue;
        };
        if steep[k] > 4.0 && k > 2 && k + 3 < n {
            let (a, b, c) = (steep[k - 1], steep[k], steep[k + 1]);
            let bend = a - 2.0 * b + c;
            let shift = if bend < 0.0 { 0.5 * (a - c) / bend } else { 0.0 };
            let r = at(k as f64 + shift.clamp(-1.0, 1.0));
            found.push((b, (near.x_px + r * cos, near.y_px + r * sin)));
        }
    }
    let mut heights: Vec<f64> = found.iter().map(|f| f.0).collect();
    let least = 0.2 * crate::statistics::median_in_place(&mut heights).unwrap_or(0.0);
    found.into_iter().filter(|f| f.0 > least).map(|f| f.1).collect()
}

fn directions(rays: usize) -> impl Iterator<Item = (f64, f64)> {
    (0..rays).map(move |k| {
        let (s, c) = (std::f64::consts::TAU * k as f64 / rays as f64).sin_cos();
        (c, s)
    })
}

fn ray_inside(plane: &Plane, near: Circle, r: f64, cos: f64, sin: f64) -> bool {
    let (x, y) = (near.x_px + r * cos, near.y_px + r * sin);
    x >= -1.0 && y >= -1.0 && x <= plane.width as f64 && y <= plane.height as f64
}
