//! Adaptive Wiener filter: smooths where the local variance is that of noise, keeps edges.
//!
//! `out = m + (1 - n/s2) (x - m)` where the local variance `s2` exceeds the noise `n`, else `m`; `m` and `s2`
//! are mean and variance over the window. Without a given noise, `n` is the mean of `s2` over the picture
//! (J. S. Lim, Two-Dimensional Signal and Image Processing, 1990, eq. 9.44 ff.). Agrees with
//! `scipy.signal.wiener` for odd windows: beyond the border samples count as zero
//! (`Border::Zero`). `Border::Reflect` mirrors the picture instead, so that its edge does not darken.

use crate::frame::Plane;

/// What lies beyond the border of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Border {
    /// Zeros, as `scipy.signal` and MATLAB's `wiener2` have it.
    Zero,
    /// The picture mirrored about its edge (`d c b a | a b c d | d c b a`).
    Reflect,
}

/// Filters with an odd window of `size` pixels a side (an even size is raised by one) and a noise
/// variance, or the mean local variance when `noise` is `None`.
#[must_use]
pub fn wiener(plane: &Plane, size: usize, noise: Option<f64>, border: Border) -> Plane {
    let side = plane.width.min(plane.height).max(1);
    let size = (size.max(1) | 1).min(if side % 2 == 1 { side } else { side - 1 }.max(1));
    let (w, h) = (plane.width, plane.height);
    if size == 1 || plane.data.is_empty() {
        return plane.clone();
    }
    // Samples are shifted to their mean, so that squares keep their digits.
    let shift = match border {
        Border::Zero => 0.0,
        Border::Reflect => {
            (plane.data.iter().map(|&v| f64::from(v)).sum::<f64>() / plane.data.len() as f64) as f32
        }
    };
    let shifted: Vec<f32> = plane.data.iter().map(|v| v - shift).collect();
    let squares: Vec<f32> = shifted.iter().map(|v| v * v).collect();
    let area = (size * size) as f64;
    let mean = box_sums(&shifted, w, h, size, size, border);
    let mut variance = box_sums(&squares, w, h, size, size, border);
    for (v, m) in variance.iter_mut().zip(&mean) {
        *v = *v / area - (m / area) * (m / area);
    }
    let noise = noise.unwrap_or_else(|| variance.iter().sum::<f64>() / variance.len() as f64);
    let data = shifted
        .iter()
        .zip(mean.iter().zip(&variance))
        .map(|(&x, (&m, &s2))| {
            let m = m / area;
            let out = if s2 < noise || s2 <= 0.0 {
                m
            } else {
                m + (f64::from(x) - m) * (1.0 - noise / s2)
            };
            out as f32 + shift
        })
        .collect();
    Plane { width: w, height: h, data }
}

/// Sums over windows of `size_x` by `size_y`, each reaching `size / 2` back; running sums in `f64`.
#[must_use]
pub fn box_sums(
    data: &[f32],
    width: usize,
    height: usize,
    size_x: usize,
    size_y: usize,
    border: Border,
) -> Vec<f64> {
    let mut out = vec![0.0f64; width * height];
    if width == 0 || height == 0 {
        return out;
    }
    let pick = |k: isize, n: usize| -> Option<usize> {
        if (0..n as isize).contains(&k) {
            return Some(k as usize);
        }
        match border {
            Border::Zero => None,
            Border::Reflect => {
                let k = if k < 0 { -1 - k } else { 2 * n as isize - 1 - k };
                Some(k.clamp(0, n as isize - 1) as usize)
            }
        }
    };
    let (back_x, back_y) = ((size_x / 2) as isize, (size_y / 2) as isize);
    let mut column = vec![0.0f64; width];
    for dy in 0..size_y as isize {
        if let Some(y) = pick(dy - back_y, height) {
            add_row(&mut column, &data[y * width..(y + 1) * width], 1.0);
        }
    }
    for y in 0..height {
        if y > 0 {
            let first = y as isize - 1 - back_y;
            if let Some(g) = pick(first, height) {
                add_row(&mut column, &data[g * width..(g + 1) * width], -1.0);
            }
            if let Some(c) = pick(first + size_y as isize, height) {
                add_row(&mut column, &data[c * width..(c + 1) * width], 1.0);
            }
        }
        let mut sum: f64 =
            (0..size_x as isize).filter_map(|k| pick(k - back_x, width)).map(|k| column[k]).sum();
        let row = &mut out[y * width..(y + 1) * width];
        for (x, out) in row.iter_mut().enumerate() {
            *out = sum;
            let first = x as isize - back_x;
            sum += pick(first + size_x as isize, width).map_or(0.0, |k| column[k])
                - pick(first, width).map_or(0.0, |k| column[k]);
        }
    }
    out
}

fn add_row(column: &mut [f64], row: &[f32], sign: f64) {
    for (c, &v) in column.iter_mut().zip(row) {
        *c += sign * f64::from(v);
    }
}
