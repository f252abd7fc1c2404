//! Summary of fit: R2, Q2, validity and reproducibility of every response.

use crate::Picture;
use crate::number::fixed;
use crate::svg::frame::{draw_title, no_data, title_lines};
use crate::svg::legend::lay_out;
use crate::svg::{Anchor, Canvas, Dash, FontSize, Key, LegendEntry, Paint, Stroke, WIDTH};

/// Quality of one response's surrogate; what is undefined (validity without replicates) is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitQuality {
    /// Response.
    pub response: String,
    /// Share of the variation explained.
    pub r2: Option<f64>,
    /// Share of the variation predicted (PRESS).
    pub q2: Option<f64>,
    /// Model validity, 0.25 at a lack-of-fit probability of 0.05.
    pub validity: Option<f64>,
    /// Reproducibility.
    pub reproducibility: Option<f64>,
}

/// Bars of the four qualities for each response, with the guide value of each as a tick.
///
/// Guides: Q2 above 0.5, validity above 0.25, reproducibility above 0.5. That R2 should exceed Q2 by
/// less than 0.3 is left to the eye: their bars stand above each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitSummary {
    /// Title.
    pub title: String,
    /// Responses.
    pub rows: Vec<FitQuality>,
}

const ROW: f64 = 15.0;
const GAP: f64 = 13.0;
const BAR: f64 = 11.0;

impl Picture for FitSummary {
    fn svg(&self) -> String {
        if self.rows.is_empty() {
            return no_data(&self.title, "no response was fitted");
        }
        let lines = title_lines(&self.title).len() as f64;
        let top = 8.0 + 17.0 * lines + 14.0;
        let group = 4.0 * ROW + GAP;
        let name_width = self
            .rows
            .iter()
            .map(|r| crate::svg::text::width(&r.response, 1.1 * FontSize::Tick.px()))
            .fold(0.0, f64::max)
            .min(110.0);
        let measure_width = crate::svg::text::width("reproducibility", FontSize::Small.px());
        let left = 10.0 + name_width + 10.0 + measure_width + 8.0;
        let right = WIDTH - 52.0;
        let bottom = top + group * self.rows.len() as f64;
        let guide = Stroke::new(Paint::Ink, 1.8);
        let legend = lay_out(
            &[LegendEntry::new(Key::Line(guide), "upright mark: guide value (at least)")],
            WIDTH - 24.0,
        );
        let height = bottom + 22.0 + legend.height + 8.0;
        let description: Vec<String> = self
            .rows
            .iter()
            .map(|r| {
                let parts: Vec<String> = measures(r)
                    .iter()
                    .map(|(name, value, _)| {
                        let value = value.map_or_else(|| "undefined".into(), |v| fixed(v, 3));
                        format!("{name} {value}")
                    })
                    .collect();
                format!("{}: {}", r.response, parts.join(", "))
            })
            .collect();
        let mut canvas = Canvas::new(WIDTH, height, &self.title, &description.join(". "));
        draw_title(&mut canvas, &self.title);
        let px = |v: f64| left + v.clamp(0.0, 1.0) * (right - left);
        for (tick, label) in [(0.0, "0"), (0.25, "0.25"), (0.5, "0.5"), (0.75, "0.75"), (1.0, "1")]
        {
            let x = px(tick);
            canvas.line(x, top - 4.0, x, bottom, Stroke::new(Paint::Grid, 0.8));
            canvas.text(x, bottom + 14.0, label, FontSize::Tick, Anchor::Middle, Paint::Ink);
        }
        for (i, row) in self.rows.iter().enumerate() {
            let y0 = top + group * i as f64;
            if i > 0 {
                let y = y0 - 0.5 * GAP;
                canvas.line(
                    8.0,
                    y,
                    WIDTH - 8.0,
                    y,
                    Stroke::new(Paint::Grid, 1.0).dashed(Dash::Dot),
                );
            }
            let name = crate::svg::text::shorten(&row.response, 1.1 * FontSize::Tick.px(), 110.0);
            let middle = y0 + 2.0 * ROW + 2.0;
            canvas.strong(10.0, middle, &name, FontSize::Tick, Anchor::Start, Paint::Ink);
            for (k, (name, value, at_least)) in measures(row).into_iter().enumerate() {
                let y = y0 + ROW * k as f64;
                let baseline = y + BAR - 1.5;
                canvas.text(left - 6.0, baseline, name, FontSize::Small, Anchor::End, Paint::Ink);
                let Some(value) = value.filter(|v| v.is_finite()) else {
                    let size = FontSize::Small;
                    canvas.text(
                        left + 4.0,
                        baseline,
                        "undefined",
                        size,
                        Anchor::Start,
                        Paint::Muted,
                    );
                    continue;
                };
                canvas.rect(left, y, px(value) - left, BAR, Paint::Series(k), 0.85);
                let mut end = px(value);
                if let Some(at_least) = at_least {
                    let x = px(at_least);
                    canvas.line(x, y - 1.0, x, y + BAR + 1.0, guide);
                    if (end - 3.0..end + 40.0).contains(&x) {
                        end = x;
                    }
                }
                let text = fixed(value, 3);
                let low = at_least.is_some_and(|g| value < g);
                let paint = if low { Paint::Alarm } else { Paint::Ink };
                let size = FontSize::Small;
                canvas.halo_text(end + 5.0, baseline, &text, size, Anchor::Start, paint, false);
            }
        }
        canvas.line(left, top - 4.0, left, bottom, Stroke::new(Paint::Muted, 1.2));
        legend.draw(&mut canvas, 12.0, bottom + 20.0);
        canvas.finish()
    }
}

fn measures(row: &FitQuality) -> [(&'static str, Option<f64>, Option<f64>); 4] {
    [
        ("R^{2}", row.r2, None),
        ("Q^{2}", row.q2, Some(0.5)),
        ("validity", row.validity, Some(0.25)),
        ("reproducibility", row.reproducibility, Some(0.5)),
    ]
}
