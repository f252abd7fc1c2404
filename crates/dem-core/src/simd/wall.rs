//! Contacts of spheres with analytic walls, eight at a time, wall by wall.
//!
//! First every entry of the list is held against its wall without a root; those that may touch,
//! or did, are collected by wall and computed in groups of eight by the laws of
//! `hertz_mindlin.rs`. Operation by operation as `touch_wall` in `forces.rs` and the shapes'
//! `nearest`: `simd_and_portable_kernels_agree_bit_by_bit` tells.

use super::carried::{Before, Remembered};
use super::facing::{Faced, Near, brush, face, nearest, nearest_alone};
use super::hertz_mindlin::{Laws, SLOTS, respond};
use super::lanes::{Lanes, V3, begins};
use super::pairs::{PairKernel, on_clump};
use super::{Arithmetic, Level, widened};
use crate::forces::{ChunkYield, TOUCHES};
use crate::geometry::PlacedWall;
use crate::neighbour::search::lowest_bits;
use crate::neighbour::verlet_list::memory_index;
use crate::neighbour::wall_gaps::{ENTRIES, Far};
use crate::particles::Record;
use crate::threads::View;

/// A chunk of the wall list.
pub(crate) struct WallRun<'a> {
    pub(crate) walls: &'a [PlacedWall],
    pub(crate) sphere: &'a [u32],
    pub(crate) wall: &'a [u16],
    pub(crate) active: &'a mut [u8],
    pub(crate) memory: &'a mut [f64],
    pub(crate) force: &'a mut [Record],
    pub(crate) torque: &'a mut [Record],
    pub(crate) on_wall: &'a mut [Record],
    /// Which entries are far, if those without a mark have no wrench already.
    pub(crate) far: Option<Far<'a>>,
}

/// Most entries that are collected before they are computed.
const HITS: usize = ENTRIES;

impl PairKernel<'_> {
    /// Compute a chunk of the wall list.
    pub(crate) fn wall_contacts(&self, level: Level, run: &mut WallRun<'_>, into: &mut ChunkYield) {
        let (mut begin, mut g) = (0, Group::EMPTY);
        while begin < run.sphere.len() {
            let mut hits = [0u32; HITS];
            let end = (begin + HITS).min(run.sphere.len());
            let mut count = self.hits(run, begin..end, &mut hits);
            // Those of the first one's wall, eight by eight; the others move up.
            while count > 0 {
                let wall = run.wall[hits[0] as usize];
                let (mut same, mut own, mut left) = ([0u32; HITS], 0, 0);
                for h in 0..count {
                    // Written to both, counted in one: walls follow each other by chance.
                    let entry = hits[h];
                    let mine = run.wall[entry as usize] == wall;
                    (same[own], hits[left]) = (entry, entry);
                    own += usize::from(mine);
                    left += usize::from(!mine);
                }
                count = left;
                if self.wall_in_stages(level, run, wall, &same[..own], into) {
                    continue;
                }
                for group in same[..own].chunks(8) {
                    self.group(level, run, wall, group, &mut g, into);
                }
            }
            begin = end;
        }
    }

    /// Collect the entries that may touch or did; the others have no force.
    fn hits(
        &self,
        run: &mut WallRun<'_>,
        entries: std::ops::Range<usize>,
        hits: &mut [u32; HITS],
    ) -> usize {
        let Some(far) = run.far.filter(Far::is_known) else {
            return self.hits_of(run, entries, hits);
        };
        let mut near = [0; HITS];
        let some = far.near(entries.clone(), run.active, &mut near);
        debug_assert!(
            (entries.start as u32..entries.end as u32)
                .filter(|e| near[..some].binary_search(e).is_err())
                .all(|e| {
                    let centre = &self.spheres.position[run.sphere[e as usize] as usize];
                    run.walls[usize::from(run.wall[e as usize])].misses(centre.vector(), centre.w)
                }),
            "a sphere that is told to be far does not touch"
        );
        self.hits_of(run, near[..some].iter().map(|e| *e as usize), hits)
    }

    /// The same for some entries.
    #[inline(always)]
    fn hits_of(
        &self,
        run: &mut WallRun<'_>,
        entries: impl Iterator<Item = usize>,
        hits: &mut [u32; HITS],
    ) -> usize {
        let mut count = 0;
        for e in entries {
            let centre = &self.spheres.position[run.sphere[e] as usize];
            let wall = &run.walls[run.wall[e] as usize];
            let misses = run.active[e] == 0 && wall.misses(centre.vector(), centre.w);
            if misses && run.far.is_none() {
                run.force[e] = Record::ZERO;
                run.torque[e] = Record::ZERO;
                run.on_wall[e] = Record::ZERO;
            }
            hits[count] = e as u32;
            count += usize::from(!misses);
        }
        count
    }

    /// Compute contacts with one wall in stages, where that is done; returns whether it was.
    fn wall_in_stages(
        &self,
        level: Level,
        run: &mut WallRun<'_>,
        wall: u16,
        entries: &[u32],
        into: &mut ChunkYield,
    ) -> bool {
        #[cfg(target_arch = "x86_64")]
        use super::{avx512::Wide, half::Half};
        #[cfg(target_arch = "x86_64")]
        if let (Some(own), false) = (self.one_material, self.spheres.clumps.is_some()) {
            #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,popcnt")]
            unsafe fn avx512<const FUSED: bool, const FAST: bool>(
                k: &PairKernel<'_>,
                run: &mut WallRun<'_>,
                by: (u16, usize),
                entries: &[u32],
                into: &mut ChunkYield,
            ) {
                // SAFETY: by the caller.
                unsafe { k.staged_walls::<Wide<FUSED, FAST>, 8>(run, by, entries, into) }
            }
            #[target_feature(enable = "avx2,fma,popcnt")]
            unsafe fn avx2<const FUSED: bool>(
                k: &PairKernel<'_>,
                run: &mut WallRun<'_>,
                by: (u16, usize),
                entries: &[u32],
                into: &mut ChunkYield,
            ) {
                // SAFETY: by the caller.
                unsafe { k.staged_walls::<Half<FUSED>, 4>(run, by, entries, into) }
            }
            let material = usize::from(run.walls[wall as usize].material.0);
            let by = (wall, own * self.materials + material);
            let of = match (level, self.arithmetic) {
                (Level::Portable, _) => return false,
                (Level::Avx512, Arithmetic::Exact) => avx512::<false, false>,
                (Level::Avx512, Arithmetic::Fused) => avx512::<true, false>,
                (Level::Avx512, Arithmetic::FastRoots) => avx512::<true, true>,
                (Level::Avx2, Arithmetic::Exact) => avx2::<false>,
                (Level::Avx2, _) => avx2::<true>,
            };
            // SAFETY: `level` comes from `Level::detect`, which asked the processor; the lists hold places of spheres.
            unsafe { of(self, run, by, entries, into) };
            return true;
        }
        let _ = (level, run, wall, entries, into);
        false
    }

    /// Compute up to eight contacts with one wall.
    fn group(
        &self,
        level: Level,
        run: &mut WallRun<'_>,
        wall: u16,
        entries: &[u32],
        g: &mut Group,
        into: &mut ChunkYield,
    ) {
        let placed = &run.walls[wall as usize];
        g.valid = lowest_bits(entries.len());
        for lane in 0..8 {
            // Lanes beyond the last repeat the first.
            let e = entries.get(lane).or(entries.first()).map_or(0, |&e| e as usize);
            g.places[lane] = run.sphere[e];
            for slot in 0..SLOTS {
                g.memory[slot][lane] = run.memory[memory_index(SLOTS, e, slot)];
            }
        }
        widened(
            level,
            #[inline(always)]
            || {
                // SAFETY: the lists hold places of spheres.
                #[cfg(target_arch = "x86_64")]
                unsafe {
                    use super::avx2::Pair;
                    use super::avx512::Wide;
                    match (level, self.arithmetic) {
                        (Level::Avx512, Arithmetic::Exact) => {
                            self.contacts::<Wide<false, false>>(placed, g);
                        }
                        (Level::Avx512, Arithmetic::Fused) => {
                            self.contacts::<Wide<true, false>>(placed, g);
                        }
                        (Level::Avx512, Arithmetic::FastRoots) => {
                            self.contacts::<Wide<true, true>>(placed, g);
                        }
                        (Level::Avx2, Arithmetic::Exact) => {
                            self.contacts::<Pair<false>>(placed, g);
                        }
                        (Level::Avx2, _) => self.contacts::<Pair<true>>(placed, g),
                        (Level::Portable, _) => {}
                    }
                }
            },
        );
        for (lane, &e) in entries.iter().enumerate() {
            let e = e as usize;
            run.active[e] = if g.touching >> lane & 1 != 0 { TOUCHES } else { 0 };
            run.force[e] = g.force[lane];
            run.torque[e] = g.torque[lane];
            run.on_wall[e] = g.on_wall[lane];
            for slot in 0..SLOTS {
                run.memory[memory_index(SLOTS, e, slot)] = g.memory[slot][lane];
            }
            if g.deep >> lane & 1 != 0 {
                let sphere = g.places[lane];
                let radius = self.spheres.position[sphere as usize].w;
                into.note_overlap(g.overlap[lane] / radius, sphere, u32::from(wall), true);
            }
        }
    }

    /// # Safety
    /// Every place of the group is that of a sphere.
    #[inline(always)]
    unsafe fn contacts<V: Lanes>(&self, wall: &PlacedWall, g: &mut Group) {
        let s = &self.spheres;
        // SAFETY: by the caller.
        let (p, v, w, end) = unsafe {
            let p = V::gather(s.position, &g.places);
            match &s.clumps {
                Some(c) => {
                    let own = on_clump::<V>(s, c, &[begins(&g.places)], V3::of(p));
                    let [mean, end] = own.moves(c.dt);
                    (p, [mean.x, mean.y, mean.z, own.velocity[3]], own.mean_spin, end)
                }
                None => {
                    let [mean, end] = V::gather_twos(s.velocities, &g.places);
                    (p, mean, V::gather(s.mean_spin, &g.places), V3::of(end))
                }
            }
        };
        let (x, radius, mass) = (V3::of(p), p[3], v[3]);
        let near = nearest::<V>(wall, x, g.valid)
            .unwrap_or_else(|| one_by_one(wall, s.position, &g.places));
        let zero = V::splat(0.0);
        let Faced { touching, deep, pressing } =
            face(wall, &near, (x, end), [radius, mass], g.valid, self.overlap_limit);
        (g.touching, g.deep) = (touching, deep);
        pressing.overlap.store(&mut g.overlap);
        let material = usize::from(wall.material.0);
        let laws = if let Some(own) = self.one_material {
            Laws::<V>::splat(&self.all[own * self.materials + material])
        } else {
            let mut own = [0.0; 8];
            w[3].store(&mut own);
            let law = |_, lane: usize| &self.all[own[lane] as usize * self.materials + material];
            Laws::lanes(law)
        };
        let moves = [V3::of(v), V3::of(w)];
        let (motion, twist) = brush(wall, &near, (x, radius), moves, &pressing, self.dt);
        let (n, dt) = (near.normal, V::splat(self.dt));
        let m = &mut g.memory;
        let spring = V3 { x: V::load(&m[0]), y: V::load(&m[1]), z: V::load(&m[2]) };
        let old = Remembered { spring, stiffness: V::load(&m[3]) };
        let before =
            if V::FUSED { Before::by_itself(&old, old.spring.dot(n)) } else { Before::nothing() };
        let (held, out) = respond::<V, false>(
            (&motion, &pressing),
            [twist, dt],
            &laws,
            self.features,
            (&old, &before),
            touching,
        );
        let none = V3::splat(0.0);
        let spring = held.spring.select(touching, none);
        spring.x.store(&mut m[0]);
        spring.y.store(&mut m[1]);
        spring.z.store(&mut m[2]);
        held.stiffness.select(touching, zero).store(&mut m[3]);
        // On the wall, about the centre of the sphere.
        let on_wall = out.torque_j - (n * motion.lever_i).cross(out.force);
        let f = out.force.select(touching, none);
        V::scatter([f.x, f.y, f.z, zero], &mut g.force);
        let t = out.torque_i.select(touching, none);
        V::scatter([t.x, t.y, t.z, zero], &mut g.torque);
        let t = on_wall.select(touching, none);
        V::scatter([t.x, t.y, t.z, zero], &mut g.on_wall);
    }
}

/// Eight contacts with one wall, outside of registers.
struct Group {
    places: [u32; 8],
    /// Lanes that hold an entry, that touch, that overlap too deeply.
    valid: u8,
    touching: u8,
    deep: u8,
    overlap: [f64; 8],
    memory: [[f64; 8]; SLOTS],
    force: [Record; 8],
    torque: [Record; 8],
    on_wall: [Record; 8],
}

impl Group {
    const EMPTY: Self = Self {
        places: [0; 8],
        valid: 0,
        touching: 0,
        deep: 0,
        overlap: [0.0; 8],
        memory: [[0.0; 8]; SLOTS],
        force: [Record::ZERO; 8],
        torque: [Record::ZERO; 8],
        on_wall: [Record::ZERO; 8],
    };
}

/// `nearest` by the shape's own function; what it knows nothing of stays zero.
#[cold]
fn one_by_one<V: Lanes>(
    wall: &PlacedWall,
    position: View<'_, Record>,
    places: &[u32; 8],
) -> Near<V> {
    let mut columns = [[0.0; 8]; 5];
    for (lane, &place) in places.iter().enumerate() {
        let fields = nearest_alone(wall, position[place as usize].vector()).unwrap_or_default();
        for (column, field) in columns.iter_mut().zip(fields) {
            column[lane] = field;
        }
    }
    let [x, y, z, distance, wall_radius] = &columns;
    Near {
        normal: V3 { x: V::load(x), y: V::load(y), z: V::load(z) },
        distance: V::load(distance),
        wall_radius: V::load(wall_radius),
    }
}
