//! Time of a particle-step on a settled, turning drum like configuration AZ1.
//!
//! 7807 beads of 6 mm in a drum of 250 x 150 mm at 17 rpm, time step 70 us; Hertz, Mindlin with
//! history, damping, constant rolling torque. Arguments: threads, steps, skin in mm, beads,
//! settling steps; the word `fused` or `roots` anywhere for those kernels.
#![expect(clippy::print_stdout, reason = "a bench reports by printing")]

mod drum;

use dem_core::prelude::*;
use drum::{RADIUS, Random, argument, timed, turning};

fn main() {
    let steps = argument(1, 4000.0) as u64;
    let skin = argument(2, 1.25) * 1e-3;
    let count = argument(3, 7807.0) as usize;
    let settle = argument(4, 14000.0) as u64;
    let material = Material::from_shear_modulus(2.52e7, 0.29, 2500.0);
    let length = 0.150 * count as f64 / 7807.0;
    let (mut b, bead, drum) = turning(material, length, 7e-5, skin);
    let mut random = Random(42);
    let mut jitter = || random.next() * 2e-4;
    let pitch = 6.3e-3;
    let per_row = (length / pitch) as usize;
    let mut left = count;
    'fill: for j in 0..40 {
        for i in 0..40 {
            let (x, y) = (-0.122 + pitch * i as f64, -0.122 + pitch * j as f64);
            if x.hypot(y) > RADIUS - 3.3e-3 {
                continue;
            }
            for k in 0..per_row {
                if left == 0 {
                    break 'fill;
                }
                let z = (k as f64 + 0.5) * length / per_row as f64;
                let p = DVec3::new(x + jitter(), y + jitter(), z + jitter());
                b.sphere(Sphere::at(p, 3e-3, bead));
                left -= 1;
            }
        }
    }
    timed(&mut b.build().expect("a valid drum"), drum, [settle, steps], "particle");
}
