//! Time to measure thirty photographs of 1936 x 1296 pixels (synthetic, JPEG), file to responses.
//!
//! `cargo run --release -p drum-vision --example speed -- FOLDER [chain]`
//!
//! Writes the frames into FOLDER when it holds none, then measures them. With `chain` the windows are those of the thesis
//! (median 40 pixels, Wiener 5) instead of the default's, as in `tests/oracles/speed.py`, which times the same
//! chain in scikit-image.

#![expect(clippy::print_stdout, reason = "an example reports to the terminal")]

use std::path::{Path, PathBuf};
use std::time::Instant;

use drum_film::{Bed, Camera, Film};
use drum_vision::{VisionConfig, decode::list_frames, image, measure_series};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let folder = PathBuf::from(args.next().ok_or("give a folder for the frames")?);
    let chain = args.next().is_some_and(|a| a == "chain");
    if list_frames(&folder).is_err() {
        film(&folder)?;
    }
    let paths = list_frames(&folder)?;
    let mut config = VisionConfig::default();
    if chain {
        config.bed.median_px = Some(40);
        config.bed.wiener_px = Some(5);
    }
    let start = Instant::now();
    let report = measure_series(&paths, &config, None, |_| {})?;
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{} frames in {seconds:.2} s, {:.1} ms a frame, {} threads, {} rejected",
        paths.len(),
        1e3 * seconds / paths.len() as f64,
        rayon::current_num_threads(),
        report.rejected.len()
    );
    if let Some(r) = report.responses {
        println!(
            "aor_lin {:.2} deg, aor_mid {:.2} deg, cen_x {:.2} %, cen_y {:.2} %",
            r.aor_lin_deg.mean, r.aor_mid_deg.mean, r.cen_x_pct.mean, r.cen_y_pct.mean
        );
    }
    Ok(())
}

fn film(folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all(folder)?;
    let mut film = Film { camera: Camera::default().with_size(1936, 1296), ..Film::default() };
    film.defocus.sigma_px = 1.0;
    film.noise.read = 0.01;
    for k in 0..30u64 {
        let bed =
            Bed { aor_lin_deg: 30.0 + 0.1 * (k % 7) as f64, s_shape_deg: 3.0, ..Bed::default() };
        let picture = film.bed_frame(&bed, k)?.image;
        let file = std::fs::File::create(folder.join(format!("frame_{k:02}.jpg")))?;
        image::codecs::jpeg::JpegEncoder::new_with_quality(file, 92).encode(
            picture.as_raw(),
            picture.width(),
            picture.height(),
            image::ExtendedColorType::Rgb8,
        )?;
    }
    Ok(())
}
