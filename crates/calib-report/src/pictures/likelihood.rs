//! Profile likelihood and posterior density of a parameter.

use crate::Picture;
use crate::number::{extent, fixed, padded};
use crate::svg::frame::{Layout, no_data};
use crate::svg::{Axis, Dash, Frame, Key, LegendEntry, Marker, Paint, Stroke};

/// The profile of chi-square over one parameter, all others refitted, and the interval it cuts off.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileLikelihood {
    /// Title.
    pub title: String,
    /// Parameter with its unit.
    pub parameter: String,
    /// Points (parameter, chi-square above its minimum) in order of the parameter.
    pub points: Vec<(f64, f64)>,
    /// Best value.
    pub best: Option<f64>,
    /// Rise at which the interval ends, as 3.84 for 95 %.
    pub threshold: f64,
    /// Ends of the interval; none where the profile stays below the threshold.
    pub interval: (Option<f64>, Option<f64>),
    /// Level of the interval, as "95 %".
    pub level: String,
}

impl Picture for ProfileLikelihood {
    fn svg(&self) -> String {
        let (Some(x_range), Some((_, highest))) =
            (extent(self.points.iter().map(|p| p.0)), extent(self.points.iter().map(|p| p.1)))
        else {
            return no_data(&self.title, "no finite profile");
        };
        let threshold =
            if self.threshold > 0.0 && self.threshold < 1e6 { self.threshold } else { 3.84 };
        // Far from the best value the profile is steep; what matters is near the threshold.
        let top = highest.min(3.0 * threshold).max(1.3 * threshold);
        let (lo, hi) = self.interval;
        let x_range = focused(x_range, self.points.iter().filter(|p| p.1 <= top).map(|p| p.0));
        let stroke = Stroke::new(Paint::Series(0), 2.0);
        let text = match (lo, hi) {
            (Some(lo), Some(hi)) => format!("{} to {}", fixed(lo, 3), fixed(hi, 3)),
            (Some(lo), None) => format!("above {}", fixed(lo, 3)),
            (None, Some(hi)) => format!("below {}", fixed(hi, 3)),
            (None, None) => "not bounded: the profile is flat".into(),
        };
        let level = if self.level.is_empty() {
            "interval".into()
        } else {
            format!("{} interval", self.level)
        };
        let legend = vec![
            LegendEntry::new(Key::Line(stroke), "profile"),
            LegendEntry::new(
                Key::Line(Frame::limit_stroke()),
                format!("rise of {}", fixed(threshold, 2)),
            ),
            LegendEntry::new(Key::Area(Paint::Series(0), 0.18), format!("{level}: {text}")),
        ];
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!("Profile of chi-square over {}; {level} {text}.", self.parameter),
            x: Axis::linear(&self.parameter, padded(x_range, 0.0)),
            y: Axis::linear("rise of χ^{2}", (-0.04 * top, top)),
            height: 210.0,
            legend,
            right: 0.0,
        });
        frame.clip();
        if lo.is_some() || hi.is_some() {
            let (a, b) = (lo.unwrap_or(x_range.0), hi.unwrap_or(x_range.1));
            frame.band(&[(a, -top, top), (b, -top, top)], Paint::Series(0), 0.18);
        }
        frame.horizontal(threshold, Frame::limit_stroke());
        frame.polyline(self.points.iter().copied(), stroke);
        frame.unclip();
        if let Some(best) = self.best.filter(|b| frame.x.contains(*b)) {
            frame.marker(best, 0.0, Marker::Circle, 4.0, Paint::Series(0), true);
        }
        frame.finish()
    }
}

/// The posterior density of one parameter with its credible interval.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PosteriorDensity {
    /// Title.
    pub title: String,
    /// Parameter with its unit.
    pub parameter: String,
    /// Points (parameter, density) in order of the parameter.
    pub points: Vec<(f64, f64)>,
    /// Prior density at the same parameters, to see what was learnt; may be empty.
    pub prior: Vec<(f64, f64)>,
    /// Posterior mean or mode, with what it is named in `centre_label`.
    pub centre: Option<f64>,
    /// "mean", "mode" or "median"; "mean" where empty.
    pub centre_label: String,
    /// Credible interval.
    pub interval: Option<(f64, f64)>,
    /// Level of the interval, as "95 %".
    pub level: String,
}

impl Picture for PosteriorDensity {
    fn svg(&self) -> String {
        let all = || self.points.iter().chain(&self.prior);
        let (Some(x_range), Some((_, highest))) =
            (extent(all().map(|p| p.0)), extent(all().map(|p| p.1)))
        else {
            return no_data(&self.title, "no finite density");
        };
        let top = if highest > 0.0 { 1.08 * highest } else { 1.0 };
        let seen = self.points.iter().filter(|p| p.1 > 1e-3 * highest).map(|p| p.0);
        let x_range = focused(x_range, seen);
        let stroke = Stroke::new(Paint::Series(0), 2.0);
        let prior = Stroke::new(Paint::Muted, 1.4).dashed(Dash::Long);
        let mut legend = vec![LegendEntry::new(Key::Line(stroke), "posterior")];
        if self.prior.len() > 1 {
            legend.push(LegendEntry::new(Key::Line(prior), "prior"));
        }
        if let Some(centre) = self.centre {
            let name = if self.centre_label.is_empty() { "mean" } else { &self.centre_label };
            let mark = Stroke::new(Paint::Ink, 1.6);
            legend.push(LegendEntry::new(Key::Line(mark), format!("{name} {}", fixed(centre, 3))));
        }
        if let Some((lo, hi)) = self.interval {
            let text = format!("{} interval: {} to {}", self.level, fixed(lo, 3), fixed(hi, 3));
            legend.push(LegendEntry::new(Key::Area(Paint::Series(0), 0.3), text.trim()));
        }
        let texts: Vec<&str> = legend.iter().map(|e| e.text.as_str()).collect();
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!("Density over {}: {}.", self.parameter, texts.join(", ")),
            x: Axis::linear(&self.parameter, padded(x_range, 0.0)),
            y: Axis::linear("posterior density", (0.0, top)),
            height: 210.0,
            legend: legend.clone(),
            right: 0.0,
        });
        frame.clip();
        if let Some((lo, hi)) = self.interval {
            let inside: Vec<(f64, f64, f64)> = clipped(&self.points, lo, hi)
                .into_iter()
                .map(|(x, density)| (x, 0.0, density))
                .collect();
            frame.band(&inside, Paint::Series(0), 0.3);
        }
        frame.polyline(self.prior.iter().copied(), prior);
        frame.polyline(self.points.iter().copied(), stroke);
        if let Some(centre) = self.centre {
            frame.vertical(centre, Stroke::new(Paint::Ink, 1.6));
        }
        frame.unclip();
        frame.finish()
    }
}

/// The part of a curve between two abscissae, cut by linear interpolation.
fn clipped(points: &[(f64, f64)], lo: f64, hi: f64) -> Vec<(f64, f64)> {
    let at = |x: f64| {
        points.windows(2).find_map(|w| {
            let ((x1, y1), (x2, y2)) = (w[0], w[1]);
            (x1 <= x && x <= x2 && x2 > x1).then(|| (x, y1 + (x - x1) / (x2 - x1) * (y2 - y1)))
        })
    };
    let inner = points.iter().copied().filter(|p| p.0 > lo && p.0 < hi);
    at(lo).into_iter().chain(inner).chain(at(hi)).collect()
}

/// The range of what is to be seen, with room around it, where that is less than half of all.
fn focused(all: (f64, f64), seen: impl Iterator<Item = f64>) -> (f64, f64) {
    let Some(range) = extent(seen) else { return all };
    let narrow = padded(range, 0.25);
    let narrow = (narrow.0.max(all.0), narrow.1.min(all.1));
    let close = narrow.1 > narrow.0 && narrow.1 - narrow.0 < 0.5 * (all.1 - all.0);
    if close { narrow } else { all }
}
