//! A start: the species side by side, strewn at random, fallen and at rest.

use std::fmt::Write as _;

use anyhow::{Context, ensure};
use dem_core::glam::DVec3;
use dem_core::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::case::{LENGTH, RADIUS, SPECIES, STEP, drum};

/// Centres of all spheres, M1 first, m.
pub(crate) struct Start {
    pub(crate) centres: Vec<DVec3>,
}

/// Species (0 or 1) of a sphere by its number.
pub(crate) fn species_of(number: usize) -> usize {
    usize::from(number >= SPECIES[0].count)
}

/// Let both species fall, M1 on the side of +X and M2 on that of -X, with random thrusts, until
/// they rest.
pub(crate) fn settled(seed: u64, threads: usize) -> anyhow::Result<Start> {
    let (mut builder, ids) = drum::<Mindlin>(false)?;
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    for (kind, species) in SPECIES.iter().enumerate() {
        let side = if kind == 0 { 1.0 } else { -1.0 };
        let places = strewn(species.radius, side, &mut random);
        ensure!(places.len() >= species.count, "species {kind} finds {} places", places.len());
        for at in places.into_iter().take(species.count) {
            let thrust = DVec3::from_array(std::array::from_fn(|_| random.random_range(-0.3..0.3)));
            builder.sphere(Sphere::at(at, species.radius, ids[kind]).with_velocity(thrust));
        }
    }
    builder.threads(threads);
    let mut world = builder.build()?;
    let steps = |seconds: f64| (seconds / STEP).round() as u64;
    world.run(steps(0.2))?;
    // What moves still is slowed down; then the bed stands by itself for a while.
    world.set_drag(Some(Drag::Uniform { rate: 20.0 }))?;
    world.run(steps(0.2))?;
    world.set_drag(None)?;
    world.run(steps(0.1))?;
    let speeds = world.particles().map(|p| world.velocity(p).length());
    let mean = speeds.sum::<f64>() / world.len() as f64;
    println!("mean speed of the settled bed {mean:.1e} m/s; it starts from rest");
    ensure!(mean < 1e-3, "after 0.5 s the spheres still move at {mean} m/s on average");
    Ok(Start { centres: world.particles().map(|p| world.position(p)).collect() })
}

/// Places of a loose random lattice in one half of the drum, from below.
fn strewn(radius: f64, side: f64, random: &mut ChaCha8Rng) -> Vec<DVec3> {
    let pitch = 2.12 * radius;
    let free = 0.5 * pitch - radius;
    let count = |length: f64| (length / pitch).floor() as i32;
    let across = count(LENGTH);
    let first = -0.5 * pitch * f64::from(across - 1);
    let mut places = Vec::new();
    for k in 0..count(2.0 * RADIUS) {
        for i in 0..count(RADIUS) {
            for j in 0..across {
                let mut shift = || random.random_range(-free..free);
                let at = DVec3::new(
                    side * (f64::from(i) + 0.5) * pitch + shift(),
                    first + f64::from(j) * pitch + shift(),
                    (f64::from(k) + 0.5) * pitch - RADIUS + shift(),
                );
                if at.x.hypot(at.z) < RADIUS - 1.001 * radius {
                    places.push(at);
                }
            }
        }
    }
    places
}

impl Start {
    /// Text: one line `x y z` a sphere, shortest decimals that give the same bits back.
    pub(crate) fn to_text(&self) -> String {
        let mut text = String::from("# centre of each sphere, m: x y z; M1 first, then M2\n");
        for c in &self.centres {
            let _ = writeln!(text, "{} {} {}", c.x, c.y, c.z);
        }
        text
    }

    /// Read [`Start::to_text`] back.
    pub(crate) fn parse(text: &str) -> anyhow::Result<Self> {
        let centres = text
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.starts_with('#'))
            .map(|(n, line)| {
                let mut numbers = line.split_whitespace().map(str::parse::<f64>);
                let mut next = || -> anyhow::Result<f64> {
                    Ok(numbers.next().with_context(|| format!("line {}: 3 numbers", n + 1))??)
                };
                Ok(DVec3::new(next()?, next()?, next()?))
            })
            .collect::<anyhow::Result<Vec<_>>>()?;
        let expected: usize = SPECIES.iter().map(|s| s.count).sum();
        ensure!(centres.len() == expected, "{} spheres instead of {expected}", centres.len());
        Ok(Self { centres })
    }

    /// The same spheres as a data file of LIGGGHTS, coordinates in the order z, x, y.
    pub(crate) fn to_liggghts(&self) -> String {
        // The box holds the corners of the end plates, too.
        let (r, y) = (2.1 * RADIUS, 0.55 * LENGTH);
        let mut text = format!(
            "spheres at rest\n\n{} atoms\n3 atom types\n\n{} {r} xlo xhi\n{} {r} ylo yhi\n{} {y} zlo zhi\n\nAtoms\n\n",
            self.centres.len(),
            -r,
            -r,
            -y,
        );
        for (n, c) in self.centres.iter().enumerate() {
            let kind = species_of(n);
            let s = &SPECIES[kind];
            let _ = writeln!(
                text,
                "{} {} {} {} {} {} {}",
                n + 1,
                kind + 1,
                2.0 * s.radius,
                s.density,
                c.z,
                c.x,
                c.y
            );
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_is_read_back_bit_by_bit_and_a_short_one_is_refused() {
        let total: usize = SPECIES.iter().map(|s| s.count).sum();
        let at = |k: usize| DVec3::new(0.1 / 3.0, k as f64 * 1e-7, -1.0 / (k as f64 + 7.0));
        let start = Start { centres: (0..total).map(at).collect() };
        assert_eq!(Start::parse(&start.to_text()).unwrap().centres, start.centres);
        assert!(Start::parse("0 0 0\n").is_err());
    }

    #[test]
    fn strewn_spheres_lie_apart_inside_their_half_of_the_drum() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let places = strewn(2e-3, -1.0, &mut random);
        assert!(places.len() >= SPECIES[1].count);
        for (k, p) in places.iter().enumerate() {
            assert!(
                p.x < -2e-3 && p.y.abs() < 0.5 * LENGTH - 2e-3 && p.x.hypot(p.z) < RADIUS - 2e-3
            );
            // Neighbours in the lattice are near in the list: one row across.
            assert!(places[k + 1..].iter().take(60).all(|q| p.distance(*q) >= 4e-3));
        }
    }
}
