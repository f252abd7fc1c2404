//! Friction against speed: the estimate with its interval beside a printed range.

use crate::Picture;
use crate::number::{extent, padded};
use crate::svg::frame::{Layout, no_data};
use crate::svg::{Axis, Dash, Frame, Key, LegendEntry, Marker, Paint, Stroke};

/// An estimate at one speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionAtSpeed {
    /// Speed of the drum, rpm.
    pub omega_rpm: f64,
    /// Best value, if there is one.
    pub value: Option<f64>,
    /// Lower end of the interval; none where the data do not bound it.
    pub lo: Option<f64>,
    /// Upper end of the interval; none where the data do not bound it.
    pub hi: Option<f64>,
}

/// A range printed by others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrintedRange {
    /// Speed of the drum, rpm.
    pub omega_rpm: f64,
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

/// Friction estimated speed by speed, and jointly over all of them, beside printed ranges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrictionSpeed {
    /// Title, with the case.
    pub title: String,
    /// Label of the friction axis; "friction coefficient μ_{pp}" where empty.
    pub friction_label: String,
    /// Estimates, one a speed.
    pub estimates: Vec<FrictionAtSpeed>,
    /// The estimate over all speeds together; its speed is not used.
    pub joint: Option<FrictionAtSpeed>,
    /// Printed ranges.
    pub printed: Vec<PrintedRange>,
    /// Range of friction in which the surrogate was built; the axis shows all of it where an
    /// interval is open.
    pub range: Option<(f64, f64)>,
    /// Level of the intervals, as "95 %".
    pub level: String,
}

impl Picture for FrictionSpeed {
    fn svg(&self) -> String {
        let speeds = self.estimates.iter().map(|e| e.omega_rpm);
        let speeds = speeds.chain(self.printed.iter().map(|p| p.omega_rpm));
        let Some(x_range) = extent(speeds) else {
            return no_data(&self.title, "no friction was estimated at any speed");
        };
        let joint = self.joint.unwrap_or_default();
        let ends = |e: &FrictionAtSpeed| [e.value, e.lo, e.hi];
        let values = self.estimates.iter().flat_map(ends).chain(ends(&joint)).flatten();
        let values = values.chain(self.printed.iter().flat_map(|p| [p.lo, p.hi]));
        // An open interval runs to the edge of what was looked at; else the axis shows the data.
        let open =
            self.estimates.iter().chain(&self.joint).any(|e| e.lo.is_none() || e.hi.is_none());
        let looked_at = self.range.iter().filter(|_| open).flat_map(|r| [r.0, r.1]);
        let values = values.chain(looked_at);
        let Some(y_range) = extent(values) else {
            return no_data(&self.title, "no finite friction");
        };
        let label = match self.friction_label.as_str() {
            "" => "friction coefficient μ_{pp}",
            label => label,
        };
        let level = if self.level.is_empty() { String::new() } else { format!("{} ", self.level) };
        let ours = Stroke::new(Paint::Series(0), 1.8);
        let joint_stroke = Stroke::new(Paint::SeriesText(0), 1.6).dashed(Dash::Long);
        let mut legend = Vec::new();
        if !self.estimates.is_empty() {
            let text = format!("this work, each speed ({level}interval; arrow: unbounded)");
            legend.push(LegendEntry::new(Key::LinePoint(ours, Marker::Circle), text));
        }
        if joint.value.is_some() {
            let text = format!("all speeds together ({level}interval)");
            legend.push(LegendEntry::new(
                Key::OutlinedArea(Paint::Series(0), 0.16, joint_stroke),
                text,
            ));
        }
        if !self.printed.is_empty() {
            legend.push(LegendEntry::new(Key::Area(Paint::Neutral, 0.6), "printed range"));
        }
        let y_range = padded(y_range, 0.12);
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!(
                "Friction estimated at {} speeds with intervals, and {} printed ranges.",
                self.estimates.len(),
                self.printed.len()
            ),
            x: Axis::linear("drum speed, rpm", padded(x_range, 0.08)),
            y: Axis::linear(label, y_range),
            height: 250.0,
            legend,
            right: 0.0,
        });
        frame.clip();
        if joint.value.is_some() {
            let (left, right) = padded(x_range, 0.08);
            let (lo, hi) = (joint.lo.unwrap_or(y_range.0), joint.hi.unwrap_or(y_range.1));
            frame.band(&[(left, lo, hi), (right, lo, hi)], Paint::Series(0), 0.16);
        }
        if let Some(value) = joint.value {
            frame.horizontal(value, joint_stroke);
        }
        for printed in &self.printed {
            if let (Some((x, lo)), Some((_, hi))) =
                (frame.at(printed.omega_rpm, printed.lo), frame.at(printed.omega_rpm, printed.hi))
            {
                frame.canvas.rect(x - 6.0, hi, 12.0, lo - hi, Paint::Neutral, 0.6);
            }
        }
        for estimate in &self.estimates {
            if estimate.value.is_none() && estimate.lo.is_none() && estimate.hi.is_none() {
                continue;
            }
            frame.interval(estimate.omega_rpm, estimate.lo, estimate.hi, ours);
            if let Some(value) = estimate.value {
                frame.marker(
                    estimate.omega_rpm,
                    value,
                    Marker::Circle,
                    4.0,
                    Paint::Series(0),
                    true,
                );
            }
        }
        frame.unclip();
        frame.finish()
    }
}
