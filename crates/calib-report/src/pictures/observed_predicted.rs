//! Observed against predicted values.

use super::replicates::label;
use crate::Picture;
use crate::number::{drawable, extent, padded};
use crate::svg::frame::{Layout, no_data};
use crate::svg::{Axis, Dash, Frame, Key, LegendEntry, Marker, Paint, Stroke};

/// A run: what was observed and what the fit predicts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObservedPrediction {
    /// Number or name of the run.
    pub run: String,
    /// Observed value.
    pub observed: f64,
    /// Predicted value.
    pub predicted: f64,
}

/// Observed against predicted values with the line of equality; the three worst runs are named.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObservedPredicted {
    /// Title.
    pub title: String,
    /// Response.
    pub response: String,
    /// Unit of the response.
    pub unit: String,
    /// Runs.
    pub points: Vec<ObservedPrediction>,
}

impl Picture for ObservedPredicted {
    fn svg(&self) -> String {
        let mut usable: Vec<&ObservedPrediction> =
            self.points.iter().filter(|p| drawable(p.observed) && drawable(p.predicted)).collect();
        let Some(range) = extent(usable.iter().flat_map(|p| [p.observed, p.predicted])) else {
            return no_data(&self.title, "no finite pair");
        };
        let range = padded(range, 0.06);
        let equality = Stroke::new(Paint::Muted, 1.3).dashed(Dash::Long);
        let name = label(&self.response, &self.unit);
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!("{} runs around the line of equality.", usable.len()),
            x: Axis::linear(&format!("predicted {name}"), range),
            y: Axis::linear(&format!("observed {name}"), range),
            height: 300.0,
            legend: vec![
                LegendEntry::new(Key::Point(Marker::Circle, Paint::Series(0), true), "run"),
                LegendEntry::new(Key::Line(equality), "observed = predicted"),
            ],
            right: 0.0,
        });
        frame.polyline([(range.0, range.0), (range.1, range.1)], equality);
        for p in &usable {
            frame.marker(p.predicted, p.observed, Marker::Circle, 3.6, Paint::Series(0), true);
            if let Some((x, y)) = frame.at(p.predicted, p.observed) {
                frame.occupy(x, y, 4.0, 4.0);
            }
        }
        let miss = |p: &ObservedPrediction| (p.observed - p.predicted).abs();
        usable.sort_by(|a, b| miss(b).total_cmp(&miss(a)).then_with(|| a.run.cmp(&b.run)));
        for p in usable.iter().take(3).filter(|p| miss(p) > 0.0) {
            frame.label(p.predicted, p.observed, &p.run, Paint::Ink);
        }
        frame.finish()
    }
}
