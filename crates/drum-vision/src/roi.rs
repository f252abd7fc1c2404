//! The region picker: one self-contained HTML page for one frame.
//!
//! A person clicks the corners of a polygon around the bed, moves two sliders under the grey histogram and saves
//! the side-car that [`crate::RegionSidecar`] reads. The page holds the picture and loads nothing from anywhere.

use image::ImageEncoder;

use crate::error::VisionError;
use crate::frame::Frame;

/// The page's frame: marks in double braces are filled in.
const PAGE: &str = include_str!("roi_page.html");

/// Longest side of the picture that the page shows, pixels; larger frames are shown smaller, corners stay in pixels of
/// the frame.
const SHOWN_SIDE: usize = 2400;

/// Makes the page for a frame; `name` is put into its title and into the side-car.
///
/// # Errors
/// [`VisionError::Write`] when the picture cannot be encoded.
pub fn roi_page(frame: &Frame, name: &str) -> Result<String, VisionError> {
    let shrink = frame.width().max(frame.height()).div_ceil(SHOWN_SIDE).max(1);
    let shown = if shrink == 1 { frame.clone() } else { thin(frame, shrink) };
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new(&mut png)
        .write_image(
            shown.rgb(),
            shown.width() as u32,
            shown.height() as u32,
            image::ExtendedColorType::Rgb8,
        )
        .map_err(|source| VisionError::Write { path: name.into(), source })?;
    Ok(PAGE
        .replace("{{TITLE}}", &escape_html(name))
        .replace("{{NAME}}", &escape_script(name))
        .replace("{{WIDTH}}", &frame.width().to_string())
        .replace("{{HEIGHT}}", &frame.height().to_string())
        .replace("{{SHRINK}}", &shrink.to_string())
        .replace("{{PICTURE}}", &base64(&png)))
}

/// Every `k`-th pixel of every `k`-th row: greys keep their levels, which the histogram needs.
fn thin(frame: &Frame, k: usize) -> Frame {
    let (w, h) = (frame.width().div_ceil(k), frame.height().div_ceil(k));
    let mut rgb = Vec::with_capacity(3 * w * h);
    for y in 0..h {
        for x in 0..w {
            rgb.extend(frame.pixel(x * k, y * k).unwrap_or([0; 3]));
        }
    }
    Frame::from_rgb(w, h, rgb).expect("three samples were pushed for every pixel")
}

fn escape_html(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// For the inside of a double-quoted script string.
fn escape_script(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        if c.is_alphanumeric() || " ._-()".contains(c) {
            out.push(c);
        } else {
            let mut units = [0u16; 2];
            for u in c.encode_utf16(&mut units) {
                out.push_str(&format!("\\u{u:04x}"));
            }
        }
    }
    out
}

/// Base 64 of RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let at = |k: usize| u32::from(chunk.get(k).copied().unwrap_or(0));
        let word = at(0) << 16 | at(1) << 8 | at(2);
        for k in 0..4 {
            if k <= chunk.len() {
                out.push(char::from(DIGITS[(word >> (18 - 6 * k)) as usize & 63]));
            } else {
                out.push('=');
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_follows_the_rfc() {
        // RFC 4648, section 10.
        for (plain, coded) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn the_page_is_whole_and_loads_nothing() {
        let frame = Frame::from_grey(60, 50, &[90; 3000]).unwrap();
        let page = roi_page(&frame, "a<b>\"'.png").unwrap();
        assert!(!page.contains("{{"), "a mark was left");
        assert!(!page.contains("http"), "something is loaded from outside");
        assert!(page.contains("a&lt;b&gt;&quot;'.png") && page.contains("\\u003cb\\u003e\\u0022"));
    }
}
