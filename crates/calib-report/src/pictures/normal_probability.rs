//! Deleted studentised residuals on normal-probability axes.

use statrs::distribution::{ContinuousCDF, Normal};

use crate::Picture;
use crate::number::{drawable, extent, fixed};
use crate::svg::frame::{Layout, no_data};
use crate::svg::scale::Tick;
use crate::svg::{Axis, Frame, Key, LegendEntry, Marker, Paint, Stroke};

/// A run's residual.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StudentisedResidual {
    /// Number or name of the run.
    pub run: String,
    /// Deleted studentised residual.
    pub residual: f64,
}

/// Normal probability against deleted studentised residual, with the line of a standard normal
/// distribution and limits beyond which a run is suspect.
///
/// The i-th of n sorted residuals stands at the probability (i - 0.375) / (n + 0.25) (Blom 1958).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NormalProbability {
    /// Title.
    pub title: String,
    /// Residuals of all runs; infinite ones (a run fitted exactly) stand beyond the limits.
    pub residuals: Vec<StudentisedResidual>,
    /// Limits on either side; 4 where none is given.
    pub limit: Option<f64>,
}

impl Picture for NormalProbability {
    fn svg(&self) -> String {
        let mut sorted: Vec<&StudentisedResidual> =
            self.residuals.iter().filter(|r| drawable(r.residual)).collect();
        sorted.sort_by(|a, b| a.residual.total_cmp(&b.residual).then_with(|| a.run.cmp(&b.run)));
        let Some((lo, hi)) = extent(sorted.iter().map(|r| r.residual)) else {
            return no_data(&self.title, "no finite residual");
        };
        let limit = self.limit.filter(|l| l.is_finite() && *l > 0.0).unwrap_or(4.0);
        let reach = 1.12 * lo.abs().max(hi.abs()).max(limit);
        let n = sorted.len() as f64;
        let normal = Normal::standard();
        let score = |p: f64| normal.inverse_cdf(p);
        let highest = score((n - 0.375) / (n + 0.25)).max(1.3) + 0.25;
        let ticks = [0.001, 0.01, 0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.95, 0.99, 0.999]
            .into_iter()
            .map(|p: f64| Tick {
                at: score(p),
                label: fixed(100.0 * p, usize::from(!(0.0095..0.9905).contains(&p))),
            })
            .filter(|t| t.at.abs() < highest)
            .collect();
        let mut legend = vec![
            LegendEntry::new(Key::Line(Stroke::new(Paint::Muted, 1.2)), "standard normal"),
            LegendEntry::new(
                Key::Line(Frame::limit_stroke()),
                format!("limits ±{}", fixed(limit, 0)),
            ),
        ];
        let left_out = self.residuals.len() - sorted.len();
        if left_out > 0 {
            let text = format!("{left_out} without a finite residual left out");
            legend.push(LegendEntry::new(Key::None, text));
        }
        let beyond = sorted.iter().filter(|r| r.residual.abs() > limit).count();
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!("{} residuals, {beyond} beyond the limits.", sorted.len()),
            x: Axis::linear("deleted studentised residual", (-reach, reach)),
            y: Axis {
                ticks: Some(ticks),
                ..Axis::linear("normal probability, %", (-highest, highest))
            },
            height: 250.0,
            legend,
            right: 0.0,
        });
        frame.clip();
        frame.polyline([(-highest, -highest), (highest, highest)], Stroke::new(Paint::Muted, 1.2));
        frame.unclip();
        frame.vertical(-limit, Frame::limit_stroke());
        frame.vertical(limit, Frame::limit_stroke());
        let placed: Vec<(f64, f64, &str)> = sorted
            .iter()
            .enumerate()
            .map(|(i, r)| (r.residual, score((i as f64 + 0.625) / (n + 0.25)), r.run.as_str()))
            .collect();
        for (x, y, _) in &placed {
            let out = x.abs() > limit;
            let paint = if out { Paint::Alarm } else { Paint::Series(0) };
            let marker = if out { Marker::Diamond } else { Marker::Circle };
            frame.marker(*x, *y, marker, 3.4, paint, true);
            if let Some((px, py)) = frame.at(*x, *y) {
                frame.occupy(px, py, 4.0, 4.0);
            }
        }
        // The suspects are named, and else the two at each end, by which one sees where the runs lie.
        for (k, (x, y, run)) in placed.iter().enumerate() {
            if x.abs() > limit || k < 2 || k + 2 >= placed.len() {
                frame.label(*x, *y, run, Paint::Ink);
            }
        }
        frame.finish()
    }
}
