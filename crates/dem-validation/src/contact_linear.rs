//! Linear spring-dashpot against its closed solution, damped, critical and overdamped, both tails.

use dem_core::contact::cohesion::Cohesionless;
use dem_core::contact::model::ContactModel;
use dem_core::contact::normal::{AttractiveTail, LinearImpact, LinearSpringDashpot};
use dem_core::contact::rolling::FreeRolling;
use dem_core::contact::tangential::Frictionless;
use dem_core::glam::DVec3;
use dem_core::impact::{Body, Partner, Settings, TwoBody, collide};

use crate::{Check, Held};

const CLOSED: Held = Held {
    tolerance: 1e-3,
    reason: "relative (forces: to the peak); 20000 steps in half an undamped period",
    source: "Schwager and Poeschel 2007, doi:10.1007/s10035-007-0065-z; thesis 7.1 corrected",
};

fn compare<const CUT: bool>(zeta: f64, checks: &mut Vec<Check>) {
    let (k, speed) = (1e5, 0.7);
    let body = Body::solid_sphere(3e-3, 2500.0).with_velocity(DVec3::X * speed);
    let tail = if CUT { AttractiveTail::Cut } else { AttractiveTail::Kept };
    let damping = 2.0 * zeta * (k * body.mass).sqrt();
    let Ok(closed) = LinearImpact::new(k, damping, body.mass, speed, tail) else { return };
    let model = ContactModel {
        normal: LinearSpringDashpot::<CUT> { stiffness: k, damping_ratio: zeta },
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    };
    let dt = std::f64::consts::PI * (body.mass / k).sqrt() / 20_000.0;
    let case = format!("linear impact, zeta = {zeta}, tail {}", if CUT { "cut" } else { "kept" });
    let settings = Settings::new(dt);
    let Ok(hit) = collide(model, body, Partner::Plane, settings) else {
        checks.push(CLOSED.fact(&case, "the bodies part", true, false));
        return;
    };
    checks.push(CLOSED.relative(&case, "restitution", closed.restitution(), hit.restitution));
    checks.push(CLOSED.relative(&case, "duration, s", closed.duration(), hit.duration));
    checks.push(CLOSED.relative(&case, "peak overlap, m", closed.peak_overlap(), hit.peak_overlap));
    checks.push(CLOSED.relative(&case, "peak force, N", closed.peak_force(), hit.peak_force));
    let mut pair = TwoBody::new(model, body, Partner::Plane, 0.0, settings);
    for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let t = share * closed.duration();
        while pair.time < t {
            pair.step();
        }
        checks.push(CLOSED.of_scale(
            &case,
            format!("force at {share} of the duration, N"),
            closed.force(pair.time),
            pair.response.normal.force,
            closed.peak_force(),
        ));
    }
}

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    let mut checks = Vec::new();
    for zeta in [0.0, 0.2, 0.5, 0.7, 0.8, 0.95, 1.0, 1.05, 1.5, 3.0] {
        compare::<true>(zeta, &mut checks);
        if zeta < 0.9 {
            compare::<false>(zeta, &mut checks);
        }
    }
    checks
}
