//! Time of a tablet-step on a settled, turning drum like configuration AZ4.
//!
//! 5997 coated tablets of ten spheres (nine of 1.87 mm on a ring, one of 2.3 mm in the middle) in a drum of 250 x 150 mm at
//! 17 rpm, time step 50 us; Hertz, Mindlin with history, damping, constant rolling torque. Arguments: threads, steps, skin in
//! mm, settling steps, tablets (the drum is as long as they need); the word `fused` or `roots` anywhere for those kernels.
#![expect(clippy::print_stdout, reason = "a bench reports by printing")]

mod drum;

use dem_core::prelude::*;
use drum::{RADIUS, Random, argument, timed, turning};

/// Mass (kg) and moments about the centre (kg m2) of a disc of 8.6 mm with a density of 1350 kg/m3: near those of the clump.
const MASS: f64 = 2.6e-4;
const MOMENTS: DVec3 = DVec3::new(1.6e-9, 1.6e-9, 2.5e-9);

fn tablet(material: MaterialId) -> Clump {
    let ring = |n: usize| {
        let at = n as f64 * std::f64::consts::TAU / 9.0;
        ClumpSphere {
            centre: DVec3::new(2.418e-3 * at.cos(), 2.418e-3 * at.sin(), 0.0),
            radius: 1.87e-3,
        }
    };
    let mut spheres: Vec<ClumpSphere> = (0..9).map(ring).collect();
    spheres.push(ClumpSphere { centre: DVec3::ZERO, radius: 2.3e-3 });
    let inertia = DMat3::from_diagonal(MOMENTS);
    ClumpSpec { spheres, mass: MASS, centre_of_mass: DVec3::ZERO, inertia, material }
        .try_into()
        .expect("a tablet")
}

fn main() {
    let steps = argument(1, 1000.0) as u64;
    let (skin, settle) = (argument(2, 0.8) * 1e-3, argument(3, 3000.0) as u64);
    let material = Material::from_shear_modulus(2.92e6, 0.29, 1350.0);
    let count = argument(4, 5997.0) as usize;
    let length = 0.150 * count as f64 / 5997.0;
    let (mut b, body, drum) = turning(material, length, 5e-5, skin);
    let shape = b.clump_shape(tablet(body));
    let mut random = Random(42);
    let (reach, mut left) = (4.3e-3, count);
    let pitch = 2.0 * reach;
    let (across, along) = ((2.0 * RADIUS / pitch) as usize, (length / pitch) as usize);
    'fill: for j in 0..across {
        for i in 0..across {
            let place = |n: usize| (n as f64 + 0.5) * pitch - RADIUS;
            let (x, y) = (place(i), place(j));
            if x.hypot(y) > RADIUS - reach {
                continue;
            }
            for k in 0..along {
                if left == 0 {
                    break 'fill;
                }
                left -= 1;
                let turn =
                    DQuat::from_xyzw(random.next(), random.next(), random.next(), random.next());
                b.clump(PlacedClump {
                    shape,
                    position: DVec3::new(x, y, (k as f64 + 0.5) * length / along as f64),
                    orientation: turn.normalize(),
                    velocity: DVec3::ZERO,
                    spin: DVec3::ZERO,
                });
            }
        }
    }
    timed(&mut b.build().expect("a valid drum"), drum, [settle, steps], "tablet");
}
