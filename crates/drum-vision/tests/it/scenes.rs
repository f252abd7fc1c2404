//! Synthetic frames over the whole range of beds, with known silhouettes; used by tests and by the accuracy example.

#![allow(
    dead_code,
    clippy::allow_attributes,
    reason = "shared by tests and the accuracy example, which use different parts"
)]

use drum_film::effects::Spot;
use drum_film::{Bed, Camera, Film, RaisedSide, Truth};
use drum_vision::{Context, Frame, VisionConfig, VisionError, measure_frame};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// One frame with what a perfect reader would measure.
pub(crate) struct Case {
    pub(crate) frame: Frame,
    pub(crate) truth: Truth,
    pub(crate) bed: Bed,
}

/// Draws bed number `index` of the range: 10 to 55 deg, fill 0.1 to 0.6, S-shape 0 to 8 deg.
///
/// Beds whose surface would leave the drum are drawn again.
pub(crate) fn draw_bed(rng: &mut ChaCha8Rng) -> Bed {
    loop {
        let bed = Bed {
            fill: rng.random_range(0.1..0.6),
            aor_lin_deg: rng.random_range(10.0..55.0),
            s_shape_deg: rng.random_range(0.0..8.0),
            curvature: rng.random_range(-0.15..0.15),
            raised: if rng.random_bool(0.5) { RaisedSide::Left } else { RaisedSide::Right },
            ..Bed::default()
        };
        if bed.shape().is_ok() {
            return bed;
        }
    }
}

pub(crate) fn to_frame(image: drum_film::image::RgbImage) -> Frame {
    let (w, h) = image.dimensions();
    Frame::from_rgb(w as usize, h as usize, image.into_raw()).unwrap()
}

/// Bed, camera and grain of a frame.
fn draw_scene(rng: &mut ChaCha8Rng, size: (u32, u32)) -> (Bed, Film) {
    let bed = draw_bed(rng);
    let mut film = Film { camera: Camera::default().with_size(size.0, size.1), ..Film::default() };
    film.camera.offset_x_pct = rng.random_range(-3.0..3.0);
    film.camera.offset_y_pct = rng.random_range(-3.0..3.0);
    film.texture.grain_radius_m = rng.random_range(0.0015..0.004);
    (bed, film)
}

/// A clean frame.
pub(crate) fn clean(index: u64, size: (u32, u32)) -> Case {
    let mut rng = ChaCha8Rng::seed_from_u64(index);
    rng.set_stream(1);
    let (bed, film) = draw_scene(&mut rng, size);
    let made = film.bed_frame(&bed, index).unwrap();
    Case { frame: to_frame(made.image), truth: made.truth, bed }
}

/// Errors and standard uncertainties of the four responses of one frame.
pub(crate) struct Outcome {
    pub(crate) error: [f64; 4],
    pub(crate) sd: [f64; 4],
    pub(crate) circle: [f64; 3],
    pub(crate) budget: drum_vision::uncertainty::Budget,
    pub(crate) radius_px: f64,
    pub(crate) warnings: Vec<String>,
    pub(crate) continued: f64,
    pub(crate) visible: f64,
    pub(crate) scatter_px: f64,
    pub(crate) edge_width_px: f64,
}

pub(crate) fn outcome(case: &Case, config: &VisionConfig) -> Result<Outcome, VisionError> {
    let m = measure_frame(&case.frame, config, Context::default())?;
    let t = &case.truth;
    let truth = [t.aor_lin_deg, t.aor_mid_deg, t.cen_x_pct, t.cen_y_pct];
    let four = m.four();
    let c = m.drum.fit.circle;
    Ok(Outcome {
        error: std::array::from_fn(|k| four[k].value - truth[k]),
        sd: std::array::from_fn(|k| four[k].sd),
        circle: [c.x_px - t.center_x_px, c.y_px - t.center_y_px, c.radius_px - t.radius_px],
        budget: m.budget,
        radius_px: c.radius_px,
        warnings: m.warnings.iter().map(ToString::to_string).collect(),
        continued: m.continued,
        visible: m.visible,
        scatter_px: m.scatter_px,
        edge_width_px: m.edge_width_px,
    })
}

/// Quantile by linear interpolation.
pub(crate) fn quantile(values: &[f64], p: f64) -> f64 {
    drum_vision::statistics::quantile(values, p).unwrap_or(f64::NAN)
}

/// A frame with glare, powder, defocus, motion, noise and a vignetting of 2 %.
pub(crate) fn degraded(index: u64, size: (u32, u32)) -> Case {
    let mut rng = ChaCha8Rng::seed_from_u64(index);
    rng.set_stream(1);
    let (bed, mut film) = draw_scene(&mut rng, size);
    rng.set_stream(2);
    film.glare.strength = rng.random_range(0.2..0.8);
    film.glare.spots = (0..rng.random_range(1..5))
        .map(|_| {
            let (r, a) = (
                rng.random_range(0.0f64..1.0).sqrt(),
                rng.random_range(0.0..std::f64::consts::TAU),
            );
            Spot {
                x: r * a.cos(),
                y: r * a.sin(),
                length: rng.random_range(0.03..0.12),
                width: rng.random_range(0.02..0.05),
                angle_deg: rng.random_range(0.0..180.0),
                weight: rng.random_range(0.4..1.2),
            }
        })
        .collect();
    film.powder.opacity = rng.random_range(0.05..0.35);
    film.powder.seed = index;
    film.defocus.sigma_px = rng.random_range(0.5..1.8) * f64::from(size.0) / 484.0;
    film.exposure.seconds = rng.random_range(0.05..1.0);
    film.exposure.speed_rpm = rng.random_range(2.0..20.0);
    film.noise.read = rng.random_range(0.005..0.03);
    film.noise.shot = 0.03;
    film.noise.seed = index;
    film.vignetting.corner_loss = 0.02;
    let made = film.bed_frame(&bed, index).unwrap();
    Case { frame: to_frame(made.image), truth: made.truth, bed }
}
