//! What it does if the printed diameter of the drum, 250 mm, is that of its tube's outside.

use super::campaigns::{Design, Kept, keep, simulate};
use super::printed::{self, Printed};

/// Simulate what is not there yet, by EDEM's laws and by ours, and write docs/src/own-dem-tube.md and the tables of responses by ours.
pub(crate) fn run(configs: &[String], jobs: usize) -> anyhow::Result<()> {
    printed::run(&DIAMETER, configs, jobs)?;
    for config in configs {
        let _ = simulate(config, Design::OursTube, jobs)?;
        keep(config, Kept::Tube)?;
    }
    Ok(())
}

const DIAMETER: Printed = Printed {
    name: "own-dem-tube",
    usual: "250 mm inside",
    readings: &[(Design::Tube, "240 mm inside")],
    head: HEAD,
};

const HEAD: &str = "# A tube of 250 mm, measured outside\n\n\
    `cargo xtask reproduce --dem --tube`. The thesis builds its drum from a tube of acrylic glass \"with a diameter of 250 mm\" and does not say where that\n\
    is measured. Such tubes are sold by their outside, with walls of 3 to 6 mm at this size. The drums of Table 8 once more in a drum of 240 mm inside,\n\
    a wall of 5 mm, with the printed number of beads and by EDEM's laws ([beside EDEM's tables](own-dem.md)). Nothing else is changed: the bed fills 1.085\n\
    times as much of the circle. No figure of EDEM's tables enters the simulation, but that this drum was tried at all came of\n\
    [how many beads EDEM's pictures show](own-dem-beads.md). RMSE of the centre about its mean difference, of the angles not.\n\n";
