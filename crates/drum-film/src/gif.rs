//! A series as an animated GIF.

use std::io::Write;

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, DynamicImage, Frame, RgbImage};

use crate::error::Error;
use crate::strip::same_size;

/// Writes frames as a GIF that repeats for ever, `delay_ms` apart (the format counts in 10 ms).
///
/// # Errors
/// [`Error::NoFrame`], [`Error::FrameSize`], and [`Error::Encode`] with the encoder's words.
pub fn write_gif(frames: &[RgbImage], delay_ms: u32, to: impl Write) -> Result<(), Error> {
    same_size(frames)?;
    let failed = |e: image::ImageError| Error::Encode { format: "GIF", reason: e.to_string() };
    // 10 of 1..30: good colours, and a frame of 1936 x 1296 in well under a second.
    let mut encoder = GifEncoder::new_with_speed(to, 10);
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    for frame in frames {
        let picture = DynamicImage::ImageRgb8(frame.clone()).into_rgba8();
        let delay = Delay::from_numer_denom_ms(delay_ms, 1);
        encoder.encode_frame(Frame::from_parts(picture, 0, 0, delay)).map_err(failed)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::AnimationDecoder;
    use image::codecs::gif::GifDecoder;

    #[test]
    fn every_frame_comes_back_with_its_delay() {
        let frames: Vec<_> = [10_u8, 90, 200]
            .iter()
            .map(|v| RgbImage::from_pixel(8, 6, image::Rgb([*v; 3])))
            .collect();
        let mut bytes = Vec::new();
        write_gif(&frames, 120, &mut bytes).unwrap();
        let decoder = GifDecoder::new(std::io::Cursor::new(bytes)).unwrap();
        let back = decoder.into_frames().collect_frames().unwrap();
        assert_eq!(back.len(), 3);
        assert_eq!(back[1].delay().numer_denom_ms(), (120, 1));
        for (frame, back) in frames.iter().zip(&back) {
            // One colour a frame: the palette holds it exactly.
            assert_eq!(frame.get_pixel(3, 3).0[0], back.buffer().get_pixel(3, 3).0[0]);
        }
    }
}
