//! Bad input ends in an error that names the stage and what to try; the rest of a series goes on.

use drum_film::{Bed, Camera, Film};
use drum_vision::config::DecodeConfig;
use drum_vision::decode::decode_bytes;
use drum_vision::{Context, Frame, Stage, VisionConfig, VisionError, measure_frame, overlay};

use crate::scenes::to_frame;

fn film() -> Film {
    Film { camera: Camera::default().with_size(484, 324), ..Film::default() }
}

fn fails(frame: &Frame) -> VisionError {
    match measure_frame(frame, &VisionConfig::default(), Context::default()) {
        Err(e) => e,
        Ok(m) => panic!("measured: {:?}, visible {}", m.responses, m.visible),
    }
}

fn png(frame: &Frame) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    overlay::write_png(frame, &path).unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn a_picture_without_a_drum_has_no_circle() {
    let stripes: Vec<u8> =
        (0..300 * 200).map(|k| if (k % 300 + k / 300) / 20 % 2 == 0 { 60 } else { 180 }).collect();
    let e = fails(&Frame::from_grey(300, 200, &stripes).unwrap());
    assert!(matches!(e, VisionError::NoCircle { .. }), "{e}");
    assert_eq!(e.stage(), Stage::Drum);
    assert!(e.to_string().contains("drum.radius_range_px"));
}

#[test]
fn two_drums_are_several_circles() {
    let one = to_frame(film().bed_frame(&Bed::default(), 1).unwrap().image);
    let (w, h) = (one.width(), one.height());
    let mut rgb = Vec::new();
    for y in 0..h {
        for k in [0, 1] {
            let _ = k;
            rgb.extend_from_slice(&one.rgb()[3 * y * w..3 * (y + 1) * w]);
        }
    }
    let e = fails(&Frame::from_rgb(2 * w, h, rgb).unwrap());
    let VisionError::SeveralCircles { candidates } = &e else { panic!("{e}") };
    assert_eq!(candidates.len(), 2);
    assert!((candidates[0].x_px - candidates[1].x_px).abs() > 0.9 * w as f64);
}

#[test]
fn empty_and_full_drums_are_refused_at_the_bed() {
    let mut empty = film();
    empty.noise.read = 0.01;
    // The least bed that the film draws: half a percent, a sliver at the wall.
    let bed = Bed { fill: 0.005, s_shape_deg: 0.0, ..Bed::default() };
    let e = fails(&to_frame(empty.bed_frame(&bed, 1).unwrap().image));
    assert!(matches!(e.stage(), Stage::Bed | Stage::Surface), "{e}");
    let bed = Bed { fill: 0.995, s_shape_deg: 0.0, ..Bed::default() };
    let e = fails(&to_frame(empty.bed_frame(&bed, 1).unwrap().image));
    assert!(matches!(e.stage(), Stage::Bed | Stage::Surface), "{e}");
}

#[test]
fn black_and_saturated_frames_are_refused_at_the_exposure() {
    let e = fails(&Frame::from_grey(200, 200, &[3; 40_000]).unwrap());
    assert!(matches!(e, VisionError::Black { .. }), "{e}");
    let e = fails(&Frame::from_grey(200, 200, &[255; 40_000]).unwrap());
    assert!(matches!(e, VisionError::Saturated { .. }), "{e}");
    let mut burnt = film();
    burnt.light.ambient = 10.0;
    burnt.scene.rear_wall = [1.0; 3];
    burnt.scene.tube = [1.0; 3];
    let e = fails(&to_frame(burnt.bed_frame(&Bed::default(), 1).unwrap().image));
    assert!(matches!(e, VisionError::Saturated { .. }), "{e}");
}

#[test]
fn broken_files_are_told_apart() {
    let limits = DecodeConfig::default();
    let good = to_frame(film().bed_frame(&Bed::default(), 1).unwrap().image);
    let bytes = png(&good);
    assert_eq!(decode_bytes(&bytes, &limits).unwrap(), good);
    let cut = decode_bytes(&bytes[..bytes.len() / 2], &limits).unwrap_err();
    assert!(matches!(cut, VisionError::Truncated { .. } | VisionError::Decode { .. }), "{cut}");
    let mut jpeg = Vec::new();
    image_jpeg(&good, &mut jpeg);
    assert!(decode_bytes(&jpeg, &limits).is_ok());
    let cut = decode_bytes(&jpeg[..jpeg.len() * 2 / 3], &limits).unwrap_err();
    assert!(matches!(cut, VisionError::Truncated { .. }), "{cut}");
    for junk in [&b"omega_rpm,aor_lin_deg\n12,27.9\n"[..], &b""[..], &b"GIF89a"[..]] {
        let e = decode_bytes(junk, &limits).unwrap_err();
        assert!(matches!(e, VisionError::NotAnImage), "{e}");
        assert_eq!(e.stage(), Stage::Decode);
    }
    let small = DecodeConfig { max_pixels: 100_000 };
    let e = decode_bytes(&bytes, &small).unwrap_err();
    assert!(matches!(e, VisionError::TooLarge { width_px: 484, height_px: 324, .. }), "{e}");
    let e = decode_bytes(&png(&Frame::from_grey(20, 20, &[9; 400]).unwrap()), &limits).unwrap_err();
    assert!(matches!(e, VisionError::TooSmall { .. }), "{e}");
}

#[test]
fn a_hundred_megapixels_are_refused_by_the_header_alone() {
    // A PNG header of 10000 x 10000 pixels with no data behind it.
    let mut bytes = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = b"IHDR".to_vec();
    chunk.extend(10_000u32.to_be_bytes());
    chunk.extend(10_000u32.to_be_bytes());
    chunk.extend([8, 2, 0, 0, 0]);
    bytes.extend(13u32.to_be_bytes());
    let crc = crc32(&chunk);
    bytes.extend(chunk);
    bytes.extend(crc.to_be_bytes());
    // The start of an empty data chunk, so that the header counts as read.
    bytes.extend([0, 0, 0, 0]);
    bytes.extend(b"IDAT");
    bytes.extend(crc32(b"IDAT").to_be_bytes());
    let e = decode_bytes(&bytes, &DecodeConfig::default()).unwrap_err();
    assert!(matches!(e, VisionError::TooLarge { .. }), "{e}");
    assert!(e.to_string().contains("100.0 million pixels"), "{e}");
}

#[test]
fn a_hidden_surface_is_refused_not_guessed() {
    let mut film = film();
    film.powder.opacity = 0.97;
    film.powder.variation = 0.3;
    film.noise.read = 0.03;
    let e = fails(&to_frame(film.bed_frame(&Bed::default(), 3).unwrap().image));
    assert!(matches!(e.stage(), Stage::Bed | Stage::Surface), "{e}");
    assert!(e.to_string().contains("tumble roi"), "{e}");
}

#[test]
fn a_tilted_camera_is_reported() {
    let mut film = film();
    film.camera.pitch_deg = 14.0;
    let made = film.bed_frame(&Bed::default(), 1).unwrap();
    let m =
        measure_frame(&to_frame(made.image), &VisionConfig::default(), Context::default()).unwrap();
    let tilt = m.warnings.iter().find_map(|w| match w {
        drum_vision::Warning::TiltedCamera { tilt_deg, .. } => Some(*tilt_deg),
        _ => None,
    });
    let drawn = made.truth.axis_ratio.acos().to_degrees();
    // The tilt goes with the root of the ellipticity: a tenth of a pixel in 112 is half a degree at 14.
    assert!(tilt.is_some_and(|t| (t - drawn).abs() < 1.5), "{tilt:?} against {drawn}");
}

fn image_jpeg(frame: &Frame, out: &mut Vec<u8>) {
    drum_vision::image::codecs::jpeg::JpegEncoder::new_with_quality(out, 90)
        .encode(
            frame.rgb(),
            frame.width() as u32,
            frame.height() as u32,
            drum_vision::image::ExtendedColorType::Rgb8,
        )
        .unwrap();
}

/// CRC-32 of PNG (polynomial 0xEDB88320), bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, &b| {
        (0..8).fold(
            crc ^ u32::from(b),
            |c, _| if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 },
        )
    })
}
