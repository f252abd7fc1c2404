//! What leaves the crate: files that other programs read back.

use drum_film::image::{self, ImageReader};
use drum_film::{Bed, Camera, Film};

#[test]
fn a_png_comes_back_bit_by_bit() {
    let film = Film { camera: Camera::default().with_size(242, 162), ..Film::default() };
    let frame = film.bed_frame(&Bed::default(), 0).unwrap();
    let mut bytes = std::io::Cursor::new(Vec::new());
    frame.image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    let bytes = std::io::Cursor::new(bytes.into_inner());
    let back = ImageReader::new(bytes).with_guessed_format().unwrap().decode().unwrap().to_rgb8();
    assert!(back == frame.image);
}

#[cfg(feature = "serde")]
#[test]
fn a_film_comes_back_from_json_and_an_unknown_key_is_refused() {
    let mut film = Film::default();
    film.set("camera.roll_deg", 1.25).unwrap();
    film.set("light.glare", 0.5).unwrap();
    let text = serde_json::to_string(&film).unwrap();
    assert_eq!(serde_json::from_str::<Film>(&text).unwrap(), film);
    let part: Film = serde_json::from_str(r#"{"camera": {"distance_m": 0.7}}"#).unwrap();
    assert_eq!(part.camera, Camera { distance_m: 0.7, ..Camera::default() });
    let error = serde_json::from_str::<Film>(r#"{"camera": {"distance": 0.7}}"#).unwrap_err();
    assert!(error.to_string().contains("unknown field `distance`"), "{error}");
}
