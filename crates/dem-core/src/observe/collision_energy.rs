//! Distribution of the energy of collisions, by kind of pair.
//!
//! The energy of a collision is `m* v^2 / 2` with the relative velocity `v` of the centres in the
//! first step of a contact. Yang, Yu, McElroy & Bao, Powder Technol. 188 (2008) 170,
//! doi:10.1016/j.powtec.2008.04.081: divided by its mean it falls on one curve for all drum speeds.

use std::collections::BTreeMap;

use super::{Contact, Observer, View};
use crate::error::Partner;
use crate::material::MaterialId;

/// Which kinds of bodies meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum PairKind {
    /// Particles of two materials, the lower number first.
    Particles(MaterialId, MaterialId),
    /// A particle and a wall, by the wall's number.
    Wall(MaterialId, usize),
}

/// Counts in bins of equal width on a logarithmic scale.
#[derive(Debug, Clone, PartialEq)]
pub struct EnergyHistogram {
    /// Lower end of the first bin, J.
    pub least: f64,
    /// Bins a decade.
    pub bins_per_decade: f64,
    /// Collisions in each bin; the first and last also hold what lies beyond.
    pub counts: Vec<u64>,
    /// Number of collisions.
    pub collisions: u64,
    /// Sum of their energies, J.
    pub total: f64,
}

impl EnergyHistogram {
    fn add(&mut self, energy: f64) {
        let bin = ((energy / self.least).log10() * self.bins_per_decade).max(0.0) as usize;
        let last = self.counts.len() - 1;
        self.counts[bin.min(last)] += 1;
        self.collisions += 1;
        self.total += energy;
    }

    /// Mean energy of a collision, J.
    pub fn mean(&self) -> f64 {
        self.total / self.collisions.max(1) as f64
    }

    /// Bins as (middle in J, share of all collisions).
    pub fn shares(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let n = self.collisions.max(1) as f64;
        self.counts.iter().enumerate().map(move |(k, &c)| {
            let middle = self.least * 10f64.powf((k as f64 + 0.5) / self.bins_per_decade);
            (middle, c as f64 / n)
        })
    }
}

/// Collects the energies of all collisions. It has to look at every step to miss none.
#[derive(Debug, Clone, PartialEq)]
pub struct CollisionEnergy {
    empty: EnergyHistogram,
    histograms: BTreeMap<PairKind, EnergyHistogram>,
    /// Contacts of the last look, sorted.
    before: Vec<(u32, u32, bool)>,
    now: Vec<(u32, u32, bool)>,
    first_look: bool,
}

impl CollisionEnergy {
    /// Bins from `least` to `most` joules, ten a decade.
    pub fn new(least: f64, most: f64) -> Self {
        let bins = ((most / least).log10() * 10.0).ceil().max(1.0) as usize;
        Self {
            empty: EnergyHistogram {
                least,
                bins_per_decade: 10.0,
                counts: vec![0; bins],
                collisions: 0,
                total: 0.0,
            },
            histograms: BTreeMap::new(),
            before: Vec::new(),
            now: Vec::new(),
            first_look: true,
        }
    }

    /// What was collected, by kind of pair.
    pub fn histograms(&self) -> &BTreeMap<PairKind, EnergyHistogram> {
        &self.histograms
    }
}

fn key(c: &Contact) -> (u32, u32, bool) {
    match c.partner {
        Partner::Particle(p) => (c.particle.0.min(p.0), c.particle.0.max(p.0), false),
        Partner::Wall(w) => (c.particle.0, w as u32, true),
    }
}

impl Observer for CollisionEnergy {
    fn every(&self) -> u64 {
        1
    }

    fn observe(&mut self, world: &dyn View) {
        self.now.clear();
        world.for_each_contact(&mut |c| {
            let key = key(c);
            self.now.push(key);
            if self.first_look || self.before.binary_search(&key).is_ok() {
                return;
            }
            let [a, b] = c.materials;
            let kind = match c.partner {
                Partner::Particle(_) => PairKind::Particles(a.min(b), a.max(b)),
                Partner::Wall(w) => PairKind::Wall(a, w),
            };
            let energy = 0.5 * c.effective_mass * c.relative_velocity.length_squared();
            self.histograms.entry(kind).or_insert_with(|| self.empty.clone()).add(energy);
        });
        self.now.sort_unstable();
        self.now.dedup();
        std::mem::swap(&mut self.now, &mut self.before);
        self.first_look = false;
    }
}
