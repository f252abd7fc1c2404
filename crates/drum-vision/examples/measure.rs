//! Measures the frames named on the command line and writes an overlay of each beside the working folder.

#![expect(clippy::print_stdout, reason = "an example reports to the terminal")]

use std::path::{Path, PathBuf};

use drum_vision::{Context, VisionConfig, decode, measure_frame, overlay};

fn main() {
    let config = VisionConfig::default();
    let out = std::env::var_os("OUT").map(PathBuf::from);
    for name in std::env::args().skip(1) {
        let path = Path::new(&name);
        let result = decode::decode_file(path, &config.decode)
            .and_then(|f| measure_frame(&f, &config, Context::default()).map(|m| (f, m)));
        match result {
            Err(e) => println!("{name}: {}: {e}", e.stage()),
            Ok((frame, m)) => {
                let [a, b, c, d] = m.four();
                println!(
                    "{name}: aor_lin {:.2} +- {:.2} deg, aor_mid {:.2} +- {:.2} deg, cen_x {:.2} +- {:.2} %, cen_y {:.2} +- {:.2} %, fill {:.3}",
                    a.value,
                    a.sd,
                    b.value,
                    b.sd,
                    c.value,
                    c.sd,
                    d.value,
                    d.sd,
                    m.fill().value
                );
                println!("  drum {:?} {:?}", m.drum.origin, m.drum.fit);
                println!(
                    "  visible {:.2} scatter {:.2} px edge width {:.2} px",
                    m.visible, m.scatter_px, m.edge_width_px
                );
                for w in &m.warnings {
                    println!("  warning: {w}");
                }
                if let Some(dir) = &out {
                    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                    let target = dir.join(format!("{stem}_overlay.png"));
                    if let Err(e) = overlay::write_png(&overlay::overlay(&frame, &m), &target) {
                        println!("  {e}");
                    }
                }
            }
        }
    }
}
