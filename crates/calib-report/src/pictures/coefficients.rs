//! Coefficient plot: scaled and centred coefficients with their intervals.

use super::replicates::label;
use crate::Picture;
use crate::number::{extent, padded};
use crate::svg::frame::{Layout, no_data};
use crate::svg::scale::Tick;
use crate::svg::{Axis, Frame, Key, LegendEntry, Paint, Stroke};

/// A coefficient, scaled and centred: change of the response from the factor's centre to its high
/// level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coefficient {
    /// Term, as "μ_{pp}" or "ω·μ_{pp}".
    pub term: String,
    /// Value, in the unit of the response.
    pub value: f64,
    /// Interval by t; none where there are no degrees of freedom left.
    pub interval: Option<(f64, f64)>,
}

/// Bars of the coefficients with intervals; a bar whose interval holds zero is hollow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CoefficientPlot {
    /// Title.
    pub title: String,
    /// Response.
    pub response: String,
    /// Unit of the response.
    pub unit: String,
    /// Terms without the constant, in the order of the model.
    pub coefficients: Vec<Coefficient>,
    /// Level of the intervals, as "95 %".
    pub level: String,
}

impl Picture for CoefficientPlot {
    fn svg(&self) -> String {
        let ends = |c: &Coefficient| {
            let (lo, hi) = c.interval.unwrap_or((c.value, c.value));
            [c.value, lo, hi]
        };
        let Some((lo, hi)) = extent(self.coefficients.iter().flat_map(ends)) else {
            return no_data(&self.title, "no coefficient");
        };
        let count = self.coefficients.len();
        let ticks = self
            .coefficients
            .iter()
            .enumerate()
            .map(|(i, c)| Tick { at: -(i as f64), label: c.term.clone() })
            .collect();
        let solid = Stroke::new(Paint::Series(0), 1.5);
        let mut legend = vec![
            LegendEntry::new(Key::OutlinedArea(Paint::Series(0), 0.8, solid), "coefficient"),
            LegendEntry::new(Key::OutlinedArea(Paint::Paper, 1.0, solid), "interval holds zero"),
        ];
        let level = if self.level.is_empty() { "t interval" } else { "interval by t" };
        let text = format!("{} {level}", self.level);
        legend.push(LegendEntry::new(Key::Line(Stroke::new(Paint::Ink, 1.4)), text.trim()));
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!(
                "Scaled and centred coefficients of {count} terms with intervals."
            ),
            x: Axis::linear(
                &format!("effect on {} (centre to high level)", label(&self.response, &self.unit)),
                padded((lo.min(0.0), hi.max(0.0)), 0.05),
            ),
            y: Axis {
                range: (0.6 - count as f64, 0.6),
                ticks: Some(ticks),
                bare: true,
                ..Axis::default()
            },
            height: 24.0 * count as f64 + 10.0,
            legend,
            right: 0.0,
        });
        let Some(zero) = frame.x.px(0.0) else { return frame.finish() };
        for (i, c) in self.coefficients.iter().enumerate() {
            let Some((x, y)) = frame.at(c.value, -(i as f64)) else { continue };
            let open = c.interval.is_none_or(|(lo, hi)| lo <= 0.0 && hi >= 0.0);
            let (paint, opacity) = if open { (Paint::Paper, 1.0) } else { (Paint::Series(0), 0.8) };
            let (left, width) = (x.min(zero), (x - zero).abs());
            frame.canvas.rect(left, y - 7.0, width, 14.0, paint, opacity);
            frame.canvas.outline(left, y - 7.0, width, 14.0, solid);
            if let Some((lo, hi)) = c.interval
                && let (Some(a), Some(b)) = (frame.x.px(lo), frame.x.px(hi))
            {
                let stroke = Stroke::new(Paint::Ink, 1.4);
                frame.canvas.line(a, y, b, y, stroke);
                frame.canvas.line(a, y - 4.0, a, y + 4.0, stroke);
                frame.canvas.line(b, y - 4.0, b, y + 4.0, stroke);
            }
        }
        frame.vertical(0.0, Stroke::new(Paint::Ink, 1.2));
        frame.finish()
    }
}
