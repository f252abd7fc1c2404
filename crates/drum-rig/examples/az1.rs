//! Configuration AZ1_Plexi of the thesis: 7807 glass beads of 6 mm in a drum of 250 x 150 mm.
//!
//! Arguments: speed (rpm), friction of beads with each other, with the mantle, threads, file for
//! positions (CSV: frame,x,y,z,radius in metres, drum axis z), checkpoint to resume from.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example shows its result")]

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use drum_rig::{Experiment, Flow, Options, rig_schema::Rig};

fn rig(speed: f64, pp: f64, mantle: f64) -> Result<Rig, drum_rig::Error> {
    let text = format!(
        r#"
name = "AZ1_Plexi"
drum = {{ radius_m = 0.125, length_m = 0.150, mantle = "plexiglas", end_plates = "plexiglas" }}
particles = {{ material = "glass", shape = {{ sphere = {{ diameter_m = 0.006 }} }} }}
fill.count = 7807
friction = {{ pp = {pp:?}, mantle = {mantle:?} }}
restitution = {{ pp = 0.90, mantle = 0.85 }}
rolling = {{ pp = 0.01, mantle = 0.01, end_plate = 0.01 }}
run = {{ speeds_rpm = [{speed:?}], time_step_s = 7e-5 }}
[materials]
glass = {{ density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e7 }}
plexiglas = {{ density_kg_m3 = 1190.0, poisson_ratio = 0.37, shear_modulus_pa = 1.7e6 }}
"#
    );
    Ok(Rig::parse("az1", &text)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default: f64| arguments.get(k).map_or(Ok(default), |a| a.parse());
    let (speed, pp, mantle) = (number(0, 17.0)?, number(1, 0.5)?, number(2, 0.6)?);
    let options = Options { threads: number(3, 1.0)? as usize, ..Options::default() };
    let rig = rig(speed, pp, mantle)?;
    let start = Instant::now();
    let mut drum = match arguments.get(5) {
        Some(file) => Experiment::resume(&rig, &options, &std::fs::read(file)?)?,
        None => Experiment::new(&rig, &options)?,
    };
    eprintln!("built and filled in {:.2} s", start.elapsed().as_secs_f64());
    let mut told = Instant::now();
    drum.run(|drum, p| {
        if told.elapsed() > Duration::from_secs(5) {
            told = Instant::now();
            eprintln!(
                "{:.0} s: {:?}, {:.3} s, {:.2} turns, {:.1} deg, {} frames, {} contacts",
                start.elapsed().as_secs_f64(),
                p.phase,
                p.time_s,
                p.turns,
                p.angle_deg,
                p.frames_done,
                drum.coordination().0
            );
        }
        Flow::Go
    })?;
    let wall = start.elapsed().as_secs_f64();
    let progress = drum.progress();
    let n = drum.grains().len() as f64;
    println!(
        "wall time {wall:.1} s, {} steps, {:.1} ns a particle-step",
        progress.steps,
        1e9 * wall / (progress.steps as f64 * n)
    );
    for s in drum.sampled() {
        let percent = |m: drum_rig::Mean| (m.mean / 0.00125, m.sd / 0.00125, m.error / 0.00125);
        println!(
            "{} rpm, Fr {:.4}, {}; steady after {:.3} s of turning, {:.2} turns",
            s.speed_rpm,
            s.froude,
            s.regime,
            s.steady_from_s - s.turned_from_s,
            s.revolutions
        );
        println!(
            "angle of the centre of mass {:.3} deg, sd {:.3}, error {:.3}",
            s.angle_deg.mean, s.angle_deg.sd, s.angle_deg.error
        );
        println!(
            "centre of mass x, y in % R (mean, sd, error): {:.3?} {:.3?}",
            percent(s.centre_of_mass[0]),
            percent(s.centre_of_mass[1])
        );
        println!(
            "torque {:.4} N m, sd {:.4}, error {:.4}; coordination {:.3}, walls {:.3}",
            s.torque.mean, s.torque.sd, s.torque.error, s.coordination.mean, s.wall_contacts.mean
        );
        if let Some(file) = arguments.get(4) {
            let mut csv = String::from("frame,x,y,z,radius\n");
            for (k, frame) in s.frames.iter().enumerate() {
                for b in frame.exposures.iter().flat_map(|e| e.balls(&s.grains)) {
                    let c = b.centre;
                    writeln!(csv, "{k},{:?},{:?},{:?},{:?}", c.x, c.y, c.z, b.radius)?;
                }
            }
            std::fs::write(file, csv)?;
        }
    }
    Ok(())
}
