//! A powdery frame, its region page, and the measurement with the side-car that a person saved.
//!
//! `region page FOLDER` writes `powder.png`, `powder.html` and `truth.json` (what was drawn, and what the
//! crate says without help); `region measure FOLDER SIDECAR` measures with the side-car and prints the errors.
//! Used by `tests/browser/region_picker.py`.

#![expect(clippy::print_stdout, reason = "an example reports to the terminal")]

use std::path::Path;

use drum_film::{Bed, BedFrame, Camera, Film};
use drum_vision::{Context, Frame, RegionSidecar, VisionConfig, measure_frame, overlay, roi_page};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let bed = Bed { fill: 0.35, aor_lin_deg: 33.0, s_shape_deg: 3.0, ..Bed::default() };
    let made = powdery().bed_frame(&bed, 5)?;
    let frame = to_frame(&made)?;
    let config = VisionConfig::default();
    match args[..] {
        ["page", folder] => {
            let folder = Path::new(folder);
            std::fs::create_dir_all(folder)?;
            overlay::write_png(&frame, &folder.join("powder.png"))?;
            std::fs::write(folder.join("powder.html"), roi_page(&frame, "powder.png")?)?;
            let plain = match measure_frame(&frame, &config, Context::default()) {
                Ok(m) => format!("measured aor_lin {:.2}", m.aor_lin_deg().value),
                Err(e) => format!("{}: {e}", e.stage()),
            };
            println!("without side-car: {plain}");
            let t = made.truth;
            // Along the surface as the eye sees it, then round the bottom outside of the drum.
            let shape = bed.shape()?;
            let corners: Vec<[f64; 2]> = (0..=10)
                .map(|k| shape.point(2.0 * f64::from(k) / 10.0 - 1.0))
                .map(|p| [t.center_x_px + t.radius_px * p.x, t.center_y_px - t.radius_px * p.y])
                .chain([
                    [t.center_x_px + 1.1 * t.radius_px, t.center_y_px + 1.1 * t.radius_px],
                    [t.center_x_px - 1.1 * t.radius_px, t.center_y_px + 1.1 * t.radius_px],
                ])
                .collect();
            let truth = serde_json::json!({
                "aor_lin_deg": t.aor_lin_deg, "aor_mid_deg": t.aor_mid_deg, "corners": corners,
            });
            std::fs::write(folder.join("truth.json"), truth.to_string())?;
        }
        ["measure", folder, sidecar] => {
            let region = RegionSidecar::from_file(Path::new(sidecar))?;
            let context = Context { reference: None, region: Some(&region) };
            let m = measure_frame(&frame, &config, context)?;
            overlay::write_png(
                &overlay::overlay(&frame, &m),
                &Path::new(folder).join("powder_overlay.png"),
            )?;
            let (lin, mid) = (m.aor_lin_deg(), m.aor_mid_deg());
            println!(
                "with side-car: aor_lin {:.2} +- {:.2} (drawn {:.2}), aor_mid {:.2} +- {:.2} (drawn {:.2})",
                lin.value,
                lin.sd,
                made.truth.aor_lin_deg,
                mid.value,
                mid.sd,
                made.truth.aor_mid_deg
            );
        }
        _ => return Err("say `page FOLDER` or `measure FOLDER SIDECAR`".into()),
    }
    Ok(())
}

fn powdery() -> Film {
    let mut film = Film { camera: Camera::default().with_size(968, 648), ..Film::default() };
    film.powder.opacity = 0.8;
    film.powder.variation = 0.9;
    film.powder.patch = 0.3;
    film.noise.read = 0.015;
    film.defocus.sigma_px = 1.0;
    film
}

fn to_frame(made: &BedFrame) -> Result<Frame, Box<dyn std::error::Error>> {
    let (w, h) = made.image.dimensions();
    Frame::from_rgb(w as usize, h as usize, made.image.as_raw().clone())
        .ok_or_else(|| "the picture has another size than it says".into())
}
