//! Histogram of a response with its skewness and the advised transform.

use super::replicates::label;
use crate::Picture;
use crate::number::{drawable, extent, fixed, padded};
use crate::svg::frame::{Layout, no_data};
use crate::svg::{Axis, Frame, Key, LegendEntry, Paint, Stroke};

/// Histogram of a response.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResponseHistogram {
    /// Title.
    pub title: String,
    /// Response.
    pub response: String,
    /// Unit of the response.
    pub unit: String,
    /// Values of all runs.
    pub values: Vec<f64>,
    /// Skewness of the values.
    pub skewness: Option<f64>,
    /// Standard error of the skewness.
    pub skewness_se: Option<f64>,
    /// What to do, as "no transform needed" or "−log(y_{max} − y)".
    pub advice: String,
}

impl ResponseHistogram {
    /// Bins (first edge, width, counts): about as many as Sturges advises, at round edges.
    fn bins(&self) -> Option<(f64, f64, Vec<usize>)> {
        let values: Vec<f64> = self.values.iter().copied().filter(|v| drawable(*v)).collect();
        let (lo, hi) = extent(values.iter().copied())?;
        let wanted = (values.len() as f64).log2().ceil() as usize + 1;
        let width = if hi - lo > 1e-12 * (lo.abs() + hi.abs()) {
            round_width((hi - lo) / wanted as f64)
        } else {
            padded((lo, hi), 0.0).1 - lo
        };
        let first = (lo / width).floor() * width;
        let bin = |v: f64| (((v - first) / width).floor().max(0.0) as usize).min(100);
        let mut counts = vec![0; bin(hi) + 1];
        for v in values {
            counts[bin(v)] += 1;
        }
        Some((first, width, counts))
    }
}

impl Picture for ResponseHistogram {
    fn svg(&self) -> String {
        let Some((first, width, counts)) = self.bins() else {
            return no_data(&self.title, "no finite response");
        };
        let highest = counts.iter().copied().max().unwrap_or(1) as f64;
        let mut legend = Vec::new();
        if let Some(skewness) = self.skewness {
            let error = self.skewness_se.map(|s| format!(" ± {}", fixed(s, 2))).unwrap_or_default();
            let text = format!("skewness {}{error}", fixed(skewness, 2));
            legend.push(LegendEntry::new(Key::None, text));
        }
        if !self.advice.is_empty() {
            legend.push(LegendEntry::new(Key::None, format!("advised transform: {}", self.advice)));
        }
        let description: Vec<&str> = legend.iter().map(|e| e.text.as_str()).collect();
        let end = first + width * counts.len() as f64;
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!(
                "Histogram of {} values. {}",
                self.values.len(),
                description.join("; ")
            ),
            x: Axis::linear(
                &label(&self.response, &self.unit),
                (first - 0.3 * width, end + 0.3 * width),
            ),
            y: Axis::linear("number of runs", (0.0, 1.08 * highest)),
            height: 210.0,
            legend,
            right: 0.0,
        });
        for (i, count) in counts.iter().enumerate().filter(|(_, c)| **c > 0) {
            let left = first + width * i as f64;
            if let (Some((x0, y)), Some((x1, zero))) =
                (frame.at(left, *count as f64), frame.at(left + width, 0.0))
            {
                frame.canvas.rect(x0, y, x1 - x0, zero - y, Paint::Series(0), 0.75);
                let edge = Stroke::new(Paint::Paper, 1.0);
                frame.canvas.outline(x0, y, x1 - x0, zero - y, edge);
            }
        }
        frame.finish()
    }
}

/// The nearest of 1, 2, 2.5 and 5 times a power of ten.
fn round_width(wanted: f64) -> f64 {
    let power = 10f64.powf(wanted.log10().floor());
    let ratio = |m: &f64| (m * power / wanted).ln().abs();
    [1.0, 2.0, 2.5, 5.0, 10.0]
        .into_iter()
        .min_by(|a, b| ratio(a).total_cmp(&ratio(b)))
        .map_or(wanted, |m| m * power)
}
