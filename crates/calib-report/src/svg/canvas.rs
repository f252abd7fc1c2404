//! The canvas: shapes in pixels, written as SVG elements with at most two decimals.

use std::fmt::Write as _;

use super::paint::{Marker, Paint, Stroke};
use super::text;

/// Where a text hangs on its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Sizes of text, px.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FontSize {
    Title,
    Label,
    Tick,
    Small,
}

impl FontSize {
    pub(crate) fn px(self) -> f64 {
        match self {
            FontSize::Title => 14.0,
            FontSize::Label => 13.0,
            FontSize::Tick => 12.0,
            FontSize::Small => 11.0,
        }
    }
}

/// A drawing surface that collects elements.
#[derive(Clone, Debug)]
pub(crate) struct Canvas {
    width: f64,
    height: f64,
    title: String,
    description: String,
    body: String,
}

/// A coordinate: two decimals at most, trailing zeros cut, never NaN.
pub(crate) fn coordinate(value: f64) -> String {
    let value = if value.is_finite() { value.clamp(-1e6, 1e6) } else { 0.0 };
    let mut text = format!("{value:.2}");
    while text.ends_with('0') {
        text.pop();
    }
    if text.ends_with('.') {
        text.pop();
    }
    if text == "-0" { "0".into() } else { text }
}

impl Canvas {
    pub(crate) fn new(width: f64, height: f64, title: &str, description: &str) -> Self {
        let mut canvas = Self {
            width,
            height,
            title: text::plain(title),
            description: text::plain(description),
            body: String::new(),
        };
        canvas.rect(0.0, 0.0, width, height, Paint::Paper, 1.0);
        canvas
    }

    pub(crate) fn line(&mut self, x1: f64, y1: f64, x2: f64, y2: f64, stroke: Stroke) {
        let _ = write!(
            self.body,
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{}/>",
            coordinate(x1),
            coordinate(y1),
            coordinate(x2),
            coordinate(y2),
            stroke_attributes(stroke)
        );
    }

    pub(crate) fn polyline(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        if points.len() > 1 {
            let _ = write!(
                self.body,
                "<path d=\"{}\" fill=\"none\"{}/>",
                path_data(points, false),
                stroke_attributes(stroke)
            );
        }
    }

    /// Closed loops filled by the even-odd rule, with an outline where one is given.
    pub(crate) fn loops(
        &mut self,
        loops: &[Vec<(f64, f64)>],
        paint: Paint,
        opacity: f64,
        outline: Option<Stroke>,
    ) {
        let data: String =
            loops.iter().filter(|l| l.len() > 2).map(|l| path_data(l, true)).collect();
        if data.is_empty() {
            return;
        }
        let _ = write!(
            self.body,
            "<path d=\"{data}\" fill-rule=\"evenodd\"{} fill=\"{}\"{}{}/>",
            class_of(Some(paint), outline.map(|stroke| stroke.paint)),
            paint.colour(),
            fill_opacity(opacity),
            outline.map(stroke_style).unwrap_or_default()
        );
    }

    pub(crate) fn rect(&mut self, x: f64, y: f64, w: f64, h: f64, paint: Paint, opacity: f64) {
        let _ = write!(
            self.body,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{} fill=\"{}\"{}/>",
            coordinate(x),
            coordinate(y),
            coordinate(w.max(0.0)),
            coordinate(h.max(0.0)),
            class_of(Some(paint), None),
            paint.colour(),
            fill_opacity(opacity)
        );
    }

    /// An unfilled rectangle.
    pub(crate) fn outline(&mut self, x: f64, y: f64, w: f64, h: f64, stroke: Stroke) {
        let _ = write!(
            self.body,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\"{}/>",
            coordinate(x),
            coordinate(y),
            coordinate(w.max(0.0)),
            coordinate(h.max(0.0)),
            stroke_attributes(stroke)
        );
    }

    /// An open circle.
    pub(crate) fn ring(&mut self, x: f64, y: f64, radius: f64, stroke: Stroke) {
        let _ = write!(
            self.body,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"none\"{}/>",
            coordinate(x),
            coordinate(y),
            coordinate(radius),
            stroke_attributes(stroke)
        );
    }

    /// A point; a hollow one is filled with the background's colour.
    pub(crate) fn marker(
        &mut self,
        x: f64,
        y: f64,
        marker: Marker,
        radius: f64,
        paint: Paint,
        filled: bool,
    ) {
        let r = radius;
        let stroke = Stroke::new(paint, 1.6);
        if marker == Marker::Cross {
            self.line(x - r, y - r, x + r, y + r, stroke);
            self.line(x - r, y + r, x + r, y - r, stroke);
            return;
        }
        let inside = if filled { paint } else { Paint::Paper };
        let shape = match marker {
            Marker::Circle => {
                format!("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"", coordinate(x), coordinate(y), r)
            }
            Marker::Square => {
                polygon(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)], x, y, r)
            }
            Marker::Triangle => polygon(&[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)], x, y, r),
            Marker::Diamond | Marker::Cross => {
                polygon(&[(0.0, -1.3), (1.1, 0.0), (0.0, 1.3), (-1.1, 0.0)], x, y, r)
            }
        };
        let _ = write!(
            self.body,
            "{shape}{} fill=\"{}\" stroke=\"{}\" stroke-width=\"1.5\"/>",
            class_of(Some(inside), Some(paint)),
            inside.colour(),
            paint.colour()
        );
    }

    pub(crate) fn text(
        &mut self,
        x: f64,
        y: f64,
        content: &str,
        size: FontSize,
        anchor: Anchor,
        paint: Paint,
    ) {
        self.write_text(x, y, content, size, anchor, paint, "");
    }

    /// Bold text.
    pub(crate) fn strong(
        &mut self,
        x: f64,
        y: f64,
        content: &str,
        size: FontSize,
        anchor: Anchor,
        paint: Paint,
    ) {
        self.write_text(x, y, content, size, anchor, paint, " font-weight=\"700\"");
    }

    /// Text with a halo of the background's colour, legible on lines and fillings.
    pub(crate) fn halo_text(
        &mut self,
        x: f64,
        y: f64,
        content: &str,
        size: FontSize,
        anchor: Anchor,
        paint: Paint,
        bold: bool,
    ) {
        let weight = if bold { " font-weight=\"700\"" } else { "" };
        let extra = format!(
            "{weight} stroke=\"{}\" stroke-width=\"3.5\" stroke-linejoin=\"round\" \
             paint-order=\"stroke\"",
            Paint::Paper.colour()
        );
        self.write_text(x, y, content, size, anchor, paint, &extra);
    }

    /// Text that reads upwards.
    pub(crate) fn upright_text(&mut self, x: f64, y: f64, content: &str, size: FontSize) {
        let extra = format!(" transform=\"rotate(-90 {} {})\"", coordinate(x), coordinate(y));
        self.write_text(x, y, content, size, Anchor::Middle, Paint::Ink, &extra);
    }

    /// Text turned by 40 degrees that ends at its point, for long names under an axis.
    pub(crate) fn slanted_text(&mut self, x: f64, y: f64, content: &str, size: FontSize) {
        let extra = format!(" transform=\"rotate(-40 {} {})\"", coordinate(x), coordinate(y));
        self.write_text(x, y, content, size, Anchor::End, Paint::Ink, &extra);
    }

    fn write_text(
        &mut self,
        x: f64,
        y: f64,
        content: &str,
        size: FontSize,
        anchor: Anchor,
        paint: Paint,
        extra: &str,
    ) {
        if content.is_empty() {
            return;
        }
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let halo = extra.contains("paint-order").then_some(Paint::Paper);
        let _ = write!(
            self.body,
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\"{anchor}{} fill=\"{}\"{extra}>{}</text>",
            coordinate(x),
            coordinate(y),
            size.px(),
            class_of(Some(paint), halo),
            paint.colour(),
            text::spans(content)
        );
    }

    /// Everything drawn until [`Canvas::end_clip`] is cut at this rectangle.
    pub(crate) fn begin_clip(&mut self, x: f64, y: f64, w: f64, h: f64) {
        let (x, y) = (coordinate(x), coordinate(y));
        let (w, h) = (coordinate(w), coordinate(h));
        let _ = write!(
            self.body,
            "<svg x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" viewBox=\"{x} {y} {w} {h}\">"
        );
    }

    pub(crate) fn end_clip(&mut self) {
        self.body.push_str("</svg>");
    }

    /// The SVG document.
    pub(crate) fn finish(self) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{w}\" \
             height=\"{h}\" role=\"img\" font-family=\"system-ui, -apple-system, 'Segoe UI', \
             Roboto, 'Helvetica Neue', Arial, 'Liberation Sans', sans-serif\"><title>{}</title>\
             <desc>{}</desc>{}</svg>",
            text::escape(&self.title),
            text::escape(&self.description),
            self.body,
            w = coordinate(self.width),
            h = coordinate(self.height),
        )
    }
}

fn polygon(corners: &[(f64, f64)], x: f64, y: f64, r: f64) -> String {
    let points: Vec<(f64, f64)> = corners.iter().map(|(cx, cy)| (x + r * cx, y + r * cy)).collect();
    format!("<path d=\"{}\"", path_data(&points, true))
}

fn path_data(points: &[(f64, f64)], closed: bool) -> String {
    let mut data = String::new();
    for (i, (x, y)) in points.iter().enumerate() {
        let command = if i == 0 { 'M' } else { 'L' };
        let _ = write!(data, "{command}{} {}", coordinate(*x), coordinate(*y));
    }
    if closed {
        data.push('Z');
    }
    data
}

fn class_of(fill: Option<Paint>, stroke: Option<Paint>) -> String {
    let mut names: Vec<String> = Vec::new();
    names.extend(fill.map(|p| format!("f-{}", p.class())));
    names.extend(stroke.map(|p| format!("s-{}", p.class())));
    if names.is_empty() { String::new() } else { format!(" class=\"{}\"", names.join(" ")) }
}

fn fill_opacity(opacity: f64) -> String {
    if opacity < 1.0 { format!(" fill-opacity=\"{}\"", coordinate(opacity)) } else { String::new() }
}

fn stroke_attributes(stroke: Stroke) -> String {
    format!("{}{}", class_of(None, Some(stroke.paint)), stroke_style(stroke))
}

fn stroke_style(stroke: Stroke) -> String {
    let mut out = format!(
        " stroke=\"{}\" stroke-width=\"{}\"",
        stroke.paint.colour(),
        coordinate(stroke.width)
    );
    if let Some(dash) = stroke.dash.array() {
        let _ = write!(out, " stroke-dasharray=\"{dash}\"");
    }
    if stroke.opacity < 1.0 {
        let _ = write!(out, " stroke-opacity=\"{}\"", coordinate(stroke.opacity));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short_and_finite() {
        assert_eq!(coordinate(1.0), "1");
        assert_eq!(coordinate(-0.001), "0");
        assert_eq!(coordinate(12.345), "12.35");
        assert_eq!(coordinate(100.0), "100");
        assert_eq!(coordinate(f64::NAN), "0");
    }
}
