//! Contacts of one law with a wall, part of the work by part, as many at a time as one register holds: as `staged.rs` does
//! it for pairs, to the same bits as `wall.rs`.
#![cfg(target_arch = "x86_64")]

use std::mem::MaybeUninit;

use super::carried::{Before, Remembered};
use super::facing::{Faced, Near, brush, face, nearest, nearest_alone};
use super::gathering::{GROUPS, remembered};
use super::group::Group;
use super::hertz_mindlin::{Laws, Motion, Pressed, SLOTS, answer, hold, press, would_be};
use super::lanes::{Numbers, RECORD, V3, begins};
use super::pairs::PairKernel;
use super::wall::WallRun;
use crate::forces::{ChunkYield, TOUCHES};
use crate::geometry::PlacedWall;

/// What a contact remembers is as long as a record.
const _: () = assert!(SLOTS == 4);

/// What contacts know of their spheres, and remember.
struct Given<V> {
    position: V3<V>,
    /// Radius and mass.
    size: [V; 2],
    velocity: V3<V>,
    spin: V3<V>,
    end: V3<V>,
    old: Remembered<V>,
    near: Near<V>,
}

/// How they are pressed.
struct Met<V: Numbers> {
    faced: Faced<V>,
    pressed: Pressed<V>,
    before: Before<V>,
}

/// How they move, and their springs if nothing slid.
struct Moved<V> {
    motion: Motion<V>,
    trial: V3<V>,
}

/// What the loops hand over, group by group.
struct Desk<V: Numbers, const N: usize> {
    /// Entries of the list, and where the records of their spheres begin.
    entries: [[u32; N]; GROUPS],
    places: [[u32; N]; GROUPS],
    given: [MaybeUninit<Given<V>>; GROUPS],
    met: [MaybeUninit<Met<V>>; GROUPS],
    moved: [MaybeUninit<Moved<V>>; GROUPS],
}

impl PairKernel<'_> {
    /// Compute contacts with one wall by one law.
    ///
    /// # Safety
    /// The instructions of the group are there, every place is that of a sphere, none of which sits on a clump, and the entries are some of the run's.
    #[inline(always)]
    pub(super) unsafe fn staged_walls<V: Group<N>, const N: usize>(
        &self,
        run: &mut WallRun<'_>,
        (wall, law): (u16, usize),
        entries: &[u32],
        into: &mut ChunkYield,
    ) {
        let placed = &run.walls[wall as usize];
        let laws = Laws::splat(&self.all[law]);
        let mut desk = Desk::<V, N> {
            entries: [[0; N]; GROUPS],
            places: [[0; N]; GROUPS],
            given: [const { MaybeUninit::uninit() }; GROUPS],
            met: [const { MaybeUninit::uninit() }; GROUPS],
            moved: [const { MaybeUninit::uninit() }; GROUPS],
        };
        for batch in entries.chunks(N * GROUPS) {
            let groups = desk.take(batch, run.sphere);
            // SAFETY: by the caller; each loop reads what those before it have written of the batch.
            unsafe {
                self.gather_walls(&mut desk, groups, placed, run.memory.as_ptr());
                self.press_walls(&mut desk, groups, placed, &laws);
                self.move_walls(&mut desk, groups, placed);
                self.answer_walls::<V, N>(&desk, groups, run, &laws);
            }
            for g in 0..groups {
                // SAFETY: the group was pressed.
                let faced = unsafe { &desk.met[g].assume_init_ref().faced };
                let deep = V::bits(faced.deep);
                if deep != 0 {
                    let overlap = faced.pressing.overlap.each();
                    for lane in (0..N).filter(|lane| deep >> lane & 1 != 0) {
                        let sphere = desk.places[g][lane] / RECORD;
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
    unsafe fn gather_walls<V: Group<N>, const N: usize>(
        &self,
        desk: &mut Desk<V, N>,
        groups: usize,
        wall: &PlacedWall,
        memory: *const f64,
    ) {
        let s = &self.spheres;
        for g in 0..groups.min(GROUPS) {
            let (places, entries) = (&desk.places[g], desk.entries[g]);
            // SAFETY: by the caller.
            unsafe {
                let p = V::quads::<1>(s.position.as_ptr().cast(), places);
                let [mean, end] = s.numbers_of_velocities();
                let v = V::quads::<2>(mean, places);
                let position = V3::of(p);
                let near = nearest(wall, position, V::which(u8::MAX))
                    .unwrap_or_else(|| self.one_by_one(wall, places));
                desk.given[g].write(Given {
                    position,
                    size: [p[3], v[3]],
                    velocity: V3::of(v),
                    spin: V3::of(V::quads::<1>(s.mean_spin.as_ptr().cast(), places)),
                    end: V3::of(V::quads::<2>(end, places)),
                    old: remembered(memory, &begins(&entries)),
                    near,
                });
            }
        }
    }

    /// `nearest` by the shape's own function; what it knows nothing of stays zero.
    #[cold]
    fn one_by_one<V: Group<N>, const N: usize>(
        &self,
        wall: &PlacedWall,
        places: &[u32; N],
    ) -> Near<V> {
        let fields = places.map(|p| {
            let x = self.spheres.position[(p / RECORD) as usize].vector();
            nearest_alone(wall, x).unwrap_or_default()
        });
        let field = |f: usize| V::from(fields.map(|own| own[f]));
        let normal = V3 { x: field(0), y: field(1), z: field(2) };
        Near { normal, distance: field(3), wall_radius: field(4) }
    }

    /// Overlaps, normal forces and stiffnesses.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn press_walls<V: Group<N>, const N: usize>(
        &self,
        desk: &mut Desk<V, N>,
        groups: usize,
        wall: &PlacedWall,
        laws: &Laws<V>,
    ) {
        for g in 0..groups.min(GROUPS) {
            // SAFETY: by the caller.
            let Given { position, size, end, old, near, .. } =
                unsafe { desk.given[g].assume_init_ref() };
            let valid = V::which(u8::MAX);
            let faced = face(wall, near, (*position, *end), *size, valid, self.overlap_limit);
            let before = if V::FUSED {
                Before::by_itself(old, old.spring.dot(near.normal))
            } else {
                Before::nothing()
            };
            desk.met[g].write(Met {
                pressed: press::<_, false>(&faced.pressing, laws),
                faced,
                before,
            });
        }
    }

    /// Slip and springs, if nothing slid.
    ///
    /// # Safety
    /// As above.
    #[inline(always)]
    unsafe fn move_walls<V: Group<N>, const N: usize>(
        &self,
        desk: &mut Desk<V, N>,
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
                V::splat(self.dt),
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
    unsafe fn answer_walls<V: Group<N>, const N: usize>(
        &self,
        desk: &Desk<V, N>,
        groups: usize,
        run: &mut WallRun<'_>,
        laws: &Laws<V>,
    ) {
        let zero = V::splat(0.0);
        let memory = run.memory.as_mut_ptr();
        for g in 0..groups.min(GROUPS) {
            // SAFETY: by the caller.
            let (given, met, Moved { motion, trial }) = unsafe {
                let (given, met) = (desk.given[g].assume_init_ref(), desk.met[g].assume_init_ref());
                (given, met, desk.moved[g].assume_init_ref())
            };
            let used = met.faced.touching;
            let old = given.old.stiffness;
            let held = hold(laws, self.features, &met.pressed, *trial, old, used);
            let out = answer::<_, false>(motion, laws, self.features, &met.pressed, &held);
            // On the wall, about the centre of the sphere.
            let on_wall = out.torque_j - (motion.normal * motion.lever_i).cross(out.force);
            let touching = V::bits(used);
            for (lane, entry) in desk.entries[g].iter().enumerate() {
                run.active[*entry as usize] = if touching >> lane & 1 != 0 { TOUCHES } else { 0 };
            }
            let begins = begins(&desk.entries[g]);
            // SAFETY: by the caller.
            unsafe {
                V::put_used(out.force, zero, used, run.force.as_mut_ptr().cast(), &begins);
                V::put_used(out.torque_i, zero, used, run.torque.as_mut_ptr().cast(), &begins);
                V::put_used(on_wall, zero, used, run.on_wall.as_mut_ptr().cast(), &begins);
                V::put_used(held.spring, held.stiffness, used, memory, &begins);
            }
        }
    }
}

impl<V: Group<N>, const N: usize> Desk<V, N> {
    /// Put up to a batch of entries into groups; returns how many.
    #[inline(always)]
    fn take(&mut self, batch: &[u32], sphere: &[u32]) -> usize {
        let groups = batch.len().div_ceil(N);
        for (g, group) in batch.chunks(N).enumerate().take(GROUPS) {
            // Lanes beyond the last do what the first does.
            let mut own = [group[0]; N];
            own[..group.len()].copy_from_slice(group);
            self.entries[g] = own;
            for (place, e) in self.places[g].iter_mut().zip(own) {
                *place = RECORD * sphere[e as usize];
            }
        }
        groups
    }
}
