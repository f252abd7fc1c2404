//! The surface between pixels: where the grey level crosses, along lines across the coarse boundary.
//!
//! Every line is averaged with its neighbours along the curve. The greys of background and bed are
//! taken beside the edge on that very piece of surface, so that glare, shade and powder that change both sides
//! do not move the crossing; the threshold lies half-way (or at the frame's fixed or Otsu level).
//!
//! The lines are read in the unfiltered grey, and the greys beside the edge are means: where a mean profile crosses half-way
//! between the means of its sides, the mean edge lies. A median filter, or medians of a bed with dark gaps between bright
//! grains, would put it up to a fifth of a pixel too deep.

use super::boundary::{Boundary, TurnedAxes};
use super::prepare::Prepared;
use crate::config::{Threshold, VisionConfig};
use crate::error::VisionError;
use crate::filter::threshold::otsu;
use crate::spline::{Smoothed, near_stiff_curve, smooth_weighted};
use crate::statistics::median_in_place;

/// The surface as a smoothed function `v(u)` in turned axes, in the plane's coordinates.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The axes.
    pub axes: TurnedAxes,
    /// Abscissae of the points used, pixels.
    pub u_px: Vec<f64>,
    /// The smoothed curve with weights and residuals of the points.
    pub smoothed: Smoothed,
    /// Fraction of the surface, outside of the hub, on which an edge was found and accepted.
    pub visible: f64,
    /// Fraction of the surface that a reflex touches.
    pub glare: f64,
    /// Stretches `(from, to)` of `u` that a faint reflex lights: measured, but not to be trusted, pixels.
    pub lit: Vec<(f64, f64)>,
    /// Half the change of `v` when the threshold moves by a tenth of the contrast either way, at every point.
    pub level_shift_px: Vec<f64>,
    /// Standard deviation of the threshold along the surface (of the greys beside the edge), fraction of the contrast.
    pub level_scatter: f64,
    /// Median contrast of bed and background at the edge, stretched grey levels, positive for a bright bed.
    pub contrast: f64,
    /// Median distance over which the grey rises from 20 % to 80 % of the contrast, pixels.
    pub edge_width_px: f64,
}

/// Pieces of the stiff curve from which glare and drops are told.
const STIFF_PIECES: usize = 3;
/// Departure from the stiff curve that is always allowed, fraction of the radius.
const STIFF_MARGIN: f64 = 0.012;

/// Half-way, and a tenth of the contrast to either side.
const SHIFTS: [f64; 3] = [0.0, -0.1, 0.1];

/// Traces the sub-pixel surface about a coarse boundary.
///
/// # Errors
/// [`VisionError::TooFewColumns`], [`VisionError::SurfaceHidden`], [`VisionError::SurfaceRagged`].
pub fn trace_edges(
    prepared: &Prepared,
    boundary: &Boundary,
    config: &VisionConfig,
) -> Result<Curve, VisionError> {
    let radius = prepared.circle.radius_px;
    let (mut u, mut v) = (Vec::new(), Vec::new());
    for (k, value) in boundary.v_px.iter().enumerate() {
        let at = boundary.u_px(k);
        if let Some(value) = value
            && at.hypot(*value) > prepared.hub_px
        {
            u.push(at);
            v.push(*value);
        }
    }
    let pieces = |u: &[f64]| {
        let span = u.last().zip(u.first()).map_or(0.0, |(b, a)| b - a);
        ((config.surface.spline_pieces as f64 * span / (2.0 * radius)).round() as usize).max(4)
    };
    let few = |columns| VisionError::TooFewColumns { columns, needed: 16 };
    let near = near_stiff_curve(&u, &v, STIFF_PIECES, STIFF_MARGIN * radius, 0.4);
    let start = smooth_weighted(&u, &v, &near, pieces(&u)).ok_or_else(|| few(u.len()))?;
    let mut curve: Option<Curve> = None;
    for round in 0..2 {
        let centre = curve.as_ref().map_or(&start, |c| &c.smoothed).spline.clone();
        let mut lines = lines_across(prepared, boundary, &centre);
        let reflexes = super::reflex::lit_stretches(&traces(&lines), radius);
        for line in &mut lines {
            line.lit = reflexes.iter().any(|r| (r.0..=r.1).contains(&line.u));
        }
        let points = crossings(prepared, boundary, config, &lines);
        let used: Vec<&Crossing> = points.iter().filter(|p| p.v[0].is_some()).collect();
        let found = used.len();
        let (u, v): (Vec<f64>, Vec<f64>) =
            used.iter().map(|p| (p.u, p.v[0].unwrap_or(0.0))).unzip();
        if u.len() < 16 {
            return Err(few(u.len()));
        }
        let glare = !prepared.hidden.is_empty();
        let near = plausible(&used, &u, &v, radius, glare);
        let smoothed = smooth_weighted(&u, &v, &near, pieces(&u)).ok_or_else(|| few(found))?;
        let accepted = smoothed.weights.iter().filter(|w| **w > 0.1).count();
        let visible = accepted as f64 / lines.len().max(1) as f64;
        if round == 1 {
            check(visible, &smoothed, radius, config)?;
        }
        let mut contrasts: Vec<f64> = used.iter().map(|p| p.contrast).collect();
        let mut widths: Vec<f64> = used.iter().filter_map(|p| p.width).collect();
        let level_shift_px = used
            .iter()
            .map(|p| match p.v {
                [_, Some(a), Some(b)] => 0.5 * (b - a),
                _ => f64::NAN,
            })
            .collect();
        curve = Some(Curve {
            axes: boundary.axes,
            u_px: u,
            smoothed,
            visible,
            glare: lines.iter().filter(|l| l.glare || l.lit).count() as f64
                / lines.len().max(1) as f64,
            lit: reflexes,
            level_shift_px,
            level_scatter: level_scatter(&used),
            contrast: median_in_place(&mut contrasts).unwrap_or(0.0),
            edge_width_px: median_in_place(&mut widths).unwrap_or(0.0),
        });
    }
    curve.ok_or_else(|| few(0))
}

/// Scatter of the half-way level along the surface over the contrast.
fn level_scatter(used: &[&Crossing]) -> f64 {
    let levels: Vec<f64> = used.iter().map(|p| p.level).collect();
    let mut contrasts: Vec<f64> = used.iter().map(|p| p.contrast.abs()).collect();
    let contrast = median_in_place(&mut contrasts).unwrap_or(0.0);
    match crate::statistics::standard_deviation(&levels) {
        Some(sd) if contrast > 0.0 => sd / contrast,
        _ => 0.0,
    }
}

/// Which crossings may belong to the bed.
///
/// Far from the stiff curve a crossing is believed only where its edge looks like the others: as sharp and with
/// as much contrast on its own line. Glare has soft flanks; a surface that levels off at the wall has not. Inside of the
/// middle 80 % three times that distance is never believed.
fn plausible(used: &[&Crossing], u: &[f64], v: &[f64], radius: f64, glare: bool) -> Vec<bool> {
    let margin = STIFF_MARGIN * radius;
    let near = near_stiff_curve(u, v, STIFF_PIECES, margin, 0.4);
    let nearer = near_stiff_curve(u, v, STIFF_PIECES, 3.0 * margin, 0.4);
    let median = |values: Vec<f64>| {
        let mut values = values;
        median_in_place(&mut values).unwrap_or(0.0)
    };
    let width = median(used.iter().filter_map(|p| p.width).collect());
    let contrast = median(used.iter().filter_map(|p| p.own_contrast).collect());
    let (from, to) = (u[0], u[u.len() - 1]);
    // Where few edges are that soft, they are glare's; where many are, that is how this frame's edges look.
    let soft_one = |p: &Crossing| p.width.is_none_or(|w| w > 1.5 * width + 0.3);
    let some_soft = used.iter().filter(|p| soft_one(p)).count() * 4 < used.len();
    let believed: Vec<bool> = used
        .iter()
        .enumerate()
        .map(|(k, p)| {
            if some_soft && soft_one(p) {
                return false;
            }
            let soft = p.width.is_none_or(|w| w > 1.35 * width + 0.3);
            let odd = p.own_contrast.is_some_and(|c| (c / contrast - 1.0).abs() > 0.3);
            let inner = (u[k] - from).min(to - u[k]) > 0.1 * (to - from);
            near[k] || (!(soft || odd) && (nearer[k] || !inner))
        })
        .collect();
    without_islands(&believed, u, radius, if glare { 0.03 } else { 0.08 })
}

/// Takes back belief in what lies next to a gap: two percent of the radius at either side of it, and islands shorter than
/// eight percent of the surface between gaps.
///
/// A gap is a stretch of a fraction `gap` of the surface without a believed crossing; its borders are the flanks of
/// whatever hid the surface.
fn without_islands(believed: &[bool], u: &[f64], radius: f64, gap: f64) -> Vec<bool> {
    let span = u[u.len() - 1] - u[0];
    let held: Vec<usize> = (0..u.len()).filter(|&k| believed[k]).collect();
    let mut runs: Vec<(f64, f64)> = Vec::new();
    for &k in &held {
        match runs.last_mut() {
            Some(run) if u[k] - run.1 < gap * span => run.1 = u[k],
            _ => runs.push((u[k], u[k])),
        }
    }
    let last = runs.len().saturating_sub(1);
    let trim = 0.02 * radius;
    let kept: Vec<(f64, f64)> = runs
        .iter()
        .enumerate()
        .filter(|(_, run)| run.1 - run.0 > 0.08 * span)
        .map(|(k, run)| {
            let from = if k > 0 || run.0 - u[0] > gap * span { run.0 + trim } else { run.0 };
            let to =
                if k < last || u[u.len() - 1] - run.1 > gap * span { run.1 - trim } else { run.1 };
            (from, to)
        })
        .collect();
    let out: Vec<bool> = u
        .iter()
        .zip(believed)
        .map(|(&u, &b)| b && kept.iter().any(|r| u >= r.0 && u <= r.1))
        .collect();
    // Where little would be left, the surface is in pieces for another reason.
    if out.iter().filter(|&&b| b).count() * 5 < held.len() * 3 { believed.to_vec() } else { out }
}

/// Refuses a surface that is mostly hidden or too ragged.
pub(crate) fn check(
    visible: f64,
    smoothed: &Smoothed,
    radius: f64,
    config: &VisionConfig,
) -> Result<(), VisionError> {
    let needed = config.surface.min_visible;
    if visible < needed {
        return Err(VisionError::SurfaceHidden { visible, needed });
    }
    let limit_px = (config.surface.max_scatter * radius).max(1.5);
    if smoothed.scatter > limit_px {
        return Err(VisionError::SurfaceRagged { scatter_px: smoothed.scatter, limit_px });
    }
    Ok(())
}

/// Grey along one line across the surface.
struct Line {
    u: f64,
    centre: f64,
    grey: Vec<f64>,
    slope: f64,
    /// Whether a reflex hides part of it.
    glare: bool,
    /// Whether a faint reflex lights it.
    lit: bool,
}

struct Crossing {
    u: f64,
    /// At the threshold and at its two neighbours.
    v: [Option<f64>; 3],
    contrast: f64,
    width: Option<f64>,
    /// Half-way between the greys beside the edge.
    level: f64,
    /// Contrast of the greys on the line itself, where both sides are seen.
    own_contrast: Option<f64>,
}

/// Spacing of the samples on a line, pixels.
const SPACING: f64 = 0.5;

/// Half the length of a line: a part of the radius, as all else here, so that pictures of any size read alike. (With at least 8 pixels,
/// and lines at least a pixel apart, pictures 400 pixels wide showed the middle line of coarse beds 0.2 deg flatter than
/// those of 968.)
fn half_length(radius: f64) -> f64 {
    (0.06 * radius).max(4.0)
}

fn lines_across(
    prepared: &Prepared,
    boundary: &Boundary,
    centre: &crate::spline::Spline,
) -> Vec<Line> {
    let radius = prepared.circle.radius_px;
    let step = radius / 300.0;
    let n = (half_length(radius) / SPACING).round() as isize;
    let rim = radius - (0.012 * radius).max(1.0);
    let count = (2.0 * radius / step).floor() as usize;
    let mut lines = Vec::new();
    // Beyond the coarse curve's ends the tangent may be followed a little.
    let (from, to) = centre.range();
    let spare = 0.08 * radius;
    for k in 0..=count {
        let u = -radius + step * k as f64;
        if u < from - spare || u > to + spare {
            continue;
        }
        let v = centre.value(u);
        let r = (u * u + v * v).sqrt();
        if r > rim || (prepared.hub_px > 0.0 && r < prepared.hub_px + 0.0075 * radius) {
            continue;
        }
        let mut glare = false;
        let grey = (-n..=n)
            .map(|j| {
                let v = v + j as f64 * SPACING;
                let r = (u * u + v * v).sqrt();
                if r > rim || (prepared.hub_px > 0.0 && r < prepared.hub_px) {
                    return f64::NAN;
                }
                let (x, y) = boundary.axes.to_picture(u, v);
                if prepared.is_hidden(x, y) {
                    glare = true;
                    return f64::NAN;
                }
                prepared.grey_at(x, y)
            })
            .collect();
        lines.push(Line { u, centre: v, grey, slope: centre.slope(u), glare, lit: false });
    }
    lines
}

/// What [`super::reflex`] looks at: place, grey of the outer zone above the edge and of the brightest part of each line.
fn traces(lines: &[Line]) -> Vec<super::reflex::Trace> {
    let dark = |grey: &[f64]| {
        let mut held: Vec<f64> =
            grey[..grey.len() * 28 / 100].iter().copied().filter(|g| !g.is_nan()).collect();
        if held.len() < 3 { None } else { median_in_place(&mut held) }
    };
    let bright = |grey: &[f64]| {
        let held: Vec<f64> = grey.iter().copied().filter(|g| !g.is_nan()).collect();
        if held.len() * 3 < grey.len() {
            return None;
        }
        crate::statistics::quantile(&held, 0.85)
    };
    lines
        .iter()
        .map(|l| super::reflex::Trace { u: l.u, greys: [dark(&l.grey), bright(&l.grey)] })
        .collect()
}

fn crossings(
    prepared: &Prepared,
    boundary: &Boundary,
    config: &VisionConfig,
    lines: &[Line],
) -> Vec<Crossing> {
    let radius = prepared.circle.radius_px;
    let step = radius / 300.0;
    let reach = ((0.008 * radius / step).round() as usize).max(1);
    let wide = ((0.1 * radius / step).round() as usize).max(4);
    let n = lines.first().map_or(0, |l| l.grey.len());
    // Greys beside the edge, from the outer part of each line.
    let zone = (n as f64 * 0.28) as usize;
    let side_level = |line: &Line, range: std::ops::Range<usize>| {
        let held: Vec<f64> = line.grey[range].iter().copied().filter(|g| !g.is_nan()).collect();
        if held.len() * 3 < zone { None } else { crate::statistics::mean(&held) }
    };
    let above: Vec<Option<f64>> = lines.iter().map(|l| side_level(l, 0..zone)).collect();
    let below: Vec<Option<f64>> = lines.iter().map(|l| side_level(l, n - zone..n)).collect();
    let global = boundary.levels[1][0] - boundary.levels[0][0];
    let fixed = match config.bed.threshold {
        Threshold::LocalContrast => None,
        Threshold::Otsu => otsu(&prepared.histogram).map(|v| f64::from(v) + 0.5),
        Threshold::Fixed { level } => Some(level),
    };
    let bias = config.measure.threshold_bias;
    let mut profile = vec![0.0; n];
    let mut counts = vec![0.0; n];
    let mut held = Vec::new();
    lines
        .iter()
        .enumerate()
        .map(|(i, line)| {
            // Lines within so many steps, among those so many places away at most.
            let within = |reach: usize| {
                let far = (reach as f64 + 0.5) * step;
                (i.saturating_sub(reach)..(i + reach + 1).min(lines.len()))
                    .filter(move |&k| (lines[k].u - line.u).abs() <= far)
            };
            let mut level = |side: &[Option<f64>]| {
                held.clear();
                held.extend(within(wide).filter_map(|k| side[k]));
                median_in_place(&mut held)
            };
            let mut out = Crossing {
                u: line.u,
                v: [None; 3],
                contrast: 0.0,
                width: None,
                level: 0.0,
                own_contrast: None,
            };
            let (Some(a), Some(b)) = (level(&above), level(&below)) else {
                return out;
            };
            out.contrast = b - a;
            out.level = 0.5 * (a + b);
            out.own_contrast = above[i].zip(below[i]).map(|(p, q)| q - p);
            // Far less contrast than elsewhere, or the other way round: glare, or no edge.
            if out.contrast * global.signum() < 0.3 * global.abs() {
                return out;
            }
            // The lines that follow one another with no gap, averaged along the curve.
            profile.fill(0.0);
            counts.fill(0.0);
            for k in within(reach) {
                for ((p, count), g) in profile.iter_mut().zip(&mut counts).zip(&lines[k].grey) {
                    let seen = !g.is_nan();
                    *p += if seen { *g } else { 0.0 };
                    *count += f64::from(u8::from(seen));
                }
            }
            for (p, count) in profile.iter_mut().zip(&counts) {
                *p = if *count > 0.0 { (*p / count - a) / (b - a) } else { f64::NAN };
            }
            let Some(split) = best_split(&profile) else {
                return out;
            };
            let place = |threshold: f64| {
                nearest_crossing(&profile, split, threshold)
                    .map(|j| line.centre + (j - (n / 2) as f64) * SPACING)
            };
            for (v, shift) in out.v.iter_mut().zip(SHIFTS) {
                let threshold = fixed.map_or(0.5, |f| (f - a) / (b - a)) + bias + shift;
                *v = if (0.02..=0.98).contains(&threshold) { place(threshold) } else { None };
            }
            let cos = 1.0 / line.slope.hypot(1.0);
            out.width = place(0.2).zip(place(0.8)).map(|(p, q)| (q - p).abs() * cos);
            out
        })
        .collect()
}

/// The index that parts a normalised profile into zeros and ones with the least squared misfit.
fn best_split(profile: &[f64]) -> Option<f64> {
    let mut cost = 0.0;
    let mut best: Option<(f64, usize)> = None;
    for (j, p) in profile.iter().enumerate() {
        if best.is_none_or(|(c, _)| cost < c) {
            best = Some((cost, j));
        }
        if !p.is_nan() {
            let s = p.clamp(0.0, 1.0);
            cost += s * s - (1.0 - s) * (1.0 - s);
        }
    }
    let (value, j) = best?;
    // At either end the profile shows one side only.
    (j > 1 && j + 2 < profile.len() && value < cost.min(0.0) + 1e-12).then_some(j as f64 - 0.5)
}

/// The upward crossing of a threshold nearest to an index, linear between samples.
fn nearest_crossing(profile: &[f64], near: f64, threshold: f64) -> Option<f64> {
    let mut best: Option<f64> = None;
    for (j, pair) in profile.windows(2).enumerate() {
        if pair[0] < threshold && pair[1] >= threshold {
            let at = j as f64 + (threshold - pair[0]) / (pair[1] - pair[0]);
            if best.is_none_or(|b| (at - near).abs() < (b - near).abs()) {
                best = Some(at);
            }
        }
    }
    best
}
