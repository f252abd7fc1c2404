//! Legends: short keys with names, flowing in rows under the plot.

use super::canvas::{Anchor, Canvas, FontSize};
use super::paint::{Marker, Paint, Stroke};
use super::text;

/// What stands before a name in the legend.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Key {
    /// A line.
    Line(Stroke),
    /// A point, filled or hollow.
    Point(Marker, Paint, bool),
    /// A line through a point.
    LinePoint(Stroke, Marker),
    /// A filled area.
    Area(Paint, f64),
    /// A filled area with an outline.
    OutlinedArea(Paint, f64, Stroke),
    /// Nothing: a remark.
    None,
}

/// A row of the legend.
#[derive(Clone, Debug)]
pub(crate) struct LegendEntry {
    pub(crate) key: Key,
    pub(crate) text: String,
}

impl LegendEntry {
    pub(crate) fn new(key: Key, text: impl Into<String>) -> Self {
        Self { key, text: text.into() }
    }

    fn indent(&self) -> f64 {
        if matches!(self.key, Key::None) { 0.0 } else { KEY + 6.0 }
    }
}

const KEY: f64 = 24.0;
const ROW: f64 = 18.0;
const GAP: f64 = 16.0;

/// A legend laid out for a width: where each entry's lines stand.
pub(crate) struct LaidLegend {
    items: Vec<(f64, f64, Key, f64, Vec<String>)>,
    /// Height, px.
    pub(crate) height: f64,
}

/// Lays entries into rows, wrapping those longer than a row.
pub(crate) fn lay_out(entries: &[LegendEntry], width: f64) -> LaidLegend {
    let size = FontSize::Tick.px();
    let (mut x, mut y) = (0.0, 0.0);
    let mut items = Vec::new();
    let mut row_lines = 1;
    for entry in entries {
        let full = entry.indent() + text::width(&entry.text, size);
        if x > 0.0 && x + full > width {
            x = 0.0;
            y += ROW * row_lines as f64;
            row_lines = 1;
        }
        let lines = text::wrap(&entry.text, size, (width - entry.indent()).max(40.0));
        row_lines = row_lines.max(lines.len());
        items.push((x, y, entry.key, entry.indent(), lines));
        x += full + GAP;
    }
    let height = if items.is_empty() { 0.0 } else { y + ROW * row_lines as f64 };
    LaidLegend { items, height }
}

impl LaidLegend {
    /// Draws the legend with its upper left corner at a point.
    pub(crate) fn draw(&self, canvas: &mut Canvas, left: f64, top: f64) {
        for (x, y, key, indent, lines) in &self.items {
            let (x, y) = (left + x, top + y);
            let middle = y + 0.5 * ROW;
            draw_key(canvas, *key, x, middle);
            for (i, line) in lines.iter().enumerate() {
                let baseline = middle + 4.0 + ROW * i as f64;
                canvas.text(x + indent, baseline, line, FontSize::Tick, Anchor::Start, Paint::Ink);
            }
        }
    }
}

fn draw_key(canvas: &mut Canvas, key: Key, x: f64, y: f64) {
    match key {
        Key::Line(stroke) => canvas.line(x, y, x + KEY, y, stroke),
        Key::Point(marker, paint, filled) => {
            canvas.marker(x + 0.5 * KEY, y, marker, 4.0, paint, filled);
        }
        Key::LinePoint(stroke, marker) => {
            canvas.line(x, y, x + KEY, y, stroke);
            canvas.marker(x + 0.5 * KEY, y, marker, 3.6, stroke.paint, true);
        }
        Key::Area(paint, opacity) => canvas.rect(x, y - 6.0, KEY, 12.0, paint, opacity),
        Key::OutlinedArea(paint, opacity, stroke) => {
            canvas.rect(x, y - 6.0, KEY, 12.0, paint, opacity);
            canvas.outline(x, y - 6.0, KEY, 12.0, stroke);
        }
        Key::None => {}
    }
}
