//! Pictures for the eye: what was found, drawn over the frame, and a contact sheet of a series.

use std::path::Path;

use crate::error::VisionError;
use crate::frame::Frame;
use crate::measure::FrameMeasurement;

/// Colours of the overlay: circle, surface, line over all, line over the middle, centre of area.
pub const COLORS: [[u8; 3]; 5] =
    [[255, 210, 0], [0, 255, 120], [80, 170, 255], [255, 90, 220], [255, 60, 40]];

/// Draws circle, surface, both lines and the centre of area over the frame.
///
/// The line over all columns is blue, the one over the middle magenta, each across its own columns.
#[must_use]
pub fn overlay(frame: &Frame, found: &FrameMeasurement) -> Frame {
    let mut canvas = Canvas::of(frame);
    let c = found.drum.fit.circle;
    let thick = (c.radius_px / 250.0).max(0.75);
    let n = (c.radius_px * 4.0) as usize + 16;
    let rim = (0..=n).map(|k| {
        let (s, q) = (std::f64::consts::TAU * k as f64 / n as f64).sin_cos();
        (c.x_px + c.radius_px * q, c.y_px + c.radius_px * s)
    });
    canvas.polyline(rim, thick, COLORS[0]);
    let place = |(x, y): (f64, f64)| (c.x_px + x, c.y_px - y);
    canvas.polyline(found.surface.points.iter().map(|&p| place(p)), thick, COLORS[1]);
    let sign = found.raised.sign();
    let (first, last) = found.surface.range();
    let span = last - first;
    for (angle_deg, share, color) in [
        (found.responses.aor_lin_deg, 0.0, COLORS[2]),
        (found.responses.aor_mid_deg, 0.25, COLORS[3]),
    ] {
        let (a, b) = (first + share * span, last - share * span);
        let slope = sign * angle_deg.to_radians().tan();
        let (mut mean, m) = (0.0, 200);
        for k in 0..m {
            mean += found.surface.height(a + (b - a) * (f64::from(k) + 0.5) / f64::from(m));
        }
        mean /= f64::from(m);
        let half = 0.5 * (b - a);
        let mid = 0.5 * (a + b);
        let ends = [(a, mean - slope * half), (b, mean + slope * half)];
        canvas.polyline(ends.map(|p| place((p.0.min(mid + half), p.1))).into_iter(), thick, color);
    }
    let (x, y) = place((
        sign * found.responses.cen_x_pct / 100.0 * c.radius_px,
        -found.responses.cen_y_pct / 100.0 * c.radius_px,
    ));
    let arm = 0.05 * c.radius_px;
    canvas.polyline([(x - arm, y), (x + arm, y)].into_iter(), thick, COLORS[4]);
    canvas.polyline([(x, y - arm), (x, y + arm)].into_iter(), thick, COLORS[4]);
    canvas.polyline(
        [(c.x_px - 0.5 * arm, c.y_px), (c.x_px + 0.5 * arm, c.y_px)].into_iter(),
        thick,
        COLORS[0],
    );
    canvas.polyline(
        [(c.x_px, c.y_px - 0.5 * arm), (c.x_px, c.y_px + 0.5 * arm)].into_iter(),
        thick,
        COLORS[0],
    );
    canvas.into_frame()
}

/// One tile of a contact sheet.
#[derive(Clone, Debug)]
pub struct Tile {
    /// The picture, already small.
    pub picture: Frame,
    /// Whether the frame was rejected: its tile gets a red border and a cross.
    pub rejected: bool,
    /// Whether it is an outlier of its series: its tile gets an orange border.
    pub outlier: bool,
}

impl Tile {
    /// Shrinks a picture to at most `side` pixels by averaging blocks.
    #[must_use]
    pub fn new(picture: &Frame, side: usize, rejected: bool, outlier: bool) -> Self {
        Self { picture: shrink(picture, side), rejected, outlier }
    }
}

/// Lays tiles out in rows of `columns`, in order; an empty list gives one grey tile.
#[must_use]
pub fn contact_sheet(tiles: &[Tile], columns: usize) -> Frame {
    let columns = columns.clamp(1, tiles.len().max(1));
    let border = 4;
    let w = tiles.iter().map(|t| t.picture.width()).max().unwrap_or(64) + 2 * border;
    let h = tiles.iter().map(|t| t.picture.height()).max().unwrap_or(64) + 2 * border;
    let rows = tiles.len().div_ceil(columns).max(1);
    let (width, height) = (w * columns, h * rows);
    let mut canvas = Canvas { width, height, rgb: vec![40; 3 * width * height] };
    for (k, tile) in tiles.iter().enumerate() {
        let (x0, y0) = (k % columns * w, k / columns * h);
        let edge = if tile.rejected {
            Some([220, 30, 30])
        } else if tile.outlier {
            Some([255, 160, 0])
        } else {
            None
        };
        if let Some(color) = edge {
            for y in y0..y0 + h {
                for x in x0..x0 + w {
                    canvas.blend(x as i64, y as i64, 1.0, color);
                }
            }
        }
        let (pw, ph) = (tile.picture.width(), tile.picture.height());
        for y in 0..ph {
            let from = 3 * y * pw;
            let to = 3 * ((y0 + border + y) * width + x0 + border);
            canvas.rgb[to..to + 3 * pw].copy_from_slice(&tile.picture.rgb()[from..from + 3 * pw]);
        }
        if tile.rejected {
            let (l, t) = ((x0 + border) as f64, (y0 + border) as f64);
            let (r, b) = (l + pw as f64, t + ph as f64);
            canvas.polyline([(l, t), (r, b)].into_iter(), 1.0, [220, 30, 30]);
            canvas.polyline([(l, b), (r, t)].into_iter(), 1.0, [220, 30, 30]);
        }
    }
    canvas.into_frame()
}

/// Writes a picture as PNG.
///
/// # Errors
/// [`VisionError::Write`].
pub fn write_png(picture: &Frame, path: &Path) -> Result<(), VisionError> {
    image::save_buffer_with_format(
        path,
        picture.rgb(),
        picture.width() as u32,
        picture.height() as u32,
        image::ExtendedColorType::Rgb8,
        image::ImageFormat::Png,
    )
    .map_err(|source| VisionError::Write { path: path.to_path_buf(), source })
}

/// Averages blocks of pixels so that the longer side has at most `side` pixels.
fn shrink(picture: &Frame, side: usize) -> Frame {
    let k = picture.width().max(picture.height()).div_ceil(side.max(1)).max(1);
    let (w, h) = ((picture.width() / k).max(1), (picture.height() / k).max(1));
    let mut rgb = Vec::with_capacity(3 * w * h);
    for y in 0..h {
        for x in 0..w {
            let mut sum = [0u32; 3];
            let mut n = 0u32;
            for yy in y * k..((y + 1) * k).min(picture.height()) {
                for xx in x * k..((x + 1) * k).min(picture.width()) {
                    if let Some(p) = picture.pixel(xx, yy) {
                        for c in 0..3 {
                            sum[c] += u32::from(p[c]);
                        }
                        n += 1;
                    }
                }
            }
            rgb.extend(sum.map(|s| (s / n.max(1)) as u8));
        }
    }
    Frame::from_rgb(w, h, rgb).expect("three samples were pushed for every pixel")
}

struct Canvas {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Canvas {
    fn of(frame: &Frame) -> Self {
        Self { width: frame.width(), height: frame.height(), rgb: frame.rgb().to_vec() }
    }

    fn into_frame(self) -> Frame {
        Frame::from_rgb(self.width, self.height, self.rgb).expect("the canvas keeps its size")
    }

    fn blend(&mut self, x: i64, y: i64, share: f64, color: [u8; 3]) {
        if x < 0 || y < 0 || x >= self.width as i64 || y >= self.height as i64 {
            return;
        }
        let k = 3 * (y as usize * self.width + x as usize);
        for (p, c) in self.rgb[k..k + 3].iter_mut().zip(color) {
            *p = (f64::from(*p) * (1.0 - share) + f64::from(c) * share).round() as u8;
        }
    }

    /// Strokes straight pieces of half-width `thick`, edges softened over a pixel.
    fn polyline(&mut self, points: impl Iterator<Item = (f64, f64)>, thick: f64, color: [u8; 3]) {
        let mut last: Option<(f64, f64)> = None;
        for p in points {
            if let Some(q) = last {
                self.segment(q, p, thick, color);
            }
            last = Some(p);
        }
    }

    fn segment(&mut self, a: (f64, f64), b: (f64, f64), thick: f64, color: [u8; 3]) {
        let reach = thick + 1.0;
        let bound = |v: f64, n: usize| v.clamp(-2.0, n as f64 + 2.0) as i64;
        let (x0, x1) =
            (bound(a.0.min(b.0) - reach, self.width), bound(a.0.max(b.0) + reach, self.width));
        let (y0, y1) =
            (bound(a.1.min(b.1) - reach, self.height), bound(a.1.max(b.1) + reach, self.height));
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let length2 = (dx * dx + dy * dy).max(1e-12);
        for y in y0..=y1 {
            for x in x0..=x1 {
                let (px, py) = (x as f64 - a.0, y as f64 - a.1);
                let t = ((px * dx + py * dy) / length2).clamp(0.0, 1.0);
                let d = (px - t * dx).hypot(py - t * dy);
                let share = (thick + 0.5 - d).clamp(0.0, 1.0);
                if share > 0.0 {
                    self.blend(x, y, share, color);
                }
            }
        }
    }
}
