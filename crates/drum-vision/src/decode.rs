//! From a file to a [`Frame`], with a bound on pixels and memory.

use std::io::Cursor;
use std::path::Path;

use image::{ImageDecoder, ImageReader, Limits};

use crate::config::DecodeConfig;
use crate::error::VisionError;
use crate::frame::Frame;

/// The least side of a picture that can hold a drum, pixels.
pub const MIN_SIDE_PX: u32 = 48;

/// Extensions that a folder of frames is searched for, lower case.
pub const EXTENSIONS: [&str; 6] = ["png", "jpg", "jpeg", "tif", "tiff", "bmp"];

/// Reads and decodes one picture.
///
/// # Errors
/// [`VisionError::Read`] when the file cannot be read; otherwise as [`decode_bytes`].
pub fn decode_file(path: &Path, config: &DecodeConfig) -> Result<Frame, VisionError> {
    let read = |source| VisionError::Read { path: path.to_path_buf(), source };
    let length = std::fs::metadata(path).map_err(read)?.len();
    // An uncompressed 16-bit picture with alpha takes 8 bytes a pixel; anything far longer is not one.
    let limit = config.max_pixels.saturating_mul(16).saturating_add(1 << 20);
    if length > limit {
        return Err(VisionError::Invalid {
            what: "frame file",
            detail: format!("{length} bytes, more than {limit} that `decode.max_pixels` allows"),
        });
    }
    decode_bytes(&std::fs::read(path).map_err(read)?, config)
}

/// Decodes PNG, JPEG, TIFF or BMP bytes to 8-bit colour.
///
/// 16-bit samples are rounded to 8 bits, transparency is dropped, grey pictures get three equal channels.
/// The pixel count is checked in the header, before any pixel is decoded; the decoder may
/// allocate at most 24 bytes per allowed pixel.
///
/// # Errors
/// [`VisionError::NotAnImage`], [`VisionError::TooLarge`], [`VisionError::TooSmall`],
/// [`VisionError::Truncated`] or [`VisionError::Decode`].
pub fn decode_bytes(bytes: &[u8], config: &DecodeConfig) -> Result<Frame, VisionError> {
    let format = image::guess_format(bytes).map_err(|_| VisionError::NotAnImage)?;
    use image::ImageFormat as F;
    if !matches!(format, F::Png | F::Jpeg | F::Tiff | F::Bmp) {
        return Err(VisionError::NotAnImage);
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(config.max_pixels.saturating_mul(24).saturating_add(1 << 16));
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(sort_error)?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > config.max_pixels {
        return Err(VisionError::TooLarge {
            width_px: width,
            height_px: height,
            max_pixels: config.max_pixels,
        });
    }
    if width.min(height) < MIN_SIDE_PX {
        return Err(VisionError::TooSmall {
            width_px: width,
            height_px: height,
            min_px: MIN_SIDE_PX,
        });
    }
    if format == F::Jpeg && !jpeg_has_end(bytes) {
        return Err(VisionError::Truncated {
            detail: "the JPEG has no end-of-image marker".into(),
        });
    }
    let picture = image::DynamicImage::from_decoder(decoder).map_err(sort_error)?;
    let (width, height) = (width as usize, height as usize);
    Frame::from_rgb(width, height, picture.into_rgb8().into_raw())
        .ok_or(VisionError::Truncated { detail: "fewer samples than the header says".into() })
}

/// All frames of a folder, by extension, in natural order (`frame_2` before `frame_10`).
///
/// # Errors
/// [`VisionError::Read`] when the folder cannot be listed, [`VisionError::NoFrames`] when nothing fits.
pub fn list_frames(folder: &Path) -> Result<Vec<std::path::PathBuf>, VisionError> {
    let read = |source| VisionError::Read { path: folder.to_path_buf(), source };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(read)? {
        let path = entry.map_err(read)?.path();
        let known = path
            .extension()
            .and_then(|e| e.to_str())
            .is_some_and(|e| EXTENSIONS.contains(&e.to_ascii_lowercase().as_str()));
        if known && path.is_file() {
            found.push(path);
        }
    }
    if found.is_empty() {
        return Err(VisionError::NoFrames { what: folder.display().to_string() });
    }
    found.sort_by_cached_key(|p| natural_key(&p.to_string_lossy()));
    Ok(found)
}

/// Splits a name into text and numbers so that numbers sort by value.
fn natural_key(name: &str) -> Vec<(String, u64)> {
    let mut key = Vec::new();
    let mut rest = name;
    while !rest.is_empty() {
        let text_end = rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len());
        let (text, tail) = rest.split_at(text_end);
        let digits_end = tail.find(|c: char| !c.is_ascii_digit()).unwrap_or(tail.len());
        let (digits, tail) = tail.split_at(digits_end);
        key.push((text.to_owned(), digits.parse().unwrap_or(0)));
        rest = tail;
    }
    key
}

fn sort_error(source: image::ImageError) -> VisionError {
    if let image::ImageError::IoError(io) = &source
        && io.kind() == std::io::ErrorKind::UnexpectedEof
    {
        return VisionError::Truncated { detail: io.to_string() };
    }
    VisionError::Decode { source }
}

/// Whether an end-of-image marker follows the first scan.
///
/// Inside entropy-coded data `FF` is always followed by `00` or a restart marker, so `FF D9` after the
/// first start-of-scan can only be the end.
fn jpeg_has_end(bytes: &[u8]) -> bool {
    let mut k = 2;
    while k + 4 <= bytes.len() {
        if bytes[k] != 0xFF {
            k += 1;
            continue;
        }
        match bytes[k + 1] {
            0xDA => return bytes[k + 2..].windows(2).any(|w| w == [0xFF, 0xD9]),
            0xFF | 0x00 | 0x01 | 0xD0..=0xD8 => k += 1,
            _ => k += 2 + usize::from(u16::from_be_bytes([bytes[k + 2], bytes[k + 3]])),
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_sort_by_their_numbers() {
        let mut names = ["f10.png", "f9.png", "f1.png"];
        names.sort_by_cached_key(|n| natural_key(n));
        assert_eq!(names, ["f1.png", "f9.png", "f10.png"]);
    }
}
