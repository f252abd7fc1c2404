//! Coverage: which share of each pixel a silhouette fills, before any light or effect.

/// Share from 0 to 1 of each pixel that is covered, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Coverage {
    width: u32,
    height: u32,
    share: Vec<f32>,
}

impl Coverage {
    pub(crate) fn new(width: u32, height: u32, share: Vec<f32>) -> Self {
        Self { width, height, share }
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

    /// The shares, row by row.
    #[must_use]
    pub fn share(&self) -> &[f32] {
        &self.share
    }

    /// Area of the silhouette, square pixels.
    #[must_use]
    pub fn area_px2(&self) -> f64 {
        self.share.iter().map(|s| f64::from(*s)).sum()
    }

    /// Column and row of its centre of area; `None` where nothing is covered.
    #[must_use]
    pub fn centroid_px(&self) -> Option<[f64; 2]> {
        let (mut area, mut x, mut y) = (0.0, 0.0, 0.0);
        for (v, row) in self.share.chunks(self.width as usize).enumerate() {
            for (u, s) in row.iter().enumerate() {
                let s = f64::from(*s);
                area += s;
                x += s * u as f64;
                y += s * v as f64;
            }
        }
        (area > 0.0).then(|| [x / area, y / area])
    }
}
