//! Spheres: outlines, occlusion, seams, and the same bits for any number of threads.

use approx::{assert_abs_diff_eq, assert_relative_eq};
use drum_film::glam::DVec3;
use drum_film::spheres::between;
use drum_film::{Camera, Error, Film, Projection, Scene, Sphere};
use std::f64::consts::PI;

fn film(camera: Camera) -> Film {
    Film { camera: camera.with_size(484, 324), edge_samples: 8, ..Film::default() }
}

fn centroid_of_coverage(film: &Film, spheres: &[Sphere]) -> (f64, [f64; 2]) {
    let studio = film.studio().expect("the film is valid");
    let coverage = studio.sphere_coverage(spheres).expect("the spheres lie in the drum");
    (coverage.area_px2(), coverage.centroid_px().expect("something is covered"))
}

/// Outline of a sphere seen through a pinhole: an ellipse of half axes `b = f r / sqrt(z^2 - r^2)` across the line from the
/// picture's middle and `a = f r sqrt(d^2 - r^2) / (z^2 - r^2)` along it, d being the distance and z the depth of the centre
/// (the cone of tangents cut by the picture plane).
fn ellipse(f: f64, c: DVec3, r: f64) -> (f64, f64) {
    let below = c.z * c.z - r * r;
    (f * r * (c.length_squared() - r * r).sqrt() / below, f * r / below.sqrt())
}

#[test]
fn a_sphere_beside_the_axis_covers_its_ellipse() {
    for camera in
        [Camera::default(), Camera { roll_deg: 20.0, pitch_deg: 8.0, ..Camera::default() }]
    {
        let film = film(camera);
        let view = *film.studio().unwrap().view();
        // Large and far aside, so that ellipse and circle differ by percents.
        let sphere = Sphere::new(DVec3::new(0.16, 0.08, 0.03), 0.05);
        let c = view.to_camera(sphere.center);
        let (a, b) = ellipse(view.principal_px, c, 0.05);
        let (area, [u, v]) = centroid_of_coverage(&film, &[sphere]);
        // 8 x 8 points a pixel on some 500 edge pixels: sd 0.3/8 px each, 1 px^2 in all of 9000; the bound is 3 sd.
        assert_relative_eq!(area, PI * a * b, max_relative = 4e-4);
        // The ellipse's centre lies on the ray through f x z / (z^2 - r^2).
        let k = view.principal_px * c.z / (c.z * c.z - 0.05_f64.powi(2));
        assert_abs_diff_eq!(u, view.center_px.x + k * c.x, epsilon = 0.02);
        assert_abs_diff_eq!(v, view.center_px.y - k * c.y, epsilon = 0.02);
    }
}

#[test]
fn parallel_rays_show_a_circle_of_the_sphere_s_radius_at_any_depth() {
    let film = film(Camera { projection: Projection::Orthographic, ..Camera::default() });
    let r = film.studio().unwrap().view().radius_px(0.04);
    for z in [-0.07, 0.0, 0.07] {
        let (area, [u, v]) =
            centroid_of_coverage(&film, &[Sphere::new(DVec3::new(0.05, 0.02, z), 0.04)]);
        assert_relative_eq!(area, PI * r * r, max_relative = 4e-4);
        assert_abs_diff_eq!(u, 241.5 + r * 1.25, epsilon = 0.02);
        assert_abs_diff_eq!(v, 161.5 - r * 0.5, epsilon = 0.02);
    }
}

fn flat() -> Film {
    let mut film = Film::silhouette(Scene::default().drum, [1.0, 1.0, 1.0], [0.0; 3]);
    film.camera = Camera::default().with_size(484, 324);
    film
}

fn colored(center: DVec3, radius_m: f64, color: [f32; 3]) -> Sphere {
    Sphere { color: Some(color), ..Sphere::new(center, radius_m) }
}

#[test]
fn the_nearer_sphere_hides_the_farther_whatever_their_order() {
    let near = colored(DVec3::new(0.0, 0.0, 0.05), 0.01, [1.0, 0.0, 0.0]);
    let far = colored(DVec3::new(0.0, 0.0, -0.05), 0.02, [0.0, 1.0, 0.0]);
    for spheres in [[near, far], [far, near]] {
        let image = flat().sphere_frame(&spheres, 0).unwrap().image;
        assert_eq!(image.get_pixel(241, 161).0, [255, 0, 0]);
        // Beside the small one the large one shows: 0.013 m at 112 px a drum radius of 0.125 m.
        assert_eq!(image.get_pixel(241 + 13, 161).0, [0, 255, 0]);
        assert_eq!(image.get_pixel(241 + 30, 161).0, [0, 0, 0]);
    }
}

#[test]
fn overlapping_spheres_meet_in_the_plane_of_their_common_circle() {
    // Equal spheres left and right of x = 0 at equal depth: the seam is the column of x = 0, seen straight on.
    let left = colored(DVec3::new(-0.01, 0.0, 0.0), 0.03, [1.0, 0.0, 0.0]);
    let right = colored(DVec3::new(0.01, 0.0, 0.0), 0.03, [0.0, 0.0, 1.0]);
    let image = flat().sphere_frame(&[left, right], 0).unwrap().image;
    for v in 150..=172 {
        assert_eq!(image.get_pixel(241, v).0, [255, 0, 0], "row {v}");
        assert_eq!(image.get_pixel(242, v).0, [0, 0, 255], "row {v}");
    }
}

#[test]
fn ring_and_hub_lie_before_the_beads() {
    let film = film(Camera::default());
    let empty = film.studio().unwrap().empty_frame(0);
    // A wall of beads just behind the front plate, reaching beyond the ring.
    let wall = Sphere::new(DVec3::new(0.0, 0.0, -2.0), 2.07);
    let image = film.sphere_frame(&[wall], 0).unwrap().image;
    let r = film.studio().unwrap().circle().radius;
    let ring = (241.5 + r * 1.02) as u32;
    assert_eq!(image.get_pixel(ring, 161), empty.get_pixel(ring, 161));
    assert_eq!(image.get_pixel(241, 161), empty.get_pixel(241, 161));
    assert_ne!(image.get_pixel(280, 161), empty.get_pixel(280, 161));
}

pub(crate) fn heap() -> Vec<Sphere> {
    let mut spheres = Vec::new();
    for k in 0..12 {
        for j in 0..14 {
            for i in 0..24 {
                let stray = (f64::from(i * 7 + j * 13 + k * 29)).sin();
                let center = DVec3::new(
                    0.0085 * f64::from(i) - 0.1 + 0.001 * stray,
                    0.0065 * f64::from(j) - 0.1,
                    0.07 - 0.012 * f64::from(k),
                );
                let body = spheres.len() as u32;
                spheres.push(Sphere { body, ..Sphere::new(center, 0.005 + 0.0005 * stray) });
            }
        }
    }
    spheres
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let mut film = film(Camera::default());
    film.noise.read = 0.02;
    film.powder.opacity = 0.2;
    film.defocus.sigma_px = 0.8;
    film.exposure = drum_film::effects::Exposure {
        seconds: 0.5,
        speed_rpm: 17.0,
        sub_frames: 3,
        ..Default::default()
    };
    let spheres = heap();
    let bed = drum_film::Bed { extruded: true, ..Default::default() };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let studio = film.studio().unwrap();
            let frame = studio.sphere_frame(&spheres, 3).unwrap();
            (frame.image, studio.bed_frame(&bed, 3).unwrap().image)
        })
    };
    let one = with(1);
    for threads in [2, 3, 7] {
        assert!(one == with(threads), "{threads} threads");
    }
}

#[test]
fn the_order_of_the_rows_does_not_change_the_picture() {
    let film = film(Camera::default());
    let mut spheres = heap();
    let first = film.sphere_frame(&spheres, 0).unwrap();
    spheres.reverse();
    assert!(first == film.sphere_frame(&spheres, 0).unwrap());
}

#[test]
fn an_exposure_of_a_still_scene_changes_nothing() {
    let film = film(Camera::default());
    let studio = film.studio().unwrap();
    let spheres = heap();
    let still = studio.sphere_frame(&spheres, 0).unwrap();
    for moments in [1, 3, 7] {
        let exposed = studio.exposed_frame(vec![&spheres; moments], 0).unwrap();
        assert!(exposed == still, "{moments} moments");
    }
    let none: [&[Sphere]; 0] = [];
    assert!(matches!(studio.exposed_frame(none, 0), Err(Error::NoFrame { .. })));
}

#[test]
fn an_exposure_spreads_a_moving_sphere_along_its_path() {
    let film = flat();
    let studio = film.studio().unwrap();
    let at = |x: f64| vec![Sphere::new(DVec3::new(x, 0.0, 0.0), 0.01)];
    // 64 moments over 8 cm: light at a place is the share of time that the sphere spends there.
    let moments = between(&at(-0.04), &at(0.04), 64).unwrap();
    let image = studio.exposed_frame(&moments, 0).unwrap().image;
    let middle = f64::from(image.get_pixel(241, 161).0[0]) / 255.0;
    // 2 cm of 8 cm; two of 64 moments more or less.
    assert_abs_diff_eq!(middle, 0.25, epsilon = 2.0 / 64.0);
    assert!(between(&at(0.0), &[], 3).is_err());
}

#[test]
fn a_sphere_smaller_than_a_pixel_keeps_its_light() {
    let film = film(Camera::default());
    let view = *film.studio().unwrap().view();
    // 0.4 px radius, 20 of them at different places within the pixel.
    let r = 0.4 * 0.8 / view.principal_px;
    let spheres: Vec<Sphere> = (0..20)
        .map(|i| Sphere::new(DVec3::new(0.0051 * f64::from(i), 0.0037 * f64::from(i), 0.075), r))
        .collect();
    let (area, _) = centroid_of_coverage(&film, &spheres);
    // Counting points of a lattice of 1/8 px in a circle of 0.4 px: 32 +- 2 points each, less over 20.
    assert_relative_eq!(area, 20.0 * PI * 0.16, max_relative = 0.04);
}

#[test]
fn what_cannot_be_drawn_is_named_by_its_place() {
    let film = film(Camera::default());
    let good = Sphere::new(DVec3::ZERO, 0.01);
    let nan = Sphere::new(DVec3::new(0.0, f64::NAN, 0.0), 0.01);
    assert!(matches!(film.sphere_frame(&[good, nan], 0), Err(Error::BadSphere { index: 1, .. })));
    let flat = Sphere::new(DVec3::ZERO, 0.0);
    assert!(matches!(film.sphere_frame(&[flat], 0), Err(Error::BadSphere { index: 0, .. })));
    let close = Sphere::new(DVec3::new(0.0, 0.0, 0.87), 0.01);
    assert!(matches!(film.sphere_frame(&[close], 0), Err(Error::SphereAtCamera { index: 0, .. })));
    assert!(film.sphere_frame(&[], 0).unwrap().image == film.studio().unwrap().empty_frame(0));
}
