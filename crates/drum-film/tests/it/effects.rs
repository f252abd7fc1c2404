//! Effects: each does what its numbers say, and nothing when they are zero.

use approx::assert_abs_diff_eq;
use drum_film::effects::{Defocus, Exposure, Noise, Powder, Vignetting};
use drum_film::glam::DVec2;
use drum_film::image::RgbImage;
use drum_film::{Bed, Camera, Drum, Film, Light, Ring};

/// A film of a grey nothing, on which an effect stands alone.
fn grey(level: f32) -> Film {
    let mut film = Film::silhouette(Drum::default(), [level; 3], [level; 3]);
    film.camera = Camera::default().with_size(484, 324);
    film
}

fn empty(film: &Film, index: u64) -> RgbImage {
    film.studio().expect("the film is valid").empty_frame(index)
}

fn mean_and_sd(image: &RgbImage) -> (f64, f64) {
    let n = image.as_raw().len() as f64;
    let mean = image.as_raw().iter().map(|v| f64::from(*v)).sum::<f64>() / n;
    let var = image.as_raw().iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / n;
    (mean, var.sqrt())
}

#[test]
fn noise_has_the_stated_standard_deviation() {
    for (read, shot, level) in [(0.02, 0.0, 0.5), (0.01, 0.03, 0.5), (0.0, 0.04, 0.25)] {
        let mut film = grey(level as f32);
        film.noise = Noise { read, shot, seed: 5 };
        let (mean, sd) = mean_and_sd(&empty(&film, 0));
        // Rounding to whole levels adds the variance 1/12.
        let expected =
            (255.0_f64.powi(2) * (read * read + shot * shot * level) + 1.0 / 12.0).sqrt();
        // 470448 values: relative sd of an sd is 1/sqrt(2 n) = 0.1 %; the bound is 4 of them.
        assert_abs_diff_eq!(sd / expected, 1.0, epsilon = 0.004);
        assert_abs_diff_eq!(mean, 255.0 * level, epsilon = 0.05);
    }
}

#[test]
fn noise_of_two_frames_is_independent_and_that_of_one_frame_repeats() {
    let mut film = grey(0.5);
    film.noise.read = 0.03;
    let (a, b) = (empty(&film, 1), empty(&film, 2));
    assert!(a == empty(&film, 1));
    let n = a.as_raw().len() as f64;
    let product = |p: &RgbImage, q: &RgbImage| {
        p.as_raw()
            .iter()
            .zip(q.as_raw())
            .map(|(p, q)| (f64::from(*p) - 127.5) * (f64::from(*q) - 127.5))
            .sum::<f64>()
            / n
    };
    // Correlation of n independent pairs: sd 1/sqrt(n) = 0.0015; the bound is 4 of them.
    assert!((product(&a, &b) / product(&a, &a)).abs() < 0.006);
}

#[test]
fn vignetting_takes_its_share_in_the_corner_and_nothing_in_the_middle() {
    let mut film = grey(0.8);
    film.vignetting = Vignetting { corner_loss: 0.25 };
    let image = empty(&film, 0);
    assert_eq!(image.get_pixel(241, 161).0[0], 204);
    for (u, v) in [(0, 0), (483, 0), (0, 323), (483, 323)] {
        assert_eq!(image.get_pixel(u, v).0[0], 153);
    }
}

#[test]
fn defocus_makes_an_edge_the_normal_distribution_of_its_width() {
    let mut film = grey(0.0);
    film.scene.rear_wall = [1.0; 3];
    film.scene.tube = [1.0; 3];
    film.camera.distance_m = 0.62;
    film.defocus = Defocus { sigma_px: 3.0 };
    let studio = film.studio().unwrap();
    let image = studio.empty_frame(0);
    let edge = studio.circle().center.y - studio.circle().radius;
    // Light at 1 sigma inside, at the edge, 1 sigma outside: 0.841, 0.5, 0.159; the circle of 145 px is straight enough
    // (sagitta 9 px^2 / 145 px / 2 = 0.03 px), pixels of 1/3 sigma are interpolated.
    let light = |y: f64| {
        let at = |v: u32| f64::from(image.get_pixel(241, v).0[0]) / 255.0;
        let v = y.floor();
        at(v as u32) + (y - v) * (at(v as u32 + 1) - at(v as u32))
    };
    assert!(edge > 12.0, "the edge must lie inside the picture: {edge}");
    for (sigmas, expected) in [(1.0, 0.8413), (0.0, 0.5), (-1.0, 0.1587)] {
        assert_abs_diff_eq!(light(edge + 3.0 * sigmas), expected, epsilon = 0.015);
    }
}

#[test]
fn powder_mixes_its_colour_in_by_its_opacity() {
    let mut film = grey(0.1);
    film.powder = Powder { opacity: 0.3, variation: 0.0, color: [0.7; 3], ..Powder::default() };
    let image = empty(&film, 0);
    // 0.1 + 0.3 (0.7 - 0.1) = 0.28 inside, 0.1 outside.
    assert_eq!(image.get_pixel(241, 161).0[0], 71);
    assert_eq!(image.get_pixel(2, 2).0[0], 26);
}

#[test]
fn uneven_powder_keeps_its_mean_opacity() {
    let powder = Powder { opacity: 0.3, variation: 0.6, patch: 0.05, ..Powder::default() };
    let (mut sum, mut sum2, n) = (0.0, 0.0, 200);
    for i in 0..n * n {
        let p = DVec2::new(f64::from(i % n), f64::from(i / n)) / f64::from(n) * 2.0 - 1.0;
        let a = powder.opacity_at(p);
        sum += a;
        sum2 += a * a;
    }
    let mean = sum / f64::from(n * n);
    let sd = (sum2 / f64::from(n * n) - mean * mean).sqrt();
    // 1600 patches of relative sd 0.25: 0.6 % of the mean; the bound is 5 of them.
    assert_abs_diff_eq!(mean, 0.3, epsilon = 0.01);
    assert!((0.03..0.12).contains(&sd), "{sd}");
}

#[test]
fn glare_stands_where_its_spot_is() {
    let mut film = grey(0.2);
    film.glare.strength = 0.5;
    film.glare.spots.truncate(1);
    film.glare.spots[0].weight = 1.0;
    (film.glare.spots[0].x, film.glare.spots[0].y) = (0.4, 0.3);
    let image = empty(&film, 0);
    let r = film.studio().unwrap().circle().radius;
    let (u, v) = ((241.5 + 0.4 * r).round() as u32, (161.5 - 0.3 * r).round() as u32);
    // Half a pixel of a spot of 4.5 px across: exp(-0.5 (0.7/4.5)^2) = 0.99.
    assert!(image.get_pixel(u, v).0[0] >= (0.69 * 255.0) as u8);
    assert_eq!(image.get_pixel(140, 161).0[0], 51);
}

#[test]
fn a_gradient_changes_the_light_by_its_share_over_a_radius() {
    let mut film = grey(0.5);
    film.light.gradient = 0.2;
    film.light.gradient_deg = 0.0;
    let image = empty(&film, 0);
    let r = film.studio().unwrap().circle().radius;
    let at = |u: f64| f64::from(image.get_pixel(u.round() as u32, 10).0[0]) / 127.5;
    // One level of 128, and half a pixel of 112.
    assert_abs_diff_eq!(at(241.5 + r), 1.2, epsilon = 0.01);
    assert_abs_diff_eq!(at(241.5 - r), 0.8, epsilon = 0.01);
}

#[test]
fn effects_change_nothing_at_their_defaults() {
    let mut film = Film { camera: Camera::default().with_size(242, 162), ..Film::default() };
    let bed = Bed::default();
    let clean = film.bed_frame(&bed, 4).unwrap();
    film.noise.seed = 99;
    film.powder.seed = 99;
    film.exposure.seconds = 1.0;
    film.glare.spots.clear();
    // An exposure of a drum that stands still leaves the beads where they are.
    assert!(clean == film.bed_frame(&bed, 4).unwrap());
}

#[test]
fn a_turning_drum_smears_the_beads_but_not_the_outline() {
    let mut film = Film { camera: Camera::default().with_size(484, 324), ..Film::default() };
    film.scene.hub.visible = false;
    let bed = Bed { fill: 0.5, ..Bed::default() };
    let sharp = film.bed_frame(&bed, 0).unwrap();
    film.exposure =
        Exposure { seconds: 1.0, speed_rpm: 17.0, sub_frames: 24, ..Exposure::default() };
    let smeared = film.bed_frame(&bed, 0).unwrap();
    assert_eq!(sharp.truth, smeared.truth);
    // A patch well inside the bed: its contrast goes down.
    let contrast = |image: &RgbImage| {
        let patch = drum_film::image::imageops::crop_imm(image, 260, 200, 40, 40).to_image();
        mean_and_sd(&patch)
    };
    let ((mean_a, sd_a), (mean_b, sd_b)) = (contrast(&sharp.image), contrast(&smeared.image));
    assert!(sd_b < 0.6 * sd_a, "{sd_a} {sd_b}");
    // The mean light stays: beads of 7 % spread, 100 of them in the patch.
    assert_abs_diff_eq!(mean_a / mean_b, 1.0, epsilon = 0.05);
    // Outside the bed nothing changes.
    assert_eq!(sharp.image.get_pixel(200, 100), smeared.image.get_pixel(200, 100));
}

#[test]
fn a_ring_in_front_of_the_plate_looks_larger() {
    let mut film = Film { camera: Camera::default().with_size(484, 324), ..Film::default() };
    let nominal = film.studio().unwrap().circle().radius;
    film.scene.ring = Ring { standoff_m: 0.003, ..Ring::default() };
    let circle = film.studio().unwrap().circle();
    assert_abs_diff_eq!(circle.radius / nominal, 0.8 / 0.797, epsilon = 1e-9);
    // The bed, which lies behind it, then looks smaller against it.
    let bed = Bed::default();
    let truth = film.bed_frame(&bed, 0).unwrap().truth;
    assert_abs_diff_eq!(truth.fill, bed.fill * (0.797_f64 / 0.8).powi(2), epsilon = 1e-6);
}

#[test]
fn marks_cover_their_share_of_the_ring() {
    let mut film = Film { camera: Camera::default(), light: Light::flat(), ..Film::default() };
    film.scene.ring = Ring { marks: 24, marks_share: 0.6, ..Ring::default() };
    let red = |film: &Film| {
        empty(film, 0).pixels().filter(|p| p.0[0] > 150 && p.0[1] < 60).count() as f64
    };
    let marks = red(&film);
    film.scene.ring.marks = 0;
    // Pixels at 48 ends of 18 px each, half of them lost: 2 % of 30000.
    assert_abs_diff_eq!(marks / red(&film), 0.6, epsilon = 0.02);
}
