//! The central picture: contours of several responses with measured bands and their overlap.

use super::overlap::Overlap;
use crate::Picture;
use crate::contour::{Bounds, Chain, Grid, region};
use crate::number::{drawable, extent, fixed};
use crate::svg::frame::{Layout, no_data};
use crate::svg::scale::{decimals_of_step, nice_step, nice_values};
use crate::svg::{
    Anchor, Axis, Dash, FontSize, Frame, Key, LegendEntry, Marker, Paint, Stroke, text,
};

/// One response over the two factors, with what was measured of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MappedResponse {
    /// Name, as "AoR line".
    pub name: String,
    /// Unit, as "°" or "% R".
    pub unit: String,
    /// The surrogate over the map.
    pub field: Grid,
    /// Measured mean, if the response was measured at this speed.
    pub measured: Option<f64>,
    /// Half width of the measured band: one standard deviation.
    pub sd: f64,
}

/// Contours of the responses over two factors at one speed, each response in its own colour, with
/// the band of its measurement (mean ± sd) laid over and the region common to most bands marked.
///
/// The thesis's contour plots (its section 5.1) in one picture: where the bands overlap, the
/// simulation agrees with the measurement. Contours of each response are labelled in a lane of
/// their own, so that no two labels collide.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CalibrationMap {
    /// Title, with case and speed.
    pub title: String,
    /// Label of the horizontal factor with its unit.
    pub x_label: String,
    /// Label of the vertical factor with its unit.
    pub y_label: String,
    /// The responses; their grids have the same nodes.
    pub responses: Vec<MappedResponse>,
    /// Estimate of the vertical factor and its interval, drawn at the right edge.
    pub estimate: Option<(f64, Option<f64>, Option<f64>)>,
    /// What the estimate is, as "this work, all speeds".
    pub estimate_label: String,
    /// Printed range of the vertical factor, drawn at the right edge.
    pub printed: Option<(f64, f64)>,
}

impl CalibrationMap {
    /// The same map cut to the rows around the measured bands, where these take up less than a
    /// third of the height; none where they take up more or lie outside.
    ///
    /// Whole rows of the grid are kept, so nothing is interpolated.
    pub fn closer(&self) -> Option<Self> {
        let first = &self.responses.first()?.field;
        if !self.responses.iter().all(|r| r.field.is_drawable() && r.field.same_nodes(first)) {
            return None;
        }
        let loops = (0..self.responses.len()).filter_map(|i| {
            let (lo, hi) = self.band(i)?;
            Some(region(&[Bounds { field: &self.responses[i].field, lo, hi }]))
        });
        let (lo, hi) = extent(loops.flatten().flatten().map(|p| p.1))?;
        let margin = 0.3 * (hi - lo);
        let step = first.y(1) - first.y(0);
        let row = |y: f64| ((y - first.y_range.0) / step).clamp(0.0, (first.ny - 1) as f64);
        let (from, to) = (row(lo - margin).floor() as usize, row(hi + margin).ceil() as usize);
        if to < from + 2 || 3 * (to - from) > 2 * (first.ny - 1) || hi - lo > 0.34 * span(first) {
            return None;
        }
        let cut = |field: &Grid| Grid {
            ny: to - from + 1,
            y_range: (field.y(from), field.y(to)),
            values: field.values[from * field.nx..(to + 1) * field.nx].to_vec(),
            ..*field
        };
        let responses =
            self.responses.iter().map(|r| MappedResponse { field: cut(&r.field), ..r.clone() });
        Some(Self {
            title: format!("{}, closer", self.title),
            responses: responses.collect(),
            ..self.clone()
        })
    }

    /// The band of a response: measured mean ∓ sd.
    pub(super) fn band(&self, i: usize) -> Option<(f64, f64)> {
        let response = &self.responses[i];
        let mean = response.measured.filter(|m| drawable(*m))?;
        let sd = if response.sd.is_finite() { response.sd.abs() } else { 0.0 };
        Some((mean - sd, mean + sd))
    }

    fn legend(&self, overlaps: &[Overlap]) -> Vec<LegendEntry> {
        let mut entries = Vec::new();
        for (i, response) in self.responses.iter().enumerate() {
            let stroke = Stroke::new(Paint::Series(i), 2.0).dashed(Dash::of_series(i));
            let text = match (response.measured, self.band(i)) {
                (Some(mean), Some((lo, hi))) => {
                    let base = format!(
                        "{} {} ± {} {}",
                        response.name,
                        fixed(mean, 2),
                        fixed(response.sd, 2),
                        response.unit
                    );
                    match response.field.value_range() {
                        Some((low, high)) if hi < low || lo > high => format!(
                            "{base} (off the map: model {} to {})",
                            fixed(low, 1),
                            fixed(high, 1)
                        ),
                        _ => base,
                    }
                }
                _ => format!("{}: not measured", response.name),
            };
            entries.push(LegendEntry::new(Key::OutlinedArea(Paint::Series(i), 0.25, stroke), text));
        }
        let outline = Stroke::new(Paint::Ink, 2.0);
        let key = Key::OutlinedArea(Paint::Ink, OVERLAP_OPACITY, outline);
        match overlaps {
            [] => entries.push(LegendEntry::new(Key::None, "No two measured bands overlap.")),
            found => entries.push(LegendEntry::new(key, self.overlap_text(found))),
        }
        if let Some((value, lo, hi)) = self.estimate.filter(|(v, _, _)| v.is_finite()) {
            let label =
                if self.estimate_label.is_empty() { "estimate" } else { &self.estimate_label };
            let text = format!("{label}: {}", interval_text(value, lo, hi));
            entries.push(LegendEntry::new(Key::Point(Marker::Circle, Paint::Ink, true), text));
        }
        if let Some((lo, hi)) = self.printed {
            let text = format!("printed range {} to {}", fixed(lo, 2), fixed(hi, 2));
            entries.push(LegendEntry::new(Key::Area(Paint::Neutral, 0.6), text));
        }
        entries
    }

    fn overlap_text(&self, found: &[Overlap]) -> String {
        let measured = (0..self.responses.len()).filter(|&i| self.band(i).is_some()).count();
        let count = found[0].responses.len();
        let range = |o: &Overlap| {
            let pieces =
                o.y_ranges.iter().map(|r| format!("{} to {}", fixed(r.0, 2), fixed(r.1, 2)));
            pieces.collect::<Vec<_>>().join(" and ")
        };
        if count == measured {
            return format!("all {count} bands overlap, at {}", range(&found[0]));
        }
        let sets: Vec<String> = found
            .iter()
            .map(|o| {
                let names: Vec<&str> =
                    o.responses.iter().map(|&i| self.responses[i].name.as_str()).collect();
                format!("{} at {}", names.join(" + "), range(o))
            })
            .collect();
        format!("at most {count} of {measured} bands overlap: {}", sets.join("; "))
    }

    fn draw_contours(&self, frame: &mut Frame) {
        for (i, response) in self.responses.iter().enumerate() {
            for level in self.levels(i) {
                for line in response.field.isolines(level) {
                    let stroke = Stroke::new(Paint::Series(i), 0.9).opacity(0.75);
                    frame.polyline(line, stroke);
                }
            }
        }
    }

    fn draw_bands(&self, frame: &mut Frame) {
        for (i, response) in self.responses.iter().enumerate() {
            let Some((lo, hi)) = self.band(i) else { continue };
            let band = region(&[Bounds { field: &response.field, lo, hi }]);
            let pixels = to_pixels(frame, &band);
            frame.canvas.loops(&pixels, Paint::Series(i), 0.25, None);
            for line in response.field.isolines(0.5 * (lo + hi)) {
                let stroke = Stroke::new(Paint::Series(i), 2.0).dashed(Dash::of_series(i));
                frame.polyline(line, stroke);
            }
        }
    }

    fn levels(&self, i: usize) -> Vec<f64> {
        let range = self.responses[i].field.value_range();
        range.map(|(lo, hi)| nice_values(lo, hi, CONTOURS)).unwrap_or_default()
    }

    /// Labels of the i-th response, in its lane: the name in its band where the band is thick
    /// enough, values on the contours elsewhere.
    fn draw_labels(&self, frame: &mut Frame, i: usize, overlaps: &[Overlap]) {
        let response = &self.responses[i];
        let lane = (i as f64 + 0.5) / self.responses.len() as f64;
        let (x0, x1) = response.field.x_range;
        let x = x0 + lane * (x1 - x0);
        let (paint, size) = (Paint::SeriesText(i), FontSize::Small);
        let row = |frame: &Frame, level: f64| {
            let py = frame.y.px(crossing_at(&response.field, x, level)?)?;
            Some((py + 4.0).clamp(frame.top + 11.0, frame.bottom - 4.0))
        };
        let Some(px) = frame.x.px(x) else { return };
        let mut taken: Vec<(f64, f64)> = Vec::new();
        for overlap in overlaps {
            let crossings = overlap.loops.iter().flat_map(|l| crossings_of(l, x, true));
            if let Some((lo, hi)) = extent(crossings)
                && let (Some(below), Some(above)) = (frame.y.px(lo), frame.y.px(hi))
            {
                taken.push((above, below + 8.0));
            }
        }
        if let Some((lo, hi)) = self.band(i)
            && let Some(middle) = row(frame, 0.5 * (lo + hi))
        {
            let thickness = row(frame, lo).zip(row(frame, hi)).map(|(a, b)| (a - b).abs());
            if thickness.is_some_and(|t| t >= 13.0) {
                let room = (frame.right - frame.left) / self.responses.len() as f64 - 6.0;
                let name = text::shorten(&response.name, 1.1 * size.px(), room);
                frame.canvas.halo_text(px, middle, &name, size, Anchor::Middle, paint, true);
            }
            taken.push((middle, middle));
        }
        let Some((lo, hi)) = response.field.value_range() else { return };
        let decimals = decimals_of_step(nice_step(lo, hi, CONTOURS));
        for level in self.levels(i) {
            let Some(baseline) = row(frame, level) else { continue };
            if taken.iter().any(|(a, b)| baseline > a - 12.5 && baseline < b + 12.5) {
                continue;
            }
            taken.push((baseline, baseline));
            let text = fixed(level, decimals);
            frame.canvas.halo_text(px, baseline, &text, size, Anchor::Middle, paint, false);
        }
    }

    fn draw_margin(&self, frame: &mut Frame) {
        if let Some((lo, hi)) = self.printed
            && let (Some(a), Some(b)) = (frame.y.px(lo), frame.y.px(hi))
        {
            let (a, b) = (a.clamp(frame.top, frame.bottom), b.clamp(frame.top, frame.bottom));
            frame.canvas.rect(frame.right + 4.0, b, 7.0, a - b, Paint::Neutral, 0.6);
        }
        if let Some((value, lo, hi)) = self.estimate
            && let Some(y) = frame.y.px(value)
        {
            let x = frame.right + 19.0;
            let ends = |v: Option<f64>, open: f64| {
                v.and_then(|v| frame.y.px(v)).unwrap_or(open).clamp(frame.top, frame.bottom)
            };
            let (low, high) = (ends(lo, frame.bottom), ends(hi, frame.top));
            let stroke = Stroke::new(Paint::Ink, 2.0);
            frame.canvas.line(x, low, x, high, stroke);
            for (end, closed) in [(low, lo.is_some()), (high, hi.is_some())] {
                if closed {
                    frame.canvas.line(x - 4.0, end, x + 4.0, end, stroke);
                }
            }
            if y >= frame.top && y <= frame.bottom {
                frame.canvas.marker(x, y, Marker::Circle, 4.0, Paint::Ink, true);
            }
        }
    }
}

const CONTOURS: usize = 7;
const OVERLAP_OPACITY: f64 = 0.55;

impl Picture for CalibrationMap {
    fn svg(&self) -> String {
        let Some(first) = self.responses.first().map(|r| &r.field) else {
            return no_data(&self.title, "no response to map");
        };
        if !self.responses.iter().all(|r| r.field.is_drawable() && r.field.same_nodes(first)) {
            return no_data(&self.title, "the responses' grids differ or are incomplete");
        }
        if self.responses.iter().all(|r| r.field.value_range().is_none()) {
            return no_data(&self.title, "the surrogates give no finite value");
        }
        let overlaps = self.overlaps();
        let legend = self.legend(&overlaps);
        let description: Vec<&str> = legend.iter().map(|e| e.text.as_str()).collect();
        let margin = if self.estimate.is_some() || self.printed.is_some() { 18.0 } else { 0.0 };
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!(
                "Contours of {} responses over {} and {}. {}.",
                self.responses.len(),
                self.x_label,
                self.y_label,
                description.join(". ")
            ),
            x: Axis { bare: true, ..Axis::linear(&self.x_label, first.x_range) },
            y: Axis { bare: true, ..Axis::linear(&self.y_label, first.y_range) },
            height: 340.0,
            legend,
            right: margin,
        });
        frame.clip();
        self.draw_contours(&mut frame);
        self.draw_bands(&mut frame);
        for overlap in &overlaps {
            let pixels = to_pixels(&frame, &overlap.loops);
            let outline = Stroke::new(Paint::Ink, 2.0);
            frame.canvas.loops(&pixels, Paint::Ink, OVERLAP_OPACITY, Some(outline));
        }
        for i in 0..self.responses.len() {
            self.draw_labels(&mut frame, i, &overlaps);
        }
        frame.unclip();
        self.draw_margin(&mut frame);
        frame.finish()
    }
}

fn span(field: &Grid) -> f64 {
    field.y_range.1 - field.y_range.0
}

fn to_pixels(frame: &Frame, loops: &[Chain]) -> Vec<Vec<(f64, f64)>> {
    loops.iter().map(|l| l.iter().filter_map(|(x, y)| frame.at(*x, *y)).collect()).collect()
}

fn interval_text(value: f64, lo: Option<f64>, hi: Option<f64>) -> String {
    match (lo, hi) {
        (Some(lo), Some(hi)) => {
            format!("{} ({} to {})", fixed(value, 2), fixed(lo, 2), fixed(hi, 2))
        }
        (Some(lo), None) => format!("{} (above {})", fixed(value, 2), fixed(lo, 2)),
        (None, Some(hi)) => format!("{} (below {})", fixed(value, 2), fixed(hi, 2)),
        (None, None) => format!("{} (no bound)", fixed(value, 2)),
    }
}

/// The lowest y at which the field passes a level along a vertical line.
fn crossing_at(field: &Grid, x: f64, level: f64) -> Option<f64> {
    let lines = field.isolines(level);
    lines.iter().flat_map(|line| crossings_of(line, x, false)).reduce(f64::min)
}

/// The ordinates at which a chain, closed or not, passes a vertical line.
fn crossings_of(chain: &Chain, x: f64, closed: bool) -> Vec<f64> {
    let last = chain.last().filter(|_| closed).into_iter();
    let starts = last.chain(chain);
    let ends = chain.iter().skip(usize::from(!closed));
    starts
        .zip(ends)
        .filter(|((x1, _), (x2, _))| (*x1 <= x) != (*x2 <= x))
        .map(|((x1, y1), (x2, y2))| y1 + (x - x1) / (x2 - x1) * (y2 - y1))
        .collect()
}
