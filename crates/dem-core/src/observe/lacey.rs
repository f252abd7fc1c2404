//! Lacey's mixing index.
//!
//! `M = (S0^2 - S^2) / (S0^2 - SR^2)` with the variance `S^2` of the share of one species over
//! cells, `S0^2 = p (1 - p)` of the unmixed and `SR^2 = p (1 - p) / n` of the randomly mixed state,
//! `n` the mean number of particles a cell (cells weigh by their number). 0 is unmixed, 1 random.
//! Lacey, J. Appl. Chem. 4 (1954) 257, doi:10.1002/jctb.5010040504.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{Observer, View};
use crate::particles::ParticleId;

/// Mixing index against time.
pub struct LaceyIndex {
    every: u64,
    cell: f64,
    least: usize,
    species: Box<dyn Fn(ParticleId) -> bool + Send + Sync>,
    /// Time (s) and index.
    pub series: Vec<[f64; 2]>,
}

impl std::fmt::Debug for LaceyIndex {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LaceyIndex")
            .field("cell", &self.cell)
            .field("series", &self.series)
            .finish()
    }
}

impl LaceyIndex {
    /// Look every `every` steps at cubes of edge `cell` (m) that hold at least `least` particles;
    /// `species` tells which particles are counted.
    pub fn new(
        every: u64,
        cell: f64,
        least: usize,
        species: impl Fn(ParticleId) -> bool + Send + Sync + 'static,
    ) -> Self {
        Self { every, cell, least, species: Box::new(species), series: Vec::new() }
    }

    /// Index of particles at `positions`, `true` for those of the species; `None` when no cell
    /// holds enough or only one species is there.
    ///
    /// ```
    /// # use dem_core::observe::LaceyIndex;
    /// # use glam::DVec3;
    /// // Two halves, each pure: unmixed.
    /// let halves = (0..1000).map(|k| (DVec3::new(f64::from(k % 10), f64::from(k / 10 % 10), f64::from(k / 100)), k % 10 < 5));
    /// let index = LaceyIndex::index(halves, 5.0, 10).expect("cells are full");
    /// assert!(index.abs() < 1e-9);
    /// ```
    pub fn index(
        particles: impl Iterator<Item = (DVec3, bool)>,
        cell: f64,
        least: usize,
    ) -> Option<f64> {
        let mut cells: BTreeMap<[i64; 3], (usize, usize)> = BTreeMap::new();
        for (x, counted) in particles {
            let key = (x / cell).floor().to_array().map(|c| c as i64);
            let entry = cells.entry(key).or_default();
            entry.0 += 1;
            entry.1 += usize::from(counted);
        }
        let full: Vec<_> = cells.values().filter(|c| c.0 >= least.max(1)).collect();
        let total: usize = full.iter().map(|c| c.0).sum();
        let counted: usize = full.iter().map(|c| c.1).sum();
        if total == 0 || counted == 0 || counted == total {
            return None;
        }
        let share = counted as f64 / total as f64;
        let variance = (full.iter())
            .map(|c| c.0 as f64 * (c.1 as f64 / c.0 as f64 - share).powi(2))
            .sum::<f64>()
            / total as f64;
        let unmixed = share * (1.0 - share);
        let random = unmixed / (total as f64 / full.len() as f64);
        Some((unmixed - variance) / (unmixed - random))
    }
}

impl Observer for LaceyIndex {
    fn every(&self) -> u64 {
        self.every
    }

    fn observe(&mut self, world: &dyn View) {
        let particles = (0..world.particle_count() as u32).map(|k| {
            let id = ParticleId(k);
            (world.position(id), (self.species)(id))
        });
        if let Some(index) = Self::index(particles, self.cell, self.least) {
            self.series.push([world.time(), index]);
        }
    }
}
