//! How one pass over contacts and bodies is shared out.
//!
//! A strip is a run of chunks of touching pairs with the run of bodies that own most of them; a thread goes through one
//! strip as one thread goes through all. Bodies of a strip are touched by its own chunks and by few of earlier strips. Those
//! chunks are computed *ahead*, together with walls and near pairs, while no body moves yet, and their wrenches are kept.
//! In their turn the strip that they belong to adds these instead of computing them; each later strip begins with those that its own
//! bodies receive. So a strip reads and writes no bodies but its own, waits for nobody, and every sum is that of the order of the list.
//!
//! Strips that took longer than others get less when the next list is cut: cores are not equally fast, above all
//! those that others work on as well. Where strips are cut changes no bit of what comes out.

mod shares;

use std::ops::Range;

pub(crate) use shares::Shares;

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
    /// Chunks that are computed ahead, and which of them is the first of each strip.
    ahead: Vec<u32>,
    ahead_start: Vec<u32>,
    /// Which of them is the first for each thread, and their end.
    ahead_share: Vec<u32>,
    /// Of each part of them that one thread computes which is the first, and what bodies of another strip they touch.
    foreign: Vec<(u32, Range<usize>)>,
    /// Where the wrenches of each chunk are kept, in chunks: [`NO_PLACE`] where it is not computed ahead.
    kept: Vec<u32>,
    /// What bodies of strips receive from chunks of earlier ones, in the order of the list, and where that of each strip begins.
    received: Vec<Received>,
    received_start: Vec<u32>,
    /// Share of the work of each strip; none before one was timed.
    shares: Vec<f64>,
    /// What each has taken since the list was cut, s.
    taken: Vec<f64>,
}

/// A kept wrench on a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Received {
    /// Where it is kept, twice, plus one where it acts on the second of its spheres.
    pub(crate) wrench: u32,
    pub(crate) body: u32,
}

/// The place of a chunk whose wrenches are not kept.
const NO_PLACE: u32 = u32::MAX;

/// Most bodies of another strip that are asked for beforehand: those of a few layers.
const MOST_FOREIGN: usize = 1024;

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

    /// Whether few enough chunks are computed ahead that they gain anything: where all pairs of the first of two strips reach into the
    /// second, as between spheres on several grids, they are half of all.
    pub(crate) fn pay(&self) -> bool {
        3 * self.ahead.len() <= self.kept.len()
    }

    /// Which of the chunks that are computed ahead is the first for each thread, and their end: of those that lie between two strips
    /// both have a half.
    pub(crate) fn ahead_share(&self) -> &[u32] {
        &self.ahead_share
    }

    /// Chunks that are computed ahead, in order.
    pub(crate) fn ahead(&self) -> &[u32] {
        &self.ahead
    }

    /// Where the wrenches of a chunk are kept, in chunks, if it is computed ahead.
    #[inline(always)]
    pub(crate) fn kept(&self, chunk: usize) -> Option<usize> {
        let place = self.kept[chunk];
        (place != NO_PLACE).then_some(place as usize)
    }

    /// What bodies of a strip receive from chunks of earlier ones.
    pub(crate) fn received(&self, strip: usize) -> &[Received] {
        let at = |strip: usize| self.received_start.get(strip).map_or(0, |&start| start as usize);
        &self.received[at(strip)..at(strip + 1)]
    }

    /// What bodies of another strip are touched by the chunks that are computed ahead from the `nth` on, if a thread begins with that:
    /// another core has them.
    pub(crate) fn foreign(&self, nth: usize) -> Option<Range<usize>> {
        let of = self.foreign.iter().find(|(first, _)| *first as usize == nth);
        of.map(|(_, bodies)| bodies.clone())
    }

    /// Room that kept wrenches need.
    pub(crate) fn room(&self) -> usize {
        self.ahead.len() * CHUNK
    }

    /// Cut a list of pairs of so many bodies.
    pub(crate) fn cut(&mut self, pairs: &PairList, bodies: usize, strips: usize, seats: Seats<'_>) {
        self.share_out(strips);
        self.cut_by_shares(pairs, bodies, strips, 0, seats);
        // What is computed ahead is no work of the strip.
        if let Some(each) = (self.ahead.len() * CHUNK).checked_div(strips - 1) {
            self.cut_by_shares(pairs, bodies, strips, each, seats);
        }
        self.see_what_is_received(pairs, bodies, seats);
    }

    /// Cut it so that every strip has its share of the work, if so many pairs of every strip but the last are none.
    fn cut_by_shares(
        &mut self,
        pairs: &PairList,
        bodies: usize,
        strips: usize,
        ahead: usize,
        seats: Seats<'_>,
    ) {
        let (pieces, chunks) = (bodies.div_ceil(PIECE), pairs.touching.div_ceil(CHUNK));
        let first = |piece: usize| seats.first((piece * PIECE).min(bodies));
        let start = |piece: usize| pairs.touching_start[first(piece)] as usize;
        let work = |piece: usize| start(piece) + (piece * PIECE).min(bodies);
        let all = work(pieces).saturating_sub((strips - 1) * ahead);
        self.chunks.clear();
        self.pieces.clear();
        let (mut piece, mut shares) = (0, 0.0);
        for strip in 0..=strips {
            let before = (all as f64 * shares) as usize + strip * ahead;
            shares += self.shares.get(strip).copied().unwrap_or_default();
            while piece < pieces && (work(piece) < before || strip == strips) {
                piece += 1;
            }
            let chunk = if strip == 0 { 0 } else { start(piece).div_ceil(CHUNK) };
            self.pieces.push(piece as u32);
            self.chunks.push(chunk.min(chunks) as u32);
        }
        self.look_ahead(pairs, bodies, chunks, seats);
    }

    /// See which chunks are computed ahead, by whom, and who receives what from them.
    fn look_ahead(&mut self, pairs: &PairList, bodies: usize, chunks: usize, seats: Seats<'_>) {
        begin_anew(&mut self.kept, chunks);
        begin_anew(&mut self.ahead, chunks);
        begin_anew(&mut self.foreign, 2 * self.chunks.len());
        begin_anew(&mut self.ahead_start, self.chunks.len());
        begin_anew(&mut self.ahead_share, self.chunks.len());
        self.kept.resize(chunks, NO_PLACE);
        self.ahead_share.push(0);
        for strip in 0..self.count() {
            let begin = self.ahead.len();
            self.ahead_start.push(begin as u32);
            let end = self.own(strip, bodies).end;
            let body = |sphere: usize| seats.body(sphere);
            let mut reach = end;
            for chunk in self.chunks[strip] as usize..self.chunks[strip + 1] as usize {
                // Most chunks touch no other strip.
                if body(pairs.owner(chunk * CHUNK)) + pairs.window <= end {
                    continue;
                }
                let last = ends(pairs, chunk).map(body).max().unwrap_or_default();
                if last >= end {
                    self.kept[chunk] = self.ahead.len() as u32;
                    self.ahead.push(chunk as u32);
                    reach = reach.max(last + 1);
                }
            }
            let own = &self.ahead[begin..];
            let half = own.len().div_ceil(2);
            self.ahead_share.push((begin + half) as u32);
            if !own.is_empty() {
                self.foreign.push((begin as u32, end..reach.min(end + MOST_FOREIGN)));
            }
            if let Some(&chunk) = own.get(half) {
                let owner = body(pairs.owner(chunk as usize * CHUNK));
                let from = owner.max(end.saturating_sub(MOST_FOREIGN)).min(end);
                self.foreign.push(((begin + half) as u32, from..end));
            }
        }
        self.ahead_start.push(self.ahead.len() as u32);
        if let Some(end) = self.ahead_share.last_mut() {
            *end = self.ahead.len() as u32;
        }
    }

    /// See what bodies of strips receive from chunks of earlier ones, if they pay.
    fn see_what_is_received(&mut self, pairs: &PairList, bodies: usize, seats: Seats<'_>) {
        // As many as there can be where strips pay.
        let most = if self.count() > 1 { self.kept.len() * CHUNK } else { 0 };
        begin_anew(&mut self.received, most);
        begin_anew(&mut self.received_start, self.chunks.len());
        if !self.pay() {
            return;
        }
        for strip in 0..self.count() {
            self.received_start.push(self.received.len() as u32);
            let own = self.own(strip, bodies);
            let earlier = &self.ahead[..self.ahead_start[strip] as usize];
            for (kept, &chunk) in earlier.iter().enumerate() {
                let begin = chunk as usize * CHUNK;
                for pair in begin..(begin + CHUNK).min(pairs.touching) {
                    for (role, sphere) in [pairs.first[pair], pairs.second[pair]].iter().enumerate()
                    {
                        let body = seats.body(*sphere as usize);
                        if own.contains(&body) {
                            let wrench = (2 * (kept * CHUNK + pair - begin) + role) as u32;
                            self.received.push(Received { wrench, body: body as u32 });
                        }
                    }
                }
            }
        }
        self.received_start.push(self.received.len() as u32);
    }

    /// Bodies of a strip, of so many.
    pub(crate) fn own(&self, strip: usize, bodies: usize) -> Range<usize> {
        let at = |piece: u32| (piece as usize * PIECE).min(bodies);
        at(self.pieces[strip])..at(self.pieces[strip + 1])
    }

    /// Pieces that have moved on before all strips were done.
    pub(crate) fn moved(&self, yields: &[StripYield]) -> impl Iterator<Item = u32> {
        yields.iter().enumerate().flat_map(move |(strip, to)| {
            let own = self.pieces[strip]..self.pieces[strip + 1];
            own.take_while(|&piece| (piece as usize) < to.drifted)
        })
    }

    /// Whether a chunk of a strip touches nothing but its own bodies, of so many.
    pub(crate) fn stays_within(
        &self,
        strip: usize,
        pairs: &PairList,
        chunk: usize,
        (seats, bodies): (Seats<'_>, usize),
    ) -> bool {
        let own = self.own(strip, bodies);
        ends(pairs, chunk).all(|sphere| own.contains(&seats.body(sphere)))
    }
}

/// Empty it, with room for so many and some more: where strips are cut is a matter of time, and a step asks for no memory.
fn begin_anew<T>(of: &mut Vec<T>, most: usize) {
    of.clear();
    if of.capacity() < most {
        of.reserve(most + most / 4);
    }
}

/// Spheres of a chunk, padding included.
pub(crate) fn ends(pairs: &PairList, chunk: usize) -> impl Iterator<Item = usize> {
    let own = chunk * CHUNK..((chunk + 1) * CHUNK).min(pairs.near_begin);
    let places = pairs.first[own.clone()].iter().chain(&pairs.second[own]);
    places.map(|&place| place as usize)
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
            let own = [0, 1].map(|k| strips.own(k, 20_000).len() as f64);
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
        let own = [0, 1].map(|k| strips.own(k, 20_000).len() as f64);
        assert!((own[0] / own[1] - 4.0).abs() < 0.1, "{own:?}");
    }

    #[test]
    fn what_touches_a_later_strip_is_computed_ahead_and_its_wrenches_are_received() {
        const BODIES: usize = 5000;
        for (closed, count) in [(false, 1), (false, 2), (false, 5), (true, 3)] {
            let (pairs, mut strips) = (chain(BODIES as u32, 70, closed), Strips::default());
            strips.cut(&pairs, BODIES, count, Seats::OWN);
            assert_eq!(strips.count(), count);
            assert!(strips.pay(), "{:?}", strips.ahead());
            assert_eq!(strips.ahead().is_empty(), count == 1);
            // What every body gets: from the strip that it is in and what that receives, every pair once, in the order of the list.
            let mut gets = vec![Vec::new(); BODIES];
            let mut expected = vec![Vec::new(); BODIES];
            for pair in 0..pairs.touching {
                for place in [pairs.first[pair], pairs.second[pair]] {
                    expected[place as usize].push(pair);
                }
            }
            for strip in 0..count {
                let own = strips.own(strip, BODIES);
                for of in strips.received(strip) {
                    assert!(own.contains(&(of.body as usize)), "{of:?} of {own:?}");
                    let (kept, role) = ((of.wrench / 2) as usize, of.wrench % 2);
                    let chunk = strips.ahead()[kept / CHUNK] as usize;
                    assert!(chunk < strips.chunks[strip] as usize);
                    assert_eq!(strips.kept(chunk), Some(kept / CHUNK));
                    let pair = chunk * CHUNK + kept % CHUNK;
                    assert_eq!([pairs.first[pair], pairs.second[pair]][role as usize], of.body);
                    gets[of.body as usize].push(pair);
                }
                for chunk in strips.chunks[strip] as usize..strips.chunks[strip + 1] as usize {
                    let within = strips.stays_within(strip, &pairs, chunk, (Seats::OWN, BODIES));
                    assert!(within || strips.kept(chunk).is_some(), "{chunk}");
                    for pair in chunk * CHUNK..((chunk + 1) * CHUNK).min(pairs.touching) {
                        for place in [pairs.first[pair], pairs.second[pair]] {
                            assert!(place as usize >= own.start, "nobody reaches back");
                            if own.contains(&(place as usize)) {
                                gets[place as usize].push(pair);
                            }
                        }
                    }
                }
            }
            assert!(gets == expected, "{closed} {count}");
        }
    }

    #[test]
    fn strips_whose_pairs_all_reach_into_the_next_one_do_not_pay() {
        for (reach, pays) in [(70, true), (500, true), (4000, false)] {
            let (pairs, mut strips) = (chain(8000, reach, false), Strips::default());
            strips.cut(&pairs, 8000, 2, Seats::OWN);
            assert_eq!(
                strips.pay(),
                pays,
                "{reach}: {} of {}",
                strips.ahead().len(),
                strips.kept.len()
            );
            assert_eq!(strips.received.is_empty(), !pays);
        }
    }

    #[test]
    fn of_what_lies_between_two_strips_both_threads_have_a_half() {
        const BODIES: usize = 9000;
        let (pairs, mut strips) = (chain(BODIES as u32, 700, false), Strips::default());
        strips.cut(&pairs, BODIES, 3, Seats::OWN);
        let (start, share) = (&strips.ahead_start, strips.ahead_share());
        assert!(share.is_sorted() && share[0] == 0 && share[3] as usize == strips.ahead().len());
        for strip in 0..2 {
            let own = start[strip]..start[strip + 1];
            assert!(
                own.len() > 3 && share[strip + 1] == own.start + (own.end - own.start).div_ceil(2)
            );
            // Each asks for what the other has.
            let end = strips.own(strip, BODIES).end;
            let [theirs, ours] = [own.start, share[strip + 1]]
                .map(|nth| strips.foreign(nth as usize).expect("a part begins there"));
            assert!(theirs.start == end && (600..=700).contains(&theirs.len()), "{theirs:?}");
            let chunk = strips.ahead()[share[strip + 1] as usize] as usize;
            assert_eq!(ours, pairs.owner(chunk * CHUNK)..end);
            assert!(strips.foreign(own.start as usize + 1).is_none());
        }
    }
}
