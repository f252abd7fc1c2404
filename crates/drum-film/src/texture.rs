//! Particle texture of an analytic bed: a jittered hexagonal lattice of beads, each with its own grey.

use glam::{DVec2, DVec3};

use crate::canvas::{Color, scaled};
use crate::error::{Error, check};
use crate::light::Lamp;

/// How the beads of an analytic bed look.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Texture {
    /// Radius of a bead, m.
    pub grain_radius_m: f64,
    /// Mean colour of the beads.
    pub color: Color,
    /// Standard deviation of a bead's brightness, as a share of the mean.
    pub variation: f64,
    /// How far a bead's site strays from the lattice, as a share of its radius.
    pub jitter: f64,
    /// Brightness of the gaps between beads as a share of the beads'.
    pub gap: f64,
    /// How much of shading, gaps and variation is drawn: 0 is a flat bed, 1 everything.
    pub contrast: f64,
    /// Seed of sites and greys.
    pub seed: u64,
}

impl Default for Texture {
    fn default() -> Self {
        Self {
            grain_radius_m: 0.003,
            color: [0.80, 0.80, 0.77],
            variation: 0.07,
            jitter: 0.45,
            gap: 0.5,
            contrast: 1.0,
            seed: 1,
        }
    }
}

impl Texture {
    pub(crate) fn check(&self) -> Result<(), Error> {
        check("texture.grain_radius_m", self.grain_radius_m, "m", (1e-6, 1e3), "a radius above 0")?;
        check("texture.variation", self.variation, "", (0.0, 1.0), "a share from 0 to 1")?;
        check("texture.jitter", self.jitter, "", (0.0, 1.0), "a share from 0 to 1")?;
        check("texture.gap", self.gap, "", (0.0, 1.0), "a share from 0 to 1")?;
        check("texture.contrast", self.contrast, "", (0.0, 1.0), "a share from 0 to 1")
    }

    /// Colour at a point of the layer, m, seen straight on.
    pub(crate) fn color(&self, lamp: &Lamp, p: DVec2) -> Color {
        if self.contrast == 0.0 {
            return self.color;
        }
        let r = self.grain_radius_m;
        // A bead of the lattice touches its neighbours; beads behind fill most of the gaps.
        let row_height = r * 3.0_f64.sqrt();
        let row = (p.y / row_height).floor() as i64;
        let mut nearest = (f64::INFINITY, DVec2::ZERO, 0_u64);
        for j in row - 1..=row + 2 {
            let shift = if j.rem_euclid(2) == 1 { r } else { 0.0 };
            let column = ((p.x - shift) / (2.0 * r)).round() as i64;
            for i in column - 1..=column + 1 {
                let bits = hash(self.seed, i, j);
                let stray = DVec2::new(unit(bits) - 0.5, unit(bits >> 24) - 0.5);
                let site = DVec2::new(2.0 * r * i as f64 + shift, row_height * j as f64)
                    + stray * (2.0 * self.jitter * r);
                let d2 = (p - site).length_squared();
                if d2 < nearest.0 {
                    nearest = (d2, p - site, bits);
                }
            }
        }
        let (d2, offset, bits) = nearest;
        let body = scaled(self.color, self.grey(bits));
        let drawn = if d2 < r * r {
            let n = offset / r;
            let normal = DVec3::new(n.x, n.y, (1.0 - n.length_squared()).max(0.0).sqrt());
            lamp.shade(body, normal, DVec3::Z)
        } else {
            scaled(body, self.gap as f32)
        };
        let share = self.contrast as f32;
        std::array::from_fn(|k| self.color[k] + share * (drawn[k] - self.color[k]))
    }
}

impl Texture {
    /// Brightness of a bead against the mean, from its random bits.
    pub(crate) fn grey(&self, bits: u64) -> f32 {
        // Triangular distribution of sd 1: the sum of two uniform ones, scaled.
        let spread =
            (unit(bits.rotate_left(17)) + unit(bits.rotate_left(41)) - 1.0) * 6.0_f64.sqrt();
        (1.0 + self.variation * spread).max(0.0) as f32
    }
}

/// 64 well-mixed bits of a lattice site (the finaliser of SplitMix64, doi:10.1145/2714064.2660195).
pub(crate) fn hash(seed: u64, i: i64, j: i64) -> u64 {
    let mut z = seed
        ^ (i as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
        ^ (j as u64).wrapping_mul(0xC2B2_AE3D_27D4_EB4F).rotate_left(32);
    for _ in 0..2 {
        z = z.wrapping_add(0x9E37_79B9_7F4A_7C15);
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
    }
    z
}

/// The low 24 bits as a number from 0 to 1.
pub(crate) fn unit(bits: u64) -> f64 {
    (bits & 0xFF_FFFF) as f64 / f64::from(0x100_0000)
}
