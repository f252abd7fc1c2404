//! Hertz, Mindlin with history, damping, constant rolling torque and the pull of simplified JKR: eight
//! contacts at once.
//!
//! Operation by operation the portable path: `forces.rs` for the kinematics, then
//! `normal/hertz.rs`, `contact/spring.rs`, `contact/friction.rs`, `tangential/mindlin.rs`,
//! `rolling/constant_torque.rs`, `cohesion/sjkr.rs` and `contact/model.rs`. Whoever changes one of them changes this
//! too: `simd_and_portable_kernels_agree_bit_by_bit` tells.

use super::lanes::{Lanes, V3};
use super::{Constants, Level};
use crate::contact::spring::{COSINE, SINE};
use crate::forces::{ChunkYield, SphereView};
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

/// One block of eight contacts.
struct Block<'a> {
    first: &'a [u32; 8],
    second: &'a [u32; 8],
    /// Lanes that hold a contact.
    valid: u8,
    /// Which of them touch: out.
    touching: u8,
    /// Which overlap too deeply: out.
    deep: u8,
    memory: &'a mut [f64; 8 * SLOTS],
    force: &'a mut [Record; 8],
    torque_first: &'a mut [Record; 8],
    torque_second: &'a mut [Record; 8],
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
    /// Whether any law pulls.
    pub(crate) cohesive: bool,
}

/// Constants of eight contacts.
#[derive(Clone, Copy)]
pub(super) struct Laws<V> {
    e_star: V,
    normal_damping: V,
    g_star: V,
    friction: V,
    shear_damping: V,
    arm_length: V,
    arm_ratio: V,
    least_force: V,
    energy_density: V,
    /// Roots of `2 E*` and `8 G*`.
    normal_root: V,
    shear_root: V,
}

impl<V: Lanes> Laws<V> {
    #[inline(always)]
    pub(super) fn splat(c: &Constants) -> Self {
        Self::from(
            #[inline(always)]
            |f| V::splat(f(c)),
        )
    }

    #[inline(always)]
    pub(super) fn lanes(each: [&Constants; 8]) -> Self {
        Self::from(
            #[inline(always)]
            |f| V::load(&each.map(f)),
        )
    }

    #[inline(always)]
    fn from(make: impl Fn(fn(&Constants) -> f64) -> V) -> Self {
        Self {
            e_star: make(|c| c.e_star),
            normal_damping: make(|c| c.normal_damping),
            g_star: make(|c| c.g_star),
            friction: make(|c| c.friction),
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

/// Hold `trial` to the limit; returns it and the lanes, of those that matter, that slide.
#[inline(always)]
fn limit<V: Lanes, const FAST: bool>(trial: V3<V>, threshold: V, used: u8) -> (V3<V>, u8) {
    let size2 = trial.dot(trial);
    let slides = (threshold * threshold).less(size2) & used;
    if slides == 0 {
        return (trial, 0);
    }
    let scaled = if FAST {
        trial * (threshold * size2.max(V::splat(f64::MIN_POSITIVE)).reciprocal_root())
    } else {
        trial * (threshold / size2.sqrt())
    };
    (scaled.select(slides, trial), slides)
}

/// Root of numbers that are not negative.
#[inline(always)]
fn root<V: Lanes, const FAST: bool>(x: V) -> V {
    if FAST { x * x.max(V::splat(f64::MIN_POSITIVE)).reciprocal_root() } else { x.sqrt() }
}

/// Sine and cosine of the twists of a step, as in `contact/spring.rs`; `used` are the lanes that
/// matter.
#[inline(always)]
fn small_sin_cos<V: Lanes>(x: V, used: u8) -> (V, V) {
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
    if large == 0 { (sin, cos) } else { large_sin_cos(x, sin, cos, large) }
}

/// The lanes of large twists by the library's functions.
#[cold]
fn large_sin_cos<V: Lanes>(x: V, sin: V, cos: V, large: u8) -> (V, V) {
    let (mut angles, mut sines, mut cosines) = ([0.0; 8], [0.0; 8], [0.0; 8]);
    x.store(&mut angles);
    sin.store(&mut sines);
    cos.store(&mut cosines);
    for lane in (0..8).filter(|l| large >> l & 1 != 0) {
        (sines[lane], cosines[lane]) = angles[lane].sin_cos();
    }
    (V::load(&sines), V::load(&cosines))
}

/// Simplified JKR.
#[inline(always)]
fn pull<V: Lanes>(m: &Motion<V>, energy_density: V, d: V) -> V {
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

/// The laws; `cohesive` tells whether any of them pulls.
#[inline(always)]
pub(super) fn respond<V: Lanes, const FAST: bool>(
    m: &Motion<V>,
    laws: &Laws<V>,
    cohesive: bool,
    old: V3<V>,
    old_stiffness: V,
    touching: u8,
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
    let share = (k / old_stiffness.abs().max(tiny)).min(V::splat(1.0));
    let trial = carried * share - (m.slip * m.dt) * k;
    let threshold = laws.friction * load;
    let (spring, sliding) = limit::<V, FAST>(trial, threshold, touching);
    let sticks_damped = touching & !sliding & zero.less(dashpot);
    // Sliding contacts are at the limit already and have no dashpot: few are left here.
    let (damped, _) = limit::<V, FAST>(spring - m.slip * dashpot, threshold, sticks_damped);
    let shear = damped.select(sticks_damped, spring);
    // Constant torque.
    let spin = m.spin_i - m.spin_j;
    let rolling = spin - n * spin.dot(n);
    let speed2 = rolling.dot(rolling);
    let arm = laws.arm_length + laws.arm_ratio * m.r_star;
    let torque = if FAST {
        rolling * (-(arm * load) * speed2.max(tiny).reciprocal_root())
    } else {
        rolling * (-(arm * load) / speed2.sqrt().max(tiny))
    };
    let moment = n.cross(shear);
    let repulsion = if cohesive { normal - pull(m, laws.energy_density, delta) } else { normal };
    Out {
        force: shear - n * repulsion,
        torque_i: moment * m.lever_i + torque,
        torque_j: moment * m.lever_j - torque,
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
            unsafe fn avx512(k: &PairKernel<'_>, run: &mut Run<'_>, into: &mut ChunkYield) {
                // SAFETY: the lists hold places of spheres.
                unsafe {
                    if k.fast_roots {
                        k.blocks::<super::avx::Wide, true>(run, into);
                    } else {
                        k.blocks::<super::avx::Wide, false>(run, into);
                    }
                }
            }
            #[target_feature(enable = "avx2,popcnt")]
            unsafe fn avx2(k: &PairKernel<'_>, run: &mut Run<'_>, into: &mut ChunkYield) {
                // SAFETY: the lists hold places of spheres.
                unsafe { k.blocks::<super::avx::Pair, false>(run, into) }
            }
            // SAFETY: `level` comes from `Level::detect`, which asked the processor.
            match level {
                Level::Avx512 => unsafe { avx512(self, run, into) },
                Level::Avx2 => unsafe { avx2(self, run, into) },
                Level::Portable => {}
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
        let (pi, pj) = unsafe { (V::gather(position, first), V::gather(position, second)) };
        let mut d = V3::of(pj) - V3::of(pi);
        if let Some(p) = self.period {
            d = d.shortest(p);
        }
        let sum = pi[3] + pj[3];
        d.dot(d).less(sum * sum)
    }

    /// # Safety
    /// Every place in the run is that of a sphere.
    #[inline(always)]
    unsafe fn blocks<V: Lanes, const FAST: bool>(&self, run: &mut Run<'_>, into: &mut ChunkYield) {
        let (first, _) = run.first.as_chunks::<8>();
        let (second, _) = run.second.as_chunks::<8>();
        let (active, _) = run.active.as_chunks_mut::<8>();
        let (memory, _) = run.memory.as_chunks_mut::<{ 8 * SLOTS }>();
        let (force, _) = run.force.as_chunks_mut::<8>();
        let (torque_first, _) = run.torque_first.as_chunks_mut::<8>();
        let (torque_second, _) = run.torque_second.as_chunks_mut::<8>();
        let each = first.iter().zip(second).zip(active).zip(memory).zip(force);
        let each = each.zip(torque_first).zip(torque_second).enumerate();
        let laws = Laws::splat(&self.constants[0]);
        for (k, ((((((first, second), active), memory), force), torque_first), torque_second)) in
            each
        {
            let left = run.pairs.saturating_sub(8 * k);
            let valid = if left >= 8 { u8::MAX } else { (1u8 << left) - 1 };
            let mut block = Block {
                first,
                second,
                valid,
                touching: 0,
                deep: 0,
                memory,
                force,
                torque_first,
                torque_second,
            };
            // SAFETY: by the caller.
            unsafe { self.block::<V, FAST>(&mut block, &laws) };
            let (touching, deep) = (block.touching, block.deep);
            *active = BYTES[usize::from(touching)];
            if deep != 0 {
                self.note_deep(deep, first, second, into);
            }
        }
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

    /// # Safety
    /// Every place in `first` and `second` of a block is that of a sphere.
    #[inline(always)]
    unsafe fn block<V: Lanes, const FAST: bool>(&self, b: &mut Block<'_>, only: &Laws<V>) {
        let s = &self.spheres;
        // Spheres alike: only differences are needed, and half as many exchanges.
        // SAFETY: by the caller.
        let (mut d, ri, rj) = unsafe {
            match self.one_size {
                Some([radius, _]) => {
                    let d = V::gather_difference(s.position, b.second, b.first);
                    (V3::of(d), V::splat(radius), V::splat(radius))
                }
                None => {
                    let pi = V::gather(s.position, b.first);
                    let pj = V::gather(s.position, b.second);
                    (V3::of(pj) - V3::of(pi), pi[3], pj[3])
                }
            }
        };
        if let Some(p) = self.period {
            d = d.shortest(p);
        }
        let distance_squared = d.dot(d);
        let sum = ri + rj;
        let touching = distance_squared.less(sum * sum) & b.valid;
        b.touching = touching;
        b.deep = 0;
        if touching == 0 {
            b.memory.fill(0.0);
            b.force.fill(Record::default());
            b.torque_first.fill(Record::default());
            b.torque_second.fill(Record::default());
            return;
        }
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
                    let v = V::gather_difference(s.mean_velocity, b.first, b.second);
                    (V3::of(v), V::splat(mass), V::splat(mass))
                }
                None => {
                    let vi = V::gather(s.mean_velocity, b.first);
                    let vj = V::gather(s.mean_velocity, b.second);
                    (V3::of(vi) - V3::of(vj), vi[3], vj[3])
                }
            }
        };
        // SAFETY: by the caller.
        let (wi, wj, end) = unsafe {
            (
                V::gather(s.mean_spin, b.first),
                V::gather(s.mean_spin, b.second),
                V3::of(V::gather_difference(s.end_velocity, b.first, b.second)),
            )
        };
        let many;
        let laws = if self.constants.len() > 1 {
            let (mut a, mut c) = ([0.0; 8], [0.0; 8]);
            wi[3].store(&mut a);
            wj[3].store(&mut c);
            many = Laws::lanes(std::array::from_fn(|k| {
                &self.constants[a[k] as usize * self.materials + c[k] as usize]
            }));
            &many
        } else {
            only
        };
        let (wi, wj) = (V3::of(wi), V3::of(wj));
        b.deep = (V::splat(self.overlap_limit) * ri.min(rj)).less(overlap) & touching;
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
        let (old, old_stiffness) = load_memory::<V>(b.memory);
        let out = respond::<V, FAST>(&motion, laws, self.cohesive, old, old_stiffness, touching);
        store(b, touching, &out);
    }
}

#[inline(always)]
fn load_memory<V: Lanes>(memory: &[f64; 8 * SLOTS]) -> (V3<V>, V) {
    let (slots, _) = memory.as_chunks::<8>();
    let old = V3 { x: V::load(&slots[0]), y: V::load(&slots[1]), z: V::load(&slots[2]) };
    (old, V::load(&slots[3]))
}

#[inline(always)]
fn store<V: Lanes>(b: &mut Block<'_>, touching: u8, out: &Out<V>) {
    let zero = V::splat(0.0);
    let none = V3::splat(0.0);
    let spring = out.spring.select(touching, none);
    let (slots, _) = b.memory.as_chunks_mut::<8>();
    spring.x.store(&mut slots[0]);
    spring.y.store(&mut slots[1]);
    spring.z.store(&mut slots[2]);
    out.stiffness.select(touching, zero).store(&mut slots[3]);
    for (v, to) in [
        (out.force, &mut *b.force),
        (out.torque_i, &mut *b.torque_first),
        (out.torque_j, &mut *b.torque_second),
    ] {
        let v = v.select(touching, none);
        V::scatter([v.x, v.y, v.z, zero], to);
    }
}
