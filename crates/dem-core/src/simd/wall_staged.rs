//! Contacts of one law with a wall where there is AVX2 alone: part of the work by part, four contacts at a time, as
//! `staged.rs` does it for pairs, to the same bits as `wall.rs`.
#![cfg(target_arch = "x86_64")]

use std::mem::MaybeUninit;

use super::avx::put_quad;
use super::carried::{Before, Remembered};
use super::facing::{Faced, Near, brush, face, nearest, nearest_alone};
use super::gathering::remembered;
use super::half::{Half, Which};
use super::hertz_mindlin::{Laws, Motion, Pressed, SLOTS, answer, press, would_be};
use super::lanes::{Numbers, V3};
use super::pairs::PairKernel;
use super::wall::WallRun;
use crate::forces::{ChunkYield, TOUCHES};
use crate::geometry::PlacedWall;
use crate::neighbour::search::lowest_bits;

/// Groups of four in a batch.
const GROUPS: usize = 8;

/// What contacts know of their spheres, and remember.
struct Given<const FUSED: bool> {
    position: V3<Half<FUSED>>,
    /// Radius and mass.
    size: [Half<FUSED>; 2],
    velocity: V3<Half<FUSED>>,
    spin: V3<Half<FUSED>>,
    end: V3<Half<FUSED>>,
    old: Remembered<Half<FUSED>>,
    near: Near<Half<FUSED>>,
}

/// How they are pressed.
struct Met<const FUSED: bool> {
    faced: Faced<Half<FUSED>>,
    pressed: Pressed<Half<FUSED>>,
    before: Before<Half<FUSED>>,
}

/// How they move, and their springs if nothing slid.
struct Moved<const FUSED: bool> {
    motion: Motion<Half<FUSED>>,
    trial: V3<Half<FUSED>>,
}

/// What the loops hand over, group by group.
struct Desk<const FUSED: bool> {
    /// Entries of the list, and four times the places of their spheres.
    entries: [[u32; 4]; GROUPS],
    places: [[u32; 4]; GROUPS],
    valid: [u8; GROUPS],
    given: [MaybeUninit<Given<FUSED>>; GROUPS],
    met: [MaybeUninit<Met<FUSED>>; GROUPS],
    moved: [MaybeUninit<Moved<FUSED>>; GROUPS],
}

impl PairKernel<'_> {
    /// Compute contacts with one wall by one law.
    ///
    /// # Safety
    /// AVX2 is there, every place is that of a sphere, none of which sits on a clump, and the entries are some of the run's.
    #[inline(always)]
    pub(super) unsafe fn staged_walls<const FUSED: bool>(
        &self,
        run: &mut WallRun<'_>,
        (wall, law): (u16, usize),
        entries: &[u32],
        into: &mut ChunkYield,
    ) {
        let placed = &run.walls[wall as usize];
        let laws = Laws::splat(&self.all[law]);
        let mut desk = Desk::<FUSED> {
            entries: [[0; 4]; GROUPS],
            places: [[0; 4]; GROUPS],
            valid: [0; GROUPS],
            given: [const { MaybeUninit::uninit() }; GROUPS],
            met: [const { MaybeUninit::uninit() }; GROUPS],
            moved: [const { MaybeUninit::uninit() }; GROUPS],
        };
        for batch in entries.chunks(4 * GROUPS) {
            let groups = desk.take(batch, run.sphere);
            // SAFETY: by the caller; each loop reads what those before it have written of the batch.
            unsafe {
                self.gather_walls(&mut desk, groups, placed, run.memory.as_ptr());
                self.press_walls(&mut desk, groups, placed, &laws);
                self.move_walls(&mut desk, groups, placed);
                self.answer_walls(&desk, groups, run, &laws);
            }
            for g in 0..groups {
                // SAFETY: the group was pressed.
                let faced = unsafe { &desk.met[g].assume_init_ref().faced };
                let deep = faced.deep.bits();
                if deep != 0 {
                    let overlap = faced.pressing.overlap.each();
                    for lane in (0..4).filter(|lane| deep >> lane & 1 != 0) {
                        let sphere = desk.places[g][lane] / 4;
                        let radius = self.spheres.position[sphere as usize].w;
                        into.note_overlap(overlap[lane] / radius, sphere, u32::from(wall), true);
                    }
                }
            }
        }
    }

    /// What contacts know, and where the wall is nearest.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn gather_walls<const FUSED: bool>(
        &self,
        desk: &mut Desk<FUSED>,
        groups: usize,
        wall: &PlacedWall,
        memory: *const f64,
    ) {
        let s = &self.spheres;
        for g in 0..groups.min(GROUPS) {
            let (places, entries) = (&desk.places[g], desk.entries[g]);
            // SAFETY: by the caller.
            unsafe {
                let p = Half::quads(s.position.as_ptr().cast(), places);
                let v = Half::quads(s.mean_velocity.as_ptr().cast(), places);
                let position = V3::of(p);
                let near = nearest(wall, position, Which::of(desk.valid[g]))
                    .unwrap_or_else(|| self.one_by_one(wall, places));
                desk.given[g].write(Given {
                    position,
                    size: [p[3], v[3]],
                    velocity: V3::of(v),
                    spin: V3::of(Half::quads(s.mean_spin.as_ptr().cast(), places)),
                    end: V3::of(Half::quads(s.end_velocity.as_ptr().cast(), places)),
                    old: remembered(memory, &entries.map(|e| SLOTS as u32 * e)),
                    near,
                });
            }
        }
    }

    /// `nearest` by the shape's own function; what it knows nothing of stays zero.
    #[cold]
    fn one_by_one<const FUSED: bool>(
        &self,
        wall: &PlacedWall,
        places: &[u32; 4],
    ) -> Near<Half<FUSED>> {
        let fields = places.map(|p| {
            let x = self.spheres.position[(p / 4) as usize].vector();
            nearest_alone(wall, x).unwrap_or_default()
        });
        let field = |f: usize| Half::from(fields.map(|own| own[f]));
        let normal = V3 { x: field(0), y: field(1), z: field(2) };
        Near { normal, distance: field(3), wall_radius: field(4) }
    }

    /// Overlaps, normal forces and stiffnesses.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn press_walls<const FUSED: bool>(
        &self,
        desk: &mut Desk<FUSED>,
        groups: usize,
        wall: &PlacedWall,
        laws: &Laws<Half<FUSED>>,
    ) {
        for g in 0..groups.min(GROUPS) {
            // SAFETY: by the caller.
            let Given { position, size, end, old, near, .. } =
                unsafe { desk.given[g].assume_init_ref() };
            let valid = Which::of(desk.valid[g]);
            let faced = face(wall, near, (*position, *end), *size, valid, self.overlap_limit);
            let before =
                if FUSED { Before::by_itself(old, near.normal) } else { Before::nothing() };
            desk.met[g].write(Met { pressed: press(&faced.pressing, laws), faced, before });
        }
    }

    /// Slip and springs, if nothing slid.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn move_walls<const FUSED: bool>(
        &self,
        desk: &mut Desk<FUSED>,
        groups: usize,
        wall: &PlacedWall,
    ) {
        for g in 0..groups.min(GROUPS) {
            // SAFETY: by the caller.
            let (given, Met { faced, pressed, before }) =
                unsafe { (desk.given[g].assume_init_ref(), desk.met[g].assume_init_ref()) };
            let moves = [given.velocity, given.spin];
            let at = (given.position, given.size[0]);
            let (motion, twist) = brush(wall, &given.near, at, moves, &faced.pressing, self.dt);
            let trial = would_be(
                [motion.normal, motion.slip],
                twist,
                Half::splat(self.dt),
                pressed,
                (&given.old, before),
                self.features.form(),
                faced.touching,
            );
            desk.moved[g].write(Moved { motion, trial });
        }
    }

    /// Friction and rolling; what comes of it goes to the run.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn answer_walls<const FUSED: bool>(
        &self,
        desk: &Desk<FUSED>,
        groups: usize,
        run: &mut WallRun<'_>,
        laws: &Laws<Half<FUSED>>,
    ) {
        let zero = Half::splat(0.0);
        let memory = run.memory.as_mut_ptr();
        for g in 0..groups.min(GROUPS) {
            // SAFETY: by the caller.
            let (given, met, Moved { motion, trial }) = unsafe {
                let (given, met) = (desk.given[g].assume_init_ref(), desk.met[g].assume_init_ref());
                (given, met, desk.moved[g].assume_init_ref())
            };
            let used = met.faced.touching;
            let old = given.old.stiffness;
            let out = answer::<_, false, false>(
                motion,
                laws,
                self.features,
                &met.pressed,
                *trial,
                old,
                used,
            );
            // On the wall, about the centre of the sphere.
            let on_wall = out.torque_j - (motion.normal * motion.lever_i).cross(out.force);
            let spring = Half::rows(out.spring, out.stiffness, used);
            let rows = [out.force, out.torque_i, on_wall];
            let [force, torque, on_wall] = [0, 1, 2].map(
                #[inline(always)]
                |k| Half::rows(rows[k], zero, used),
            );
            let touching = used.bits();
            // Backwards: lanes beyond the last repeat the first, which has the last word.
            for lane in (0..4).rev() {
                let entry = desk.entries[g][lane];
                let e = entry as usize;
                run.active[e] = if touching >> lane & 1 != 0 { TOUCHES } else { 0 };
                // SAFETY: by the caller.
                unsafe {
                    put_quad(run.force.as_mut_ptr().cast(), 4 * entry, force[lane]);
                    put_quad(run.torque.as_mut_ptr().cast(), 4 * entry, torque[lane]);
                    put_quad(run.on_wall.as_mut_ptr().cast(), 4 * entry, on_wall[lane]);
                    put_quad(memory, SLOTS as u32 * entry, spring[lane]);
                }
            }
        }
    }
}

impl<const FUSED: bool> Desk<FUSED> {
    /// Put up to a batch of entries into groups; returns how many.
    #[inline(always)]
    fn take(&mut self, batch: &[u32], sphere: &[u32]) -> usize {
        let groups = batch.len().div_ceil(4);
        for (g, group) in batch.chunks(4).enumerate().take(GROUPS) {
            let mut own = [group[0]; 4];
            own[..group.len()].copy_from_slice(group);
            self.entries[g] = own;
            self.places[g] = own.map(|e| 4 * sphere[e as usize]);
            self.valid[g] = lowest_bits(group.len());
        }
        groups
    }
}
