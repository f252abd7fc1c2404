//! Eight contacts at once: with `threads/` the only unsafe code of the crate.
//!
//! The kernel is written once, over [`lanes::Lanes`]; AVX-512 and AVX2 each compile it for their
//! registers, and the widest that the processor has is chosen when a world runs. Every operation
//! is the same, in the same order, as in the portable kernel, and none is fused unless the world asks for it: so the bits of
//! the result are those of the portable kernel, on every processor.
#![expect(unsafe_code, reason = "vector instructions and unchecked gathers")]

mod acting;
mod avx;
mod avx2;
mod avx512;
mod blocks;
mod carried;
mod clumps;
mod facing;
mod gathering;
mod group;
mod half;
mod hertz_mindlin;
mod lanes;
mod meeting;
mod near;
mod pairs;
mod reach;
mod records;
mod staged;
mod wall;
mod wall_staged;

use std::any::Any;

pub(crate) use clumps::{OnBodies, Placing, Since, Turning};
pub(crate) use hertz_mindlin::Features;
pub(crate) use lanes::{Apart, Mask, Numbers, Quad, Quads, V3};
pub(crate) use pairs::{PairKernel, Run, Wrenches};
pub(crate) use reach::{in_reach, keep_marked};
pub(crate) use wall::WallRun;

use crate::contact::cohesion::{Cohesionless, Sjkr};
use crate::contact::model::ContactModel;
use crate::contact::normal::Hertz;
use crate::contact::rolling::{AbsoluteSpin, ConstantTorque, FreeRolling, RollingArm};
use crate::contact::tangential::{Mindlin, MindlinTotalSpring};
use crate::particles::{LINE, Record};
use crate::threads::View;

/// Instruction set that a world's kernels use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Level {
    /// One contact at a time, any processor.
    Portable,
    /// Two registers of four lanes (AVX2 with fused operations, which came together).
    Avx2,
    /// One register of eight lanes.
    Avx512,
}

/// How the kernels of contacts compute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Arithmetic {
    /// Every operation is rounded by itself, as in the portable kernel.
    Exact,
    /// What a product is added to is rounded once.
    Fused,
    /// The same, and roots may be off in the last places.
    FastRoots,
}

impl Level {
    /// The widest that this processor has.
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let has_avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("popcnt");
            let has_avx512 = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl");
            if has_avx2 && has_avx512 {
                return Self::Avx512;
            }
            if has_avx2 {
                return Self::Avx2;
            }
        }
        Self::Portable
    }
}

/// Constants of a Hertz-Mindlin law that the kernel knows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Constants {
    pub(crate) e_star: f64,
    pub(crate) normal_damping: f64,
    pub(crate) g_star: f64,
    /// Friction while a contact sticks, and once it slides.
    pub(crate) friction: f64,
    pub(crate) kinetic: f64,
    pub(crate) shear_damping: f64,
    pub(crate) arm_length: f64,
    pub(crate) arm_ratio: f64,
    /// Lowest normal force: 0 where the tail is cut, minus infinity where it is kept.
    pub(crate) least_force: f64,
    /// Cohesion energy density of the simplified JKR law.
    pub(crate) energy_density: f64,
    /// Forms of the laws: the same for all of a world, whose laws are of one type.
    pub(crate) form: Form,
}

/// Forms of the laws that a kernel distinguishes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Form {
    /// The present stiffness multiplies the whole displacement of the shear spring.
    pub(crate) total_spring: bool,
    /// The rolling torque acts against each body's own spin.
    pub(crate) absolute_spin: bool,
}

/// A shear spring that the kernel knows.
trait Shear: 'static {
    const TOTAL: bool;
    fn mindlin(&self) -> &Mindlin;
}

impl Shear for Mindlin {
    const TOTAL: bool = false;
    fn mindlin(&self) -> &Mindlin {
        self
    }
}

impl Shear for MindlinTotalSpring {
    const TOTAL: bool = true;
    fn mindlin(&self) -> &Mindlin {
        &self.0
    }
}

/// A rolling torque that the kernel knows.
trait Torque: 'static {
    const ABSOLUTE: bool;
    fn arm(&self) -> RollingArm;
}

impl Torque for ConstantTorque {
    const ABSOLUTE: bool = false;
    fn arm(&self) -> RollingArm {
        self.arm
    }
}

impl Torque for AbsoluteSpin {
    const ABSOLUTE: bool = true;
    fn arm(&self) -> RollingArm {
        self.arm
    }
}

impl Torque for FreeRolling {
    const ABSOLUTE: bool = false;
    fn arm(&self) -> RollingArm {
        RollingArm { length: 0.0, ratio: 0.0 }
    }
}

/// A pull that the kernel knows.
trait Pull: 'static {
    fn energy_density(&self) -> f64;
}

impl Pull for Cohesionless {
    fn energy_density(&self) -> f64 {
        0.0
    }
}

impl Pull for Sjkr {
    fn energy_density(&self) -> f64 {
        self.energy_density
    }
}

impl Constants {
    /// Those of a law of this very type.
    fn of<const CUT: bool, T: Shear, R: Torque, C: Pull>(law: &dyn Any) -> Option<Self> {
        let m = law.downcast_ref::<ContactModel<Hertz<CUT>, T, R, C>>()?;
        let (tangential, arm) = (m.tangential.mindlin(), m.rolling.arm());
        let f = &tangential.friction;
        // No exponential here.
        let fades = f.mu_static != f.mu_kinetic && f.decay_speed > 0.0;
        (!fades).then_some(Self {
            e_star: m.normal.e_star,
            normal_damping: m.normal.damping,
            g_star: tangential.g_star,
            friction: f.mu_static,
            kinetic: f.mu_kinetic,
            shear_damping: tangential.damping,
            arm_length: arm.length,
            arm_ratio: arm.ratio,
            least_force: if CUT { 0.0 } else { f64::NEG_INFINITY },
            energy_density: m.cohesion.energy_density(),
            form: Form { total_spring: T::TOTAL, absolute_spin: R::ABSOLUTE },
        })
    }

    /// Those of a law of any type that the kernel knows.
    fn of_any<const CUT: bool>(law: &dyn Any) -> Option<Self> {
        Self::of::<CUT, Mindlin, ConstantTorque, Cohesionless>(law)
            .or_else(|| Self::of::<CUT, Mindlin, ConstantTorque, Sjkr>(law))
            .or_else(|| Self::of::<CUT, Mindlin, FreeRolling, Cohesionless>(law))
            .or_else(|| Self::of::<CUT, Mindlin, AbsoluteSpin, Cohesionless>(law))
            .or_else(|| Self::of::<CUT, MindlinTotalSpring, ConstantTorque, Cohesionless>(law))
            .or_else(|| Self::of::<CUT, MindlinTotalSpring, AbsoluteSpin, Cohesionless>(law))
    }
}

/// Constants of all laws of a table, if the kernel knows every one of them.
pub(crate) fn constants<M: 'static>(laws: &[M]) -> Option<Vec<Constants>> {
    laws.iter()
        .map(|law| Constants::of_any::<true>(law).or_else(|| Constants::of_any::<false>(law)))
        .collect()
}

/// Ask the memory for records that are needed soon.
#[inline(always)]
pub(crate) fn fetch<T>(records: View<'_, T>, places: std::ops::Range<usize>) {
    #[cfg(target_arch = "x86_64")]
    for place in places.step_by(const { LINE / size_of::<T>() }) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        debug_assert!(place < records.len());
        // SAFETY: nothing is read.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(records.as_ptr().wrapping_add(place).cast()) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (records, places);
}

/// Work on records that is written once for all instruction sets.
pub(crate) trait RecordWork {
    /// What it yields.
    type Yield;
    /// Do it with `Q` for a record, and `W` for as many records as a register holds.
    fn run<Q: Quad, W: Quads>(self) -> Self::Yield;
}

/// Do `work` with the registers of `level`: the same operations on each number, of which those that fuse are rounded once
/// unless the arithmetic is exact.
#[inline(always)]
pub(crate) fn on_records<W: RecordWork>(level: Level, arithmetic: Arithmetic, work: W) -> W::Yield {
    #[cfg(target_arch = "x86_64")]
    if level != Level::Portable {
        return widened_for(
            level,
            #[inline(always)]
            |level| {
                use records::{Eight, Four};
                match (level, arithmetic) {
                    (Level::Avx512, Arithmetic::Exact) => work.run::<Four<false>, Eight<false>>(),
                    (Level::Avx512, _) => work.run::<Four<true>, Eight<true>>(),
                    (_, Arithmetic::Exact) => work.run::<Four<false>, Four<false>>(),
                    _ => work.run::<Four<true>, Four<true>>(),
                }
            },
        );
    }
    let _ = (level, arithmetic);
    work.run::<Record, Record>()
}

/// Run `work` compiled for the instructions of `level`: the same operations, wider registers.
#[inline(always)]
pub(crate) fn widened<R>(level: Level, work: impl FnOnce() -> R) -> R {
    widened_for(
        level,
        #[inline(always)]
        |_| work(),
    )
}

/// The same for work that asks for the level, which the compiler knows there.
#[inline(always)]
pub(crate) fn widened_for<R>(level: Level, work: impl FnOnce(Level) -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,popcnt")]
        unsafe fn avx512<R>(work: impl FnOnce(Level) -> R) -> R {
            work(Level::Avx512)
        }
        #[target_feature(enable = "avx2,fma,popcnt")]
        unsafe fn avx2<R>(work: impl FnOnce(Level) -> R) -> R {
            work(Level::Avx2)
        }
        // SAFETY: `level` comes from `Level::detect`, which asked the processor.
        match level {
            Level::Avx512 => return unsafe { avx512(work) },
            Level::Avx2 => return unsafe { avx2(work) },
            Level::Portable => {}
        }
    }
    let _ = level;
    work(Level::Portable)
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use lanes::{Lanes, Numbers};

    /// By how much reciprocal roots, roots, reciprocals and both roots at once are off at most by the table, in units of
    /// `f64::EPSILON`.
    fn worst_by_the_table() -> [f64; 5] {
        type V = avx512::Wide<true, true>;
        let mut worst = [0.0f64; 5];
        for k in 0..40_000 {
            let x: [f64; 8] = std::array::from_fn(|lane| {
                let k = f64::from(8 * k + lane as i32);
                (1.0 + k / 320_000.0) * 10f64.powi(k as i32 % 60 - 30)
            });
            let (mut inverse, mut root, mut over) = ([0.0; 8], [0.0; 8], [0.0; 8]);
            let mut both = [[0.0; 8]; 2];
            widened(
                Level::Avx512,
                #[inline(always)]
                || {
                    let own = V::load(&x);
                    own.reciprocal_root().store(&mut inverse);
                    own.root().store(&mut root);
                    own.reciprocal().store(&mut over);
                    let [root, quarter] = own.both_roots();
                    root.store(&mut both[0]);
                    quarter.store(&mut both[1]);
                },
            );
            for (lane, x) in x.iter().enumerate() {
                let off = [
                    inverse[lane] * x.sqrt(),
                    root[lane] / x.sqrt(),
                    over[lane] * x,
                    both[0][lane] / x.sqrt(),
                    both[1][lane] / x.sqrt().sqrt(),
                ];
                for (worst, off) in worst.iter_mut().zip(off) {
                    *worst = worst.max((off - 1.0).abs() / f64::EPSILON);
                }
            }
        }
        worst
    }

    #[test]
    fn reciprocals_and_roots_by_the_table_are_a_few_units_in_the_last_place_off_at_most() {
        if Level::detect() != Level::Avx512 {
            return;
        }
        let worst = worst_by_the_table();
        // Roots and products that they are held against round as well: half a unit each.
        assert!(worst[..3].iter().all(|w| *w < 3.0), "{worst:?}");
        // Products of three and four numbers from the series.
        assert!(worst[3..].iter().all(|w| *w < 4.0), "{worst:?}");
        assert!(worst.iter().all(|w| *w > 0.0), "{worst:?}");
    }

    #[test]
    fn roots_by_the_table_of_nothing_are_nothing() {
        if Level::detect() != Level::Avx512 {
            return;
        }
        let mut root = [1.0; 8];
        widened(
            Level::Avx512,
            #[inline(always)]
            || avx512::Wide::<true, true>::splat(0.0).root().store(&mut root),
        );
        assert_eq!(root, [0.0; 8]);
    }

    use crate::prelude::*;

    type Model = ContactModel<HertzTailCut, Mindlin, ConstantTorque, Cohesionless>;

    /// Bodies in a drum, of so many materials of one law, which are put at places of a grid.
    fn filled(
        kernels: Kernels,
        materials: usize,
        mut put: impl FnMut(&mut WorldBuilder<Model>, usize, DVec3, MaterialId),
    ) -> World<Model> {
        let material = Material::from_shear_modulus(2.52e7, 0.29, 2500.0);
        let mut b = WorldBuilder::<Model>::new(2e-5);
        let all: Vec<MaterialId> = (0..materials).map(|_| b.material(material)).collect();
        let normal: HertzTailCut =
            HertzSpec { e_star: 3.5e7, restitution: 0.8 }.try_into().unwrap();
        let law = ContactModel {
            normal,
            tangential: Mindlin {
                g_star: 7e6,
                friction: Friction::coulomb(0.5).unwrap(),
                damping: normal.damping,
            },
            rolling: ConstantTorqueSpec { coefficient: RollingCoefficient::Ratio(0.01) }
                .try_into()
                .unwrap(),
            cohesion: Cohesionless,
        };
        for (k, one) in all.iter().enumerate() {
            for other in &all[k..] {
                b.pair_law(*one, *other, law);
            }
        }
        b.gravity(DVec3::NEG_Y * 9.81).kernels(kernels);
        b.domain(DVec3::splat(-0.1), DVec3::splat(0.1));
        b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, 0.02, all[0]));
        for k in 0..216 {
            let at = DVec3::new((k % 6) as f64, (k / 6 % 6) as f64, (k / 36) as f64) - 2.5;
            // Rows are shifted, so that beads do not stand on each other.
            let at = at * 4.1e-3 + DVec3::X * 3e-4 * (k / 6 % 2) as f64;
            put(&mut b, k, at, all[k % materials]);
        }
        b.build().unwrap()
    }

    /// Beads whose radii scatter or not.
    fn beads(kernels: Kernels, materials: usize, scatter: f64) -> World<Model> {
        filled(kernels, materials, |b, k, at, own| {
            let radius = 2e-3 * (1.0 - scatter * (k % 7) as f64 / 7.0);
            b.sphere(Sphere::at(at, radius, own).with_spin(DVec3::new(3.0, 1.0, 2.0)));
        })
    }

    /// Clumps of two beads that are not alike.
    fn dumbbells(kernels: Kernels, materials: usize) -> World<Model> {
        let sphere = |x: f64, radius| ClumpSphere { centre: DVec3::X * x, radius };
        let mut shapes = Vec::new();
        filled(kernels, materials, |b, k, position, material| {
            let spheres = vec![sphere(-0.8e-3, 1.2e-3), sphere(0.9e-3, 1e-3)];
            let inertia = DMat3::from_diagonal(DVec3::new(2.0, 4.0, 4.0) * 1e-11);
            let spec =
                ClumpSpec { spheres, mass: 3e-5, centre_of_mass: DVec3::ZERO, inertia, material };
            let shape = match shapes.get(k % materials) {
                Some(shape) => *shape,
                None => {
                    shapes.push(b.clump_shape(spec.try_into().unwrap()));
                    shapes[k]
                }
            };
            b.clump(PlacedClump {
                shape,
                position,
                orientation: DQuat::from_rotation_y(0.3 * k as f64),
                velocity: DVec3::ZERO,
                spin: DVec3::new(3.0, 1.0, 2.0),
            });
        })
    }

    /// Where beads are and how they move after a while, bit by bit, by the registers of a level.
    fn after_a_while(mut world: World<Model>, level: Level) -> Vec<[u64; 3]> {
        world.make.level = level;
        world.run(6000).unwrap();
        assert!(world.contact_count() > 50, "{}", world.contact_count());
        let b = &world.state.bodies;
        let columns = [&b.position, &b.velocity, &b.spin];
        let vectors = columns.into_iter().flatten().map(|r| r.vector().to_array());
        vectors.map(|v| v.map(f64::to_bits)).collect()
    }

    #[test]
    fn fused_kernels_give_the_same_bits_with_either_registers() {
        if Level::detect() != Level::Avx512 {
            return;
        }
        for scatter in [0.0, 0.3] {
            let run = |kernels, level| after_a_while(beads(kernels, 1, scatter), level);
            let wide = run(Kernels::Fused, Level::Avx512);
            assert_eq!(wide, run(Kernels::Fused, Level::Avx2));
            assert_ne!(wide, run(Kernels::Fastest, Level::Avx512));
        }
        let run = |level| after_a_while(dumbbells(Kernels::Fused, 1), level);
        assert_eq!(run(Level::Avx512), run(Level::Avx2));
    }

    #[test]
    fn contacts_of_one_law_in_stages_and_of_several_in_blocks_have_the_same_bits() {
        if Level::detect() == Level::Portable {
            return;
        }
        for kernels in [Kernels::Fastest, Kernels::Fused] {
            let run = |materials| after_a_while(beads(kernels, materials, 0.3), Level::Avx2);
            assert_eq!(run(1), run(2), "{kernels:?}");
            let run = |materials| after_a_while(dumbbells(kernels, materials), Level::Avx2);
            assert_eq!(run(1), run(2), "{kernels:?}, clumps");
        }
    }

    #[test]
    fn bodies_keep_their_scalars_while_their_vectors_change() {
        // Mass twice, moment of inertia, radius, material and charge, by name.
        let scalars = |world: &World<Model>| {
            let b = &world.state.bodies;
            let mut all: Vec<_> = (0..b.len())
                .map(|k| {
                    let of = [&b.velocity, &b.spin, &b.position, &b.mean_spin];
                    let of_two = &b.velocities[k];
                    (b.id[k], of.map(|column| column[k].w), of_two.map(|record| record.w))
                })
                .collect();
            all.sort_by_key(|(id, ..)| *id);
            all
        };
        for kernels in [Kernels::Fastest, Kernels::Fused, Kernels::Portable] {
            // Alike and not: one mass for all, or that of each.
            for (materials, scatter) in [(2, 0.0), (3, 0.3)] {
                let mut world = beads(kernels, materials, scatter);
                let before = scalars(&world);
                world.run(6000).unwrap();
                assert!(world.contact_count() > 50, "{}", world.contact_count());
                assert_eq!(before, scalars(&world), "{kernels:?}, {materials}, {scatter}");
            }
        }
    }
}
