//! Elastic normal impact under Hertz: peak force, peak overlap and duration (Chung and Ooi 1, 2).

use dem_core::contact::normal::hertz::ElasticImpact;
use dem_core::glam::DVec3;
use dem_core::impact::{Body, Partner, Settings, collide};

use crate::laws::{ALUMINIUM, GLASS, LIMESTONE, MAGNESIUM, Material, smooth};
use crate::{Check, Held};

const SOURCE: &str = "Chung and Ooi 2011, doi:10.1007/s10035-011-0277-0, tests 1 and 2";
const PUBLISHED: Held =
    Held { tolerance: 1e-3, reason: "relative; numbers printed to four digits", source: SOURCE };
const CLOSED: Held = Held {
    tolerance: 2e-3,
    reason: "relative; 2000 steps a contact: the duration is known to one step in 2000",
    source: "Hertz's elastic impact in closed form",
};

/// Material, sphere on sphere, radius (m), speed (m/s), force (N), overlap (m), duration (s).
const ROWS: [(Material, bool, f64, f64, f64, f64, f64); 4] = [
    (GLASS, true, 0.01, 10.0, 10_697.0, 274.1e-6, 40.34e-6),
    (LIMESTONE, true, 0.01, 10.0, 7108.2, 368.3e-6, 54.20e-6),
    (ALUMINIUM, false, 0.1, 0.2, 11_370.0, 49.72e-6, 731.6e-6),
    (MAGNESIUM, false, 0.1, 0.2, 7232.7, 52.12e-6, 767.0e-6),
];

/// All checks of this group.
pub fn cases() -> Vec<Check> {
    let mut checks = Vec::new();
    for (m, pair, radius, speed, force, overlap, duration) in ROWS {
        let body = Body::solid_sphere(radius, m.rho).with_velocity(DVec3::X * speed);
        let (e_star, r_star, m_star, approach, partner) = if pair {
            let other = body.with_velocity(DVec3::X * -speed);
            let e_star = m.on_itself().e_star;
            (e_star, 0.5 * radius, 0.5 * body.mass, 2.0 * speed, Partner::Sphere(other))
        } else {
            (m.on_rigid().e_star, radius, body.mass, speed, Partner::Plane)
        };
        let number = if pair { 1 } else { 2 };
        let case = format!("Chung-Ooi {number}, {}", m.name);
        let closed = ElasticImpact::new(e_star, r_star, m_star, approach);
        checks.push(PUBLISHED.relative(&case, "closed peak force, N", force, closed.peak_force));
        checks.push(PUBLISHED.relative(
            &case,
            "closed peak overlap, m",
            overlap,
            closed.peak_overlap,
        ));
        checks.push(PUBLISHED.relative(&case, "closed duration, s", duration, closed.duration));
        let settings = Settings::new(closed.duration / 2000.0);
        let Ok(hit) = collide(smooth::<true>(e_star, 1.0), body, partner, settings) else {
            checks.push(CLOSED.fact(&case, "the bodies part", true, false));
            continue;
        };
        checks.push(CLOSED.relative(&case, "peak force, N", closed.peak_force, hit.peak_force));
        checks.push(CLOSED.relative(
            &case,
            "peak overlap, m",
            closed.peak_overlap,
            hit.peak_overlap,
        ));
        checks.push(CLOSED.relative(&case, "duration, s", closed.duration, hit.duration));
        checks.push(CLOSED.relative(&case, "restitution", 1.0, hit.restitution));
    }
    checks
}
