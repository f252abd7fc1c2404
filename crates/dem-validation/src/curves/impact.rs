//! Normal impacts: force histories, restitution, the curve of JKR.

use dem_core::contact::cohesion::Cohesionless;
use dem_core::contact::kinematics::PairGeometry;
use dem_core::contact::law::NormalLaw;
use dem_core::contact::model::ContactModel;
use dem_core::contact::normal::hertz::ElasticImpact;
use dem_core::contact::normal::jkr::Bond;
use dem_core::contact::normal::restitution::{AttractiveTail, damping_ratio, restitution_of};
use dem_core::contact::normal::{LinearImpact, LinearTailCut, LinearTailKept};
use dem_core::contact::rolling::FreeRolling;
use dem_core::contact::tangential::Frictionless;
use dem_core::glam::DVec3;
use dem_core::impact::{Body, Partner, RateAt, Settings, TwoBody};

use super::{Axis, Curve, Plot, spread};
use crate::contact_jkr;
use crate::contact_restitution::{hertz_rebound, restitution_at_steps};
use crate::laws::{GLASS, smooth};

pub(super) fn plots() -> Vec<Plot> {
    vec![hertz(), restitution_in_out(), restitution_steps(), linear(), jkr()]
}

fn hertz() -> Plot {
    let body = Body::solid_sphere(0.01, GLASS.rho).with_velocity(DVec3::X * 10.0);
    let other = body.with_velocity(DVec3::X * -10.0);
    let e_star = GLASS.on_itself().e_star;
    let closed = ElasticImpact::new(e_star, 0.005, 0.5 * body.mass, 20.0);
    let law = smooth::<true>(e_star, 1.0);
    let settings = Settings::new(closed.duration / 2000.0);
    let mut pair = TwoBody::new(law, body, Partner::Sphere(other), 0.0, settings);
    let mut ours = Vec::new();
    while pair.time < closed.duration {
        for _ in 0..40 {
            pair.step();
        }
        ours.push((pair.overlap * 1e6, pair.response.normal.force * 1e-3));
    }
    ours.retain(|p| p.0 > 0.0);
    let curve = |d: f64| 4.0 / 3.0 * e_star * 0.005f64.sqrt() * d.powf(1.5);
    Plot {
        group: "contact_hertz",
        file: "chung-ooi-1-force",
        title: "Chung-Ooi 1, glass: force against overlap",
        caption: "Every 40th of some 2000 steps of the contact; the peak is the published one.",
        x: Axis::linear("overlap (um)"),
        y: Axis::linear("force (kN)"),
        curves: vec![
            Curve::line(
                "Hertz, closed form",
                spread(0.0, closed.peak_overlap, 60).map(|d| (d * 1e6, curve(d) * 1e-3)).collect(),
            ),
            Curve::points("ours, both ways", ours),
            Curve::points("published peak", vec![(274.1, 10.697)]),
        ],
    }
}

fn restitution_in_out() -> Plot {
    let e = || spread(0.05, 1.0, 19);
    let uncorrected = |e: f64| {
        damping_ratio(e, AttractiveTail::Kept)
            .map_or(f64::NAN, |zeta| restitution_of(zeta, AttractiveTail::Cut))
    };
    Plot {
        group: "contact_restitution",
        file: "chung-ooi-3-restitution",
        title: "Chung-Ooi 3, Al2O3: restitution found against asked",
        caption: "Each tail has the damping that gives the asked restitution. The damping of \
                  equations 14 to 17 with the tail cut off gives the dashed curve instead: .1 becomes .253.",
        x: Axis::linear("restitution asked"),
        y: Axis::linear("restitution found"),
        curves: vec![
            Curve::line("as asked", vec![(0.0, 0.0), (1.0, 1.0)]),
            Curve::line("equations 14-17, tail cut", e().map(|e| (e, uncorrected(e))).collect()),
            Curve::points("ours, tail cut", e().map(|e| (e, hertz_rebound::<true>(e))).collect()),
            Curve::points("ours, tail kept", e().map(|e| (e, hertz_rebound::<false>(e))).collect()),
        ],
    }
}

fn restitution_steps() -> Plot {
    let steps = [4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0, 50.0, 100.0];
    let row = |e: f64, rate: RateAt| {
        steps.iter().map(|&n| (n, restitution_at_steps(e, n, rate, true) - e)).collect()
    };
    Plot {
        group: "contact_restitution",
        file: "restitution-steps",
        title: "Restitution found less asked, against steps a contact",
        caption: "Hertz, tail cut, mean over 50 places of first touch. The engine damps with the rate \
                  foretold for the end of the step (second order); a rate half or a whole step late is \
                  first order. The thesis's 7e-5 s gives 4 to 7 steps a bead contact.",
        x: Axis::logarithmic("steps in an elastic contact"),
        y: Axis::linear("error of restitution"),
        curves: vec![
            Curve::line("end of step, e = 0.5", row(0.5, RateAt::End)),
            Curve::line("end of step, e = 0.9", row(0.9, RateAt::End)),
            Curve::line("middle, e = 0.9", row(0.9, RateAt::Middle)),
            Curve::line("one step late, e = 0.9", row(0.9, RateAt::Start)),
        ],
    }
}

fn linear_history<N: NormalLaw>(normal: N, body: Body, k: f64, duration: f64) -> Vec<(f64, f64)> {
    let model = ContactModel {
        normal,
        tangential: Frictionless,
        rolling: FreeRolling,
        cohesion: Cohesionless,
    };
    let settings = Settings::new(duration / 4000.0);
    let mut pair = TwoBody::new(model, body, Partner::Plane, 0.0, settings);
    let unit = (k * body.mass).sqrt() * body.velocity.x;
    let rate = (k / body.mass).sqrt();
    let mut points = Vec::new();
    for n in 1..4000 {
        pair.step();
        if n % 160 == 80 {
            points.push((pair.time * rate, pair.response.normal.force / unit));
        }
    }
    points
}

fn linear() -> Plot {
    let (k, speed) = (1e5, 0.7);
    let body = Body::solid_sphere(3e-3, 2500.0).with_velocity(DVec3::X * speed);
    let rate = (k / body.mass).sqrt();
    let unit = (k * body.mass).sqrt() * speed;
    let mut curves = Vec::new();
    for (zeta, tail) in [
        (0.2, AttractiveTail::Kept),
        (0.2, AttractiveTail::Cut),
        (0.8, AttractiveTail::Cut),
        (1.5, AttractiveTail::Cut),
    ] {
        let damping = 2.0 * zeta * (k * body.mass).sqrt();
        let Ok(closed) = LinearImpact::new(k, damping, body.mass, speed, tail) else { continue };
        let end = closed.duration();
        let kept = tail == AttractiveTail::Kept;
        let name = format!("zeta {zeta}, tail {}", if kept { "kept" } else { "cut" });
        let history = spread(0.0, end * (1.0 - 1e-9), 100)
            .map(|t| (t * rate, closed.force(t) / unit))
            .collect();
        curves.push(Curve::line(name.clone(), history));
        let stiff = LinearTailCut { stiffness: k, damping_ratio: zeta };
        let soft = LinearTailKept { stiffness: k, damping_ratio: zeta };
        let found = if kept {
            linear_history(soft, body, k, end)
        } else {
            linear_history(stiff, body, k, end)
        };
        curves.push(Curve::points(format!("ours, {name}"), found));
    }
    Plot {
        group: "contact_linear",
        file: "linear-force",
        title: "Linear spring-dashpot: force against time",
        caption: "Lines: closed solution (thesis 7.1, corrected), on the damped and the overdamped \
                  branch; points: ours.",
        x: Axis::linear("time times sqrt(k/m)"),
        y: Axis::linear("force / (v sqrt(k m))"),
        curves,
    }
}

fn jkr() -> Plot {
    use std::f64::consts::PI;
    let (law, dmt) = contact_jkr::laws();
    let r = contact_jkr::R;
    let (w, e) = (law.work_of_adhesion, law.e_star);
    let pair = PairGeometry { r_star: r, m_star: 1e-8, radius_i: r, radius_j: f64::INFINITY };
    let pull = 1.5 * PI * w * r;
    let tear = -law.reach(&pair);
    let scale = -tear;
    let force =
        |d: f64| law.respond(&pair, &contact_jkr::at(d), &mut Bond { formed: true }).force / pull;
    let closed = spread(0.0, 1.0, 80)
        .map(|s| {
            let a_tear = (PI * w * r * r / (8.0 * e)).cbrt();
            let a = a_tear * (1.0 + 2.93 * s);
            let delta = a * a / r - (2.0 * PI * w * a / e).sqrt();
            let f = 4.0 * e * a.powi(3) / (3.0 * r) - (8.0 * PI * w * e * a.powi(3)).sqrt();
            (delta / scale, f / pull)
        })
        .collect();
    let touching = spread(0.0, 2.5, 20).map(|d| (d, force(d * scale)));
    let necking = spread(tear * 0.9999, 0.0, 12).map(|d| (d / scale, force(d)));
    let dmt_line = spread(0.0, 2.5, 40)
        .map(|d| (d, dmt.respond(&pair, &contact_jkr::at(d * scale), &mut ()).force / pull));
    Plot {
        group: "contact_jkr",
        file: "jkr-force",
        title: "JKR: force against overlap",
        caption: "In units of the pull-off force 1.5 pi w R* and of the gap at the tear. Approaching \
                  bodies snap into contact at overlap 0 (-8/9); parting ones hold on down to the tear at \
                  -1 (-5/9): the loop is the loss.",
        x: Axis::linear("overlap / gap at the tear"),
        y: Axis::linear("force / pull-off force"),
        curves: vec![
            Curve::line("JKR, closed form by contact radius", closed),
            Curve::line("DMT, ours", dmt_line.collect()),
            Curve::points("JKR, ours, loading and unloading", touching.collect()),
            Curve::points("JKR, ours, neck while parting", necking.collect()),
        ],
    }
}
