//! Grouped bars.

use crate::Picture;
use crate::number::{extent, fixed, padded};
use crate::svg::frame::{Layout, no_data};
use crate::svg::{Anchor, Axis, FontSize, Frame, Key, LegendEntry, Paint, Stroke};

/// A group of bars under one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BarGroup {
    /// Name under the group.
    pub name: String,
    /// Height of each bar, in the order of [`GroupedBars::series`]; none where undefined.
    pub values: Vec<Option<f64>>,
}

/// Bars of several series side by side, group by group, from zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroupedBars {
    /// Title.
    pub title: String,
    /// Label of the height with its unit.
    pub value_label: String,
    /// Names of the series, one a bar of each group.
    pub series: Vec<String>,
    /// Groups.
    pub groups: Vec<BarGroup>,
    /// Decimals of the number over each bar; no numbers where none.
    pub decimals: Option<usize>,
    /// A limit drawn across, with its name.
    pub limit: Option<(f64, String)>,
}

impl Picture for GroupedBars {
    fn svg(&self) -> String {
        let values = self.groups.iter().flat_map(|g| g.values.iter().flatten().copied());
        let Some((lo, hi)) = extent(values) else {
            return no_data(&self.title, "no finite value");
        };
        let limit = self.limit.as_ref().map_or(0.0, |l| if l.0.is_finite() { l.0 } else { 0.0 });
        let (lo, hi) = (lo.min(0.0).min(limit), hi.max(0.0).max(limit));
        let (below, above) = padded((lo, hi), 0.08);
        let range = (if lo < 0.0 { below } else { 0.0 }, if hi > 0.0 { above } else { 0.0 });
        let names: Vec<String> = self.groups.iter().map(|g| g.name.clone()).collect();
        let bars = self.groups.iter().map(|g| g.values.len()).max().unwrap_or(1).max(1);
        let mut legend: Vec<LegendEntry> = Vec::new();
        if bars > 1 {
            let key = |i| Key::Area(Paint::Series(i), 0.85);
            legend.extend(
                self.series.iter().enumerate().map(|(i, name)| LegendEntry::new(key(i), name)),
            );
        }
        if let Some((_, name)) = self.limit.as_ref().filter(|l| !l.1.is_empty()) {
            legend.push(LegendEntry::new(Key::Line(Frame::limit_stroke()), name));
        }
        let mut frame = Frame::new(&Layout {
            title: &self.title,
            description: format!("Bars of {} series in {} groups.", bars, self.groups.len()),
            x: Axis::names("", &names),
            y: Axis::linear(&self.value_label, range),
            height: 230.0,
            legend,
            right: 0.0,
        });
        let group_px = frame.x.px(1.0).zip(frame.x.px(0.0)).map_or(20.0, |(b, a)| b - a);
        let bar_px = (0.82 * group_px / bars as f64).min(46.0);
        let Some(zero) = frame.y.px(0.0) else { return frame.finish() };
        for (g, group) in self.groups.iter().enumerate() {
            let Some(middle) = frame.x.px(g as f64) else { continue };
            let first = middle - 0.5 * bar_px * bars as f64;
            for (i, value) in group.values.iter().enumerate() {
                let x = first + bar_px * i as f64;
                let centre = x + 0.5 * bar_px;
                let Some((value, y)) = value.and_then(|v| Some((v, frame.y.px(v)?))) else {
                    let size = FontSize::Small;
                    frame.canvas.text(centre, zero - 4.0, "–", size, Anchor::Middle, Paint::Muted);
                    continue;
                };
                let (top, height) = (y.min(zero), (y - zero).abs());
                frame.canvas.rect(x + 1.0, top, bar_px - 2.0, height, Paint::Series(i), 0.85);
                if let Some(decimals) = self.decimals {
                    let text = fixed(value, decimals);
                    if crate::svg::text::width(&text, FontSize::Small.px()) <= bar_px + 6.0 {
                        let at = if value < 0.0 { y + 11.0 } else { y - 3.0 };
                        let size = FontSize::Small;
                        frame.canvas.text(centre, at, &text, size, Anchor::Middle, Paint::Ink);
                    }
                }
            }
        }
        frame.horizontal(0.0, Stroke::new(Paint::Ink, 1.2));
        if let Some((value, _)) = &self.limit {
            frame.horizontal(*value, Frame::limit_stroke());
        }
        frame.finish()
    }
}
