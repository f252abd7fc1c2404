//! A sphere on a plane: slip that ends in rolling (MFIX DEM04), an incline, rolling decay, and Zhu's
//! three facts as a table over all rolling laws.

use dem_core::contact::cohesion::Cohesionless;
use dem_core::contact::law::RollingLaw;
use dem_core::contact::model::ContactModel;
use dem_core::contact::normal::{LinearSpringDashpotSpec, LinearTailCut};
use dem_core::contact::rolling::{
    AbsoluteSpin, ConstantTorque, FreeRolling, RollingArm, RollingSpringDashpot, Torsion,
    ViscousCapped, WithTorsion, Zhu, zhu,
};
use dem_core::contact::tangential::LinearSpring;
use dem_core::glam::DVec3;
use dem_core::impact::{Body, Partner, Settings, TwoBody};

use crate::laws::coulomb;
use crate::{Check, Held};

pub(crate) type Model<R> = ContactModel<LinearTailCut, LinearSpring, R, Cohesionless>;

/// A sphere of radius `r` (m) at rest on the plane, at the overlap that bears its weight.
pub(crate) fn resting<R: RollingLaw>(
    rolling: R,
    body: Body,
    k: f64,
    mu: f64,
    gravity: DVec3,
    dt: f64,
) -> TwoBody<Model<R>> {
    let spec = LinearSpringDashpotSpec { stiffness: k, restitution: 0.5 };
    let model = ContactModel {
        normal: LinearTailCut::try_from(spec).expect("a stiffness above 0, a restitution of 0.5"),
        tangential: LinearSpring { stiffness: k, friction: coulomb(mu), damping_ratio: 0.3 },
        rolling,
        cohesion: Cohesionless,
    };
    let overlap = body.mass * gravity.x / k;
    TwoBody::new(model, body, Partner::Plane, -overlap, Settings::new(dt)).in_gravity(gravity)
}

fn rough_plane(checks: &mut Vec<Check>) {
    const HELD: Held = Held {
        tolerance: 5e-3,
        reason: "relative; the spring is wound up and let go within 0.5 % of the slip",
        source: "t = 2 u0/(7 mu g), u = R omega = 5/7 u0 (MFIX DEM04)",
    };
    let (u0, g) = (0.1, 9.81);
    for mu in [0.2, 0.4, 0.6, 0.8, 1.0] {
        let body = Body::solid_sphere(0.5e-3, 1e4).with_velocity(DVec3::Y * u0);
        let mut ball = resting(FreeRolling, body, 1e5, mu, DVec3::X * g, 1e-7);
        let end = 2.0 * u0 / (7.0 * mu * g);
        let mut last_slip = 0.0;
        while ball.time < 1.5 * end {
            ball.step();
            if ball.response.tangential.sliding {
                last_slip = ball.time;
            }
        }
        let case = format!("MFIX DEM04, ball slipping on a rough plane, mu = {mu}");
        checks.push(HELD.relative(&case, "end of slip, s", end, last_slip));
        checks.push(HELD.relative(&case, "velocity, m/s", 5.0 / 7.0 * u0, ball.i.velocity.y));
        checks.push(HELD.relative(
            &case,
            "R omega, m/s",
            5.0 / 7.0 * u0,
            -ball.i.spin.z * body.radius,
        ));
    }
}

fn incline(checks: &mut Vec<Check>) {
    const HELD: Held = Held {
        tolerance: 5e-3,
        reason: "relative; the overlap shortens the lever of rolling by 1e-4 of the radius",
        source: "pure rolling: v = 5/7 g sin(15 deg) t",
    };
    let (sin, cos) = 15f64.to_radians().sin_cos();
    let body = Body::solid_sphere(5e-3, 2500.0);
    let gravity = DVec3::new(cos, sin, 0.0) * 9.8;
    let mut ball = resting(FreeRolling, body, 1e5, 0.5, gravity, 5e-6);
    while ball.time < 1.0 {
        ball.step();
    }
    let case = "incline of 15 deg, mu = 0.5";
    let want = 5.0 / 7.0 * 9.8 * sin * ball.time;
    checks.push(HELD.relative(case, "velocity after 1 s, m/s", want, ball.i.velocity.y));
    checks.push(HELD.relative(case, "R omega after 1 s, m/s", want, -ball.i.spin.z * body.radius));
}

const RATIO: f64 = 0.05;
pub(crate) const ARM: RollingArm = RollingArm { length: 0.0, ratio: RATIO };
pub(crate) const VISCOUS: ViscousCapped =
    ViscousCapped { arm: ARM, viscosity: 1e-6, viscosity_per_load: 0.0 };

pub(crate) fn marble() -> Body {
    Body::solid_sphere(5e-3, 2500.0)
}

pub(crate) fn on_level<R: RollingLaw>(rolling: R, velocity: f64, spin: f64) -> TwoBody<Model<R>> {
    let body = marble().with_velocity(DVec3::Y * velocity).with_spin(DVec3::Z * -spin);
    resting(rolling, body, 1e4, 0.5, DVec3::X * 9.81, 2e-5)
}

fn decay(checks: &mut Vec<Check>) {
    const HELD: Held = Held {
        tolerance: 5e-3,
        reason: "relative; the contact spring rings once the torque sets in, then decays",
        source: "pure rolling under a torque M: v' = -M R/(I + m R^2)",
    };
    fn deceleration<R: RollingLaw>(rolling: R) -> f64 {
        let v = 0.3;
        let mut ball = on_level(rolling, v, v / marble().radius);
        while ball.time < 0.1 {
            ball.step();
        }
        let before = (ball.time, ball.i.velocity.y);
        while ball.time < 0.4 {
            ball.step();
        }
        (before.1 - ball.i.velocity.y) / (ball.time - before.0)
    }
    let want = 5.0 / 7.0 * RATIO * 9.81;
    let case = "rolling decay at 60 rad/s, mu_r = 0.05";
    let quantity = |name: &str| format!("{name}, m/s^2");
    let constant = deceleration(ConstantTorque { arm: ARM });
    checks.push(HELD.relative(case, quantity("constant torque A, 5/7 mu_r g"), want, constant));
    let spring = deceleration(spring_dashpot());
    checks.push(HELD.relative(case, quantity("spring-dashpot at its limit"), want, spring));
    let capped = deceleration(VISCOUS);
    checks.push(HELD.relative(case, quantity("viscous at its cap"), want, capped));
    let scaled = deceleration(Zhu { torque: VISCOUS, inertia_share: zhu::SOLID_SPHERE_SHARE });
    checks.push(HELD.relative(case, quantity("Zhu, 2/7 of that"), 2.0 / 7.0 * want, scaled));
    let absolute = deceleration(AbsoluteSpin { arm: ARM });
    checks.push(HELD.relative(case, quantity("absolute spin (as A on a plane)"), want, absolute));
    checks.push(HELD.absolute(case, quantity("free rolling"), 0.0, deceleration(FreeRolling)));
}

pub(crate) fn spring_dashpot() -> RollingSpringDashpot {
    RollingSpringDashpot { arm: ARM, stiffness: 0.0, stiffness_ratio: 2.25, damping_ratio: 0.3 }
}

/// Which of Zhu's facts a rolling law obeys: equilibrium, coming to rest, rolling without slip
/// under a resistance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Facts {
    /// A sphere at rest without load along the plane stays at rest.
    pub equilibrium: bool,
    /// A slow sphere comes to rest.
    pub comes_to_rest: bool,
    /// A sphere in pure rolling keeps rolling without slip while it is slowed down.
    pub pure_rolling: bool,
}

/// Find Zhu's facts of one law by running them.
pub fn facts<R: RollingLaw>(rolling: R) -> Facts {
    let mut still = on_level(rolling, 0.0, 0.0);
    for _ in 0..5000 {
        still.step();
    }
    let equilibrium = still.i.velocity.y == 0.0 && still.i.spin == DVec3::ZERO;

    let v = 0.02;
    let mut slow = on_level(rolling, v, 0.0);
    let at_start = slow.i.kinetic_energy();
    for _ in 0..150_000 {
        slow.step();
    }
    // Less than 1e-4 of the energy after 3 s; the chatter of a dry torque is 1e-6 here.
    let comes_to_rest = slow.i.kinetic_energy() < 1e-4 * at_start;

    let v = 0.1;
    let mut rolling_on = on_level(rolling, v, v / marble().radius);
    let mut slip = 0f64;
    while rolling_on.time < 0.1 {
        rolling_on.step();
        if rolling_on.time > 0.05 {
            slip = slip.max(rolling_on.slip_velocity.length());
        }
    }
    // Once the first ringing is over: slip below 1e-3 of the speed, speed lower by 1 % at least.
    let now = rolling_on.i.velocity.y;
    let pure_rolling = slip < 1e-3 * now && now < 0.99 * v;
    Facts { equilibrium, comes_to_rest, pure_rolling }
}

fn zhu_table(checks: &mut Vec<Check>) {
    const HELD: Held = Held {
        tolerance: 0.0,
        reason: "a fact holds or does not",
        source: "Zhu's three facts about a sphere on a plane, thesis appendix 7.2",
    };
    let all = Facts { equilibrium: true, comes_to_rest: true, pure_rolling: true };
    let torsion = Torsion { g_series: 1e7, friction: 0.5 };
    let zhu_law = Zhu { torque: VISCOUS, inertia_share: zhu::SOLID_SPHERE_SHARE };
    let rows = [
        ("none", Facts { comes_to_rest: false, pure_rolling: false, ..all }, facts(FreeRolling)),
        ("constant torque A", all, facts(ConstantTorque { arm: ARM })),
        ("viscous capped", all, facts(VISCOUS)),
        ("spring-dashpot", all, facts(spring_dashpot())),
        (
            "spring-dashpot with torsion",
            all,
            facts(WithTorsion { rolling: spring_dashpot(), torsion }),
        ),
        ("Zhu", all, facts(zhu_law)),
        ("absolute spin (compatibility)", all, facts(AbsoluteSpin { arm: ARM })),
    ];
    for (law, want, found) in rows {
        let case = format!("Zhu's facts, rolling law: {law}");
        checks.push(HELD.fact(
            &case,
            "1: rest is an equilibrium",
            want.equilibrium,
            found.equilibrium,
        ));
        checks.push(HELD.fact(
            &case,
            "2: a slow sphere comes to rest",
            want.comes_to_rest,
            found.comes_to_rest,
        ));
        checks.push(HELD.fact(
            &case,
            "3: rolls without slip under a resistance",
            want.pure_rolling,
            found.pure_rolling,
        ));
    }
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    let mut checks = Vec::new();
    rough_plane(&mut checks);
    incline(&mut checks);
    decay(&mut checks);
    zhu_table(&mut checks);
    checks
}
