//! Synthetic frames over the whole range of beds, with known silhouettes; used by tests and by the accuracy example.

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

/// A clean frame.
pub(crate) fn clean(index: u64, size: (u32, u32)) -> Case {
    let mut rng = ChaCha8Rng::seed_from_u64(index);
    rng.set_stream(1);
    let bed = draw_bed(&mut rng);
    let mut film = Film { camera: Camera::default().with_size(size.0, size.1), ..Film::default() };
    film.camera.offset_x_pct = rng.random_range(-3.0..3.0);
    film.camera.offset_y_pct = rng.random_range(-3.0..3.0);
    film.texture.grain_radius_m = rng.random_range(0.0015..0.004);
    let made = film.bed_frame(&bed, index).unwrap();
    Case { frame: to_frame(made.image), truth: made.truth, bed }
}

/// Errors and standard uncertainties of the four responses of one frame.
pub(crate) struct Outcome {
    pub(crate) error: [f64; 4],
    pub(crate) sd: [f64; 4],
    pub(crate) circle: [f64; 3],
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
    })
}

/// Quantile by linear interpolation.
pub(crate) fn quantile(values: &[f64], p: f64) -> f64 {
    drum_vision::statistics::quantile(values, p).unwrap_or(f64::NAN)
}

/// How strongly a frame is degraded.
pub(crate) struct Defects {
    /// Number of glare spots.
    pub(crate) spots: u32,
    /// Brightness that powder adds next to the bed, grey levels.
    pub(crate) powder: f64,
    /// Standard deviation of the blur, pixels at a width of 484.
    pub(crate) blur_px: f64,
    /// Standard deviation of the noise, grey levels.
    pub(crate) noise: f64,
    /// Loss of light in the corners.
    pub(crate) vignetting: f64,
}

impl Defects {
    pub(crate) fn draw(rng: &mut ChaCha8Rng) -> Self {
        Self {
            spots: rng.random_range(1..5),
            powder: rng.random_range(10.0..50.0),
            blur_px: rng.random_range(0.5..1.8),
            noise: rng.random_range(2.0..8.0),
            vignetting: 0.02,
        }
    }
}

/// A frame with glare, powder, blur, noise and vignetting.
pub(crate) fn degraded(index: u64, size: (u32, u32)) -> Case {
    let mut case = clean(index, size);
    let mut rng = ChaCha8Rng::seed_from_u64(index);
    rng.set_stream(2);
    let defects = Defects::draw(&mut rng);
    case.frame = degrade(&case, &defects, &mut rng);
    case
}

fn degrade(case: &Case, defects: &Defects, rng: &mut ChaCha8Rng) -> Frame {
    let (w, h) = (case.frame.width(), case.frame.height());
    let t = &case.truth;
    let r = t.radius_px;
    let mut light: Vec<[f64; 3]> =
        case.frame.rgb().chunks(3).map(|p| [p[0].into(), p[1].into(), p[2].into()]).collect();
    // Powder clings to the front plate, mostly next to the surface, in smooth patches.
    let waves: Vec<[f64; 4]> = (0..6)
        .map(|_| {
            [
                rng.random_range(-6.0..6.0),
                rng.random_range(-6.0..6.0),
                rng.random_range(0.0..std::f64::consts::TAU),
                rng.random_range(0.3..1.0),
            ]
        })
        .collect();
    let [x0, y0] = t.lower_end_px;
    let [x1, y1] = t.upper_end_px;
    let length = (x1 - x0).hypot(y1 - y0);
    // Spots: centre, half axes, direction, brightness.
    let spots: Vec<[f64; 6]> = (0..defects.spots)
        .map(|_| {
            let (q, a) = (rng.random_range(0.0f64..0.9), rng.random_range(0.0..std::f64::consts::TAU));
            let radius = r * q.sqrt();
            [
                t.center_x_px + radius * a.cos(),
                t.center_y_px + radius * a.sin(),
                r * rng.random_range(0.02..0.07),
                r * rng.random_range(0.02..0.15),
                rng.random_range(0.0..3.2),
                rng.random_range(60.0..260.0),
            ]
        })
        .collect();
    for y in 0..h {
        for x in 0..w {
            let p = &mut light[y * w + x];
            let (px, py) = (x as f64, y as f64);
            let (dx, dy) = ((px - t.center_x_px) / r, (py - t.center_y_px) / r);
            let mut add = 0.0;
            if dx.hypot(dy) < 1.0 {
                let above = (((py - y0) * (x1 - x0) - (px - x0) * (y1 - y0)) / length).abs() / r;
                let patch: f64 = waves.iter().map(|v| v[3] * (v[0] * dx + v[1] * dy + v[2]).sin()).sum();
                add += defects.powder * (-above / 0.35).exp() * (0.6 + 0.2 * patch).max(0.0);
            }
            for s in &spots {
                let (c, q) = (s[4].cos(), s[4].sin());
                let (ex, ey) = (px - s[0], py - s[1]);
                let d2 = ((ex * c + ey * q) / s[2]).powi(2) + ((ey * c - ex * q) / s[3]).powi(2);
                add += s[5] * (-0.5 * d2 * d2).exp();
            }
            let (cx, cy) = (px / w as f64 - 0.5, py / h as f64 - 0.5);
            let fall = 1.0 - defects.vignetting * 2.0 * (cx * cx + cy * cy);
            for v in p.iter_mut() {
                *v = (*v + add).min(400.0) * fall;
            }
        }
    }
    blur(&mut light, w, h, defects.blur_px * w as f64 / 484.0);
    let normal = rand_distr::Normal::new(0.0, defects.noise).unwrap();
    let rgb = light
        .iter()
        .flat_map(|p| p.map(|v| v))
        .map(|v| (v + rng.sample(normal) + 0.5).clamp(0.0, 255.0) as u8)
        .collect();
    Frame::from_rgb(w, h, rgb).unwrap()
}

fn blur(light: &mut [[f64; 3]], w: usize, h: usize, sd: f64) {
    let reach = (3.0 * sd).ceil() as isize;
    let kernel: Vec<f64> = (-reach..=reach).map(|k| (-0.5 * (k as f64 / sd).powi(2)).exp()).collect();
    let sum: f64 = kernel.iter().sum();
    for across in [true, false] {
        let old = light.to_vec();
        for y in 0..h {
            for x in 0..w {
                let mut v = [0.0; 3];
                for (k, weight) in (-reach..=reach).zip(&kernel) {
                    let (xx, yy) = if across {
                        ((x as isize + k).clamp(0, w as isize - 1) as usize, y)
                    } else {
                        (x, (y as isize + k).clamp(0, h as isize - 1) as usize)
                    };
                    for c in 0..3 {
                        v[c] += weight / sum * old[yy * w + xx][c];
                    }
                }
                light[y * w + x] = v;
            }
        }
    }
}
