//! Residuals in standard deviations against speed, one line a response.

use crate::Picture;
use crate::number::{drawable, extent, fixed, padded};
use crate::svg::frame::{Layout, no_data};
use crate::svg::{Axis, Dash, Frame, Key, LegendEntry, Marker, Paint, Stroke};

/// One residual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResidualAtSpeed {
    /// Speed of the drum, rpm.
    pub omega_rpm: f64,
    /// (measured - model) / sd.
    pub residual_sd: f64,
    /// Flagged as an outlier: drawn hollow with a ring and labelled.
    pub outlier: bool,
}

/// The residuals of one response.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResponseResiduals {
    /// Name of the response.
    pub response: String,
    /// Residuals in order of speed.
    pub points: Vec<ResidualAtSpeed>,
}

/// Residuals (measured minus model, in sd) of every response against speed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResidualSpeed {
    /// Title, with the case.
    pub title: String,
    /// Which sd the residuals are in units of, as "frame sd"; "sd" where empty.
    pub sd_of: String,
    /// The responses.
    pub responses: Vec<ResponseResiduals>,
    /// Residuals beyond it on either side are shaded as unlikely; 2 where none is given.
    pub limit: Option<f64>,
}

impl Picture for ResidualSpeed {
    fn svg(&self) -> String {
        let all = || self.responses.iter().flat_map(|r| &r.points);
        let usable = || all().filter(|p| drawable(p.residual_sd));
        let (Some(x_range), Some(y_range)) =
            (extent(usable().map(|p| p.omega_rpm)), extent(usable().map(|p| p.residual_sd)))
        else {
            return no_data(&self.title, "no finite residual");
        };
        let limit = self.limit.filter(|l| l.is_finite() && *l > 0.0).unwrap_or(2.0);
        let y_range = padded((y_range.0.min(-1.25 * limit), y_range.1.max(1.25 * limit)), 0.06);
        let x_range = padded(x_range, 0.06);
        let sd = if self.sd_of.is_empty() { "sd" } else { &self.sd_of };
        let mut legend: Vec<LegendEntry> = self
            .responses
            .iter()
            .enumerate()
            .map(|(i, r)| {
                LegendEntry::new(Key::LinePoint(stroke(i), Marker::of_series(i)), &r.response)
            })
            .collect();
        legend.push(LegendEntry::new(
            Key::Area(Paint::Neutral, 0.25),
            format!("within ±{} sd", fixed(limit, if limit.fract() == 0.0 { 0 } else { 1 })),
        ));
        if all().any(|p| p.outlier) {
            let key = Key::Point(Marker::Circle, Paint::Alarm, false);
            legend.push(LegendEntry::new(key, "ring: flagged as outlier (speed in rpm)"));
        }
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!(
                "Residuals in units of {sd} against speed for {} responses; {} flagged.",
                self.responses.len(),
                all().filter(|p| p.outlier).count()
            ),
            x: Axis::linear("drum speed, rpm", x_range),
            y: Axis::linear(&format!("(measured − model) / {sd}"), y_range),
            height: 260.0,
            legend,
            right: 0.0,
        });
        frame.clip();
        frame.band(&[(x_range.0, -limit, limit), (x_range.1, -limit, limit)], Paint::Neutral, 0.25);
        frame.horizontal(0.0, Stroke::new(Paint::Muted, 1.2));
        for (i, response) in self.responses.iter().enumerate() {
            let line = response.points.iter().map(|p| (p.omega_rpm, p.residual_sd));
            frame.polyline(line, stroke(i));
        }
        for (i, response) in self.responses.iter().enumerate() {
            for p in &response.points {
                let (x, y, marker) = (p.omega_rpm, p.residual_sd, Marker::of_series(i));
                frame.marker(x, y, marker, 3.4, Paint::Series(i), true);
            }
        }
        for p in all().filter(|p| p.outlier && drawable(p.residual_sd)) {
            if let Some((x, y)) = frame.at(p.omega_rpm, p.residual_sd) {
                frame.canvas.ring(x, y, 7.0, Stroke::new(Paint::Alarm, 1.8));
                frame.occupy(x, y, 5.5, 5.5);
            }
        }
        for p in all().filter(|p| p.outlier) {
            let text = fixed(p.omega_rpm, if p.omega_rpm.fract() == 0.0 { 0 } else { 1 });
            frame.label(p.omega_rpm, p.residual_sd, &text, Paint::Alarm);
        }
        frame.unclip();
        frame.finish()
    }
}

fn stroke(i: usize) -> Stroke {
    let dash = if i == 0 { Dash::Solid } else { Dash::of_series(i) };
    Stroke::new(Paint::Series(i), 1.4).dashed(dash)
}
