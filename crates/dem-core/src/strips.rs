//! How one pass over contacts and bodies is shared out.
//!
//! A strip is a run of chunks of touching pairs with the run of bodies that own most of them; a thread goes through one
//! strip as one thread goes through all. Where a body is touched by pairs of another strip than its own, it has to
//! wait for both: it is *deferred*. A strip reads deferred bodies but leaves them as they are, and the wrenches of
//! the chunks that touch them are kept, so that a later stage finds them. All other bodies are read and
//! written by their own strip alone. Bodies are told by pieces: a piece is deferred if one of its bodies is.
//!
//! Strips that took longer than others get less when the next list is cut: cores are not equally fast, above all
//! those that others work on as well. Where strips are cut changes no bit of what comes out.

use crate::contact_stage::CHUNK;
use crate::neighbour::verlet_list::PairList;
use crate::spheres::Seats;
use crate::sums::PIECE;
use crate::world::StripYield;

/// The strips of a list of pairs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Strips {
    /// First chunk of pairs of each strip, and the end of the last one; nothing before the list is cut.
    pub(crate) chunks: Vec<u32>,
    /// First piece of bodies of each, and the end of the last one.
    pub(crate) pieces: Vec<u32>,
    /// Deferred pieces.
    pub(crate) deferred: Vec<u32>,
    /// Whether a piece is deferred.
    waits: Vec<bool>,
    /// Whether the wrenches of a chunk are kept.
    kept: Vec<bool>,
    /// Share of the work of each strip; none before one was timed.
    shares: Vec<f64>,
    /// What each has taken since the list was cut, s.
    taken: Vec<f64>,
}

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

    /// Whether a piece of bodies is deferred.
    #[inline(always)]
    pub(crate) fn waits(&self, piece: usize) -> bool {
        self.waits[piece]
    }

    /// Whether the wrenches of a chunk are kept.
    #[inline(always)]
    pub(crate) fn keep(&self, chunk: usize) -> bool {
        self.kept[chunk]
    }

    /// Chunks whose wrenches are kept.
    pub(crate) fn kept(&self) -> impl Iterator<Item = usize> {
        self.kept.iter().enumerate().filter(|(_, kept)| **kept).map(|(chunk, _)| chunk)
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
        self.deferred.clear();
        // Room for all, since where strips are cut is a matter of time: a step asks for no memory.
        self.deferred.reserve(pieces);
        for strip in 0..self.count() {
            let own = self.own(strip);
            let chunks = self.chunks[strip] as usize..self.chunks[strip + 1] as usize;
            // Most chunks touch no other strip.
            for chunk in chunks.filter(|&c| !holds(&own, &touched(pairs, c, seats, pieces))) {
                for piece in ends(pairs, chunk, seats).filter(|piece| !own.contains(piece)) {
                    self.waits[piece] = true;
                }
            }
        }
        self.deferred.extend((0..pieces as u32).filter(|&piece| self.waits[piece as usize]));
        self.kept.clear();
        for chunk in 0..chunks {
            let waits = |piece: usize| self.waits.get(piece).copied().unwrap_or_default();
            let kept = touched(pairs, chunk, seats, pieces).any(waits)
                && ends(pairs, chunk, seats).any(waits);
            self.kept.push(kept);
        }
    }

    /// Pieces of bodies of a strip.
    fn own(&self, strip: usize) -> std::ops::Range<usize> {
        self.pieces[strip] as usize..self.pieces[strip + 1] as usize
    }

    /// Pieces that have moved on before all strips were done.
    pub(crate) fn moved(&self, yields: &[StripYield]) -> impl Iterator<Item = u32> {
        let all = yields.iter().enumerate().flat_map(|(strip, to)| {
            let (own, drifted) = (self.own(strip), to.drifted);
            own.take_while(move |&piece| piece < drifted)
        });
        all.filter(|&piece| !self.waits[piece]).map(|piece| piece as u32)
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
fn touched(
    pairs: &PairList,
    chunk: usize,
    seats: Seats<'_>,
    pieces: usize,
) -> std::ops::Range<usize> {
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

fn holds(outer: &std::ops::Range<usize>, inner: &std::ops::Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::neighbour::verlet_list::Found;

    /// Spheres of which each touches the next and the one `reach` further on, with or without a link from the
    /// last back to the first.
    fn chain(spheres: u32, reach: u32, closed: bool) -> PairList {
        let pair = |first: u32, second: u32| Found { first, second, touching: true };
        let mut found: Vec<_> = (0..spheres)
            .flat_map(|k| [1, reach].map(|d| pair(k, k + d)))
            .filter(|f| f.second < spheres)
            .collect();
        if closed {
            found.push(pair(spheres - 1, 0));
        }
        let mut list = PairList::default();
        list.fill(spheres as usize, 1, &[found], &PairList::default(), None, Seats::OWN);
        list
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
