//! Motions on a plane: dropped, slipping and rolling spheres; two that are squeezed.

use dem_core::contact::law::RollingLaw;
use dem_core::contact::rolling::{AbsoluteSpin, ConstantTorque, FreeRolling, Zhu, zhu};
use dem_core::glam::DVec3;
use dem_core::impact::Body;

use super::{Axis, Curve, Plot, spread};
use crate::contact_free_fall::{closed_height, drop};
use crate::contact_rolling::{ARM, VISCOUS, marble, on_level, resting, spring_dashpot};
use crate::squeezed;

pub(super) fn plots() -> Vec<Plot> {
    vec![falling(), squeezed(), slipping(), decaying()]
}

fn falling() -> Plot {
    let (k, mut curves) = (1e4, Vec::new());
    for e in [1.0, 0.8, 0.6] {
        let closed = spread(0.0, 0.55, 220).map(|t| (t, closed_height(k, e, t))).collect();
        curves.push(Curve::line(format!("closed form, e = {e}"), closed));
        let mut ball = drop(k, e, 1e-5);
        let found = spread(0.025, 0.55, 21).map(|t| {
            while ball.time < t - 1e-9 {
                ball.step();
            }
            (ball.time, -ball.position_i.x)
        });
        curves.push(Curve::points(format!("ours, e = {e}"), found.collect()));
    }
    Plot {
        group: "contact_free_fall",
        file: "mfix-dem01-height",
        title: "MFIX DEM01: height of a dropped sphere",
        caption: "Linear contact of 10 kN/m; lines: piecewise closed form, points: ours.",
        x: Axis::linear("time (s)"),
        y: Axis::linear("height of the centre (m)"),
        curves,
    }
}

fn squeezed() -> Plot {
    let times: Vec<f64> = spread(2e-5, 1e-3, 49).collect();
    let mut curves = Vec::new();
    for e in [1.0, 0.5] {
        let want = squeezed::reference(e, &times);
        let found = squeezed::engine(e, &times).unwrap_or_default();
        for (k, name) in ["lower", "upper"].into_iter().enumerate() {
            let shift = |heights: &[[f64; 2]]| -> Vec<(f64, f64)> {
                let start = [0.45e-3, 1.35e-3][k];
                times.iter().zip(heights).map(|(t, y)| (t * 1e3, (y[k] - start) * 1e6)).collect()
            };
            curves.push(Curve::line(format!("Runge-Kutta, {name}, e = {e}"), shift(&want)));
            curves.push(Curve::points(format!("engine, {name}, e = {e}"), shift(&found)));
        }
    }
    Plot {
        group: "engine_drops",
        file: "mfix-dem03-height",
        title: "MFIX DEM03: two spheres squeezed between walls",
        caption: "Way of each centre from its start; lines: independent integration, points: the engine.",
        x: Axis::linear("time (ms)"),
        y: Axis::linear("way (um)"),
        curves,
    }
}

fn slipping() -> Plot {
    let (u0, g, mut curves) = (0.1, 9.81, Vec::new());
    for mu in [0.2, 0.6] {
        let body = Body::solid_sphere(0.5e-3, 1e4).with_velocity(DVec3::Y * u0);
        let mut ball = resting(FreeRolling, body, 1e5, mu, DVec3::X * g, 1e-7);
        let (mut v, mut spin) = (Vec::new(), Vec::new());
        for t in spread(5e-4, 2e-2, 39) {
            while ball.time < t {
                ball.step();
            }
            v.push((t * 1e3, ball.i.velocity.y / u0));
            spin.push((t * 1e3, -ball.i.spin.z * body.radius / u0));
        }
        let end = 2.0 * u0 / (7.0 * mu * g) * 1e3;
        let stays = 5.0 / 7.0;
        let slow = vec![(0.0, 1.0), (end, stays), (20.0, stays)];
        curves.push(Curve::line(format!("velocity, mu = {mu}"), slow));
        curves.push(Curve::points(format!("ours, velocity, mu = {mu}"), v));
        let fast = vec![(0.0, 0.0), (end, stays), (20.0, stays)];
        curves.push(Curve::line(format!("R omega, mu = {mu}"), fast));
        curves.push(Curve::points(format!("ours, R omega, mu = {mu}"), spin));
    }
    Plot {
        group: "contact_rolling",
        file: "mfix-dem04-slip",
        title: "MFIX DEM04: slip that ends in rolling",
        caption: "Over the first speed; lines: rigid body, points: ours.",
        x: Axis::linear("time (ms)"),
        y: Axis::linear("speed / first speed"),
        curves,
    }
}

fn decaying() -> Plot {
    fn row<R: RollingLaw>(rolling: R) -> Vec<(f64, f64)> {
        let v = 0.1;
        let mut ball = on_level(rolling, v, v / marble().radius);
        spread(0.01, 1.0, 99)
            .map(|t| {
                while ball.time < t {
                    ball.step();
                }
                (t, ball.i.velocity.y * 1e3)
            })
            .collect()
    }
    fn sparse(row: Vec<(f64, f64)>, first: usize) -> Vec<(f64, f64)> {
        row.into_iter().skip(first).step_by(4).collect()
    }
    let torque = VISCOUS;
    Plot {
        group: "contact_rolling",
        file: "rolling-decay",
        title: "A marble rolls to rest under each rolling law",
        caption: "mu_r = 0.05, from 0.1 m/s in pure rolling. Rigid body: 5/7 mu_r g.",
        x: Axis::linear("time (s)"),
        y: Axis::linear("velocity (mm/s)"),
        curves: vec![
            Curve::line("rigid body, torque A", vec![(0.0, 100.0), (0.285_41, 0.0), (1.0, 0.0)]),
            Curve::line("none", row(FreeRolling)),
            Curve::line("Zhu", row(Zhu { torque, inertia_share: zhu::SOLID_SPHERE_SHARE })),
            Curve::line("viscous capped", row(VISCOUS)),
            Curve::line("spring-dashpot", row(spring_dashpot())),
            Curve::points("constant torque A", sparse(row(ConstantTorque { arm: ARM }), 0)),
            Curve::points("absolute spin", sparse(row(AbsoluteSpin { arm: ARM }), 2)),
        ],
    }
}
