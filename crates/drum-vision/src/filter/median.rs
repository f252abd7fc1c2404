//! Median filter over a rectangle, in time that does not grow with the window.
//!
//! Agrees with `scipy.ndimage.median_filter(mode="reflect")`: the window of an even size `n` reaches
//! `n / 2` pixels back and `n / 2 - 1` forward, the value is the sample of rank `n_x n_y / 2` (from 0),
//! and beyond the border the picture is mirrored about its edge (`d c b a | a b c d | d c b a`).
//! MATLAB's `medfilt2` pads with zeros instead, which darkens corners.
//!
//! Method: a histogram per column, slid down by rows, and a window histogram, slid along the row by adding
//! and removing whole columns (Perreault and Hebert, IEEE Trans. Image Process. 16 (2007) 2389,
//! doi:10.1109/TIP.2007.902329).

/// Filters an 8-bit picture with a window of `size_x` by `size_y` pixels.
///
/// Sizes are clamped to the picture's sides; a size of 0 counts as 1.
#[must_use]
pub fn median_u8(
    data: &[u8],
    width: usize,
    height: usize,
    size_x: usize,
    size_y: usize,
) -> Vec<u8> {
    assert_eq!(data.len(), width * height, "samples must fill the picture");
    let (size_x, size_y) = (size_x.clamp(1, width.max(1)), size_y.clamp(1, height.max(1)));
    if size_x * size_y == 1 || data.is_empty() {
        return data.to_vec();
    }
    if size_x == 3 && size_y == 3 && width >= 3 && height >= 3 {
        return median_3x3(data, width, height);
    }
    let (back_x, back_y) = ((size_x / 2) as isize, (size_y / 2) as isize);
    let rank = (size_x * size_y / 2) as u32;
    let reflect = |k: isize, n: usize| {
        let k = if k < 0 { -1 - k } else { k } as usize;
        if k >= n { 2 * n - 1 - k } else { k }
    };
    // Columns of the mirrored picture: those of the window at x = 0 come first.
    let wide = width + size_x - 1;
    let source: Vec<usize> = (0..wide).map(|k| reflect(k as isize - back_x, width)).collect();
    let mut columns = vec![Histogram::default(); width];
    for dy in 0..size_y {
        let row = &data[reflect(dy as isize - back_y, height) * width..][..width];
        for (column, &v) in columns.iter_mut().zip(row) {
            column.add(v);
        }
    }
    let mut out = vec![0u8; data.len()];
    for y in 0..height {
        if y > 0 {
            let gone = &data[reflect(y as isize - 1 - back_y, height) * width..][..width];
            let come = &data[reflect(y as isize - 1 - back_y + size_y as isize, height) * width..]
                [..width];
            for ((column, &g), &c) in columns.iter_mut().zip(gone).zip(come) {
                column.remove(g);
                column.add(c);
            }
        }
        let mut window = Histogram::default();
        for &s in &source[..size_x] {
            window.merge(&columns[s]);
        }
        for x in 0..width {
            out[y * width + x] = window.sample_of_rank(rank);
            if x + 1 < width {
                window.exchange(&columns[source[x]], &columns[source[x + size_x]]);
            }
        }
    }
    out
}

/// Majority filter of a binary picture: the median of zeros and ones, same window and border rules.
#[must_use]
pub fn median_binary(mask: &[bool], width: usize, height: usize, size: usize) -> Vec<bool> {
    let size_x = size.clamp(1, width.max(1));
    let size_y = size.clamp(1, height.max(1));
    let counts = super::wiener::box_sums(
        &mask.iter().map(|&m| f32::from(u8::from(m))).collect::<Vec<_>>(),
        width,
        height,
        size_x,
        size_y,
        super::wiener::Border::Reflect,
    );
    // The sample of rank k of n is one when more than n - 1 - k of them are.
    let n = size_x * size_y;
    let least = (n - n / 2) as f64 - 0.5;
    counts.into_iter().map(|c| c > least).collect()
}

/// Counts of the 256 grey levels, with a coarse layer of 16.
#[derive(Clone)]
struct Histogram {
    coarse: [u16; 16],
    fine: [u16; 256],
}

impl Default for Histogram {
    fn default() -> Self {
        Self { coarse: [0; 16], fine: [0; 256] }
    }
}

impl Histogram {
    #[inline]
    fn add(&mut self, v: u8) {
        self.coarse[usize::from(v >> 4)] += 1;
        self.fine[usize::from(v)] += 1;
    }

    #[inline]
    fn remove(&mut self, v: u8) {
        self.coarse[usize::from(v >> 4)] -= 1;
        self.fine[usize::from(v)] -= 1;
    }

    fn merge(&mut self, other: &Self) {
        self.coarse.iter_mut().zip(&other.coarse).for_each(|(a, b)| *a += b);
        self.fine.iter_mut().zip(&other.fine).for_each(|(a, b)| *a += b);
    }

    #[inline]
    fn exchange(&mut self, gone: &Self, come: &Self) {
        for k in 0..16 {
            self.coarse[k] =
                self.coarse[k].wrapping_add(come.coarse[k]).wrapping_sub(gone.coarse[k]);
        }
        for k in 0..256 {
            self.fine[k] = self.fine[k].wrapping_add(come.fine[k]).wrapping_sub(gone.fine[k]);
        }
    }

    #[inline]
    fn sample_of_rank(&self, rank: u32) -> u8 {
        let mut below = 0u32;
        let mut c = 0;
        while c < 15 && below + u32::from(self.coarse[c]) <= rank {
            below += u32::from(self.coarse[c]);
            c += 1;
        }
        let mut v = 16 * c;
        while v < 255 && below + u32::from(self.fine[v]) <= rank {
            below += u32::from(self.fine[v]);
            v += 1;
        }
        v as u8
    }
}

/// The 3 x 3 case by a network of comparisons, several times faster than histograms.
fn median_3x3(data: &[u8], width: usize, height: usize) -> Vec<u8> {
    let mut out = vec![0u8; data.len()];
    let mut low = vec![0u8; width + 2];
    let mut mid = vec![0u8; width + 2];
    let mut high = vec![0u8; width + 2];
    for y in 0..height {
        let row = |k: usize| &data[k * width..(k + 1) * width];
        let (a, b, c) = (row(y.saturating_sub(1)), row(y), row((y + 1).min(height - 1)));
        for x in 0..width {
            let (p, q) = (a[x].min(b[x]), a[x].max(b[x]));
            let r = c[x];
            low[x + 1] = p.min(r);
            high[x + 1] = q.max(r);
            mid[x + 1] = p.max(q.min(r));
        }
        for v in [&mut low, &mut mid, &mut high] {
            v[0] = v[1];
            v[width + 1] = v[width];
        }
        let target = &mut out[y * width..(y + 1) * width];
        for (x, t) in target.iter_mut().enumerate() {
            let l = low[x].max(low[x + 1]).max(low[x + 2]);
            let h = high[x].min(high[x + 1]).min(high[x + 2]);
            let (p, q) = (mid[x].min(mid[x + 1]), mid[x].max(mid[x + 1]));
            let m = p.max(q.min(mid[x + 2]));
            let (s, u) = (l.min(m), l.max(m));
            *t = s.max(u.min(h));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn network_and_histograms_agree() {
        let (w, h) = (23usize, 17usize);
        let data: Vec<u8> = (0..w * h).map(|k| (k * 7919 % 251) as u8).collect();
        let fast = median_3x3(&data, w, h);
        let brute: Vec<u8> = (0..w * h)
            .map(|k| {
                let (x, y) = ((k % w) as isize, (k / w) as isize);
                let mut v: Vec<u8> = (-1..=1)
                    .flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)))
                    .map(|(dx, dy)| {
                        let xx = (x + dx).clamp(0, w as isize - 1) as usize;
                        let yy = (y + dy).clamp(0, h as isize - 1) as usize;
                        data[yy * w + xx]
                    })
                    .collect();
                v.sort_unstable();
                v[4]
            })
            .collect();
        assert_eq!(fast, brute);
    }

    #[test]
    fn a_lone_pixel_is_removed_and_an_edge_stays() {
        let (w, h) = (20usize, 20usize);
        let mut data: Vec<u8> = (0..w * h).map(|k| if k % w < 10 { 20 } else { 200 }).collect();
        let edge = data.clone();
        data[5 * w + 5] = 255;
        assert_eq!(median_u8(&data, w, h, 5, 5), edge);
    }
}
