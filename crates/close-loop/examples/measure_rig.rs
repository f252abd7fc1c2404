//! What a rig would be measured as: `measure_rig RIG.toml CACHE SEED [PATH=VALUE...]` prints a
//! table of measured responses.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example shows its result")]

use std::path::Path;

use close_loop::campaign::{Laboratory, Resolution, Sampling};
use close_loop::rig_schema::Rig;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, cache, seed, rest @ ..] = arguments.as_slice() else {
        return Err("expected RIG.toml CACHE SEED [PATH=VALUE...]".into());
    };
    let mut rig = Rig::parse(file, &std::fs::read_to_string(file)?)?;
    for setting in rest {
        let (path, value) = setting.split_once('=').ok_or("expected PATH=VALUE")?;
        rig.settings.set(path, value.parse()?).map_err(|_| format!("{path} is refused"))?;
    }
    rig.run.seed = seed.parse()?;
    let resolution = Resolution { width_px: 484, ..Resolution::default() };
    let lab =
        Laboratory::open(Path::new(cache), 1, Sampling { resolution, ..Sampling::default() })?;
    let run = lab.run(&[rig], |_| ()).remove(0)?;
    eprintln!("{:.2} s, {} particles, {} steps", run.cost_s, run.particles, run.steps);
    println!(
        "omega_rpm,aor_lin_deg,aor_lin_sd,aor_mid_deg,aor_mid_sd,cen_x_pct,cen_x_sd,cen_y_pct,cen_y_sd,n_frames,n_eff,cov_lin_mid,cov_lin_x,cov_lin_y,cov_mid_x,cov_mid_y,cov_x_y"
    );
    for s in &run.speeds {
        let n = s.n_eff.iter().copied().fold(f64::INFINITY, f64::min);
        print!("{}", s.omega_rpm);
        for r in 0..4 {
            print!(",{:.4},{:.4}", s.mean[r], (s.covariance[r][r] * n).sqrt());
        }
        print!(",{},{n:.2}", s.n_frames);
        for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            print!(",{:.5}", s.covariance[a][b] * n);
        }
        println!();
    }
    Ok(())
}
