//! Effect plot and interaction plot.

use super::replicates::label;
use crate::Picture;
use crate::number::{extent, padded};
use crate::svg::frame::{Layout, no_data};
use crate::svg::{Axis, Dash, Frame, Key, LegendEntry, Marker, Paint, Stroke};

/// A predicted value along a factor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EffectPoint {
    /// Value of the factor.
    pub factor: f64,
    /// Predicted response.
    pub response: f64,
    /// Interval of the prediction, if known.
    pub interval: Option<(f64, f64)>,
}

/// The response along one factor, the others at their centre.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EffectPlot {
    /// Title.
    pub title: String,
    /// Factor with its unit, as "μ_{pp}" or "speed, rpm".
    pub factor: String,
    /// Response.
    pub response: String,
    /// Unit of the response.
    pub unit: String,
    /// Points in order of the factor.
    pub points: Vec<EffectPoint>,
    /// Range of the response on the axis, so that several effects can be compared; none for the
    /// range of this one.
    pub response_range: Option<(f64, f64)>,
    /// Level of the intervals, as "95 %".
    pub level: String,
}

impl Picture for EffectPlot {
    fn svg(&self) -> String {
        let ends = |p: &EffectPoint| {
            let (lo, hi) = p.interval.unwrap_or((p.response, p.response));
            [p.response, lo, hi]
        };
        let (Some(x_range), Some(y_range)) = (
            extent(self.points.iter().map(|p| p.factor)),
            extent(self.points.iter().flat_map(ends)),
        ) else {
            return no_data(&self.title, "no finite prediction");
        };
        let y_range = self
            .response_range
            .filter(|(lo, hi)| lo.is_finite() && hi > lo && hi.is_finite())
            .unwrap_or(padded(y_range, 0.08));
        let line = Stroke::new(Paint::Series(0), 2.0);
        let mut legend =
            vec![LegendEntry::new(Key::Line(line), "prediction, other factors at centre")];
        let band: Vec<(f64, f64, f64)> = self
            .points
            .iter()
            .filter_map(|p| p.interval.map(|(lo, hi)| (p.factor, lo, hi)))
            .collect();
        if band.len() > 1 {
            let text = format!("{} interval", self.level);
            legend.push(LegendEntry::new(Key::Area(Paint::Series(0), 0.2), text.trim()));
        }
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!("{} along {}.", self.response, self.factor),
            x: Axis::linear(&self.factor, padded(x_range, 0.02)),
            y: Axis::linear(&label(&self.response, &self.unit), y_range),
            height: 210.0,
            legend,
            right: 0.0,
        });
        frame.clip();
        frame.band(&band, Paint::Series(0), 0.2);
        frame.polyline(self.points.iter().map(|p| (p.factor, p.response)), line);
        if let [p] = self.points[..] {
            frame.marker(p.factor, p.response, Marker::Circle, 4.0, Paint::Series(0), true);
        }
        frame.unclip();
        frame.finish()
    }
}

/// The response along one factor at one level of another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InteractionLine {
    /// Level of the other factor, as "μ_{wall} = 0.4".
    pub level: String,
    /// Points (factor, response) in order of the factor.
    pub points: Vec<(f64, f64)>,
}

/// The response along one factor at several levels of another: parallel lines mean no interaction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InteractionPlot {
    /// Title.
    pub title: String,
    /// Factor along the axis, with its unit.
    pub factor: String,
    /// Response.
    pub response: String,
    /// Unit of the response.
    pub unit: String,
    /// Lines, one a level.
    pub lines: Vec<InteractionLine>,
}

impl Picture for InteractionPlot {
    fn svg(&self) -> String {
        let all = || self.lines.iter().flat_map(|l| &l.points);
        let (Some(x_range), Some(y_range)) =
            (extent(all().map(|p| p.0)), extent(all().map(|p| p.1)))
        else {
            return no_data(&self.title, "no finite prediction");
        };
        let stroke = |i| Stroke::new(Paint::Series(i), 2.0).dashed(Dash::of_series(i));
        let legend = self
            .lines
            .iter()
            .enumerate()
            .map(|(i, l)| {
                LegendEntry::new(Key::LinePoint(stroke(i), Marker::of_series(i)), &l.level)
            })
            .collect();
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!(
                "{} along {} at {} levels of another factor.",
                self.response,
                self.factor,
                self.lines.len()
            ),
            x: Axis::linear(&self.factor, padded(x_range, 0.03)),
            y: Axis::linear(&label(&self.response, &self.unit), padded(y_range, 0.08)),
            height: 210.0,
            legend,
            right: 0.0,
        });
        for (i, line) in self.lines.iter().enumerate() {
            frame.polyline(line.points.iter().copied(), stroke(i));
            for (x, y) in [line.points.first(), line.points.last()].into_iter().flatten() {
                frame.marker(*x, *y, Marker::of_series(i), 4.0, Paint::Series(i), true);
            }
        }
        frame.finish()
    }
}
