//! Eight bodies at once against one by itself, and how far their spheres move.

use super::*;
use crate::material::MaterialId;
use crate::rigid::{ClumpSpec, ClumpSphere};
use glam::DMat3;

/// Eleven bodies of two shapes with single spheres among them, some slow and some that turn by
/// a good part of a radian a step.
#[derive(Clone, PartialEq, Debug)]
struct Bodies {
    shape: Vec<u32>,
    attitude: Vec<DQuat>,
    momentum: Vec<Record>,
    torque: Vec<Record>,
    mean_spin: Vec<Record>,
    end_spin: Vec<Record>,
    first: Vec<u32>,
    position: Vec<Record>,
    /// The farthest that a sphere has moved, squared, after each turn.
    farthest: Vec<f64>,
}

fn shapes() -> Vec<Clump> {
    let make = |size: f64| {
        let sphere =
            |x, y, z| ClumpSphere { centre: DVec3::new(x, y, z) * size, radius: 2.0 * size };
        let spheres = vec![sphere(-1.0, 0.2, 0.0), sphere(1.0, 0.1, -0.3)];
        let inertia = DMat3::from_diagonal(DVec3::new(1.0, 2.0, 2.5)) * size.powi(5) * 1e4;
        let (mass, centre_of_mass) = (1e4 * size.powi(3), DVec3::ZERO);
        let material = MaterialId(0);
        ClumpSpec { spheres, mass, centre_of_mass, inertia, material }.try_into().unwrap()
    };
    vec![make(1e-3), make(1.5e-3)]
}

fn bodies() -> Bodies {
    let shape = vec![0, 0, 0, 0, 0, 0, 0, 0, SPHERE, 1, 0];
    let n = shape.len();
    let at = |k: usize, seed: f64| {
        let x = seed + 1.7 * k as f64;
        DVec3::new(x.sin(), (1.3 * x).cos(), (2.1 * x).sin())
    };
    let spin = |k: usize| [0.0, 1e-3, 1.0, 30.0, 2e3, 2e4, 5e4, 10.0][k % 8];
    let moment = 1e-11;
    let mut first = vec![0];
    for s in &shape {
        first.push(first[first.len() - 1] + if *s == SPHERE { 1 } else { 2 });
    }
    let spheres = first[n] as usize;
    Bodies {
        attitude: (0..n).map(|k| DQuat::from_scaled_axis(at(k, 0.3) * 2.0).normalize()).collect(),
        momentum: (0..n).map(|k| Record::new(at(k, 0.7) * moment * spin(k), 4.0)).collect(),
        torque: (0..n).map(|k| Record::new(at(k, 0.9) * 1e-7, 0.0)).collect(),
        mean_spin: vec![Record::new(DVec3::ZERO, 7.0); n],
        end_spin: vec![Record::ZERO; n],
        position: vec![Record::ZERO; spheres],
        farthest: Vec::new(),
        first,
        shape,
    }
}

fn centres(b: &Bodies) -> Vec<Record> {
    b.torque.iter().map(|t| Record { w: 3e-3, ..*t * 1e4 }).collect()
}

fn moved(level: Level, arithmetic: Arithmetic) -> Bodies {
    let (shapes, mut b) = (shapes(), bodies());
    let centre: Vec<Record> = centres(&b);
    let (reference, attitude) =
        (vec![Record { w: 1e-8, ..Record::ZERO }; centre.len()], b.attitude.clone());
    let frame = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO].map(|v| Record::new(v, 0.0));
    for _ in 0..3 {
        let mut farthest = Farthest::default();
        let since = Since {
            position: &centre,
            reference: &reference,
            attitude: &attitude,
            frame: &frame,
            turn: DQuat::IDENTITY,
        };
        Turning {
            shapes: &shapes,
            shape: &b.shape,
            torque: &b.torque,
            attitude: &mut b.attitude,
            mean_spin: &mut b.mean_spin,
            end_spin: &mut b.end_spin,
            momentum: &mut b.momentum,
            dt: 2e-5,
            since,
            farthest: &mut farthest,
        }
        .run(level, arithmetic);
        b.farthest.push(farthest.square);
        assert!(farthest.too_far);
    }
    Placing {
        shapes: &shapes,
        shape: &b.shape,
        attitude: &b.attitude,
        centre: &centre,
        first: &b.first,
        position: &mut b.position,
    }
    .run(level, arithmetic);
    b
}

#[test]
fn no_sphere_moves_further_than_told() {
    // Any turn of a body in any turned frame: the bound holds, and is tight for small turns.
    let at = |k: f64| DVec3::new((1.7 * k).sin(), (2.3 * k).cos(), (3.1 * k).sin());
    for k in 0..400 {
        let seed = 0.37 * f64::from(k);
        let angle = [1e-9, 1e-3, 0.1, 1.0, 3.0][k as usize % 5];
        let frame = DQuat::from_scaled_axis(at(seed + 0.2) * angle);
        let then = DQuat::from_scaled_axis(at(seed + 0.5) * 3.0);
        let own = at(seed + 0.9).normalize();
        let now = DQuat::from_scaled_axis(own * angle) * frame * then;
        let now = if k % 2 == 0 { now } else { -now };
        let (shift, reference, position) = (at(seed), at(seed + 2.0), at(seed + 3.0));
        let f = glam::DMat3::from_quat(frame);
        let columns = [f.x_axis, f.y_axis, f.z_axis, shift].map(V3::from);
        let (ends, attitudes) = ([reference, position], [then.to_array(), now.to_array()]);
        let of = |reach: f64| {
            moved_since(columns, frame.to_array(), ends.map(V3::from), attitudes, reach)
        };
        let reach = 0.3;
        // The arm across the axis of the turn moves most.
        let across = (frame * then).conjugate() * own.any_orthonormal_vector() * reach;
        let image = |p: DVec3| frame * p + shift;
        let before = image(reference + then * across);
        let after = position + now * across;
        assert!((after - before).length() <= of(reach) + 1e-12);
        let turned = (now * across - frame * (then * across)).length();
        let told = of(reach) - of(0.0);
        let tight = if angle < 0.2 { 1.001 * turned + 1e-14 } else { 2.0 * turned };
        assert!(told <= tight && turned <= told + 1e-14, "{angle}: {turned} {told}");
    }
}

#[test]
fn eight_bodies_move_as_one_does_to_the_bit() {
    let one = moved(Level::Portable, Arithmetic::Exact);
    // The fastest turns by half a radian a step; its arm is as long as it was.
    assert!(one.mean_spin[6].vector().length() * 2e-5 > 0.3);
    let length = (one.position[12].vector() - centres(&one)[6].vector()).length()
        / shapes()[0].spheres[0].centre.length();
    assert!((length - 1.0).abs() < 1e-14, "{length}");
    assert_eq!((one.mean_spin[3].w, one.momentum[3].w), (7.0, 4.0));
    assert_eq!(one.position[16], centres(&one)[8]);
    let widest = Level::detect();
    if widest != Level::Portable {
        assert_eq!(one, moved(Level::Avx2, Arithmetic::Exact));
        assert_eq!(one, moved(widest, Arithmetic::Exact));
    }
}

#[test]
fn fused_turns_and_places_are_those_of_exact_ones_to_rounding() {
    let widest = Level::detect();
    if widest == Level::Portable {
        return;
    }
    let (exact, fused) = (moved(widest, Arithmetic::Exact), moved(Level::Avx2, Arithmetic::Fused));
    assert_eq!(fused, moved(widest, Arithmetic::Fused));
    assert_ne!(fused, exact);
    // Three turns of some fifty operations each, most of them of numbers as large as what comes of them.
    let bound = 50.0 * f64::EPSILON;
    for (own, other) in fused.attitude.iter().zip(&exact.attitude) {
        assert!((*own - *other).length() < bound, "{own} {other}");
    }
    let columns =
        |b: &Bodies| [&b.momentum, &b.mean_spin, &b.end_spin, &b.position].map(Vec::clone);
    for (own, other) in columns(&fused).into_iter().zip(columns(&exact)) {
        for (own, other) in own.iter().zip(&other) {
            let off = (own.vector() - other.vector()).length();
            assert!(off <= bound * other.vector().length(), "{own:?} {other:?}");
            assert_eq!(own.w, other.w);
        }
    }
    // Who is beside a body does not matter to it, nor how many are.
    let (shapes, centre) = (shapes(), centres(&fused));
    for k in 0..fused.shape.len() {
        let own = fused.first[k] as usize..fused.first[k + 1] as usize;
        let mut alone = vec![Record::ZERO; own.len()];
        Placing {
            shapes: &shapes,
            shape: &fused.shape[k..=k],
            attitude: &fused.attitude[k..=k],
            centre: &centre[k..=k],
            first: &fused.first[k..=k + 1],
            position: &mut alone,
        }
        .run(widest, Arithmetic::Fused);
        assert_eq!(alone, fused.position[own], "{k}");
    }
}
