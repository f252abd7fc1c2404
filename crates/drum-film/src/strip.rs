//! Several frames in one picture.

use image::{RgbImage, imageops};

use crate::error::Error;

/// Pixels between two frames.
const GAP: u32 = 4;

/// Frames side by side, 4 light pixels apart.
///
/// # Errors
/// As [`contact_sheet`].
pub fn strip(frames: &[RgbImage]) -> Result<RgbImage, Error> {
    contact_sheet(frames, frames.len() as u32)
}

/// Frames in rows of `columns`, 4 light pixels apart.
///
/// # Errors
/// [`Error::NoFrame`] without frames or columns, [`Error::FrameSize`] where a frame is not as large as the first.
pub fn contact_sheet(frames: &[RgbImage], columns: u32) -> Result<RgbImage, Error> {
    let (width, height) = same_size(frames)?;
    if columns == 0 {
        return Err(Error::NoFrame { what: "at least one column of frames" });
    }
    let rows = (frames.len() as u32).div_ceil(columns);
    let columns = columns.min(frames.len() as u32);
    let light = image::Rgb([230, 230, 230]);
    let mut sheet =
        RgbImage::from_pixel(columns * (width + GAP) - GAP, rows * (height + GAP) - GAP, light);
    for (i, frame) in frames.iter().enumerate() {
        let (x, y) = (i as u32 % columns * (width + GAP), i as u32 / columns * (height + GAP));
        imageops::replace(&mut sheet, frame, x.into(), y.into());
    }
    Ok(sheet)
}

/// Width and height that all frames share.
pub(crate) fn same_size(frames: &[RgbImage]) -> Result<(u32, u32), Error> {
    let first = frames.first().ok_or(Error::NoFrame { what: "at least one frame" })?;
    let expected = first.dimensions();
    match frames.iter().position(|f| f.dimensions() != expected) {
        None => Ok(expected),
        Some(index) => Err(Error::FrameSize { index, found: frames[index].dimensions(), expected }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_keep_their_pixels_and_their_places() {
        let frame = |v| RgbImage::from_pixel(10, 6, image::Rgb([v; 3]));
        let sheet = contact_sheet(&[frame(1), frame(2), frame(3)], 2).unwrap();
        assert_eq!(sheet.dimensions(), (24, 16));
        assert_eq!(sheet.get_pixel(9, 5).0, [1; 3]);
        assert_eq!(sheet.get_pixel(14, 0).0, [2; 3]);
        assert_eq!(sheet.get_pixel(0, 10).0, [3; 3]);
        assert_eq!(sheet.get_pixel(12, 3).0, [230; 3]);
        assert_eq!(strip(&[frame(1), frame(2)]).unwrap().dimensions(), (24, 6));
    }

    #[test]
    fn frames_of_other_size_are_refused() {
        let frames = [RgbImage::new(10, 6), RgbImage::new(10, 7)];
        assert!(matches!(strip(&frames), Err(Error::FrameSize { index: 1, .. })));
        assert!(matches!(strip(&[]), Err(Error::NoFrame { .. })));
    }
}
