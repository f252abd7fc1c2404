//! Sensor noise: `sd^2 = read^2 + shot^2 v`, v being the light of a pixel as a share of full scale.
//!
//! The first term is that of the amplifier, the second that of the photons' number (Janesick 2007, *Photon Transfer*,
//! doi:10.1117/3.725073), both normal and independent from pixel to pixel and from channel to channel.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::canvas::Canvas;
use crate::error::{Error, check};

/// Noise of the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Noise {
    /// Standard deviation in the dark, as a share of full scale.
    pub read: f64,
    /// Standard deviation that the photons add at full scale, as a share of it.
    pub shot: f64,
    /// Seed; every frame and every row of it has its own stream.
    pub seed: u64,
}

impl Noise {
    pub(crate) fn check(&self) -> Result<(), Error> {
        check("noise.read", self.read, "", (0.0, 1.0), "a share of full scale from 0 to 1")?;
        check("noise.shot", self.shot, "", (0.0, 1.0), "a share of full scale from 0 to 1")
    }

    /// Adds the noise of the frame with this index.
    pub(crate) fn apply(&self, canvas: &mut Canvas, index: u64) {
        if self.read == 0.0 && self.shot == 0.0 {
            return;
        }
        let seed = crate::texture::hash(self.seed, index as i64, 1);
        let (read2, shot2) = ((self.read * self.read) as f32, (self.shot * self.shot) as f32);
        canvas.for_rows(|v, row| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            random.set_stream(v.into());
            for pixel in row {
                for value in pixel {
                    let sd = (read2 + shot2 * value.max(0.0)).sqrt();
                    let normal: f32 = StandardNormal.sample(&mut random);
                    *value += sd * normal;
                }
            }
        });
    }
}
