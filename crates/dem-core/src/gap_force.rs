//! Forces across gaps in the pair loop: tables of laws by material pair, behind one pointer.

use std::fmt::Debug;

use crate::contact::kinematics::PairGeometry;
use crate::contact::law::Memory;
use crate::forces::MAX_SLOTS;
use crate::material::{MaterialId, PairTable};
use crate::noncontact::{NonContactForce, NonContactResponse, Separation};

/// A table of one kind of non-contact law.
pub(crate) trait GapForce: Debug + Send + Sync {
    /// Numbers remembered by a pair.
    fn slots(&self) -> usize;
    /// Largest gap at which bodies of these materials act on each other, m; `None` if they do not.
    fn range(&self, a: MaterialId, b: MaterialId, pair: &PairGeometry) -> Option<f64>;
    /// Force at the present separation, `None` beyond the range; updates the memory.
    fn respond(
        &self,
        a: MaterialId,
        b: MaterialId,
        pair: &PairGeometry,
        separation: &Separation,
        memory: &mut [f64],
    ) -> Option<NonContactResponse>;
}

impl<F: NonContactForce + Debug> GapForce for PairTable<F> {
    fn slots(&self) -> usize {
        <F::Memory as Memory>::SLOTS
    }

    fn range(&self, a: MaterialId, b: MaterialId, pair: &PairGeometry) -> Option<f64> {
        self.get(a, b).map(|law| law.range(pair))
    }

    fn respond(
        &self,
        a: MaterialId,
        b: MaterialId,
        pair: &PairGeometry,
        separation: &Separation,
        memory: &mut [f64],
    ) -> Option<NonContactResponse> {
        let law = self.get(a, b)?;
        let slots = <F::Memory as Memory>::SLOTS;
        if separation.gap > law.range(pair) {
            memory[..slots].fill(0.0);
            return None;
        }
        let mut remembered = F::Memory::load(&memory[..slots]);
        let response = law.respond(pair, separation, &mut remembered);
        remembered.store(&mut memory[..slots]);
        Some(response)
    }
}

/// Buffer for what one pair remembers of one force.
pub(crate) type Slots = [f64; MAX_SLOTS];
