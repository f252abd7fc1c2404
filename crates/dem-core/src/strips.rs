//! How one pass over contacts and bodies is shared out.
//!
//! A strip is a run of chunks of touching pairs with the run of bodies that own most of them; a thread goes through one
//! strip as one thread goes through all. Where a body is touched by pairs of another strip than its own, it has to
//! wait for both: it is *deferred*. A strip reads deferred bodies but leaves them as they are, and the wrenches of
//! the chunks that touch them are kept, so that a later stage finds them. All other bodies are read and
//! written by their own strip alone. Bodies are told by pieces: a piece is deferred if one of its bodies is.
//!
//! Bodies that only two neighbouring strips touch are *handed*: they lie at the beginning of the later strip, which computes its pairs with
//! them first. When the earlier one comes to its end it has summed its own wrenches on them, as a rule the later one has long
//! left them behind, and so the earlier one goes on with the wrenches kept there, in the order of the list, and finishes them: only what it
//! cannot take over yet waits for the last stage.
//!
//! Strips that took longer than others get less when the next list is cut: cores are not equally fast, above all
//! those that others work on as well. Where strips are cut changes no bit of what comes out.

mod shares;

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

pub(crate) use shares::Shares;

use crate::contact_stage::CHUNK;
use crate::neighbour::verlet_list::PairList;
use crate::spheres::Seats;
use crate::sums::PIECE;
use crate::threads::NO_PLACE;
use crate::world::StripYield;

/// The strips of a list of pairs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Strips {
    /// First chunk of pairs of each strip, and the end of the last one; nothing before the list is cut.
    pub(crate) chunks: Vec<u32>,
    /// First piece of bodies of each, and the end of the last one.
    pub(crate) pieces: Vec<u32>,
    /// First piece that each finishes, itself or by taking over, and the end of the last one.
    pub(crate) finished: Vec<u32>,
    /// Chunks of the next strip that touch what it hands to each.
    next_chunks: Vec<Range<usize>>,
    /// Deferred pieces, and those that nobody has taken over in this step.
    deferred: Vec<u32>,
    pub(crate) left: Vec<u32>,
    /// Which strip other than its own touches a piece.
    touched_by: Vec<u32>,
    /// Chunks that each has passed in this step.
    passed: Passed,
    /// Whether a piece is deferred.
    waits: Vec<bool>,
    /// Where the wrenches of each chunk are kept, in chunks.
    kept: Vec<u32>,
    /// How many chunks are.
    kept_chunks: usize,
    /// Share of the work of each strip; none before one was timed.
    shares: Vec<f64>,
    /// What each has taken since the list was cut, s.
    taken: Vec<f64>,
}

/// Up to which chunk strips have come, as others see it: twice, plus one where two bodies overlap too deeply.
#[derive(Debug, Default)]
struct Passed(Vec<AtomicU32>);

impl Clone for Passed {
    /// A copy has come nowhere.
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Touched by no other strip, or by several.
const NONE: u32 = u32::MAX;
const SEVERAL: u32 = u32::MAX - 1;

/// Least share of a strip, of an equal one, before all shares are brought to one.
const LEAST_SHARE: f64 = 0.5;
/// Which part of what strips differ by is mended at once: times of few steps scatter.
const MENDED: f64 = 0.5;

impl Strips {
    /// Whether the present list is cut.
    pub(crate) fn are_cut(&self) -> bool {
        !self.chunks.is_empty()
    }

    /// Forget them, since the list has changed.
    pub(crate) fn forget(&mut self) {
        self.chunks.clear();
    }

    /// Note what each strip has taken for a step.
    pub(crate) fn note(&mut self, yields: &[StripYield]) {
        self.taken.resize(yields.len(), 0.0);
        for (taken, strip) in self.taken.iter_mut().zip(yields) {
            *taken += strip.seconds;
        }
    }

    /// Give more to strips that were done early, less to others.
    fn share_out(&mut self, strips: usize) {
        let even = 1.0 / strips as f64;
        if self.shares.len() != strips {
            self.shares.clear();
            self.shares.resize(strips, even);
        }
        let told = self.taken.len() == strips && self.taken.iter().all(|taken| *taken > 0.0);
        if told {
            for (share, taken) in self.shares.iter_mut().zip(&self.taken) {
                *share *= taken.powf(-MENDED);
            }
            let all: f64 = self.shares.iter().sum();
            for share in &mut self.shares {
                *share = (*share / all).max(LEAST_SHARE * even);
            }
            let all: f64 = self.shares.iter().sum();
            self.shares.iter_mut().for_each(|share| *share /= all);
        }
        self.taken.clear();
    }

    /// How many they are.
    pub(crate) fn count(&self) -> usize {
        self.chunks.len().saturating_sub(1)
    }

    /// Whether few enough bodies are deferred that they gain anything.
    pub(crate) fn pay(&self) -> bool {
        2 * self.deferred.len() <= self.waits.len()
    }

    /// A step begins: no strip has come anywhere.
    pub(crate) fn begin(&mut self) {
        self.passed.0.resize_with(self.count(), AtomicU32::default);
        self.passed.0.iter_mut().for_each(|passed| *passed.get_mut() = 0);
    }

    /// A strip has computed all its chunks before this one, and reads no body that no later one touches; `deep` tells whether two overlap
    /// too deeply.
    #[inline(always)]
    pub(crate) fn pass(&self, strip: usize, chunk: usize, deep: bool) {
        self.passed.0[strip].store(2 * chunk as u32 + u32::from(deep), Ordering::Release);
    }

    /// Chunks of the next strip that touch what it hands to this one, in order.
    pub(crate) fn next_chunks(&self, strip: usize) -> Range<usize> {
        self.next_chunks[strip].clone()
    }

    /// Whether two bodies overlap too deeply as far as the next strip has come, if it has left behind what it hands to this one.
    pub(crate) fn are_handed(&self, strip: usize) -> Option<bool> {
        let passed = self.passed.0[strip + 1].load(Ordering::Acquire);
        ((passed / 2) as usize >= self.next_chunks[strip].end).then_some(!passed.is_multiple_of(2))
    }

    /// Pieces that the next strip hands to this one.
    #[inline(always)]
    pub(crate) fn handed(&self, strip: usize) -> Range<usize> {
        self.pieces[strip + 1] as usize..self.finished[strip + 1] as usize
    }

    /// Note which deferred pieces nobody has taken over.
    pub(crate) fn see_what_is_left(&mut self, yields: &[StripYield]) {
        let mut left = std::mem::take(&mut self.left);
        left.clear();
        let taken = |piece: usize| {
            let strip = self.finished.partition_point(|&begin| begin as usize <= piece) - 1;
            yields[strip].took_over && self.handed(strip).contains(&piece)
        };
        left.extend(self.deferred.iter().filter(|&&piece| !taken(piece as usize)));
        self.left = left;
    }

    /// Whether a piece of bodies is deferred.
    #[inline(always)]
    pub(crate) fn waits(&self, piece: usize) -> bool {
        self.waits[piece]
    }

    /// Whether the wrenches of a chunk are kept.
    #[inline(always)]
    pub(crate) fn keep(&self, chunk: usize) -> bool {
        self.kept[chunk] != NO_PLACE
    }

    /// Where the wrenches of each chunk are kept, in chunks: side by side.
    pub(crate) fn kept(&self) -> &[u32] {
        &self.kept
    }

    /// Room that they need.
    pub(crate) fn room(&self) -> usize {
        self.kept_chunks * CHUNK
    }

    /// Cut a list of pairs of so many bodies.
    pub(crate) fn cut(&mut self, pairs: &PairList, bodies: usize, strips: usize, seats: Seats<'_>) {
        self.share_out(strips);
        self.cut_by_shares(pairs, bodies, strips, 0, seats);
        // Deferred bodies lie at the beginning of every strip but the first, and are no work of the strip.
        let later = strips - 1;
        if let Some(each) = (self.deferred.len() * PIECE).checked_div(later) {
            self.cut_by_shares(pairs, bodies, strips, each, seats);
        }
    }

    /// Cut it so that every strip has its share of the work, if so many bodies of every strip but the first are none.
    fn cut_by_shares(
        &mut self,
        pairs: &PairList,
        bodies: usize,
        strips: usize,
        deferred: usize,
        seats: Seats<'_>,
    ) {
        let (pieces, chunks) = (bodies.div_ceil(PIECE), pairs.touching.div_ceil(CHUNK));
        let first = |piece: usize| seats.first((piece * PIECE).min(bodies));
        let start = |piece: usize| pairs.touching_start[first(piece)] as usize;
        let work = |piece: usize| start(piece) + (piece * PIECE).min(bodies);
        let all = work(pieces).saturating_sub((strips - 1) * deferred);
        self.chunks.clear();
        self.pieces.clear();
        let (mut piece, mut shares) = (0, 0.0);
        for strip in 0..=strips {
            let before = (all as f64 * shares) as usize + strip.saturating_sub(1) * deferred;
            shares += self.shares.get(strip).copied().unwrap_or_default();
            while piece < pieces && (work(piece) < before || strip == strips) {
                piece += 1;
            }
            let chunk = if strip == 0 { 0 } else { start(piece).div_ceil(CHUNK) };
            self.pieces.push(piece as u32);
            self.chunks.push(chunk.min(chunks) as u32);
        }
        self.defer(pairs, pieces, chunks, seats);
    }

    /// See which pieces have to wait and which chunks are kept for them.
    fn defer(&mut self, pairs: &PairList, pieces: usize, chunks: usize, seats: Seats<'_>) {
        self.waits.clear();
        self.waits.resize(pieces, false);
        self.touched_by.clear();
        self.touched_by.resize(pieces, NONE);
        for strip in 0..self.count() {
            let own = self.own(strip);
            let chunks = self.chunks[strip] as usize..self.chunks[strip + 1] as usize;
            // Most chunks touch no other strip.
            for chunk in chunks.filter(|&c| !holds(&own, &touched(pairs, c, seats, pieces))) {
                for piece in ends(pairs, chunk, seats).filter(|piece| !own.contains(piece)) {
                    self.waits[piece] = true;
                    let by = &mut self.touched_by[piece];
                    let alone = [NONE, strip as u32].contains(by);
                    *by = if alone { strip as u32 } else { SEVERAL };
                }
            }
        }
        self.hand_over(pairs, seats);
        self.deferred.clear();
        // Room for all, since where strips are cut is a matter of time: a step asks for no memory.
        self.deferred.reserve(pieces);
        self.left.clear();
        self.left.reserve(pieces);
        self.deferred.extend((0..pieces as u32).filter(|&piece| self.waits[piece as usize]));
        self.kept.clear();
        self.kept_chunks = 0;
        for chunk in 0..chunks {
            let waits = |piece: usize| self.waits.get(piece).copied().unwrap_or_default();
            let kept = touched(pairs, chunk, seats, pieces).any(waits)
                && ends(pairs, chunk, seats).any(waits);
            self.kept.push(if kept { self.kept_chunks as u32 } else { NO_PLACE });
            self.kept_chunks += usize::from(kept);
        }
    }

    /// See what each strip hands to the one before it: all of its deferred pieces, if they are touched by no other.
    fn hand_over(&mut self, pairs: &PairList, seats: Seats<'_>) {
        self.finished.clone_from(&self.pieces);
        self.next_chunks.clear();
        for strip in 0..self.count() {
            let own = if strip + 1 < self.count() { self.own(strip + 1) } else { 0..0 };
            let mut deferred = own.clone().filter(|&piece| self.waits[piece]);
            let alone = deferred.clone().all(|piece| self.touched_by[piece] == strip as u32);
            let Some(last) = deferred.next_back().filter(|_| alone) else {
                self.next_chunks.push(0..0);
                continue;
            };
            // What lies between them waits with them.
            self.waits[own.start..=last].fill(true);
            self.finished[strip + 1] = last as u32 + 1;
            let next = self.chunks[strip + 1] as usize..self.chunks[strip + 2] as usize;
            let owner = |chunk: usize| seats.body(pairs.owner(chunk * CHUNK)) / PIECE;
            let touching = next.clone().take_while(|&chunk| owner(chunk) <= last).count();
            self.next_chunks.push(next.start..next.start + touching);
        }
    }

    /// Pieces of bodies of a strip.
    fn own(&self, strip: usize) -> Range<usize> {
        self.pieces[strip] as usize..self.pieces[strip + 1] as usize
    }

    /// Pieces that have moved on before all strips were done.
    pub(crate) fn moved(&self, yields: &[StripYield]) -> impl Iterator<Item = u32> {
        yields.iter().enumerate().flat_map(move |(strip, to)| {
            let own = self.finished[strip] as usize..self.finished[strip + 1] as usize;
            let taken = if to.took_over { self.handed(strip) } else { 0..0 };
            let gone = own.take_while(|&piece| piece < to.drifted);
            gone.filter(move |piece| taken.contains(piece) || !self.waits[*piece])
                .map(|piece| piece as u32)
        })
    }

    /// Whether a chunk of a strip touches nothing but its own bodies and deferred ones.
    pub(crate) fn stays_within(
        &self,
        strip: usize,
        pairs: &PairList,
        chunk: usize,
        seats: Seats<'_>,
    ) -> bool {
        let own = self.own(strip);
        ends(pairs, chunk, seats).all(|piece| own.contains(&piece) || self.waits[piece])
    }
}

/// Pieces between the first and the last that a chunk may touch.
fn touched(pairs: &PairList, chunk: usize, seats: Seats<'_>, pieces: usize) -> Range<usize> {
    let first = seats.body(pairs.owner(chunk * CHUNK));
    first / PIECE..(first + pairs.window).div_ceil(PIECE).min(pieces)
}

/// Pieces of the spheres of a chunk, padding included.
pub(crate) fn ends(
    pairs: &PairList,
    chunk: usize,
    seats: Seats<'_>,
) -> impl Iterator<Item = usize> {
    let own = chunk * CHUNK..((chunk + 1) * CHUNK).min(pairs.near_begin);
    let places = pairs.first[own.clone()].iter().chain(&pairs.second[own]);
    places.map(move |&place| seats.body(place as usize) / PIECE)
}

fn holds(outer: &Range<usize>, inner: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::neighbour::verlet_list::Found;

    /// Spheres of which each touches the next and the one `reach` further on, with or without a link from the
    /// last back to the first.
    fn chain(spheres: u32, reach: u32, closed: bool) -> PairList {
        let mut touching: Vec<_> = (0..spheres)
            .flat_map(|k| [1, reach].map(|d| [k, k + d]))
            .filter(|pair| pair[1] < spheres)
            .collect();
        if closed {
            touching.push([spheres - 1, 0]);
        }
        PairList::of(spheres as usize, Found { touching, near: Vec::new() })
    }

    #[test]
    fn strips_that_take_longer_get_less() {
        let (pairs, mut strips) = (chain(20_000, 70, false), Strips::default());
        // The second core does half as much in the same time.
        let speed = [1.0, 0.5];
        let mut last = 0.0;
        for _ in 0..12 {
            strips.cut(&pairs, 20_000, 2, Seats::OWN);
            let own = [0, 1].map(|k| strips.own(k).len() as f64);
            let steps = [0, 1]
                .map(|k| StripYield { seconds: own[k] / speed[k] * 1e-6, ..StripYield::default() });
            strips.note(&steps);
            strips.note(&steps);
            strips.forget();
            last = own[0] / own[1];
        }
        assert!((last / 2.0 - 1.0).abs() < 0.03, "{last}");
        // A core that is taken away for long does not lose all.
        for _ in 0..20 {
            let stuck = StripYield { seconds: 1.0, ..StripYield::default() };
            strips.note(&[StripYield { seconds: 1e-6, ..stuck }, stuck]);
            strips.cut(&pairs, 20_000, 2, Seats::OWN);
        }
        let own = [0, 1].map(|k| strips.own(k).len() as f64);
        assert!((own[0] / own[1] - 4.0).abs() < 0.1, "{own:?}");
    }

    #[test]
    fn what_only_neighbours_touch_is_handed_to_the_earlier_one() {
        for (closed, count) in [(false, 2), (false, 5), (true, 3)] {
            let (pairs, mut strips) = (chain(5000, 70, closed), Strips::default());
            strips.cut(&pairs, 5000, count, Seats::OWN);
            let touched = |chunk: usize| ends(&pairs, chunk, Seats::OWN);
            for strip in 0..count - 1 {
                // The end of a closed chain is touched by its first strip too, which lies far from it.
                let handed = strips.handed(strip);
                assert_eq!(handed.is_empty(), closed && strip + 2 == count, "{strip} of {count}");
                assert!(handed.clone().all(|piece| strips.waits(piece)));
                if handed.is_empty() {
                    continue;
                }
                let next = strips.chunks[strip + 1] as usize..strips.chunks[strip + 2] as usize;
                let touching = |chunk: &usize| touched(*chunk).any(|p| handed.contains(&p));
                let last = next.clone().rfind(touching).unwrap();
                assert!((next.start..last + 1) == strips.next_chunks(strip));
                let others = (0..pairs.touching.div_ceil(CHUNK))
                    .filter(|chunk| *chunk < strips.chunks[strip] as usize || next.end <= *chunk);
                assert_eq!(others.filter(touching).count(), 0);
                // It is handed over as soon as those are passed.
                strips.begin();
                strips.pass(strip + 1, last, false);
                assert_eq!(strips.are_handed(strip), None);
                strips.pass(strip + 1, last + 1, true);
                assert_eq!(strips.are_handed(strip), Some(true));
            }
            assert!(strips.handed(count - 1).is_empty());
            let mut yields = vec![StripYield::default(); count];
            strips.see_what_is_left(&yields);
            assert_eq!(strips.left, strips.deferred);
            yields.iter_mut().for_each(|strip| strip.took_over = true);
            strips.see_what_is_left(&yields);
            let handed: usize = (0..count).map(|strip| strips.handed(strip).len()).sum();
            assert_eq!(strips.left.len(), strips.deferred.len() - handed);
            assert_eq!(strips.left.is_empty(), !closed);
        }
    }

    #[test]
    fn what_two_strips_touch_is_deferred_and_its_wrenches_are_kept() {
        for (closed, count) in [(false, 1), (false, 2), (false, 5), (true, 3)] {
            let (pairs, mut strips) = (chain(5000, 70, closed), Strips::default());
            strips.cut(&pairs, 5000, count, Seats::OWN);
            assert_eq!(strips.count(), count);
            assert!(strips.pay(), "{} of 79", strips.deferred.len());
            let mut touches = vec![Vec::new(); 5000];
            for strip in 0..count {
                for chunk in strips.chunks[strip] as usize..strips.chunks[strip + 1] as usize {
                    assert!(strips.stays_within(strip, &pairs, chunk, Seats::OWN));
                    for pair in chunk * CHUNK..((chunk + 1) * CHUNK).min(pairs.touching) {
                        for place in [pairs.first[pair], pairs.second[pair]] {
                            touches[place as usize].push((strip, chunk));
                        }
                    }
                }
            }
            for (place, touched) in touches.iter().enumerate() {
                let piece = place / PIECE;
                let own = strips.pieces.iter().rposition(|&p| p as usize <= piece).unwrap();
                let alone = touched.iter().all(|&(strip, _)| strip == own);
                assert!(alone || strips.waits(piece), "{place}");
                assert!(!strips.waits(piece) || touched.iter().all(|&(_, c)| strips.keep(c)));
            }
        }
    }
}
