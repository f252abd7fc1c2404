//! JKR and DMT: pull-off and the curve in closed form; an impact that pays for the neck.
//!
//! Convention: work of adhesion `w`; the pull-off force of JKR is `1.5 pi w R*`, of DMT `2 pi w R*`.

use dem_core::contact::cohesion::Cohesionless;
use dem_core::contact::kinematics::{Kinematics, PairGeometry};
use dem_core::contact::law::NormalLaw;
use dem_core::contact::model::ContactModel;
use dem_core::contact::normal::jkr::Bond;
use dem_core::contact::normal::{Dmt, Jkr};
use dem_core::contact::rolling::FreeRolling;
use dem_core::contact::tangential::Frictionless;
use dem_core::glam::DVec3;
use dem_core::impact::{Body, ImpactError, Partner, Settings, collide};

use crate::{Check, Held};

const CURVE: Held = Held {
    tolerance: 1e-6,
    reason: "relative; the law evaluates the curve to rounding, extremes are sampled",
    source: "Johnson, Kendall and Roberts 1971, doi:10.1098/rspa.1971.0141",
};
const TEAR: Held = Held {
    tolerance: 1e-4,
    reason: "relative; the slope is infinite at the tear, so rounding is felt as its root",
    source: CURVE.source,
};
const IMPACT: Held = Held {
    tolerance: 1e-3,
    reason: "relative; the tear is met within one of some 5000 steps",
    source: "energy balance: what remains is what came less the hysteresis of the curve",
};

const W: f64 = 0.05;
const E_STAR: f64 = 1e8;
pub(crate) const R: f64 = 1e-4;

pub(crate) fn at(overlap: f64) -> Kinematics {
    Kinematics {
        normal_i_to_j: DVec3::X,
        overlap,
        overlap_rate: 0.0,
        slip_velocity: DVec3::ZERO,
        spin_i: DVec3::ZERO,
        spin_j: DVec3::ZERO,
        lever_i: R,
        lever_j: 0.0,
        dt: 1.0,
    }
}

/// The laws of this group, undamped.
pub(crate) fn laws() -> (Jkr, Dmt) {
    (
        Jkr { e_star: E_STAR, work_of_adhesion: W, damping: 0.0 },
        Dmt { e_star: E_STAR, work_of_adhesion: W, damping: 0.0 },
    )
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    use std::f64::consts::PI;
    let (law, dmt) = laws();
    let pair = PairGeometry { r_star: R, m_star: 1e-8, radius_i: R, radius_j: f64::INFINITY };
    let force = |overlap: f64| law.respond(&pair, &at(overlap), &mut Bond { formed: true });
    let case = "JKR, sphere of 0.1 mm on a plane";
    let pull = 1.5 * PI * W * R;
    // independent closed forms of the tear: a^3 = pi w R^2/(8 E*), delta = a^2/R - sqrt(2 pi w a/E*)
    let a_tear = (PI * W * R * R / (8.0 * E_STAR)).cbrt();
    let tear = a_tear * a_tear / R - (2.0 * PI * W * a_tear / E_STAR).sqrt();
    let n = 200_000;
    let least = (0..n)
        .map(|k| force(tear * f64::from(k) / f64::from(n)).force)
        .fold(f64::INFINITY, f64::min);
    let mut checks = vec![
        CURVE.relative(case, "pull-off force 1.5 pi w R*, N", pull, -least),
        CURVE.relative(
            case,
            "force at first touch, -8/9 pull-off, N",
            -8.0 / 9.0 * pull,
            force(0.0).force,
        ),
        TEAR.relative(
            case,
            "force at the tear, -5/9 pull-off, N",
            -5.0 / 9.0 * pull,
            force(tear * (1.0 - 1e-12)).force,
        ),
        CURVE.relative(case, "overlap of the tear, m", tear, -law.reach(&pair)),
    ];
    // the curve by its parameter a
    for share in [1.2, 1.5, 2.0, 3.0, 5.0] {
        let a: f64 = share * a_tear;
        let delta = a * a / R - (2.0 * PI * W * a / E_STAR).sqrt();
        let f = 4.0 * E_STAR * a.powi(3) / (3.0 * R) - (8.0 * PI * W * E_STAR * a.powi(3)).sqrt();
        let r = force(delta);
        checks.push(CURVE.of_scale(case, format!("force at {share} a_tear, N"), f, r.force, pull));
        checks.push(CURVE.relative(
            case,
            format!("contact radius at {share} a_tear, m"),
            a,
            r.contact_radius,
        ));
    }
    checks.push(
        Held {
            source: "Derjaguin, Muller and Toporov 1975, doi:10.1016/0021-9797(75)90018-1",
            ..CURVE
        }
        .relative(
            "DMT, the same sphere",
            "pull-off force 2 pi w R*, N",
            2.0 * PI * W * R,
            -dmt.respond(&pair, &at(0.0), &mut ()).force,
        ),
    );
    checks.extend(impacts(law));
    checks
}

fn impacts(law: Jkr) -> Vec<Check> {
    let model = ContactModel {
        normal: law,
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    };
    let body = Body::solid_sphere(R, 2500.0);
    let lost = law.hysteresis(R);
    let sticking = (2.0 * lost / body.mass).sqrt();
    let mut checks = Vec::new();
    for over in [1.1, 1.5, 3.0] {
        let speed = over * sticking;
        let hit = collide(
            model,
            body.with_velocity(DVec3::X * speed),
            Partner::Plane,
            Settings::new(2e-9),
        );
        let want = (1.0 - 1.0 / (over * over)).sqrt();
        checks.push(IMPACT.absolute(
            format!("JKR impact at {over} sticking speeds"),
            "restitution sqrt(1 - (v_s/v)^2)",
            want,
            hit.map_or(f64::NAN, |h| h.restitution),
        ));
    }
    let settings = Settings { max_steps: 200_000, ..Settings::new(2e-9) };
    let slow =
        collide(model, body.with_velocity(DVec3::X * (0.9 * sticking)), Partner::Plane, settings);
    checks.push(IMPACT.fact(
        "JKR impact at 0.9 sticking speeds",
        "the sphere sticks",
        true,
        matches!(slow, Err(ImpactError::NoSeparation { .. })),
    ));
    checks
}
