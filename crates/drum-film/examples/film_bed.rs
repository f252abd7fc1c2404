//! Films one analytic bed, clean and as a poor photograph:
//! `cargo run --release -p drum-film --example film_bed -- clean.png poor.png`.

use drum_film::{Bed, Film};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let clean = arguments.next().unwrap_or_else(|| "film_bed.png".into());
    let poor = arguments.next().unwrap_or_else(|| "film_bed_poor.png".into());

    let bed = Bed { fill: 0.35, aor_lin_deg: 32.0, s_shape_deg: 4.0, ..Bed::default() };
    let mut film = Film::default();
    let frame = film.bed_frame(&bed, 0)?;
    frame.image.save(&clean)?;
    let t = frame.truth;
    #[expect(clippy::print_stdout, reason = "an example speaks to its reader")]
    {
        println!("{clean}: whole {:.2} deg, middle {:.2} deg", t.aor_lin_deg, t.aor_mid_deg);
        println!("centre of area {:.2} % of R, {:.2} % of R", t.cen_x_pct, t.cen_y_pct);
    }

    film.set("exposure.seconds", 0.5)?;
    film.exposure.speed_rpm = 17.0;
    for (path, value) in [
        ("light.powder", 0.18),
        ("light.glare", 0.55),
        ("light.vignetting", 0.02),
        ("light.noise", 0.015),
        ("light.shot_noise", 0.02),
        ("light.gradient", 0.06),
        ("light.defocus_px", 1.2),
        ("camera.roll_deg", 1.0),
    ] {
        film.set(path, value)?;
    }
    film.bed_frame(&bed, 1)?.image.save(&poor)?;
    Ok(())
}
