//! Pictures in the manner of EDEM's: two colours, and a reference circle.

use approx::assert_abs_diff_eq;
use drum_film::{Bed, Camera, Drum, Film};

fn film() -> Film {
    let mut film = Film::silhouette(Drum::default(), [0.2, 0.3, 0.6], [0.95; 3]);
    film.camera = Camera::default().with_size(484, 324);
    film
}

#[test]
fn without_edge_samples_a_silhouette_has_two_colours() {
    let film = Film { edge_samples: 1, ..film() };
    for image in [
        film.bed_frame(&Bed::default(), 0).unwrap().image,
        film.sphere_frame(&super::spheres::heap(), 0).unwrap().image,
    ] {
        let mut colors: Vec<[u8; 3]> = image.pixels().map(|p| p.0).collect();
        colors.sort_unstable();
        colors.dedup();
        assert_eq!(colors, [[51, 77, 153], [242, 242, 242]]);
    }
}

#[test]
fn the_reference_circle_is_the_drum_without_shift_and_scale_error() {
    let mut film = film();
    film.set("camera.offset_x_pct", 3.0).unwrap();
    film.set("camera.offset_y_pct", 2.0).unwrap();
    film.set("camera.scale", 1.02).unwrap();
    let studio = film.studio().unwrap();
    let image = studio.reference_circle().unwrap();
    let dark: Vec<(f64, f64)> = image
        .enumerate_pixels()
        .filter(|(_, _, p)| p.0[0] < 150)
        .map(|(u, v, _)| (f64::from(u), f64::from(v)))
        .collect();
    let n = dark.len() as f64;
    let nominal =
        Camera::default().with_size(484, 324).view(&Drum::default()).unwrap().radius_px(0.125);
    // Whole pixels over an edge of 700: 0.3 sqrt(700) = 8 px^2 of area, 0.01 px of radius and centre.
    assert_abs_diff_eq!((n / std::f64::consts::PI).sqrt(), nominal, epsilon = 0.05);
    assert_abs_diff_eq!(dark.iter().map(|p| p.0).sum::<f64>() / n, 241.5, epsilon = 0.05);
    assert_abs_diff_eq!(dark.iter().map(|p| p.1).sum::<f64>() / n, 161.5, epsilon = 0.05);
    // The frames themselves are shifted to the right and upwards, and larger.
    let circle = studio.circle();
    assert_abs_diff_eq!(circle.center.x, 241.5 + 0.03 * nominal, epsilon = 1e-6);
    assert_abs_diff_eq!(circle.center.y, 161.5 - 0.02 * nominal, epsilon = 1e-6);
    assert_abs_diff_eq!(circle.radius, 1.02 * nominal, epsilon = 1e-6);
}
