//! Hertz, Mindlin with history, damping, static and kinetic friction, a rolling torque and the pull of
//! simplified JKR: eight contacts at once; spring and torque in EDEM's forms too.
//!
//! Operation by operation the portable path: `forces.rs` for the kinematics, then
//! `normal/hertz.rs`, `contact/spring.rs` (in `carried.rs`), `contact/friction.rs`, `tangential/mindlin.rs` and
//! `mindlin_total_spring.rs`, `rolling/constant_torque.rs` and `absolute_spin.rs`, `cohesion/sjkr.rs` and
//! `contact/model.rs`. Whoever changes one of them changes this
//! too: `simd_and_portable_kernels_agree_bit_by_bit` tells.
//!
//! The laws come in three parts, each of which needs what the part before it found: [`press`], [`would_be`],
//! [`answer`]. [`respond`] is all three at once, `staged.rs` goes part by part.

use super::blocks::Blocks;
use super::carried::{Before, LEAST, Remembered};
use super::lanes::{Mask, Numbers, V3};
use super::{Constants, Form};

/// Numbers that a contact of these laws remembers: the spring's force and its signed stiffness.
pub(crate) const SLOTS: usize = 4;

/// Smallest overlap of fast kernels, m: none, but its product with a radius has a root and a reciprocal.
const LEAST_OVERLAP: f64 = 1e-90;

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
    pub(super) const NONE: Self = Self {
        cohesive: false,
        stick_slip: false,
        form: Form { total_spring: false, absolute_spin: false },
    };

    /// Forms of the laws.
    pub(super) fn form(self) -> Form {
        self.form
    }

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
    /// Roots of `2 E*` and `8 G*`: of exact kernels, as are `e_star` and both dampings.
    normal_root: V,
    shear_root: V,
    /// Of fused kernels: `4/3 E*`, and both dampings times these roots.
    hertz: V,
    viscous: V,
    dashpot: V,
}

impl<V: Numbers> Laws<V> {
    #[inline(always)]
    pub(super) fn splat(c: &Constants) -> Self {
        Self::from(
            #[inline(always)]
            |f| V::splat(f(c)),
        )
    }

    #[inline(always)]
    fn from(make: impl Fn(fn(&Constants) -> f64) -> V) -> Self {
        // What the other mode reads is not gathered: by lane that costs a call and a root for each.
        macro_rules! of_mode {
            ($fused:literal, $f:expr) => {
                if $fused == V::FUSED { make($f) } else { V::splat(0.0) }
            };
        }
        Self {
            e_star: of_mode!(false, |c| c.e_star),
            normal_damping: of_mode!(false, |c| c.normal_damping),
            g_star: make(|c| c.g_star),
            friction: make(|c| c.friction),
            kinetic: make(|c| c.kinetic),
            shear_damping: of_mode!(false, |c| c.shear_damping),
            arm_length: make(|c| c.arm_length),
            arm_ratio: make(|c| c.arm_ratio),
            least_force: make(|c| c.least_force),
            energy_density: make(|c| c.energy_density),
            normal_root: of_mode!(false, |c| (2.0 * c.e_star).sqrt()),
            shear_root: of_mode!(false, |c| (8.0 * c.g_star).sqrt()),
            hertz: of_mode!(true, |c| 4.0 / 3.0 * c.e_star),
            viscous: of_mode!(true, |c| c.normal_damping * (2.0 * c.e_star).sqrt()),
            dashpot: of_mode!(true, |c| c.shear_damping * (8.0 * c.g_star).sqrt()),
        }
    }
}

impl<V: Blocks> Laws<V> {
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
}

/// How the surfaces of contacts are pressed together.
#[derive(Clone, Copy)]
pub(super) struct Pressing<V> {
    pub(super) overlap: V,
    pub(super) rate: V,
    pub(super) r_star: V,
    pub(super) m_star: V,
}

/// What pressing gives.
#[derive(Clone, Copy)]
pub(super) struct Pressed<V> {
    /// Normal force, without any pull.
    force: V,
    /// Of the shear spring, and of its dashpot.
    stiffness: V,
    dashpot: V,
}

/// Relative motion of contacts.
#[derive(Clone, Copy)]
pub(super) struct Motion<V> {
    pub(super) normal: V3<V>,
    pub(super) slip: V3<V>,
    /// Part of the difference of spins across the normal.
    pub(super) rolling: V3<V>,
    pub(super) spin_i: V3<V>,
    pub(super) spin_j: V3<V>,
    pub(super) lever_i: V,
    pub(super) lever_j: V,
    pub(super) overlap: V,
    pub(super) r_star: V,
    pub(super) radius_i: V,
    pub(super) radius_j: V,
}

/// Springs of contacts, held by friction, and their signed stiffness.
pub(super) struct Held<V: Numbers> {
    pub(super) spring: V3<V>,
    pub(super) stiffness: V,
    /// Normal force that is not negative.
    load: V,
    /// The limit to friction.
    bound: V,
    sticks: V::Mask,
}

/// Wrenches of contacts.
pub(super) struct Out<V> {
    pub(super) force: V3<V>,
    pub(super) torque_i: V3<V>,
    pub(super) torque_j: V3<V>,
}

/// Hold `trial` to `bound` where it exceeds `threshold`, as is `rare` or not; returns it and the lanes, of those that
/// matter, that slide.
#[inline(always)]
fn limit<V: Numbers>(
    trial: V3<V>,
    threshold: V,
    bound: V,
    used: V::Mask,
    rare: bool,
) -> (V3<V>, V::Mask) {
    let size2 = trial.dot(trial);
    let slides = (threshold * threshold).less(size2) & used;
    if !V::FAST && (rare || !V::FEW) && slides.is_empty() {
        return (trial, slides);
    }
    // What slides is longer than nothing.
    let scale = if V::FAST { bound * size2.reciprocal_root() } else { over_root(bound, size2) };
    let scaled = trial * scale;
    (scaled.select(slides, trial), slides)
}

/// `x` over the root of `square`, if that is positive.
#[inline(always)]
fn over_root<V: Numbers>(x: V, square: V) -> V {
    if V::FAST {
        x * square.max(V::splat(f64::MIN_POSITIVE)).reciprocal_root()
    } else if V::FUSED {
        // Neither waits for the other.
        x / square * square.sqrt()
    } else {
        x / square.sqrt()
    }
}

/// Simplified JKR.
#[inline(always)]
fn pull<V: Numbers>(m: &Motion<V>, energy_density: V) -> V {
    let (one, two, d) = (V::splat(1.0), V::splat(2.0), m.overlap.max(V::splat(0.0)));
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

/// Torque along `spin`, of that size: negative where it goes against it.
#[inline(always)]
fn along<V: Numbers>(spin: V3<V>, limit: V) -> V3<V> {
    let speed2 = spin.dot(spin);
    if V::FAST {
        spin * over_root(limit, speed2)
    } else if V::FUSED {
        spin * over_root(limit, speed2.max(V::splat(LEAST)))
    } else {
        spin * (limit / speed2.sqrt().max(V::splat(f64::MIN_POSITIVE)))
    }
}

/// Hertz without dashpots.
#[derive(Clone, Copy)]
pub(super) struct Squeezed<V> {
    /// Radius of the contact.
    pub(super) a: V,
    /// Root of effective mass times that radius, where it comes with it.
    pub(super) inertia: Option<V>,
    pub(super) elastic: V,
}

/// Hertz, without dashpots, by an overlap that is not negative, effective radius and effective mass.
#[inline(always)]
pub(super) fn squeeze<V: Numbers, const ALIKE: bool>(
    delta: V,
    [r_star, m_star]: [V; 2],
    laws: &Laws<V>,
) -> Squeezed<V> {
    let (a, inertia) = if V::FAST && ALIKE {
        let [a, own] = (r_star * delta).both_roots();
        (a, Some(own * m_star.root()))
    } else {
        ((r_star * delta).root(), None)
    };
    let elastic = if V::FUSED {
        laws.hertz * delta * a
    } else {
        let stiffness = V::splat(2.0) * laws.e_star * a;
        V::splat(2.0 / 3.0) * stiffness * delta
    };
    Squeezed { a, inertia, elastic }
}

/// Both dashpots, which go with the root of mass times contact radius.
#[inline(always)]
pub(super) fn damp<V: Numbers>(
    s: &Squeezed<V>,
    [rate, m_star]: [V; 2],
    laws: &Laws<V>,
) -> Pressed<V> {
    let inertia = match s.inertia {
        Some(inertia) => inertia,
        None => (m_star * s.a).root(),
    };
    let (viscosity, dashpot) = if V::FUSED {
        (laws.viscous * inertia, laws.dashpot * inertia)
    } else {
        let viscosity = laws.normal_damping * (inertia * laws.normal_root);
        (viscosity, laws.shear_damping * (inertia * laws.shear_root))
    };
    Pressed {
        force: viscosity.times_plus(rate, s.elastic).max(laws.least_force),
        stiffness: V::splat(8.0) * laws.g_star * s.a,
        dashpot,
    }
}

/// Hertz, and both dashpots.
#[inline(always)]
pub(super) fn press<V: Numbers, const ALIKE: bool>(p: &Pressing<V>, laws: &Laws<V>) -> Pressed<V> {
    let delta = p.overlap.max(V::splat(if V::FAST { LEAST_OVERLAP } else { 0.0 }));
    damp(&squeeze::<V, ALIKE>(delta, [p.r_star, p.m_star], laws), [p.rate, p.m_star], laws)
}

/// Mindlin's spring, if nothing slid: `carried` over from before, as `before` tells.
#[inline(always)]
pub(super) fn would_be<V: Numbers>(
    [normal, slip]: [V3<V>; 2],
    twist: V,
    dt: V,
    pressed: &Pressed<V>,
    (old, before): (&Remembered<V>, &Before<V>),
    form: Form,
    touching: V::Mask,
) -> V3<V> {
    let k = pressed.stiffness;
    let most = if form.total_spring { f64::MAX } else { 1.0 };
    let carried = before.carried(old, normal, twist, k, most, touching);
    if V::FUSED { carried.less_times(slip, k * dt) } else { carried.less_times(slip * dt, k) }
}

/// Springs as friction holds them: `trial` is the spring if nothing slid, `old` the stiffness that is remembered.
#[inline(always)]
pub(super) fn hold<V: Numbers>(
    laws: &Laws<V>,
    features: Features,
    pressed: &Pressed<V>,
    trial: V3<V>,
    old: V,
    touching: V::Mask,
) -> Held<V> {
    let (zero, k) = (V::splat(0.0), pressed.stiffness);
    let load = pressed.force.max(zero);
    let sticking = laws.friction * load;
    let (threshold, bound) = if features.stick_slip {
        let sliding = laws.kinetic * load;
        (sliding.select(old.less(zero), sticking), sliding)
    } else {
        (sticking, sticking)
    };
    let (spring, sliding) = limit(trial, threshold, bound, touching, false);
    let sticks = touching & !sliding;
    Held { spring, stiffness: (-k).select(sliding, k), load, bound: sticking, sticks }
}

/// Friction with its dashpot, rolling and what follows, of spheres that are `ALIKE` or of any two.
#[inline(always)]
pub(super) fn answer<V: Numbers, const ALIKE: bool>(
    m: &Motion<V>,
    laws: &Laws<V>,
    features: Features,
    pressed: &Pressed<V>,
    held: &Held<V>,
) -> Out<V> {
    let (zero, n) = (V::splat(0.0), m.normal);
    let Pressed { force: normal, dashpot, .. } = *pressed;
    let Held { spring, load, bound: sticking, sticks, .. } = *held;
    // No dashpot changes nothing but the sign of zero.
    let (damped, sticks_damped) = if V::FUSED && !V::FAST {
        (spring.less_times(m.slip, dashpot.only(sticks)), sticks)
    } else {
        let damped = if V::FAST { sticks } else { sticks & zero.less(dashpot) };
        (spring.less_times(m.slip, dashpot).select(damped, spring), damped)
    };
    // Sliding contacts are at the limit already and have no dashpot: few are left here.
    let (shear, _) = limit(damped, sticking, sticking, sticks_damped, true);
    let moment = n.cross(shear);
    // Rolling.
    let (torque_i, torque_j) = if features.form.absolute_spin {
        let limit_i = laws.arm_ratio.times_plus(m.lever_i, laws.arm_length) * load;
        let limit_j = laws.arm_ratio.times_plus(m.lever_j, laws.arm_length) * load;
        let roll_i = along(m.spin_i, -limit_i);
        let roll_j = along(m.spin_j, -limit_j);
        (moment.times_plus(m.lever_i, roll_i), moment.times_plus(m.lever_j, roll_j))
    } else {
        let arm = laws.arm_ratio.times_plus(m.r_star, laws.arm_length);
        let roll = along(m.rolling, -arm * load);
        (moment.times_plus(m.lever_i, roll), moment.times_less(m.lever_j, roll))
    };
    let repulsion = if features.cohesive { normal - pull(m, laws.energy_density) } else { normal };
    Out { force: shear.less_times(n, repulsion), torque_i, torque_j }
}

/// The laws in one go.
#[inline(always)]
pub(super) fn respond<V: Numbers, const ALIKE: bool>(
    (m, pressing): (&Motion<V>, &Pressing<V>),
    [twist, dt]: [V; 2],
    laws: &Laws<V>,
    features: Features,
    (old, before): (&Remembered<V>, &Before<V>),
    touching: V::Mask,
) -> (Held<V>, Out<V>) {
    let pressed = press::<V, ALIKE>(pressing, laws);
    let motion = [m.normal, m.slip];
    let trial = would_be(motion, twist, dt, &pressed, (old, before), features.form, touching);
    let held = hold(laws, features, &pressed, trial, old.stiffness, touching);
    let out = answer::<V, ALIKE>(m, laws, features, &pressed, &held);
    (held, out)
}
