//! Which entries of the wall list cannot touch yet.
//!
//! Of the walls near the spheres of clumps nine in ten are not touched before the list is made again. They are told by how far
//! their spheres were from them then and have moved at most since, without a look at where they are. (Of single spheres
//! every other one touches, and a look costs no more than this.)

use std::ops::Range;

use super::near_order::Moved;
use crate::sums::PIECE;

/// Most entries that are told at once.
pub(crate) const ENTRIES: usize = 256;

/// By how much less gaps are told than they are, over what lists reach: more than single precision and positions are rounded by.
const ROUNDING: f64 = 1e-6;

/// Gaps of the wall list when it was made.
#[derive(Debug, Clone, Default)]
pub(crate) struct WallGaps {
    gaps: Vec<WallGap>,
}

#[derive(Debug, Clone, Copy)]
struct WallGap {
    /// A hair less than it was, m; below nothing where it does not tell how far the sphere has to move.
    gap: f32,
    /// The piece of bodies that the sphere's own is one of.
    piece: u32,
}

/// What of a run of the wall list cannot touch yet.
#[derive(Clone, Copy)]
pub(crate) struct Far<'a> {
    /// Of each entry; of none where they are not known.
    gaps: &'a [WallGap],
    /// How far the bodies of each piece have moved at most since the list was made, squared, and any surface of a wall, m.
    square: &'a [f64],
    shift: f64,
}

/// What is told of a gap, m, by a list that reaches so far.
pub(crate) fn told(gap: f64, range: f64) -> f32 {
    (gap - ROUNDING * range) as f32
}

impl WallGaps {
    /// Nothing is known.
    pub(crate) fn forget(&mut self) {
        self.gaps.clear();
    }

    /// Those of a list, entry by entry: what is told of the gap, and the body of the sphere.
    pub(crate) fn make(&mut self, of: impl Iterator<Item = (f32, u32)>) {
        self.gaps.clear();
        self.gaps.extend(of.map(|(gap, body)| WallGap { gap, piece: body / PIECE as u32 }));
    }

    /// Which of so many entries are far by now.
    pub(crate) fn far<'a>(&'a self, entries: usize, moved: &'a Moved, shift: f64) -> Far<'a> {
        let gaps = if self.gaps.len() == entries { &self.gaps[..] } else { &[] };
        Far { gaps, square: &moved.square, shift }
    }
}

impl Far<'_> {
    /// The same for some entries.
    pub(crate) fn of(&self, entries: Range<usize>) -> Self {
        Self { gaps: self.gaps.get(entries).unwrap_or_default(), ..*self }
    }

    /// Whether anything is known of them.
    pub(crate) fn is_known(&self) -> bool {
        !self.gaps.is_empty()
    }

    /// Put those of some entries, of which something is known, into `to` that are marked or may have come to touch; returns how many they are.
    pub(crate) fn near(
        &self,
        entries: Range<usize>,
        active: &[u8],
        to: &mut [u32; ENTRIES],
    ) -> usize {
        let gaps = &self.gaps[entries.clone()];
        let (mut count, mut piece, mut moved) = (0, u32::MAX, f64::INFINITY);
        for ((e, own), active) in entries.clone().zip(gaps).zip(&active[entries]) {
            if own.piece != piece {
                // Entries go by spheres: this is seldom.
                piece = own.piece;
                let square = self.square.get(piece as usize).copied().unwrap_or(f64::INFINITY);
                moved = square.sqrt() + self.shift;
            }
            // Written in any case, so that nothing branches on it. What is no number may be anywhere.
            to[count] = e as u32;
            let far = f64::from(own.gap) > moved;
            count += usize::from((*active != 0) | !far);
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_that_are_marked_or_may_have_closed_are_near_and_no_others() {
        let (bodies, range) = (700u32, 1e-3);
        let gap_of = |e: usize| range * (e * 7919 % 1000) as f64 / 1000.0 - 1e-5;
        let body_of = |e: usize| e as u32 / 2;
        let entries = 2 * bodies as usize;
        let mut gaps = WallGaps::default();
        gaps.make((0..entries).map(|e| (told(gap_of(e), range), body_of(e))));
        let mut moved = Moved::default();
        moved.reset(&vec![range; bodies as usize]);
        for (k, square) in moved.square.iter_mut().enumerate() {
            *square = (0.1 * range * k as f64).powi(2);
        }
        let shift = 0.03 * range;
        let far = gaps.far(entries, &moved, shift);
        let (mut to, mut spared) = ([0; ENTRIES], 0);
        for run in [0..200, 200..417, 1300..entries] {
            let active: Vec<_> = run.clone().map(|e| u8::from(e % 11 == 0)).collect();
            let of = far.of(run.clone());
            let count = of.near(0..run.len().min(ENTRIES), &active, &mut to);
            let near = |k: &usize| {
                let reach = moved.square[body_of(run.start + k) as usize / PIECE].sqrt() + shift;
                active[*k] != 0 || gap_of(run.start + k) < reach + 1e-5 * range
            };
            let expected: Vec<_> = (0..run.len()).filter(near).map(|k| k as u32).collect();
            assert_eq!(to[..count], expected);
            spared += run.len() - count;
        }
        assert!(spared > 200, "{spared}");
        // All are near where nobody knows how far bodies or walls have moved.
        let count = |far: Far<'_>| far.near(0..200, &[0; 200], &mut [0; ENTRIES]);
        assert!(count(gaps.far(entries, &moved, shift)) < 200);
        assert_eq!(count(gaps.far(entries, &moved, f64::NAN)), 200);
        assert_eq!(count(gaps.far(entries, &Moved::default(), shift)), 200);
        // Nothing is known of another list, or after a restart.
        assert!(gaps.far(entries, &moved, shift).of(9..20).is_known());
        assert!(!gaps.far(entries + 1, &moved, shift).is_known());
        gaps.forget();
        assert!(!gaps.far(entries, &moved, shift).is_known());
    }
}
