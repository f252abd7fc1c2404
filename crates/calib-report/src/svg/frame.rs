//! The frame of a plot: title, axes with ticks and grid, legend, and drawing in data coordinates.

use super::WIDTH;
use super::canvas::{Anchor, Canvas, FontSize};
use super::legend::{LegendEntry, lay_out};
use super::paint::{Dash, Marker, Paint, Stroke};
use super::scale::{Scale, Spacing, Tick, ticks};
use super::text;

/// An axis: its label with unit, its range and how its ticks are made.
#[derive(Clone, Debug, Default)]
pub(crate) struct Axis {
    pub(crate) label: String,
    pub(crate) range: (f64, f64),
    pub(crate) spacing: Spacing,
    /// Ticks that replace the automatic ones.
    pub(crate) ticks: Option<Vec<Tick>>,
    /// No grid lines.
    pub(crate) bare: bool,
}

impl Axis {
    pub(crate) fn linear(label: &str, range: (f64, f64)) -> Self {
        Self { label: label.into(), range, ..Self::default() }
    }

    /// An axis of names at 0, 1, 2, ...
    pub(crate) fn names(label: &str, names: &[String]) -> Self {
        let ticks = names
            .iter()
            .enumerate()
            .map(|(i, name)| Tick { at: i as f64, label: name.clone() })
            .collect();
        Self {
            label: label.into(),
            range: (-0.6, names.len() as f64 - 0.4),
            ticks: Some(ticks),
            bare: true,
            ..Self::default()
        }
    }
}

/// What a frame is made of.
#[derive(Clone, Debug, Default)]
pub(crate) struct Layout<'a> {
    pub(crate) title: &'a str,
    pub(crate) description: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    /// Height of the plotting area, px.
    pub(crate) height: f64,
    pub(crate) legend: Vec<LegendEntry>,
    /// Room kept free on the right, px.
    pub(crate) right: f64,
}

/// A plot under construction.
pub(crate) struct Frame {
    pub(crate) canvas: Canvas,
    pub(crate) x: Scale,
    pub(crate) y: Scale,
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
    taken: Vec<[f64; 4]>,
}

/// Draws the title, wrapped, and returns the y below it.
pub(crate) fn draw_title(canvas: &mut Canvas, title: &str) -> f64 {
    let mut y = 8.0;
    for line in title_lines(title) {
        y += 17.0;
        canvas.strong(8.0, y, &line, FontSize::Title, Anchor::Start, Paint::Ink);
    }
    y
}

/// The title's lines for the width of a picture.
pub(crate) fn title_lines(title: &str) -> Vec<String> {
    // Bold letters are about a tenth wider.
    text::wrap(title, 1.1 * FontSize::Title.px(), WIDTH - 16.0)
}

impl Frame {
    pub(crate) fn new(layout: &Layout<'_>) -> Self {
        let head = 8.0 + 17.0 * title_lines(layout.title).len() as f64;
        let tick_px = FontSize::Tick.px();
        let y_count = (layout.height / 34.0).clamp(3.0, 10.0) as usize;
        let y_ticks = layout
            .y
            .ticks
            .clone()
            .unwrap_or_else(|| ticks(layout.y.spacing, layout.y.range, y_count));
        let y_lines = text::wrap(&layout.y.label, FontSize::Label.px(), layout.height + 30.0);
        let widest = y_ticks
            .iter()
            .map(|t| text::width(&t.label, tick_px))
            .fold(0.0f64, f64::max)
            .min(150.0);
        let left = 8.0 + 17.0 * y_lines.len() as f64 + widest + 9.0;
        // The last tick's label may reach beyond the plot by half its width.
        let wide = WIDTH - 14.0 - layout.right;
        let overhang = last_label_width(&layout.x, wide - left) / 2.0 + 3.0;
        let right = wide.min(WIDTH - overhang);
        let top = head + 14.0;
        let bottom = top + layout.height;

        let x_ticks = x_ticks(&layout.x, right - left);
        let room = (right - left) / x_ticks.len().max(1) as f64;
        let longest = x_ticks.iter().map(|t| text::width(&t.label, tick_px)).fold(0.0, f64::max);
        let slanted = layout.x.ticks.is_some() && longest > room - 4.0;
        let tick_height = if slanted { 10.0 + 0.66 * longest.min(130.0) + 8.0 } else { 20.0 };
        let room = (right - left + 20.0).min(2.0 * (WIDTH - 6.0) - left - right);
        let x_lines = text::wrap(&layout.x.label, FontSize::Label.px(), room);
        let foot = tick_height + 18.0 * x_lines.len() as f64 + 4.0;
        let legend = lay_out(&layout.legend, WIDTH - 24.0);
        let legend_room = if legend.height > 0.0 { legend.height + 8.0 } else { 0.0 };
        let height = bottom + foot + legend_room + 8.0;

        let mut canvas = Canvas::new(WIDTH, height, layout.title, &layout.description);
        draw_title(&mut canvas, layout.title);
        legend.draw(&mut canvas, 12.0, bottom + foot + 6.0);

        let mut frame = Self {
            canvas,
            x: Scale::new(layout.x.spacing, layout.x.range, (left, right)),
            y: Scale::new(layout.y.spacing, layout.y.range, (bottom, top)),
            left,
            top,
            right,
            bottom,
            taken: Vec::new(),
        };
        frame.draw_x_axis(&layout.x, &x_ticks, slanted);
        frame.draw_y_axis(&layout.y, &y_ticks);
        let edge = Stroke::new(Paint::Muted, 1.0);
        frame.canvas.outline(left, top, right - left, bottom - top, edge);
        for (i, line) in x_lines.iter().enumerate() {
            let y = bottom + tick_height + 13.0 + 18.0 * i as f64;
            frame.canvas.text(
                0.5 * (left + right),
                y,
                line,
                FontSize::Label,
                Anchor::Middle,
                Paint::Ink,
            );
        }
        for (i, line) in y_lines.iter().enumerate() {
            let x = 19.0 + 17.0 * i as f64;
            frame.canvas.upright_text(x, 0.5 * (top + bottom), line, FontSize::Label);
        }
        frame
    }

    fn draw_x_axis(&mut self, axis: &Axis, ticks: &[Tick], slanted: bool) {
        for tick in ticks {
            let Some(x) = self.x.px(tick.at).filter(|_| self.x.contains(tick.at)) else { continue };
            if !axis.bare {
                self.canvas.line(x, self.top, x, self.bottom, Stroke::new(Paint::Grid, 0.8));
            }
            self.canvas.line(x, self.bottom, x, self.bottom + 4.0, Stroke::new(Paint::Muted, 1.0));
            if slanted {
                let label = text::shorten(&tick.label, FontSize::Tick.px(), 130.0);
                self.canvas.slanted_text(x + 4.0, self.bottom + 14.0, &label, FontSize::Tick);
            } else {
                let y = self.bottom + 17.0;
                self.canvas.text(x, y, &tick.label, FontSize::Tick, Anchor::Middle, Paint::Ink);
            }
        }
    }

    fn draw_y_axis(&mut self, axis: &Axis, ticks: &[Tick]) {
        for tick in ticks {
            let Some(y) = self.y.px(tick.at).filter(|_| self.y.contains(tick.at)) else { continue };
            if !axis.bare {
                self.canvas.line(self.left, y, self.right, y, Stroke::new(Paint::Grid, 0.8));
            }
            self.canvas.line(self.left - 4.0, y, self.left, y, Stroke::new(Paint::Muted, 1.0));
            let label = text::shorten(&tick.label, FontSize::Tick.px(), 150.0);
            let x = self.left - 7.0;
            self.canvas.text(x, y + 4.0, &label, FontSize::Tick, Anchor::End, Paint::Ink);
        }
    }

    /// Cuts what follows at the edges of the plotting area.
    pub(crate) fn clip(&mut self) {
        self.canvas.begin_clip(self.left, self.top, self.right - self.left, self.bottom - self.top);
    }

    /// Ends [`Frame::clip`].
    pub(crate) fn unclip(&mut self) {
        self.canvas.end_clip();
    }

    /// The pixels of a data point.
    pub(crate) fn at(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        Some((self.x.px(x)?, self.y.px(y)?))
    }

    /// A line through data points, broken where one has no place.
    pub(crate) fn polyline(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        stroke: Stroke,
    ) {
        let mut piece = Vec::new();
        for (x, y) in points {
            match self.at(x, y) {
                Some(point) => piece.push(point),
                None => {
                    self.canvas.polyline(&piece, stroke);
                    piece.clear();
                }
            }
        }
        self.canvas.polyline(&piece, stroke);
    }

    /// The area between two curves; points without a place are left out.
    pub(crate) fn band(&mut self, points: &[(f64, f64, f64)], paint: Paint, opacity: f64) {
        let placed: Vec<_> = points
            .iter()
            .filter_map(|(x, lo, hi)| Some((self.x.px(*x)?, self.y.px(*lo)?, self.y.px(*hi)?)))
            .collect();
        let lower = placed.iter().map(|(x, lo, _)| (*x, *lo));
        let upper = placed.iter().rev().map(|(x, _, hi)| (*x, *hi));
        self.canvas.loops(&[lower.chain(upper).collect()], paint, opacity, None);
    }

    /// A point at data coordinates.
    pub(crate) fn marker(
        &mut self,
        x: f64,
        y: f64,
        marker: Marker,
        radius: f64,
        paint: Paint,
        filled: bool,
    ) {
        if let Some((x, y)) = self.at(x, y) {
            self.canvas.marker(x, y, marker, radius, paint, filled);
        }
    }

    /// A vertical interval; an open end (`None`) runs to the edge and carries an arrow head.
    pub(crate) fn interval(&mut self, x: f64, lo: Option<f64>, hi: Option<f64>, stroke: Stroke) {
        let Some(x) = self.x.px(x) else { return };
        let (top, bottom) = (self.top, self.bottom);
        let low = lo.and_then(|v| self.y.px(v));
        let high = hi.and_then(|v| self.y.px(v));
        let cap = 4.5;
        let y_low = low.map_or(bottom - 2.0, |y| y.clamp(top, bottom));
        let y_high = high.map_or(top + 2.0, |y| y.clamp(top, bottom));
        self.canvas.line(x, y_low, x, y_high, stroke);
        for (closed, y, towards) in [(low.is_some(), y_low, -1.0), (high.is_some(), y_high, 1.0)] {
            if closed {
                self.canvas.line(x - cap, y, x + cap, y, stroke);
            } else {
                let back = y + 6.0 * towards;
                self.canvas.polyline(&[(x - cap, back), (x, y), (x + cap, back)], stroke);
            }
        }
    }

    /// A horizontal line across the plot.
    pub(crate) fn horizontal(&mut self, y: f64, stroke: Stroke) {
        if let Some(px) = self.y.px(y).filter(|_| self.y.contains(y)) {
            self.canvas.line(self.left, px, self.right, px, stroke);
        }
    }

    /// A vertical line across the plot.
    pub(crate) fn vertical(&mut self, x: f64, stroke: Stroke) {
        if let Some(px) = self.x.px(x).filter(|_| self.x.contains(x)) {
            self.canvas.line(px, self.top, px, self.bottom, stroke);
        }
    }

    /// The dashed thin line of a limit.
    pub(crate) fn limit_stroke() -> Stroke {
        Stroke::new(Paint::Alarm, 1.2).dashed(Dash::Short)
    }

    /// Marks a rectangle (px) as occupied for [`Frame::label`].
    pub(crate) fn occupy(&mut self, x: f64, y: f64, half_width: f64, half_height: f64) {
        self.taken.push([x - half_width, y - half_height, x + half_width, y + half_height]);
    }

    /// Writes a small label next to a data point where there is room; says whether it found any.
    pub(crate) fn label(&mut self, x: f64, y: f64, content: &str, paint: Paint) -> bool {
        let Some((px, py)) = self.at(x, y) else { return false };
        let size = FontSize::Small;
        let width = text::width(content, size.px());
        let places = [
            (7.0, 4.0, Anchor::Start),
            (-7.0, 4.0, Anchor::End),
            (0.0, -8.0, Anchor::Middle),
            (0.0, 16.0, Anchor::Middle),
            (6.0, -7.0, Anchor::Start),
            (-6.0, 15.0, Anchor::End),
        ];
        for (dx, dy, anchor) in places {
            let (cx, baseline) = (px + dx, py + dy);
            let x0 = match anchor {
                Anchor::Start => cx,
                Anchor::Middle => cx - 0.5 * width,
                Anchor::End => cx - width,
            };
            let area = [x0, baseline - 9.0, x0 + width, baseline + 2.0];
            let inside = area[0] > self.left
                && area[2] < self.right
                && area[1] > self.top
                && area[3] < self.bottom;
            let free = self
                .taken
                .iter()
                .all(|t| area[2] < t[0] || area[0] > t[2] || area[3] < t[1] || area[1] > t[3]);
            if inside && free {
                self.taken.push(area);
                self.canvas.halo_text(cx, baseline, content, size, anchor, paint, false);
                return true;
            }
        }
        false
    }

    pub(crate) fn finish(self) -> String {
        self.canvas.finish()
    }
}

/// Ticks of the x axis, as many as have room.
fn x_ticks(axis: &Axis, length: f64) -> Vec<Tick> {
    if let Some(ticks) = &axis.ticks {
        return ticks.clone();
    }
    let mut best = Vec::new();
    for count in (2..=10).rev() {
        best = ticks(axis.spacing, axis.range, count);
        let needed: f64 =
            best.iter().map(|t| text::width(&t.label, FontSize::Tick.px()) + 12.0).sum();
        if needed <= length {
            break;
        }
    }
    best
}

/// Width of the label at the right end of the x axis.
fn last_label_width(axis: &Axis, length: f64) -> f64 {
    if axis.ticks.is_some() {
        return 0.0; // names turn where they have no room
    }
    let last = x_ticks(axis, length).pop();
    last.map_or(0.0, |t| text::width(&t.label, FontSize::Tick.px()))
}

/// A picture that says why there is nothing to see.
pub(crate) fn no_data(title: &str, reason: &str) -> String {
    let title_height = 17.0 * title_lines(title).len() as f64;
    let height = title_height + 110.0;
    let mut canvas = Canvas::new(WIDTH, height, title, &format!("No data: {reason}"));
    let top = draw_title(&mut canvas, title) + 10.0;
    let edge = Stroke::new(Paint::Muted, 1.0).dashed(Dash::Short);
    canvas.outline(8.0, top, WIDTH - 16.0, height - top - 8.0, edge);
    let middle = 0.5 * (top + height - 8.0);
    canvas.strong(0.5 * WIDTH, middle, "no data", FontSize::Label, Anchor::Middle, Paint::Muted);
    let reason = text::shorten(reason, FontSize::Tick.px(), WIDTH - 32.0);
    canvas.text(0.5 * WIDTH, middle + 18.0, &reason, FontSize::Tick, Anchor::Middle, Paint::Muted);
    canvas.finish()
}
