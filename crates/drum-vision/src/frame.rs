//! Pixels in memory: a colour [`Frame`] and a single-channel [`Plane`].
//!
//! Coordinates run right (x) and down (y) in pixels, and **pixel centres lie at whole numbers**: a picture of
//! `width` columns reaches from -0.5 to `width - 0.5` (the convention of scikit-image, and of MATLAB
//! less one). Planes hold `f32`: samples come from 8-bit channels, which `f32` represents exactly; all
//! geometry is `f64`.

/// An 8-bit colour picture, rows from the top, three interleaved channels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Frame {
    /// Wraps `3 * width * height` interleaved samples; `None` when the length does not fit.
    #[must_use]
    pub fn from_rgb(width: usize, height: usize, rgb: Vec<u8>) -> Option<Self> {
        (rgb.len() == width.checked_mul(height)?.checked_mul(3)?).then_some(Self {
            width,
            height,
            rgb,
        })
    }

    /// Makes a colourless picture of `width * height` grey samples; `None` when the length does not fit.
    #[must_use]
    pub fn from_grey(width: usize, height: usize, grey: &[u8]) -> Option<Self> {
        (grey.len() == width.checked_mul(height)?).then(|| Self {
            width,
            height,
            rgb: grey.iter().flat_map(|&g| [g, g, g]).collect(),
        })
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The interleaved samples.
    #[must_use]
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Red, green and blue of one pixel; `None` outside of the picture.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> Option<[u8; 3]> {
        if x >= self.width || y >= self.height {
            return None;
        }
        let k = 3 * (y * self.width + x);
        Some([self.rgb[k], self.rgb[k + 1], self.rgb[k + 2]])
    }

    /// Luma of a window, `0.299 R + 0.587 G + 0.114 B` (ITU-R BT.601), not rounded.
    ///
    /// The window is clipped to the picture.
    #[must_use]
    pub fn grey(&self, window: Window) -> Plane {
        self.channel_mix(window, [0.299, 0.587, 0.114])
    }

    /// Redness of a window, `R - (G + B) / 2`: zero for every grey, linear in the mixing of colours.
    #[must_use]
    pub fn redness(&self, window: Window) -> Plane {
        self.channel_mix(window, [1.0, -0.5, -0.5])
    }

    fn channel_mix(&self, window: Window, w: [f32; 3]) -> Plane {
        let window = window.clipped(self.width, self.height);
        let mut data = Vec::with_capacity(window.width * window.height);
        for y in window.y0..window.y0 + window.height {
            let start = 3 * (y * self.width + window.x0);
            let row = &self.rgb[start..start + 3 * window.width];
            data.extend(
                row.as_chunks::<3>().0.iter().map(|p| {
                    w[0] * f32::from(p[0]) + w[1] * f32::from(p[1]) + w[2] * f32::from(p[2])
                }),
            );
        }
        Plane { width: window.width, height: window.height, data }
    }

    /// The window that covers the whole picture.
    #[must_use]
    pub fn window(&self) -> Window {
        Window { x0: 0, y0: 0, width: self.width, height: self.height }
    }
}

/// A rectangle of whole pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub x0: usize,
    /// First row.
    pub y0: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Window {
    /// The square around a circle with some margin, clipped to a picture.
    #[must_use]
    pub fn around(x: f64, y: f64, half: f64, width: usize, height: usize) -> Self {
        let lo = |c: f64, n: usize| (c - half).floor().clamp(0.0, n as f64) as usize;
        let hi = |c: f64, n: usize| (c + half).ceil().clamp(0.0, n as f64) as usize;
        let (x0, y0) = (lo(x, width), lo(y, height));
        Self {
            x0,
            y0,
            width: hi(x, width).saturating_sub(x0),
            height: hi(y, height).saturating_sub(y0),
        }
    }

    fn clipped(self, width: usize, height: usize) -> Self {
        let x0 = self.x0.min(width);
        let y0 = self.y0.min(height);
        Self { x0, y0, width: self.width.min(width - x0), height: self.height.min(height - y0) }
    }
}

/// A single-channel picture, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Samples, row by row.
    pub data: Vec<f32>,
}

impl Plane {
    /// A plane of one value.
    #[must_use]
    pub fn filled(width: usize, height: usize, value: f32) -> Self {
        Self { width, height, data: vec![value; width * height] }
    }

    /// The sample of a pixel; panics outside of the plane.
    #[must_use]
    #[inline]
    pub fn at(&self, x: usize, y: usize) -> f32 {
        self.data[y * self.width + x]
    }

    /// One row.
    #[must_use]
    pub fn row(&self, y: usize) -> &[f32] {
        &self.data[y * self.width..(y + 1) * self.width]
    }

    /// Bilinear value at a point (pixel centres at whole numbers); beyond the border the nearest sample counts.
    ///
    /// ```
    /// use drum_vision::frame::Plane;
    /// let ramp = Plane { width: 2, height: 1, data: vec![10.0, 20.0] };
    /// assert_eq!(ramp.sample(0.5, 0.0), 15.0);
    /// ```
    #[must_use]
    #[inline]
    pub fn sample(&self, x: f64, y: f64) -> f64 {
        let fx = x.clamp(0.0, (self.width - 1) as f64);
        let fy = y.clamp(0.0, (self.height - 1) as f64);
        let (ix, iy) = (fx as usize, fy as usize);
        let (ax, ay) = (fx - ix as f64, fy - iy as f64);
        let (jx, jy) = ((ix + 1).min(self.width - 1), (iy + 1).min(self.height - 1));
        let top = f64::from(self.at(ix, iy)) * (1.0 - ax) + f64::from(self.at(jx, iy)) * ax;
        let low = f64::from(self.at(ix, jy)) * (1.0 - ax) + f64::from(self.at(jx, jy)) * ax;
        top * (1.0 - ay) + low * ay
    }

    /// Mean over blocks of `k x k` pixels; an incomplete block at the right or lower border is averaged over what it has.
    #[must_use]
    pub fn binned(&self, k: usize) -> Self {
        let k = k.max(1);
        let (width, height) = (self.width.div_ceil(k), self.height.div_ceil(k));
        let mut sum = vec![0.0f32; width * height];
        for y in 0..self.height {
            let out = &mut sum[(y / k) * width..(y / k + 1) * width];
            for (o, block) in out.iter_mut().zip(self.row(y).chunks(k)) {
                *o += block.iter().sum::<f32>();
            }
        }
        for y in 0..height {
            let rows = k.min(self.height - y * k);
            for x in 0..width {
                sum[y * width + x] /= (rows * k.min(self.width - x * k)) as f32;
            }
        }
        Self { width, height, data: sum }
    }

    /// Rounds to 8-bit samples, clamped to 0..=255.
    #[must_use]
    pub fn to_u8(&self) -> Vec<u8> {
        self.data.iter().map(|&v| (v + 0.5).clamp(0.0, 255.0) as u8).collect()
    }
}
