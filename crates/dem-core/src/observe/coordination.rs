//! Mean number of contacts of a particle.

use super::{Observer, View};
use crate::error::Partner;

/// Coordination number against time: `2 (pairs) / N` between particles, and wall contacts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CoordinationNumber {
    every: u64,
    /// Time (s), contacts with particles, contacts with walls, each per particle.
    pub series: Vec<[f64; 3]>,
}

impl CoordinationNumber {
    /// Look every `every` steps.
    pub fn new(every: u64) -> Self {
        Self { every, series: Vec::new() }
    }
}

impl Observer for CoordinationNumber {
    fn every(&self) -> u64 {
        self.every
    }

    fn observe(&mut self, world: &dyn View) {
        let (mut ends, mut walls) = (0.0, 0.0);
        world.for_each_contact(&mut |c| match c.partner {
            Partner::Particle(_) => ends += 2.0,
            Partner::Wall(_) => walls += 1.0,
        });
        let n = world.particle_count().max(1) as f64;
        self.series.push([world.time(), ends / n, walls / n]);
    }
}
