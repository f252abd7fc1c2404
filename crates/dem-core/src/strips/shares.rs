//! How walls and near pairs are shared out: to each thread those of the bodies that it moves in its strip; and what is computed ahead:
//! to two neighbours a half each.
//!
//! What a thread has moved lies in its own cache, and what another has moved has to come from there, which takes as long as from memory
//! where cores are far from each other. Near pairs keep their chunks. The entries of walls go in runs as long as may be, since
//! each run leaves registers half empty, once for every wall. Any thread may take what another has not begun: where they are cut
//! changes no bit of what comes out.

use crate::contact_stage::CHUNK;
use crate::neighbour::verlet_list::PairList;
use crate::neighbour::wall_list::WallList;
use crate::spheres::Seats;
use crate::strips::Strips;
use crate::sums::PIECE;

/// Most entries of walls in a run.
const LONGEST: usize = 1024;

/// How walls and near pairs of a list are shared out.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shares {
    /// First entry of each run of walls, and the end of the last; nothing before they are shared out.
    pub(crate) entries: Vec<u32>,
    /// First run of each thread, and the end of the last one; nothing where all have as many.
    pub(crate) walls: Vec<u32>,
    /// First chunk of near pairs of each, likewise.
    pub(crate) near: Vec<u32>,
    /// First chunk of touching pairs that are computed ahead of each, likewise.
    pub(crate) ahead: Vec<u32>,
}

impl Shares {
    /// Forget them, since the list has changed.
    pub(crate) fn forget(&mut self) {
        self.entries.clear();
    }

    /// How many runs of walls there are.
    pub(crate) fn runs(&self) -> usize {
        self.entries.len().saturating_sub(1)
    }

    /// Share out evenly what is not shared out yet, to its end.
    pub(crate) fn cover(&mut self, walls: &WallList) {
        if self.entries.last().is_none_or(|&end| end as usize != walls.len()) {
            self.entries.clear();
            self.walls.clear();
            self.near.clear();
            self.ahead.clear();
            self.add(0..walls.len(), CHUNK);
        }
    }

    /// Share out by the strips of a list.
    pub(crate) fn follow(
        &mut self,
        strips: &Strips,
        pairs: &PairList,
        walls: &WallList,
        seats: Seats<'_>,
        bodies: usize,
    ) {
        [&mut self.entries, &mut self.walls, &mut self.near].into_iter().for_each(Vec::clear);
        let near = pairs.near();
        let chunks = near.len().div_ceil(CHUNK);
        let place = |piece: u32| seats.first((piece as usize * PIECE).min(bodies));
        for of in strips.pieces.windows(2) {
            let (begin, end) = (place(of[0]), place(of[1]));
            self.walls.push(self.runs() as u32);
            self.add(walls.start[begin] as usize..walls.start[end] as usize, LONGEST);
            let before = pairs.near_start[begin] as usize - near.start;
            self.near.push(before.div_ceil(CHUNK).min(chunks) as u32);
        }
        self.walls.push(self.runs() as u32);
        self.near.push(chunks as u32);
        self.ahead.clear();
        self.ahead.extend_from_slice(strips.ahead_share());
    }

    /// Cut more entries into even runs.
    fn add(&mut self, own: std::ops::Range<usize>, longest: usize) {
        if self.entries.is_empty() {
            self.entries.push(own.start as u32);
        }
        let runs = own.len().div_ceil(longest);
        self.entries.extend((1..=runs).map(|run| (own.start + own.len() * run / runs) as u32));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::neighbour::verlet_list::Found;

    /// Spheres in a row of which each touches the next and is near the two behind it, and a wall that the first third and the last
    /// sphere are near, twice each.
    fn row(spheres: u32) -> (PairList, WallList) {
        let pairs = |by: &[u32]| {
            let ends = |k: u32| by.iter().map(move |d| [k, k + d]);
            (0..spheres).flat_map(ends).filter(|pair| pair[1] < spheres).collect::<Vec<_>>()
        };
        let found = Found { touching: pairs(&[1]), near: pairs(&[2, 3]) };
        let mut walls = WallList::default();
        for k in (0..spheres / 3).chain([spheres - 1]) {
            walls.close(k as usize);
            walls.sphere.extend([k, k]);
        }
        walls.close(spheres as usize);
        (PairList::of(spheres as usize, found), walls)
    }

    #[test]
    fn every_thread_has_the_walls_and_near_pairs_of_its_own_bodies() {
        const BODIES: usize = 9000;
        let (pairs, walls) = row(BODIES as u32);
        for threads in [1, 2, 5] {
            let (mut strips, mut shares) = (Strips::default(), Shares::default());
            strips.cut(&pairs, BODIES, threads, Seats::OWN);
            shares.follow(&strips, &pairs, &walls, Seats::OWN, BODIES);
            assert!(shares.entries.is_sorted() && shares.entries.first() == Some(&0));
            assert_eq!(shares.entries.last(), Some(&(walls.len() as u32)));
            let run_ends = shares.entries.windows(2);
            assert!(run_ends.clone().all(|run| run[1] - run[0] <= LONGEST as u32));
            for (of, all) in
                [(&shares.walls, shares.runs()), (&shares.near, pairs.near().len().div_ceil(CHUNK))]
            {
                assert!(of.len() == threads + 1 && of.is_sorted());
                assert!(of[0] == 0 && of[threads] as usize == all, "{of:?} of {all}");
            }
            for k in 0..threads {
                let own = [k, k + 1].map(|k| strips.pieces[k] as usize * PIECE);
                let begin = |of: &[u32]| [of[k] as usize, of[k + 1] as usize];
                let entries = begin(&shares.walls).map(|run| shares.entries[run] as usize);
                let spheres = &walls.sphere[entries[0]..entries[1]];
                assert!(spheres.iter().all(|s| (own[0]..own[1]).contains(&(*s as usize))));
                for chunk in begin(&shares.near)[0]..begin(&shares.near)[1] {
                    let owner = pairs.owner(pairs.near().start + chunk * CHUNK);
                    assert!((own[0]..own[1]).contains(&owner), "{owner} of {own:?}");
                }
            }
        }
    }

    #[test]
    fn without_strips_runs_are_chunks_until_the_list_changes() {
        let (_, walls) = row(900);
        let mut shares = Shares::default();
        shares.cover(&walls);
        assert_eq!(shares.entries, [0, 200, 401, 602]);
        assert!(shares.walls.is_empty() && shares.near.is_empty());
        let before = shares.entries.as_ptr();
        shares.cover(&walls);
        assert_eq!(
            (shares.entries.as_ptr(), shares.runs()),
            (before, 3),
            "the list has not changed"
        );
        shares.cover(&row(90).1);
        assert_eq!(shares.entries, [0, 62], "one of other entries is not covered by these");
        shares.forget();
        shares.cover(&WallList::default());
        assert_eq!((shares.runs(), &shares.entries[..]), (0, &[0][..]));
    }
}
