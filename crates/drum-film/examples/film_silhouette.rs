//! A strip of EDEM-like pictures with growing speed, and the reference circle that belongs to them:
//! `cargo run --release -p drum-film --example film_silhouette -- strip.png`.

use drum_film::{Bed, Camera, Drum, Film, strip};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "film_silhouette.png".into());
    let mut film = Film::silhouette(Drum::default(), [0.25, 0.35, 0.65], [0.94, 0.94, 0.95]);
    film.camera = Camera::default().with_size(484, 324);
    let studio = film.studio()?;
    let mut frames = vec![studio.reference_circle()?];
    for (aor_lin_deg, s_shape_deg) in [(25.0, 0.5), (32.0, 3.0), (40.0, 6.0)] {
        let bed = Bed { aor_lin_deg, s_shape_deg, extruded: true, ..Bed::default() };
        frames.push(studio.bed_frame(&bed, 0)?.image);
    }
    strip(&frames)?.save(path)?;
    Ok(())
}
