//! What the scatter of the beads' radii does that Table 6 prints, (3.0 +- 0.3) mm.

use super::campaigns::Design;
use super::printed::{self, Printed};

/// Simulate what is not there yet and write docs/src/own-dem-sizes.md.
pub(crate) fn run(configs: &[String], jobs: usize) -> anyhow::Result<()> {
    printed::run(&RADII, configs, jobs)
}

const RADII: Printed = Printed {
    name: "own-dem-sizes",
    usual: "one size",
    readings: &[(Design::Limits, "limits"), (Design::Deviation, "standard deviation")],
    head: HEAD,
};

const HEAD: &str = "# Beads of (3.0 \u{b1} 0.3) mm\n\n\
    `cargo xtask reproduce --dem --sizes`. Table 6, which lists what the simulations of the thesis need, prints the radius of the beads as\n\
    (3.0 \u{b1} 0.3) mm and does not say what the 0.3 is. The drums of Table 8 once more, with the printed number of beads and by EDEM's laws\n\
    ([beside EDEM's tables](own-dem.md)), in both readings: as limits between which every radius is as likely (standard deviation 5.8 %) and as a\n\
    standard deviation (10 %, a step of 60 us for 70, since the smallest beads ring faster); diameters are log-normal. Nothing else is changed, and\n\
    no figure of EDEM's tables enters. RMSE of the centre about its mean difference, of the angles not.\n\n";
