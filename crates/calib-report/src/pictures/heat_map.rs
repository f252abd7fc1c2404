//! Heat map, as of a confusion matrix or correlations.

use crate::Picture;
use crate::number::{drawable, extent, fixed};
use crate::svg::frame::{draw_title, no_data, title_lines};
use crate::svg::text::{shorten, width, wrap};
use crate::svg::{Anchor, Canvas, FontSize, Paint, Stroke, WIDTH};

/// How values become shades.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shading {
    /// From zero (or the least value, if negative) to the largest, in one hue.
    #[default]
    Sequential,
    /// Two hues for the two signs, white at zero: correlations, effects.
    Diverging,
}

/// A matrix of numbers as shaded cells with the numbers written in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeatMap {
    /// Title.
    pub title: String,
    /// What the rows are, as "true effect".
    pub row_label: String,
    /// What the columns are, as "effect named".
    pub column_label: String,
    /// Names of the rows, from the top.
    pub rows: Vec<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Values row by row; a value that is not finite leaves an empty cell.
    pub values: Vec<f64>,
    /// Decimals of the numbers.
    pub decimals: usize,
    /// Shading.
    pub shading: Shading,
}

const NAME: f64 = 120.0;

impl Picture for HeatMap {
    fn svg(&self) -> String {
        let (rows, columns) = (self.rows.len(), self.columns.len());
        let Some((lo, hi)) = extent(self.values.iter().copied()) else {
            return no_data(&self.title, "no finite value");
        };
        if rows * columns == 0 || self.values.len() != rows * columns {
            return no_data(&self.title, "the values do not fill the matrix");
        }
        let small = FontSize::Small.px();
        let widest =
            |names: &[String]| names.iter().map(|n| width(n, small)).fold(0.0, f64::max).min(NAME);
        let row_lines = wrap(&self.row_label, FontSize::Label.px(), 200.0);
        let left = 10.0 + 17.0 * row_lines.len() as f64 + widest(&self.rows) + 8.0;
        let right = WIDTH - 12.0;
        let cell_width = (right - left) / columns as f64;
        let cell_height = cell_width.clamp(20.0, 36.0);
        let slanted = widest(&self.columns) > cell_width - 4.0;
        let head = if slanted { 0.66 * widest(&self.columns) + 16.0 } else { 18.0 };
        let top = 8.0 + 17.0 * title_lines(&self.title).len() as f64 + 10.0;
        let bottom = top + cell_height * rows as f64;
        let height = bottom + head + 26.0;
        let mut canvas = Canvas::new(
            WIDTH,
            height,
            &self.title,
            &format!("{rows} by {columns} cells, from {} to {}.", fixed(lo, 3), fixed(hi, 3)),
        );
        draw_title(&mut canvas, &self.title);
        for (k, value) in self.values.iter().enumerate() {
            let (row, column) = (k / columns, k % columns);
            let x = left + cell_width * column as f64;
            let y = top + cell_height * row as f64;
            if drawable(*value) {
                let (paint, opacity) = self.shade(*value, lo, hi);
                canvas.rect(x, y, cell_width, cell_height, paint, opacity);
                let text = fixed(*value, self.decimals);
                if width(&text, small) <= cell_width - 2.0 {
                    let (x, y) = (x + 0.5 * cell_width, y + 0.5 * cell_height + 4.0);
                    canvas.text(x, y, &text, FontSize::Small, Anchor::Middle, Paint::Ink);
                }
            }
            canvas.outline(x, y, cell_width, cell_height, Stroke::new(Paint::Grid, 0.8));
        }
        for (i, name) in self.rows.iter().enumerate() {
            let y = top + cell_height * (i as f64 + 0.5) + 4.0;
            let name = shorten(name, small, NAME);
            canvas.text(left - 6.0, y, &name, FontSize::Small, Anchor::End, Paint::Ink);
        }
        for (i, name) in self.columns.iter().enumerate() {
            let x = left + cell_width * (i as f64 + 0.5);
            let name = shorten(name, small, NAME);
            if slanted {
                canvas.slanted_text(x + 4.0, bottom + 12.0, &name, FontSize::Small);
            } else {
                canvas.text(x, bottom + 14.0, &name, FontSize::Small, Anchor::Middle, Paint::Ink);
            }
        }
        let middle = 0.5 * (top + bottom);
        for (i, line) in row_lines.iter().enumerate() {
            canvas.upright_text(19.0 + 17.0 * i as f64, middle, line, FontSize::Label);
        }
        let x = 0.5 * (left + right);
        let label = shorten(&self.column_label, FontSize::Label.px(), right - left);
        canvas.text(x, bottom + head + 14.0, &label, FontSize::Label, Anchor::Middle, Paint::Ink);
        canvas.finish()
    }
}

impl HeatMap {
    /// Hue and opacity of a value; opacity stays low enough for dark text to be read.
    fn shade(&self, value: f64, lo: f64, hi: f64) -> (Paint, f64) {
        let strongest = 0.62;
        match self.shading {
            Shading::Sequential => {
                let base = lo.min(0.0);
                let span = hi - base;
                let t = if span > 0.0 { (value - base) / span } else { 0.0 };
                (Paint::Series(0), strongest * t)
            }
            Shading::Diverging => {
                let span = lo.abs().max(hi.abs());
                let t = if span > 0.0 { value.abs() / span } else { 0.0 };
                (Paint::Series(usize::from(value < 0.0)), strongest * t)
            }
        }
    }
}
