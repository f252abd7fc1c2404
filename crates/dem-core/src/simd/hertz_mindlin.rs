//! Hertz, Mindlin with history, damping, static and kinetic friction, a rolling torque and the pull of
//! simplified JKR: eight contacts at once; spring and torque in EDEM's forms too.
//!
//! Operation by operation the portable path: `forces.rs` for the kinematics, then
//! `normal/hertz.rs`, `contact/spring.rs`, `contact/friction.rs`, `tangential/mindlin.rs` and
//! `mindlin_total_spring.rs`, `rolling/constant_torque.rs` and `absolute_spin.rs`, `cohesion/sjkr.rs` and
//! `contact/model.rs`. Whoever changes one of them changes this
//! too: `simd_and_portable_kernels_agree_bit_by_bit` tells.

use super::blocks::{Blocks, MOST, Two};
use super::lanes::{Lanes, Mask, Numbers, V3};
use super::{Constants, Form, Level};
use crate::contact::spring::{COSINE, SINE};
use crate::contact_stage::CHUNK;
use crate::forces::{ChunkYield, SphereView};
use crate::list::SET_BITS;
use crate::particles::Record;

/// Numbers that a contact of these laws remembers: the spring's force and its signed stiffness.
pub(crate) const SLOTS: usize = 4;

/// A run of touching pairs, in whole blocks.
pub(crate) struct Run<'a> {
    /// Pairs in the run; what is beyond them in the last block is padding.
    pub(crate) pairs: usize,
    pub(crate) first: &'a [u32],
    pub(crate) second: &'a [u32],
    pub(crate) active: &'a mut [u8],
    pub(crate) memory: &'a mut [f64],
    pub(crate) force: &'a mut [Record],
    pub(crate) torque_first: &'a mut [Record],
    pub(crate) torque_second: &'a mut [Record],
}

/// Eight bits as bytes.
const BYTES: [[u8; 8]; 256] = {
    let (mut table, mut bits) = ([[0; 8]; 256], 0);
    while bits < 256 {
        let mut lane = 0;
        while lane < 8 {
            table[bits][lane] = (bits >> lane & 1) as u8;
            lane += 1;
        }
        bits += 1;
    }
    table
};

/// Blocks of eight contacts that are computed together.
struct Block {
    first: [[u32; 8]; MOST],
    second: [[u32; 8]; MOST],
    /// Places in the run.
    pair: [[u32; 8]; MOST],
    /// Lanes that hold a contact.
    valid: [u8; MOST],
}

/// Where contacts of a run remember and write: four numbers each.
#[derive(Clone, Copy)]
struct Sinks {
    memory: *mut f64,
    force: *mut f64,
    torque_first: *mut f64,
    torque_second: *mut f64,
}

/// Pairs of a run that touch, or did and have something to forget.
struct Acting {
    /// Filled up to a whole block with one that does neither.
    pair: [u32; CHUNK + 8],
    count: usize,
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
    /// Whether roots may be off in the last places.
    pub(crate) fast_roots: bool,
    pub(crate) features: Features,
}

/// What of the laws a world makes use of: the same for all of its contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Features {
    /// Any law pulls.
    cohesive: bool,
    /// Friction falls once any contact slides.
    stick_slip: bool,
    form: Form,
}

impl Features {
    /// The usual laws: the kernel is compiled for them by themselves.
    const NONE: Self = Self {
        cohesive: false,
        stick_slip: false,
        form: Form { total_spring: false, absolute_spin: false },
    };

    /// Those of a table of laws.
    pub(crate) fn of(all: &[Constants]) -> Self {
        Self {
            cohesive: all.iter().any(|c| c.energy_density > 0.0),
            stick_slip: all.iter().any(|c| c.kinetic != c.friction),
            form: all.first().map_or_else(Form::default, |c| c.form),
        }
    }
}

/// Constants of eight contacts.
#[derive(Clone, Copy)]
pub(super) struct Laws<V> {
    e_star: V,
    normal_damping: V,
    g_star: V,
    friction: V,
    kinetic: V,
    shear_damping: V,
    arm_length: V,
    arm_ratio: V,
    least_force: V,
    energy_density: V,
    /// Roots of `2 E*` and `8 G*`.
    normal_root: V,
    shear_root: V,
}

impl<V: Blocks> Laws<V> {
    #[inline(always)]
    pub(super) fn splat(c: &Constants) -> Self {
        Self::from(
            #[inline(always)]
            |f| V::splat(f(c)),
        )
    }

    /// By block and lane.
    #[inline(always)]
    pub(super) fn lanes<'c>(each: impl Fn(usize, usize) -> &'c Constants) -> Self {
        Self::from(
            #[inline(always)]
            |f| {
                V::of(
                    #[inline(always)]
                    |block, lane| f(each(block, lane)),
                )
            },
        )
    }

    #[inline(always)]
    fn from(make: impl Fn(fn(&Constants) -> f64) -> V) -> Self {
        Self {
            e_star: make(|c| c.e_star),
            normal_damping: make(|c| c.normal_damping),
            g_star: make(|c| c.g_star),
            friction: make(|c| c.friction),
            kinetic: make(|c| c.kinetic),
            shear_damping: make(|c| c.shear_damping),
            arm_length: make(|c| c.arm_length),
            arm_ratio: make(|c| c.arm_ratio),
            least_force: make(|c| c.least_force),
            energy_density: make(|c| c.energy_density),
            normal_root: make(|c| (2.0 * c.e_star).sqrt()),
            shear_root: make(|c| (8.0 * c.g_star).sqrt()),
        }
    }
}

/// Relative motion of eight contacts.
#[derive(Clone, Copy)]
pub(super) struct Motion<V> {
    pub(super) normal: V3<V>,
    pub(super) overlap: V,
    pub(super) rate: V,
    pub(super) slip: V3<V>,
    pub(super) spin_i: V3<V>,
    pub(super) spin_j: V3<V>,
    pub(super) lever_i: V,
    pub(super) lever_j: V,
    pub(super) r_star: V,
    pub(super) m_star: V,
    pub(super) radius_i: V,
    pub(super) radius_j: V,
    pub(super) twist: V,
    pub(super) dt: V,
}

/// Wrenches of eight contacts.
pub(super) struct Out<V> {
    pub(super) force: V3<V>,
    pub(super) torque_i: V3<V>,
    pub(super) torque_j: V3<V>,
    /// Spring force and signed stiffness.
    pub(super) spring: V3<V>,
    pub(super) stiffness: V,
}

/// Hold `trial` to `bound` where it exceeds `threshold`; returns it and the lanes, of those that matter, that
/// slide.
#[inline(always)]
fn limit<V: Numbers, const FAST: bool>(
    trial: V3<V>,
    threshold: V,
    bound: V,
    used: V::Mask,
) -> (V3<V>, V::Mask) {
    let size2 = trial.dot(trial);
    let slides = (threshold * threshold).less(size2) & used;
    if slides.is_empty() {
        return (trial, slides);
    }
    let scaled = if FAST {
        trial * (bound * size2.max(V::splat(f64::MIN_POSITIVE)).reciprocal_root())
    } else {
        trial * (bound / size2.sqrt())
    };
    (scaled.select(slides, trial), slides)
}

/// Root of numbers that are not negative.
#[inline(always)]
fn root<V: Numbers, const FAST: bool>(x: V) -> V {
    if FAST { x * x.max(V::splat(f64::MIN_POSITIVE)).reciprocal_root() } else { x.sqrt() }
}

/// Sine and cosine of the twists of a step, as in `contact/spring.rs`; `used` are the lanes that
/// matter.
#[inline(always)]
fn small_sin_cos<V: Blocks>(x: V, used: V::Mask) -> (V, V) {
    let one = V::splat(1.0);
    let x2 = x * x;
    // Not by `map`: its closure would not be compiled for the instructions of the kernel.
    let (s3, s5, s7, s9) =
        (V::splat(SINE[0]), V::splat(SINE[1]), V::splat(SINE[2]), V::splat(SINE[3]));
    let (c2, c4, c6, c8) =
        (V::splat(COSINE[0]), V::splat(COSINE[1]), V::splat(COSINE[2]), V::splat(COSINE[3]));
    let sin = x * (one + x2 * (s3 + x2 * (s5 + x2 * (s7 + x2 * s9))));
    let cos = one + x2 * (c2 + x2 * (c4 + x2 * (c6 + x2 * c8)));
    let large = V::splat(0.1).less(x.abs()) & used;
    if large.is_empty() { (sin, cos) } else { large_sin_cos(x, sin, cos, large) }
}

/// The lanes of large twists by the library's functions.
#[cold]
fn large_sin_cos<V: Blocks>(x: V, sin: V, cos: V, large: V::Mask) -> (V, V) {
    let each = x.each();
    let (sines, cosines) = (V::of(|b, l| each[b][l].sin()), V::of(|b, l| each[b][l].cos()));
    (sines.select(large, sin), cosines.select(large, cos))
}

/// Simplified JKR.
#[inline(always)]
fn pull<V: Numbers>(m: &Motion<V>, energy_density: V, d: V) -> V {
    let (one, two) = (V::splat(1.0), V::splat(2.0));
    let (r, kappa) = (m.radius_i, one / m.radius_j);
    let sum = r * kappa + one;
    let distance = sum - d * kappa;
    let area = V::splat(std::f64::consts::PI)
        * d
        * (two * sum - d * kappa)
        * (two * r - d)
        * (two - d * kappa)
        / (V::splat(4.0) * distance * distance);
    energy_density * area
}

/// Torque of size `limit` against `spin`.
#[inline(always)]
fn against<V: Numbers, const FAST: bool>(spin: V3<V>, limit: V) -> V3<V> {
    let (speed2, tiny) = (spin.dot(spin), V::splat(f64::MIN_POSITIVE));
    if FAST {
        spin * (-limit * speed2.max(tiny).reciprocal_root())
    } else {
        spin * (-limit / speed2.sqrt().max(tiny))
    }
}

/// The laws.
#[inline(always)]
pub(super) fn respond<V: Blocks, const FAST: bool>(
    m: &Motion<V>,
    laws: &Laws<V>,
    features: Features,
    old: V3<V>,
    old_stiffness: V,
    touching: V::Mask,
) -> Out<V> {
    let (zero, n) = (V::splat(0.0), m.normal);
    let tiny = V::splat(f64::MIN_POSITIVE);
    // Transport of the spring with the contact frame.
    let flat = old - n * old.dot(n);
    let (flat2, size2) = (flat.dot(flat), old.dot(old));
    let alive = zero.less(flat2);
    let flat = if FAST {
        flat * (size2 * (size2 * flat2).max(tiny).reciprocal_root())
    } else {
        flat * (size2 / flat2).sqrt()
    };
    let (sin, cos) = small_sin_cos(m.twist, touching & alive);
    let carried = (flat * cos + n.cross(flat) * sin).select(alive, V3::splat(0.0));
    // Hertz.
    let delta = m.overlap.max(zero);
    let a = root::<V, FAST>(m.r_star * delta);
    let stiffness = V::splat(2.0) * laws.e_star * a;
    let elastic = V::splat(2.0 / 3.0) * stiffness * delta;
    // Both dashpots go with the root of mass times contact radius.
    let inertia = root::<V, FAST>(m.m_star * a);
    let viscous = laws.normal_damping * (inertia * laws.normal_root) * m.rate;
    let normal = (elastic + viscous).max(laws.least_force);
    let load = normal.max(zero);
    // Mindlin.
    let k = V::splat(8.0) * laws.g_star * a;
    let dashpot = laws.shear_damping * (inertia * laws.shear_root);
    // A new contact carries nothing, so that its share need only be finite.
    let most = if features.form.total_spring { f64::MAX } else { 1.0 };
    let share = (k / old_stiffness.abs().max(tiny)).min(V::splat(most));
    let trial = carried * share - (m.slip * m.dt) * k;
    let sticking = laws.friction * load;
    let (threshold, bound) = if features.stick_slip {
        let sliding = laws.kinetic * load;
        (sliding.select(old_stiffness.less(zero), sticking), sliding)
    } else {
        (sticking, sticking)
    };
    let (spring, sliding) = limit::<V, FAST>(trial, threshold, bound, touching);
    let sticks_damped = touching & !sliding & zero.less(dashpot);
    // Sliding contacts are at the limit already and have no dashpot: few are left here.
    let (damped, _) =
        limit::<V, FAST>(spring - m.slip * dashpot, sticking, sticking, sticks_damped);
    let shear = damped.select(sticks_damped, spring);
    // Rolling.
    let (roll_i, roll_j) = if features.form.absolute_spin {
        let limit_i = (laws.arm_length + laws.arm_ratio * m.lever_i) * load;
        let limit_j = (laws.arm_length + laws.arm_ratio * m.lever_j) * load;
        (against::<V, FAST>(m.spin_i, limit_i), against::<V, FAST>(m.spin_j, limit_j))
    } else {
        let spin = m.spin_i - m.spin_j;
        let arm = laws.arm_length + laws.arm_ratio * m.r_star;
        let torque = against::<V, FAST>(spin - n * spin.dot(n), arm * load);
        (torque, -torque)
    };
    let moment = n.cross(shear);
    let repulsion =
        if features.cohesive { normal - pull(m, laws.energy_density, delta) } else { normal };
    Out {
        force: shear - n * repulsion,
        torque_i: moment * m.lever_i + roll_i,
        torque_j: moment * m.lever_j + roll_j,
        spring,
        stiffness: (-k).select(sliding, k),
    }
}

impl PairKernel<'_> {
    /// Compute a run of touching pairs.
    pub(crate) fn touching(&self, level: Level, run: &mut Run<'_>, into: &mut ChunkYield) {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,popcnt")]
            unsafe fn avx512<const FAST: bool, const MORE: bool>(
                k: &PairKernel<'_>,
                run: &mut Run<'_>,
                into: &mut ChunkYield,
            ) {
                // SAFETY: the lists hold places of spheres.
                unsafe {
                    let acting = k.acting::<super::avx::Wide>(run);
                    let done = k.blocks::<Two<super::avx::Wide>, FAST, MORE>(run, &acting, 0, into);
                    k.blocks::<super::avx::Wide, FAST, MORE>(run, &acting, done, into);
                }
            }
            #[target_feature(enable = "avx2,popcnt")]
            unsafe fn avx2<const MORE: bool>(
                k: &PairKernel<'_>,
                run: &mut Run<'_>,
                into: &mut ChunkYield,
            ) {
                // SAFETY: the lists hold places of spheres.
                unsafe {
                    let acting = k.acting::<super::avx::Pair>(run);
                    k.blocks::<super::avx::Pair, false, MORE>(run, &acting, 0, into);
                }
            }
            let more = self.features != Features::NONE;
            // SAFETY: `level` comes from `Level::detect`, which asked the processor.
            match (level, self.fast_roots, more) {
                (Level::Avx512, false, false) => unsafe { avx512::<false, false>(self, run, into) },
                (Level::Avx512, false, true) => unsafe { avx512::<false, true>(self, run, into) },
                (Level::Avx512, true, false) => unsafe { avx512::<true, false>(self, run, into) },
                (Level::Avx512, true, true) => unsafe { avx512::<true, true>(self, run, into) },
                (Level::Avx2, _, false) => unsafe { avx2::<false>(self, run, into) },
                (Level::Avx2, _, true) => unsafe { avx2::<true>(self, run, into) },
                (Level::Portable, ..) => {}
            }
        }
        let _ = level;
    }

    /// Bits of the near pairs that touch now, among eight.
    pub(crate) fn touch(&self, level: Level, first: &[u32; 8], second: &[u32; 8]) -> u8 {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,popcnt")]
            unsafe fn avx512(k: &PairKernel<'_>, first: &[u32; 8], second: &[u32; 8]) -> u8 {
                // SAFETY: the lists hold places of spheres.
                unsafe { k.near::<super::avx::Wide>(first, second) }
            }
            #[target_feature(enable = "avx2,popcnt")]
            unsafe fn avx2(k: &PairKernel<'_>, first: &[u32; 8], second: &[u32; 8]) -> u8 {
                // SAFETY: the lists hold places of spheres.
                unsafe { k.near::<super::avx::Pair>(first, second) }
            }
            // SAFETY: `level` comes from `Level::detect`, which asked the processor.
            match level {
                Level::Avx512 => return unsafe { avx512(self, first, second) },
                Level::Avx2 => return unsafe { avx2(self, first, second) },
                Level::Portable => {}
            }
        }
        let _ = (level, first, second);
        u8::MAX
    }

    /// # Safety
    /// Every place is that of a sphere.
    #[inline(always)]
    unsafe fn near<V: Lanes>(&self, first: &[u32; 8], second: &[u32; 8]) -> u8 {
        let position = self.spheres.position;
        // SAFETY: by the caller.
        let (mut d, ri, rj) = unsafe {
            match self.one_size {
                Some([radius, _]) => {
                    let d = <V as Lanes>::gather_difference(position, second, first);
                    (V3::of(d), V::splat(radius), V::splat(radius))
                }
                None => {
                    let pi = V::gather(position, first);
                    let pj = V::gather(position, second);
                    (V3::of(pj) - V3::of(pi), pi[3], pj[3])
                }
            }
        };
        if let Some(p) = self.period {
            d = d.shortest(p);
        }
        let sum = ri + rj;
        d.dot(d).less(sum * sum)
    }

    /// Look which pairs of a run act, and mark those that touch. The others feel nothing and remember
    /// nothing, as before, so that they cost no more than this look: a third to a half of them.
    ///
    /// # Safety
    /// Every place in the run is that of a sphere.
    #[inline(always)]
    unsafe fn acting<V: Lanes>(&self, run: &mut Run<'_>) -> Acting {
        let (first, _) = run.first.as_chunks::<8>();
        let (second, _) = run.second.as_chunks::<8>();
        let (active, _) = run.active.as_chunks_mut::<8>();
        debug_assert!(8 * active.len() <= CHUNK);
        let mut acting = Acting { pair: [0; CHUNK + 8], count: 0 };
        let mut idle = 0;
        for (k, ((first, second), active)) in first.iter().zip(second).zip(active).enumerate() {
            let valid = match run.pairs.saturating_sub(8 * k) {
                left @ 0..8 => (1u8 << left) - 1,
                _ => u8::MAX,
            };
            // SAFETY: by the caller.
            let touching = unsafe { self.near::<V>(first, second) } & valid;
            // A byte of 0 or 1 each: their bits side by side.
            let before = u64::from_le_bytes(*active).wrapping_mul(0x0102_0408_1020_4080) >> 56;
            let acts = touching | before as u8;
            *active = BYTES[usize::from(touching)];
            if let Some(to) = acting.pair[acting.count..].first_chunk_mut::<8>() {
                for (to, lane) in to.iter_mut().zip(SET_BITS[usize::from(acts)]) {
                    *to = 8 * k as u32 + u32::from(lane);
                }
            }
            acting.count += acts.count_ones() as usize;
            if acts != u8::MAX {
                idle = 8 * k as u32 + acts.trailing_ones();
            }
        }
        // As many lanes are idle as a last block lacks, or more.
        acting.pair[acting.count..].iter_mut().take(8).for_each(|p| *p = idle);
        acting
    }

    /// Compute blocks of the pairs that act, from `done` pairs on, by the usual laws or by `MORE`, as long as there
    /// are enough; returns how many pairs are done then.
    ///
    /// # Safety
    /// Every place in the run is that of a sphere, and `acting` is of that run.
    #[inline(always)]
    unsafe fn blocks<V: Blocks, const FAST: bool, const MORE: bool>(
        &self,
        run: &mut Run<'_>,
        acting: &Acting,
        mut done: usize,
        into: &mut ChunkYield,
    ) -> usize {
        let laws = Laws::splat(&self.constants[0]);
        // Not known to the compiler: it would take the exchanges of `put_quads` apart for the sake of a zero.
        let nothing = std::hint::black_box(0.0);
        let sinks = Sinks {
            memory: run.memory.as_mut_ptr(),
            force: run.force.as_mut_ptr().cast(),
            torque_first: run.torque_first.as_mut_ptr().cast(),
            torque_second: run.torque_second.as_mut_ptr().cast(),
        };
        let whole = acting.count.next_multiple_of(8);
        while done + 8 * V::COUNT <= whole {
            let mut block = Block {
                first: [[0; 8]; MOST],
                second: [[0; 8]; MOST],
                pair: [[0; 8]; MOST],
                valid: [0; MOST],
            };
            for k in 0..V::COUNT {
                let begin = done + 8 * k;
                for lane in 0..8 {
                    let pair = acting.pair[begin + lane];
                    block.pair[k][lane] = pair;
                    block.first[k][lane] = run.first[pair as usize];
                    block.second[k][lane] = run.second[pair as usize];
                }
                block.valid[k] = match acting.count.saturating_sub(begin) {
                    left @ 0..8 => (1u8 << left) - 1,
                    _ => u8::MAX,
                };
            }
            // SAFETY: by the caller; every pair is one of the run.
            let deep = unsafe { self.block::<V, FAST, MORE>(&block, sinks, &laws, nothing) };
            if deep != [0; MOST] {
                for k in 0..V::COUNT {
                    self.note_deep(deep[k], &block.first[k], &block.second[k], into);
                }
            }
            done += 8 * V::COUNT;
        }
        done
    }

    #[cold]
    fn note_deep(&self, deep: u8, first: &[u32; 8], second: &[u32; 8], into: &mut ChunkYield) {
        for lane in (0..8).filter(|l| deep >> l & 1 != 0) {
            let (i, j) = (first[lane], second[lane]);
            let (a, b) = (self.spheres.position[i as usize], self.spheres.position[j as usize]);
            let d = crate::neighbour::Period::shortest(self.period, b.vector() - a.vector());
            let overlap = a.w + b.w - d.length();
            into.note_overlap(overlap / a.w.min(b.w), i, j, false);
        }
    }

    /// Compute a block; returns which lanes overlap too deeply.
    ///
    /// # Safety
    /// Every place in `first` and `second` of a block is that of a sphere; the sinks hold four numbers for each
    /// of its pairs.
    #[inline(always)]
    unsafe fn block<V: Blocks, const FAST: bool, const MORE: bool>(
        &self,
        b: &Block,
        sinks: Sinks,
        only: &Laws<V>,
        nothing: f64,
    ) -> [u8; MOST] {
        let s = &self.spheres;
        // Spheres alike: only differences are needed, and half as many exchanges.
        // SAFETY: by the caller.
        let (mut d, ri, rj) = unsafe {
            match self.one_size {
                Some([radius, _]) => {
                    let d = V::gather_difference(s.position, &b.second, &b.first);
                    (V3::of(d), V::splat(radius), V::splat(radius))
                }
                None => {
                    let pi = V::quads(s.position.as_ptr().cast(), &b.first);
                    let pj = V::quads(s.position.as_ptr().cast(), &b.second);
                    (V3::of(pj) - V3::of(pi), pi[3], pj[3])
                }
            }
        };
        if let Some(p) = self.period {
            d = d.shortest(p);
        }
        let distance_squared = d.dot(d);
        let sum = ri + rj;
        let touching = distance_squared.less(sum * sum) & V::mask(b.valid);
        let (distance, inverse) = if FAST {
            let inverse = distance_squared.reciprocal_root();
            (distance_squared * inverse, inverse)
        } else {
            let distance = distance_squared.sqrt();
            (distance, V::splat(1.0) / distance)
        };
        let overlap = sum - distance;
        // SAFETY: by the caller.
        let (approach, mi, mj) = unsafe {
            match self.one_size {
                Some([_, mass]) => {
                    let v = V::gather_difference(s.mean_velocity, &b.first, &b.second);
                    (V3::of(v), V::splat(mass), V::splat(mass))
                }
                None => {
                    let vi = V::quads(s.mean_velocity.as_ptr().cast(), &b.first);
                    let vj = V::quads(s.mean_velocity.as_ptr().cast(), &b.second);
                    (V3::of(vi) - V3::of(vj), vi[3], vj[3])
                }
            }
        };
        // SAFETY: by the caller.
        let (wi, wj, end) = unsafe {
            (
                V::quads(s.mean_spin.as_ptr().cast(), &b.first),
                V::quads(s.mean_spin.as_ptr().cast(), &b.second),
                V3::of(V::gather_difference(s.end_velocity, &b.first, &b.second)),
            )
        };
        let many;
        let laws = if self.constants.len() > 1 {
            let (a, c) = (wi[3].each(), wj[3].each());
            many = Laws::lanes(|k, lane| {
                &self.constants[a[k][lane] as usize * self.materials + c[k][lane] as usize]
            });
            &many
        } else {
            only
        };
        let (wi, wj) = (V3::of(wi), V3::of(wj));
        let deep = (V::splat(self.overlap_limit) * ri.min(rj)).less(overlap) & touching;
        let n = d * inverse;
        let dt = V::splat(self.dt);
        let half = V::splat(0.5) * overlap;
        let (lever_i, lever_j) = (ri - half, rj - half);
        let back = V::splat(0.25 * self.dt) * approach.dot(n);
        let relative = approach + (wi * (lever_i + back) + wj * (lever_j + back)).cross(n);
        // Spheres alike: the same operations, once for all lanes.
        let (r_star, m_star) = match self.one_size {
            Some([r, m]) => (V::splat(r * r / (r + r)), V::splat(m * m / (m + m))),
            None => (ri * rj / sum, mi * mj / (mi + mj)),
        };
        let motion = Motion {
            normal: n,
            overlap,
            rate: end.dot(n),
            slip: relative - n * relative.dot(n),
            spin_i: wi,
            spin_j: wj,
            lever_i,
            lever_j,
            r_star,
            m_star,
            radius_i: ri,
            radius_j: rj,
            twist: V::splat(0.5) * (wi + wj).dot(n) * dt,
            dt,
        };
        // SAFETY: by the caller.
        let old = unsafe { V::quads(sinks.memory, &b.pair) };
        let features = if MORE { self.features } else { Features::NONE };
        let out = respond::<V, FAST>(&motion, laws, features, V3::of(old), old[3], touching);
        // SAFETY: by the caller.
        unsafe { store(b, sinks, touching, &out, nothing) };
        V::bits(deep)
    }
}

/// # Safety
/// The sinks hold four numbers for each pair of the block.
#[inline(always)]
unsafe fn store<V: Blocks>(b: &Block, sinks: Sinks, touching: V::Mask, out: &Out<V>, nothing: f64) {
    let zero = V::splat(nothing);
    let none = V3::splat(0.0);
    let stiffness = out.stiffness.select(touching, zero);
    for (v, scalar, to) in [
        (out.spring, stiffness, sinks.memory),
        (out.force, zero, sinks.force),
        (out.torque_i, zero, sinks.torque_first),
        (out.torque_j, zero, sinks.torque_second),
    ] {
        let v = v.select(touching, none);
        // SAFETY: by the caller.
        unsafe { V::put_quads([v.x, v.y, v.z, scalar], to, &b.pair) };
    }
}
