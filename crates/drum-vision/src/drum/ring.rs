//! The mask of the red ring.

use crate::config::RedConfig;
use crate::filter::median::median_binary;
use crate::frame::{Frame, Plane};

/// The fraction of red pixels in blocks of `bin x bin`, after a median filter of the full-size mask.
///
/// A pixel is red when red exceeds and green and blue lie below their thresholds, strictly, as
/// in the thesis (appendix 7.5.2: 100 each). `median_px` is the side of the median's window.
#[must_use]
pub fn red_mask(frame: &Frame, config: &RedConfig, median_px: usize) -> Vec<bool> {
    let mask: Vec<bool> = frame
        .rgb()
        .as_chunks::<3>()
        .0
        .iter()
        .map(|p| p[0] > config.red_above && p[1] < config.green_below && p[2] < config.blue_below)
        .collect();
    if !mask.iter().any(|&m| m) {
        return mask;
    }
    median_binary(&mask, frame.width(), frame.height(), median_px)
}

/// A mask as a plane of 0 and 255, averaged over blocks.
#[must_use]
pub fn mask_plane(mask: &[bool], width: usize, height: usize, bin: usize) -> Plane {
    let data = mask.iter().map(|&m| if m { 255.0 } else { 0.0 }).collect();
    Plane { width, height, data }.binned(bin)
}
