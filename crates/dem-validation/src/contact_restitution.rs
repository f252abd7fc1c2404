//! Restitution against what was asked: every law that takes it (Chung and Ooi 3), both tails, and
//! what few steps a contact make of it.

use dem_core::contact::cohesion::Cohesionless;
use dem_core::contact::law::NormalLaw;
use dem_core::contact::model::ContactModel;
use dem_core::contact::normal::hertz::ElasticImpact;
use dem_core::contact::normal::{
    LinearSpringDashpotSpec, LinearTailCut, LinearTailKept, WaltonBraun, WaltonBraunSpec,
    YieldStiffness,
};
use dem_core::contact::rolling::FreeRolling;
use dem_core::contact::tangential::Frictionless;
use dem_core::glam::DVec3;
use dem_core::impact::{Body, Partner, RateAt, Settings, collide};

use crate::laws::{ALUMINA, CAST_IRON, smooth};
use crate::{Check, Held};

const ASKED: Held = Held {
    tolerance: 1e-3,
    reason: "relative; 0.1 % asked of every dissipative law at 5000 steps a contact",
    source: "the law's own input; Chung and Ooi 2011, test 3",
};

const E: [f64; 10] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];

fn plain<N: NormalLaw>(normal: N) -> ContactModel<N, Frictionless, FreeRolling, Cohesionless> {
    ContactModel { normal, tangential: Frictionless, rolling: FreeRolling, cohesion: Cohesionless }
}

fn rebound<N: NormalLaw>(normal: N, body: Body, dt: f64) -> f64 {
    collide(plain(normal), body, Partner::Plane, Settings::new(dt))
        .map_or(f64::NAN, |hit| hit.restitution)
}

/// Restitution that Al2O3 finds on a rigid plane at 3.9 m/s when `asked` is asked (test 3).
pub(crate) fn hertz_rebound<const CUT: bool>(asked: f64) -> f64 {
    let body = Body::solid_sphere(2.5e-3, ALUMINA.rho).with_velocity(DVec3::X * 3.9);
    let e_star = ALUMINA.on_rigid().e_star;
    let dt = ElasticImpact::new(e_star, body.radius, body.mass, 3.9).duration / 2000.0;
    rebound(smooth::<CUT>(e_star, asked).normal, body, dt)
}

/// Mean restitution over where in a step the bodies touch, at `steps` steps an elastic contact.
pub fn restitution_at_steps(asked: f64, steps: f64, rate: RateAt, cut_tail: bool) -> f64 {
    let body = Body::solid_sphere(3e-3, 2500.0).with_velocity(DVec3::X);
    let e_star = 1e9;
    let duration = ElasticImpact::new(e_star, body.radius, body.mass, 1.0).duration;
    let phases = 50;
    let sum: f64 = (0..phases)
        .map(|k| {
            let phase = (f64::from(k) + 0.5) / f64::from(phases);
            let settings = Settings { phase, rate, ..Settings::new(duration / steps) };
            let hit = if cut_tail {
                collide(smooth::<true>(e_star, asked), body, Partner::Plane, settings)
            } else {
                collide(smooth::<false>(e_star, asked), body, Partner::Plane, settings)
            };
            hit.map_or(f64::NAN, |h| h.restitution)
        })
        .sum();
    sum / f64::from(phases)
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    let mut checks = Vec::new();
    for m in [ALUMINA, CAST_IRON] {
        let body = Body::solid_sphere(2.5e-3, m.rho).with_velocity(DVec3::X * 3.9);
        let e_star = m.on_rigid().e_star;
        let dt = ElasticImpact::new(e_star, body.radius, body.mass, 3.9).duration / 5000.0;
        for e in E {
            let case = format!("Chung-Ooi 3, {}, Hertz, e = {e}", m.name);
            let cut = rebound(smooth::<true>(e_star, e).normal, body, dt);
            checks.push(ASKED.relative(&case, "restitution, tail cut", e, cut));
            let kept = rebound(smooth::<false>(e_star, e).normal, body, dt);
            checks.push(ASKED.relative(&case, "restitution, tail kept", e, kept));
        }
    }
    let body = Body::solid_sphere(3e-3, 2500.0).with_velocity(DVec3::X * 0.5);
    let k = 1e5;
    let dt = std::f64::consts::PI * (body.mass / k).sqrt() / 5000.0;
    for e in E {
        let spec = LinearSpringDashpotSpec { stiffness: k, restitution: e };
        let case = format!("linear spring-dashpot, e = {e}");
        let cut = LinearTailCut::try_from(spec).map_or(f64::NAN, |law| rebound(law, body, dt));
        checks.push(ASKED.relative(&case, "restitution, tail cut", e, cut));
        let kept = LinearTailKept::try_from(spec).map_or(f64::NAN, |law| rebound(law, body, dt));
        checks.push(ASKED.relative(&case, "restitution, tail kept", e, kept));
        let spec = WaltonBraunSpec { loading: YieldStiffness::Fixed(k), restitution: e };
        // the unloading line is 1/e^2 stiffer, and its step shorter by e
        let hysteretic =
            WaltonBraun::try_from(spec).map_or(f64::NAN, |law| rebound(law, body, dt * e));
        checks.push(ASKED.relative(format!("Walton-Braun, e = {e}"), "restitution", e, hysteretic));
    }
    checks.extend(few_steps());
    checks
}

/// Restitution against steps a contact, by where in the step the laws see the overlap rate.
fn few_steps() -> Vec<Check> {
    const SOURCE: &str = "the law's own input";
    let mut checks = Vec::new();
    for steps in [5.0, 10.0, 20.0, 50.0] {
        let second_order = Held {
            tolerance: 2.0 / (steps * steps),
            reason: "absolute; mean over 50 places of first touch, second order: 2/n^2 at n steps",
            source: SOURCE,
        };
        let first_order = Held {
            tolerance: 0.11 / steps,
            reason: "absolute; mean over 50 places of first touch, first order: 0.11/n at n steps",
            source: SOURCE,
        };
        for e in [0.5, 0.7, 0.9, 1.0] {
            for (name, cut) in [("cut", true), ("kept", false)] {
                let case = format!("Hertz, {steps} steps a contact, e = {e}, tail {name}");
                let end = restitution_at_steps(e, steps, RateAt::End, cut);
                checks.push(second_order.absolute(&case, "restitution, rate at the end", e, end));
                let middle = restitution_at_steps(e, steps, RateAt::Middle, cut);
                checks.push(first_order.absolute(
                    &case,
                    "restitution, rate at the middle",
                    e,
                    middle,
                ));
            }
        }
    }
    let lag = Held {
        tolerance: 0.015,
        reason: "absolute; quoted to two digits for 4 to 7 steps a contact, here at 5",
        source: "what a damping one step late makes of 0.90 (the thesis's step of 7e-5 s)",
    };
    let late = restitution_at_steps(0.9, 5.0, RateAt::Start, false);
    checks.push(lag.absolute(
        "Hertz, 5 steps a contact, e = 0.9, tail kept",
        "restitution, rate one step late",
        0.93,
        late,
    ));
    checks
}
