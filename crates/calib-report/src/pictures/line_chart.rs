//! A general chart: lines with bands and points with error bars.

use crate::Picture;
use crate::number::{extent, padded};
use crate::svg::frame::{Layout, no_data};
use crate::svg::{Axis, Dash, Frame, Key, LegendEntry, Marker, Paint, Spacing, Stroke};

/// How values are spaced along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisSpacing {
    /// Evenly.
    #[default]
    Linear,
    /// By their decadic logarithm; values at or below zero are left out.
    Logarithmic,
}

/// An axis of a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartAxis {
    /// Label with unit.
    pub label: String,
    /// Range; that of the data where none is given.
    pub range: Option<(f64, f64)>,
    /// Spacing.
    pub spacing: AxisSpacing,
}

impl ChartAxis {
    /// A linear axis over the range of the data.
    pub fn new(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }
}

/// A point with an optional error bar or band (both ends in data units).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChartPoint {
    /// Abscissa.
    pub x: f64,
    /// Ordinate.
    pub y: f64,
    /// Lower and upper end of the interval.
    pub interval: Option<(f64, f64)>,
}

impl From<(f64, f64)> for ChartPoint {
    fn from((x, y): (f64, f64)) -> Self {
        Self { x, y, interval: None }
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SeriesStyle {
    /// A line, with its intervals as a band.
    #[default]
    Line,
    /// Points, with their intervals as error bars.
    Points,
    /// Points joined by a line, with error bars.
    LineAndPoints,
    /// Steps that hold a value until the next abscissa.
    Steps,
}

/// A series of a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartSeries {
    /// Name in the legend.
    pub name: String,
    /// How it is drawn.
    pub style: SeriesStyle,
    /// Points in order of the abscissa.
    pub points: Vec<ChartPoint>,
}

/// Lines with bands and points with error bars over linear or logarithmic axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineChart {
    /// Title.
    pub title: String,
    /// Abscissa.
    pub x: ChartAxis,
    /// Ordinate.
    pub y: ChartAxis,
    /// Series; colour, dash and marker follow their order.
    pub series: Vec<ChartSeries>,
    /// Horizontal limits: (value, name).
    pub horizontal_limits: Vec<(f64, String)>,
    /// Vertical limits: (value, name).
    pub vertical_limits: Vec<(f64, String)>,
}

impl LineChart {
    fn ranges(&self) -> Option<((f64, f64), (f64, f64))> {
        let points = || self.series.iter().flat_map(|s| &s.points);
        let ends = points().flat_map(|p| {
            let (lo, hi) = p.interval.unwrap_or((p.y, p.y));
            [p.y, lo, hi]
        });
        let limits = self.horizontal_limits.iter().map(|l| l.0);
        let x = range_of(&self.x, points().map(|p| p.x), 0.03)?;
        let y = range_of(&self.y, ends.chain(limits), 0.07)?;
        Some((x, y))
    }
}

impl Picture for LineChart {
    fn svg(&self) -> String {
        let Some((x_range, y_range)) = self.ranges() else {
            return no_data(&self.title, "no point that the axes can show");
        };
        let mut legend: Vec<LegendEntry> = Vec::new();
        for (i, series) in self.series.iter().enumerate().filter(|(_, s)| !s.name.is_empty()) {
            let key = match series.style {
                SeriesStyle::Line | SeriesStyle::Steps => Key::Line(stroke(i)),
                SeriesStyle::Points => Key::Point(Marker::of_series(i), Paint::Series(i), true),
                SeriesStyle::LineAndPoints => Key::LinePoint(stroke(i), Marker::of_series(i)),
            };
            legend.push(LegendEntry::new(key, &series.name));
        }
        for (_, name) in self.horizontal_limits.iter().chain(&self.vertical_limits) {
            if !name.is_empty() {
                legend.push(LegendEntry::new(Key::Line(Frame::limit_stroke()), name));
            }
        }
        let names: Vec<&str> = self.series.iter().map(|s| s.name.as_str()).collect();
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!(
                "{} against {}: {}.",
                self.y.label,
                self.x.label,
                names.join(", ")
            ),
            x: Axis { spacing: spacing(&self.x), ..Axis::linear(&self.x.label, x_range) },
            y: Axis { spacing: spacing(&self.y), ..Axis::linear(&self.y.label, y_range) },
            height: 250.0,
            legend,
            right: 0.0,
        });
        frame.clip();
        for (value, _) in &self.horizontal_limits {
            frame.horizontal(*value, Frame::limit_stroke());
        }
        for (value, _) in &self.vertical_limits {
            frame.vertical(*value, Frame::limit_stroke());
        }
        for (i, series) in self.series.iter().enumerate() {
            draw_series(&mut frame, i, series);
        }
        frame.unclip();
        frame.finish()
    }
}

fn draw_series(frame: &mut Frame, i: usize, series: &ChartSeries) {
    let paint = Paint::Series(i);
    let points = || series.points.iter().map(|p| (p.x, p.y));
    let intervals = series.points.iter().filter_map(|p| p.interval.map(|(lo, hi)| (p.x, lo, hi)));
    match series.style {
        SeriesStyle::Line | SeriesStyle::Steps => {
            frame.band(&intervals.collect::<Vec<_>>(), paint, 0.18);
        }
        SeriesStyle::Points | SeriesStyle::LineAndPoints => {
            for (x, lo, hi) in intervals {
                let stroke = Stroke::new(paint, 1.4);
                // A NaN end is an open one: it runs to the edge with an arrow.
                let end = |v: f64| (!v.is_nan()).then_some(v);
                frame.interval(x, end(lo), end(hi), stroke);
            }
        }
    }
    match series.style {
        SeriesStyle::Line | SeriesStyle::LineAndPoints => frame.polyline(points(), stroke(i)),
        SeriesStyle::Steps => {
            let pairs = series.points.windows(2);
            let steps = pairs.flat_map(|w| [(w[0].x, w[0].y), (w[1].x, w[0].y)]);
            frame.polyline(steps.chain(points().next_back()), stroke(i));
        }
        SeriesStyle::Points => {}
    }
    if matches!(series.style, SeriesStyle::Points | SeriesStyle::LineAndPoints) {
        for (x, y) in points() {
            frame.marker(x, y, Marker::of_series(i), 3.6, paint, true);
        }
    }
}

fn stroke(i: usize) -> Stroke {
    Stroke::new(Paint::Series(i), 1.8).dashed(Dash::of_series(i))
}

fn spacing(axis: &ChartAxis) -> Spacing {
    match axis.spacing {
        AxisSpacing::Linear => Spacing::Linear,
        AxisSpacing::Logarithmic => Spacing::Log10,
    }
}

fn range_of(
    axis: &ChartAxis,
    values: impl Iterator<Item = f64>,
    padding: f64,
) -> Option<(f64, f64)> {
    let logarithmic = axis.spacing == AxisSpacing::Logarithmic;
    let seen = extent(values.filter(|v| !logarithmic || *v > 1e-100))?;
    let given = axis.range.filter(|(lo, hi)| {
        lo.is_finite() && hi.is_finite() && hi > lo && (!logarithmic || *lo > 0.0)
    });
    Some(given.unwrap_or_else(|| {
        if logarithmic {
            let (lo, hi) = padded((seen.0.log10(), seen.1.log10()), padding);
            (10f64.powf(lo), 10f64.powf(hi))
        } else {
            padded(seen, padding)
        }
    }))
}
