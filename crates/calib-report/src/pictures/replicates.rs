//! Replicate plot: the response of every run, with repeated settings highlighted.

use crate::Picture;
use crate::number::{drawable, extent, padded};
use crate::svg::frame::{Layout, no_data};
use crate::svg::{Axis, Frame, Key, LegendEntry, Marker, Paint, Stroke};

/// A run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReplicatePoint {
    /// Number or name of the run.
    pub run: String,
    /// Number of its setting: runs with equal factors share it.
    pub setting: usize,
    /// Response.
    pub value: f64,
}

/// Response against the number of the setting: replicates stand above each other and are joined.
///
/// The scatter of replicates should be small against the scatter of all runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReplicatePlot {
    /// Title.
    pub title: String,
    /// Response.
    pub response: String,
    /// Unit of the response.
    pub unit: String,
    /// Runs.
    pub points: Vec<ReplicatePoint>,
}

impl Picture for ReplicatePlot {
    fn svg(&self) -> String {
        let usable: Vec<&ReplicatePoint> =
            self.points.iter().filter(|p| drawable(p.value)).collect();
        let (Some(y_range), Some(x_range)) = (
            extent(usable.iter().map(|p| p.value)),
            extent(usable.iter().map(|p| p.setting as f64)),
        ) else {
            return no_data(&self.title, "no finite response");
        };
        let repeated =
            |p: &ReplicatePoint| usable.iter().filter(|q| q.setting == p.setting).count() > 1;
        let replicates = usable.iter().filter(|p| repeated(p)).count();
        let single = Key::Point(Marker::Circle, Paint::Series(0), true);
        let replicate = Key::LinePoint(Stroke::new(Paint::Series(1), 2.0), Marker::Square);
        let legend = vec![
            LegendEntry::new(single, "single run"),
            LegendEntry::new(replicate, "replicates (run number)"),
        ];
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!("{} runs, of which {replicates} are replicates.", usable.len()),
            x: Axis::linear("number of the setting", padded(x_range, 0.04)),
            y: Axis::linear(&label(&self.response, &self.unit), padded(y_range, 0.08)),
            height: 230.0,
            legend,
            right: 0.0,
        });
        let mut settings: Vec<usize> =
            usable.iter().filter(|p| repeated(p)).map(|p| p.setting).collect();
        settings.sort_unstable();
        settings.dedup();
        for setting in settings {
            let values = usable.iter().filter(|p| p.setting == setting).map(|p| p.value);
            if let Some((lo, hi)) = extent(values) {
                let x = setting as f64;
                frame.polyline([(x, lo), (x, hi)], Stroke::new(Paint::Series(1), 2.0));
            }
        }
        for p in &usable {
            let (marker, series) =
                if repeated(p) { (Marker::Square, 1) } else { (Marker::Circle, 0) };
            frame.marker(p.setting as f64, p.value, marker, 3.6, Paint::Series(series), true);
            if let Some((x, y)) = frame.at(p.setting as f64, p.value) {
                frame.occupy(x, y, 4.0, 4.0);
            }
        }
        for p in usable.iter().filter(|p| repeated(p)) {
            frame.label(p.setting as f64, p.value, &p.run, Paint::SeriesText(1));
        }
        frame.finish()
    }
}

/// "response, unit" or the response alone.
pub(super) fn label(response: &str, unit: &str) -> String {
    if unit.is_empty() { response.to_string() } else { format!("{response}, {unit}") }
}
