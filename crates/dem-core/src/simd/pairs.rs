//! The run of touching pairs: those that act are packed into blocks of eight and computed by the laws of
//! `hertz_mindlin.rs`.

use super::acting::{Acting, Room};
use super::blocks::{Blocks, MOST, Two};
use super::carried::Remembered;
use super::hertz_mindlin::{Features, Held, Laws, Motion, Out, Pressing, respond};
use super::lanes::{Numbers, RECORD, V3};
use super::meeting::{Line, Slide, Spins, meet, slide};
use super::{Arithmetic, Constants, Level};
use crate::forces::ChunkYield;
use crate::neighbour::search::lowest_bits;
use crate::particles::{END, Record};
use crate::spheres::{ClumpView, SphereView, between, on_arm};
use crate::sums::Pull;
use crate::threads::View;

/// A run of touching pairs, in whole blocks.
pub(crate) struct Run<'a> {
    /// Pairs in the run; what is beyond them in the last block is padding.
    pub(crate) pairs: usize,
    pub(crate) first: &'a [u32],
    pub(crate) second: &'a [u32],
    pub(crate) active: &'a mut [u8],
    pub(crate) memory: &'a mut [f64],
    pub(crate) wrenches: Wrenches<'a>,
}

/// What becomes of wrenches.
pub(crate) enum Wrenches<'a> {
    /// Each is kept: force, torques on the bodies of the first and of the second sphere.
    Kept([&'a mut [Record]; 3]),
    /// Both bodies add theirs to the sums of their places modulo the length, a power of two.
    Summed(&'a mut [Pull]),
}

/// Blocks of eight contacts that are computed together: where the numbers of their spheres and their own in the
/// run begin.
#[derive(Clone, Copy)]
struct Block<'a> {
    first: &'a [[u32; 8]],
    second: &'a [[u32; 8]],
    pair: &'a [[u32; 8]],
    /// Lanes that hold a contact.
    valid: [u8; MOST],
}

/// Where contacts of a run remember and write: four numbers each.
#[derive(Clone, Copy)]
pub(super) struct Sinks {
    /// Marks of pairs.
    pub(super) active: *mut u8,
    pub(super) memory: *mut f64,
    pub(super) wrenches: Sink,
}

#[derive(Clone, Copy)]
pub(super) enum Sink {
    /// Force, torques on the first and on the second sphere.
    Kept([*mut f64; 3]),
    /// The sums, and what counts of where a record begins.
    Summed(*mut f64, u32),
}

impl Sinks {
    /// Take the marks off those lanes of pairs whose numbers begin there.
    ///
    /// # Safety
    /// They are pairs of the run.
    #[inline(always)]
    pub(super) unsafe fn unmark(&self, lanes: u8, pairs: &[u32]) {
        let mut left = lanes;
        while left != 0 {
            // SAFETY: by the caller.
            unsafe {
                *self.active.add((pairs[left.trailing_zeros() as usize] / RECORD) as usize) = 0;
            }
            left &= left - 1;
        }
    }

    #[inline(always)]
    fn of(run: &mut Run<'_>) -> Self {
        Self {
            active: run.active.as_mut_ptr(),
            memory: run.memory.as_mut_ptr(),
            wrenches: match &mut run.wrenches {
                Wrenches::Kept(each) => {
                    Sink::Kept(each.each_mut().map(|records| records.as_mut_ptr().cast()))
                }
                Wrenches::Summed(sums) => {
                    assert!(sums.len().is_power_of_two(), "places are taken modulo the length");
                    Sink::Summed(sums.as_mut_ptr().cast(), (sums.len() as u32 - 1) * RECORD)
                }
            },
        }
    }
}

/// What is the same for all pairs of spheres.
#[derive(Clone, Copy)]
pub(crate) struct PairKernel<'a> {
    pub(crate) spheres: SphereView<'a>,
    /// Laws of pairs of spheres: one, or all by material times material.
    pub(crate) constants: &'a [Constants],
    /// All laws, by material times material.
    pub(crate) all: &'a [Constants],
    /// Material of all spheres, if they have but one.
    pub(crate) one_material: Option<usize>,
    pub(crate) materials: usize,
    /// Radius and mass of all spheres, if they are alike.
    pub(crate) one_size: Option<[f64; 2]>,
    pub(crate) period: Option<crate::neighbour::Period>,
    pub(crate) dt: f64,
    pub(crate) overlap_limit: f64,
    pub(crate) arithmetic: Arithmetic,
    pub(crate) features: Features,
}

impl PairKernel<'_> {
    /// Compute a run of touching pairs.
    pub(crate) fn touching(&self, level: Level, run: &mut Run<'_>, into: &mut ChunkYield) {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,popcnt")]
            unsafe fn avx512<
                const FUSED: bool,
                const FAST: bool,
                const ALIKE: bool,
                const MORE: bool,
            >(
                k: &PairKernel<'_>,
                run: &mut Run<'_>,
                into: &mut ChunkYield,
            ) {
                // SAFETY: the lists hold places of spheres.
                unsafe {
                    let mut room = Room::EMPTY;
                    let acting = k.acting::<Wide<FUSED, FAST>>(run, &mut room);
                    let done =
                        k.blocks::<Two<Wide<FUSED, FAST>>, ALIKE, MORE>(run, &acting, 0, into);
                    k.blocks::<Wide<FUSED, FAST>, ALIKE, MORE>(run, &acting, done, into);
                }
            }
            #[target_feature(enable = "avx2,fma,popcnt")]
            unsafe fn avx2<
                const FUSED: bool,
                const ALIKE: bool,
                const MORE: bool,
                const CLUMPS: bool,
            >(
                k: &PairKernel<'_>,
                run: &mut Run<'_>,
                into: &mut ChunkYield,
            ) {
                // SAFETY: the lists hold places of spheres.
                unsafe {
                    let mut room = Room::EMPTY;
                    let acting = k.acting::<Pair<FUSED>>(run, &mut room);
                    if k.constants.len() == 1 {
                        let sinks = Sinks::of(run);
                        return k.staged::<FUSED, ALIKE, MORE, CLUMPS>(&acting, sinks, into);
                    }
                    if CLUMPS {
                        k.blocks::<Pair<FUSED>, ALIKE, true>(run, &acting, 0, into);
                    } else {
                        k.blocks::<Pair<FUSED>, ALIKE, false>(run, &acting, 0, into);
                    }
                }
            }
            use super::avx2::Pair;
            use super::avx512::Wide;
            macro_rules! chosen {
                ($alike:literal, $more:literal, $clumps:literal) => {
                    match (level, self.arithmetic) {
                        (Level::Portable, _) => return,
                        (Level::Avx512, Arithmetic::Exact) => {
                            avx512::<false, false, $alike, $clumps>
                        }
                        (Level::Avx512, Arithmetic::Fused) => {
                            avx512::<true, false, $alike, $clumps>
                        }
                        (Level::Avx512, Arithmetic::FastRoots) => {
                            avx512::<true, true, $alike, $clumps>
                        }
                        (Level::Avx2, Arithmetic::Exact) => avx2::<false, $alike, $more, $clumps>,
                        (Level::Avx2, _) => avx2::<true, $alike, $more, $clumps>,
                    }
                };
            }
            let alike = self.one_size.is_some() && self.constants.len() == 1;
            let usual = self.features == Features::NONE;
            let of = match (usual, self.spheres.clumps.is_some(), alike) {
                (true, false, true) => chosen!(true, false, false),
                (true, false, false) => chosen!(false, false, false),
                (true, true, _) => chosen!(false, false, true),
                (false, ..) => chosen!(false, true, true),
            };
            // SAFETY: `level` comes from `Level::detect`, which asked the processor.
            unsafe { of(self, run, into) }
        }
        let _ = level;
    }

    /// Compute blocks of the pairs that act, from `done` pairs on, by the usual laws or by `MORE`, as long as there
    /// are enough; returns how many pairs are done then.
    ///
    /// # Safety
    /// Every place in the run is that of a sphere, and `acting` is of that run.
    #[inline(always)]
    unsafe fn blocks<V: Blocks, const ALIKE: bool, const MORE: bool>(
        &self,
        run: &mut Run<'_>,
        acting: &Acting<'_>,
        mut done: usize,
        into: &mut ChunkYield,
    ) -> usize {
        let laws = Laws::splat(&self.constants[0]);
        // Not known to the compiler: it would take the exchanges of `put_quads` apart for the sake of a zero.
        let nothing = std::hint::black_box(0.0);
        let sinks = Sinks::of(run);
        let whole = acting.count.next_multiple_of(8);
        while done + 8 * V::COUNT <= whole {
            let block = Block {
                first: acting.first[done..done + 8 * V::COUNT].as_chunks().0,
                second: acting.second[done..done + 8 * V::COUNT].as_chunks().0,
                pair: acting.pair[done..done + 8 * V::COUNT].as_chunks().0,
                valid: [0, 8].map(|k| lowest_bits(acting.count.saturating_sub(done + k))),
            };
            // SAFETY: by the caller; every pair is one of the run.
            let deep = unsafe { self.block::<V, ALIKE, MORE>(block, sinks, &laws, nothing) };
            if deep != [0; MOST] {
                for ((deep, first), second) in deep.into_iter().zip(block.first).zip(block.second) {
                    self.note_deep(deep, first, second, into);
                }
            }
            done += 8 * V::COUNT;
        }
        done
    }

    /// Note lanes that overlap too deeply, of spheres whose numbers begin there.
    #[cold]
    pub(super) fn note_deep(&self, deep: u8, first: &[u32], second: &[u32], into: &mut ChunkYield) {
        for lane in (0..first.len()).filter(|l| deep >> l & 1 != 0) {
            let (i, j) = (first[lane] / RECORD, second[lane] / RECORD);
            let (a, b) = (self.spheres.position[i as usize], self.spheres.position[j as usize]);
            let d = crate::neighbour::Period::shortest(self.period, b.vector() - a.vector());
            let overlap = a.w + b.w - d.length();
            into.note_overlap(overlap / a.w.min(b.w), i, j, false);
        }
    }

    /// Effective radius and mass of two spheres alike.
    #[inline(always)]
    pub(super) fn reduced<V: Numbers>([r, m]: [f64; 2]) -> (V, V) {
        (V::splat(r * r / (r + r)), V::splat(m * m / (m + m)))
    }

    /// Compute a block; returns which lanes overlap too deeply.
    ///
    /// # Safety
    /// Every place in `first` and `second` of a block is that of a sphere; the sinks hold what its pairs write.
    #[inline(always)]
    unsafe fn block<V: Blocks, const ALIKE: bool, const MORE: bool>(
        &self,
        b: Block<'_>,
        sinks: Sinks,
        only: &Laws<V>,
        nothing: f64,
    ) -> [u8; MOST] {
        let s = &self.spheres;
        let size = if ALIKE { Some(self.one_size.unwrap_or_default()) } else { self.one_size };
        let [radius, mass] = [0, 1].map(|k| size.map(|s| s[k]));
        let clumps = if MORE { s.clumps.as_ref() } else { None };
        let alike = if ALIKE && clumps.is_none() {
            let from = [
                s.position.as_ptr().cast(),
                s.velocities.as_ptr().cast(),
                s.mean_spin.as_ptr().cast(),
            ];
            // SAFETY: by the caller.
            Some(unsafe { V::of_spheres(from, b.first, b.second) })
        } else {
            None
        };
        // SAFETY: by the caller.
        let (mut d, [rj, ri], places) = unsafe {
            if let Some([apart, ..]) = alike {
                (apart, [V::splat(radius.unwrap_or_default()); 2], None)
            } else if clumps.is_some() {
                let from = s.position.as_ptr().cast();
                let (i, j) = (V::quads::<1>(from, b.first), V::quads::<1>(from, b.second));
                (V3::of(j) - V3::of(i), [j[3], i[3]], Some([V3::of(i), V3::of(j)]))
            } else {
                let (d, radii) = difference::<V, 1, _>(s.position, b.second, b.first, radius);
                (d, radii, None)
            }
        };
        let mut on = None;
        if let Some(p) = self.period {
            d = d.shortest(p);
        }
        // SAFETY: by the caller.
        let (approach, [mi, mj], wi, wj, end) = unsafe {
            if let Some([_, approach, end, wi, wj]) = alike {
                let (none, mass) = (V::splat(0.0), V::splat(mass.unwrap_or_default()));
                let [wi, wj] = [[wi.x, wi.y, wi.z, none], [wj.x, wj.y, wj.z, none]];
                (approach, [mass; 2], wi, wj, end)
            } else if let (Some(c), Some([xi, xj])) = (clumps, places) {
                let i = on_clump::<V>(s, c, b.first, xi);
                let j = on_clump::<V>(s, c, b.second, xj);
                on = Some([(i.bodies, i.arm), (j.bodies, j.arm)]);
                let [approach, end] = if V::FUSED {
                    let moves = [V3::of(i.velocity) - V3::of(j.velocity), i.end - j.end];
                    let moves = between(moves, i.arm, i.spins(), c.dt, false);
                    between(moves, j.arm, j.spins(), c.dt, true)
                } else {
                    let (i, j) = (i.moves(c.dt), j.moves(c.dt));
                    [i[0] - j[0], i[1] - j[1]]
                };
                (approach, [i.velocity[3], j.velocity[3]], i.mean_spin, j.mean_spin, end)
            } else {
                let (approach, masses) =
                    difference::<V, 2, _>(s.velocities, b.first, b.second, mass);
                let spins = s.mean_spin.as_ptr().cast();
                let end = V::differences::<2>(s.numbers_of_velocities()[END], b.first, b.second);
                let (wi, wj) = (V::quads::<1>(spins, b.first), V::quads::<1>(spins, b.second));
                (approach, masses, wi, wj, V3::of(end))
            }
        };
        let many;
        let laws = if !ALIKE && self.constants.len() > 1 {
            let (a, c) = (wi[3].each(), wj[3].each());
            many = Laws::lanes(|k, lane| {
                &self.constants[a[k][lane] as usize * self.materials + c[k][lane] as usize]
            });
            &many
        } else {
            only
        };
        let (wi, wj) = (V3::of(wi), V3::of(wj));
        // SAFETY: by the caller.
        let old = unsafe { V::quads::<1>(sinks.memory, b.pair) };
        let old = Remembered { spring: V3::of(old), stiffness: old[3] };
        let met = meet(d, [ri, rj], &old, V::mask(b.valid), self.overlap_limit);
        let line = Line::of(d, met.inverse);
        let half = V::splat(0.5);
        let levers = [ri.less_times(half, met.overlap), rj.less_times(half, met.overlap)];
        let Slide { slip, rolling, twist } =
            slide::<V, ALIKE>(&line, approach, &Spins::of([wi, wj]), levers, self.dt);
        // Spheres alike: the same operations, once for all lanes.
        let (r_star, m_star) = match size {
            Some(size) => PairKernel::reduced(size),
            None => (ri * rj / (ri + rj), mi * mj / (mi + mj)),
        };
        let motion = Motion {
            normal: line.normal,
            slip,
            rolling,
            spin_i: wi,
            spin_j: wj,
            lever_i: levers[0],
            lever_j: levers[1],
            overlap: met.overlap,
            r_star,
            radius_i: ri,
            radius_j: rj,
        };
        let pressing = Pressing { overlap: met.overlap, rate: line.along(end), r_star, m_star };
        let features = if MORE { self.features } else { Features::NONE };
        let (held, mut out) = respond::<V, ALIKE>(
            (&motion, &pressing),
            [twist, V::splat(self.dt)],
            laws,
            features,
            (&old, &met.before),
            met.touching,
        );
        let mut sums = [b.first, b.second];
        if let Some([(first, arm_i), (second, arm_j)]) = &on {
            // Torques about the centres of the bodies, which have the sums.
            out.torque_i = out.torque_i + arm_i.cross(out.force);
            out.torque_j = out.torque_j - arm_j.cross(out.force);
            sums = [&first[..V::COUNT], &second[..V::COUNT]];
        }
        // SAFETY: by the caller.
        unsafe { store(&b, sinks, sums, met.touching, (&held, &out), nothing) };
        let lanes = b.valid.into_iter().zip(V::bits(met.touching));
        for ((valid, touching), pairs) in lanes.zip(b.pair) {
            // SAFETY: by the caller.
            unsafe { sinks.unmark(valid & !touching, pairs) };
        }
        V::bits(met.deep)
    }
}

/// Where spheres sit on clumps, and how those move.
pub(super) struct OnClump<V> {
    /// Where the numbers of their bodies begin, and where they sit on them.
    pub(super) bodies: [[u32; 8]; MOST],
    pub(super) arm: V3<V>,
    /// Mean velocity and mass.
    pub(super) velocity: [V; 4],
    /// Velocity at the end.
    end: V3<V>,
    /// Mean angular velocity and material.
    pub(super) mean_spin: [V; 4],
    end_spin: V3<V>,
}

impl<V: Numbers> OnClump<V> {
    /// Mean velocity of the spheres, and that at the end: `SphereView::motion`.
    #[inline(always)]
    pub(super) fn moves(&self, dt: f64) -> [V3<V>; 2] {
        on_arm(
            self.arm,
            [V3::of(self.velocity), V3::of(self.mean_spin)],
            [self.end, self.end_spin],
            dt,
        )
    }

    #[inline(always)]
    fn spins(&self) -> [V3<V>; 2] {
        [V3::of(self.mean_spin), self.end_spin]
    }
}

/// Where the records of the bodies of spheres begin, of which that is given.
///
/// # Safety
/// They are spheres.
#[inline(always)]
pub(super) unsafe fn bodies_of<const N: usize>(c: &ClumpView<'_>, spheres: &[u32; N]) -> [u32; N] {
    let mut bodies = [0; N];
    for (body, sphere) in bodies.iter_mut().zip(spheres) {
        let sphere = (sphere / RECORD) as usize;
        debug_assert!(sphere < c.body.len());
        // SAFETY: by the caller; every sphere has a body.
        *body = RECORD * unsafe { c.body.get_unchecked(sphere) };
    }
    bodies
}

/// Of spheres whose numbers begin there and which are at `position`.
///
/// # Safety
/// Every place in `at` is that of a sphere.
#[inline(always)]
pub(super) unsafe fn on_clump<V: Blocks>(
    s: &SphereView<'_>,
    c: &ClumpView<'_>,
    at: &[[u32; 8]],
    position: V3<V>,
) -> OnClump<V> {
    let mut of_bodies = [[0; 8]; MOST];
    for (of, spheres) in of_bodies.iter_mut().zip(at) {
        // SAFETY: by the caller.
        *of = unsafe { bodies_of(c, spheres) };
    }
    let bodies = &of_bodies[..at.len()];
    let [mean, end] = s.numbers_of_velocities();
    // SAFETY: by the caller; spheres sit on bodies.
    let (centre, v, w, end, end_spin) = unsafe {
        (
            V3::of(V::quads::<1>(c.centre.as_ptr().cast(), bodies)),
            V::quads::<2>(mean, bodies),
            V::quads::<1>(s.mean_spin.as_ptr().cast(), bodies),
            V3::of(V::quads::<2>(end, bodies)),
            V3::of(V::quads::<1>(c.end_spin.as_ptr().cast(), bodies)),
        )
    };
    let arm = position - centre;
    OnClump { bodies: of_bodies, arm, velocity: v, end, mean_spin: w, end_spin }
}

/// Vectors of records less those of others, whose numbers begin at `EACH` times that, and both scalars, which are `alike` in all
/// records if given: then only differences are needed, and half as many exchanges.
///
/// # Safety
/// Four numbers of `records` (or the first ones of pairs of them) begin at every place.
#[inline(always)]
pub(super) unsafe fn difference<V: Blocks, const EACH: usize, T>(
    records: View<'_, T>,
    of: &[[u32; 8]],
    less: &[[u32; 8]],
    alike: Option<f64>,
) -> (V3<V>, [V; 2]) {
    debug_assert!(of.iter().chain(less).flatten().all(|at| {
        EACH * (*at as usize) * size_of::<f64>() / 2 < records.len() * size_of::<T>()
    }));
    let from = records.as_ptr().cast();
    // SAFETY: by the caller.
    unsafe {
        match alike {
            Some(scalar) => (V3::of(V::differences::<EACH>(from, of, less)), [V::splat(scalar); 2]),
            None => {
                let (a, b) = (V::quads::<EACH>(from, of), V::quads::<EACH>(from, less));
                (V3::of(a) - V3::of(b), [a[3], b[3]])
            }
        }
    }
}

/// # Safety
/// The sinks hold four numbers for each pair of the block, or sums for all that counts of a place.
#[inline(always)]
unsafe fn store<V: Blocks>(
    b: &Block<'_>,
    sinks: Sinks,
    [first, second]: [&[[u32; 8]]; 2],
    touching: V::Mask,
    (held, out): (&Held<V>, &Out<V>),
    nothing: f64,
) {
    let zero = V::splat(nothing);
    let none = V3::splat(0.0);
    let record = |v: V3<V>, scalar: V| {
        let v = v.select(touching, none);
        [v.x, v.y, v.z, scalar]
    };
    let stiffness = held.stiffness.select(touching, zero);
    let wrench = [out.force, out.torque_i, out.torque_j];
    // SAFETY: by the caller.
    unsafe {
        V::put_quads(record(held.spring, stiffness), sinks.memory, b.pair);
        match sinks.wrenches {
            Sink::Kept(to) => {
                for (v, to) in wrench.into_iter().zip(to) {
                    V::put_quads(record(v, zero), to, b.pair);
                }
            }
            Sink::Summed(to, within) => {
                let [f, ti, tj] = wrench;
                let (f, ti) = (f.select(touching, none), ti.select(touching, none));
                let wrench = [f, ti, tj.select(touching, none)];
                V::add_wrenches(wrench, to, within, first, second);
            }
        }
    }
}
