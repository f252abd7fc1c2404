//! The picture while it is made: linear colours in single precision.

use image::{Rgb, RgbImage};
use rayon::prelude::*;

/// Red, green and blue, 0 black to 1 the brightest grey level of the picture.
///
/// Grey levels are proportional to light: no gamma curve lies between them and the 8-bit picture.
pub type Color = [f32; 3];

/// A picture of colours, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Canvas {
    width: u32,
    height: u32,
    pixels: Vec<Color>,
}

impl Canvas {
    /// A picture of one colour.
    #[must_use]
    pub fn new(width: u32, height: u32, color: Color) -> Self {
        Self { width, height, pixels: vec![color; width as usize * height as usize] }
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, row by row.
    #[must_use]
    pub fn pixels(&self) -> &[Color] {
        &self.pixels
    }

    /// Calls `paint(row, pixels)` for every row, rows in parallel.
    pub fn for_rows(&mut self, paint: impl Fn(u32, &mut [Color]) + Sync) {
        self.pixels
            .par_chunks_mut(self.width as usize)
            .enumerate()
            .for_each(|(row, pixels)| paint(row as u32, pixels));
    }

    pub(crate) fn pixels_mut(&mut self) -> &mut [Color] {
        &mut self.pixels
    }

    /// Moves every pixel by a share of the way to another picture's: with shares 1/2, 1/3 .. a running mean that leaves
    /// equal pictures as they are, bit by bit.
    pub(crate) fn approach(&mut self, other: &Self, share: f32) {
        self.pixels.par_iter_mut().zip(&other.pixels).for_each(|(p, q)| *p = mixed(*p, *q, share));
    }

    /// Rounds to 8 bits a channel; values below 0 and above 1 saturate.
    #[must_use]
    pub fn to_image(&self) -> RgbImage {
        let mut image = RgbImage::new(self.width, self.height);
        for (p, q) in image.pixels_mut().zip(&self.pixels) {
            *p = Rgb(q.map(|v| (v * 255.0 + 0.5).clamp(0.0, 255.0) as u8));
        }
        image
    }
}

/// A colour times a factor.
pub(crate) fn scaled(color: Color, factor: f32) -> Color {
    color.map(|v| v * factor)
}

/// `a` towards `b` by a share from 0 to 1.
pub(crate) fn mixed(a: Color, b: Color, share: f32) -> Color {
    std::array::from_fn(|k| a[k] + share * (b[k] - a[k]))
}
