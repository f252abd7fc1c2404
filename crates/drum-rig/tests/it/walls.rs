//! Lifters and liners.

use std::fmt::Write;

use drum_rig::rig_schema::Lifters;
use drum_rig::{Error, Experiment, Flow, Options, Phase};

use crate::rigs::{small, turned_for};

#[test]
fn lifters_carry_beads_higher_than_a_smooth_mantle() {
    let highest = |lifters| {
        let mut rig = small(80);
        rig.drum.lifters = lifters;
        let drum = turned_for(&rig, 0.75);
        let e = drum.exposure();
        e.positions.iter().map(|p| p.y).fold(f64::NEG_INFINITY, f64::max)
    };
    let bars = Lifters { count: 6, height_m: 0.008, width_m: 0.003 };
    let (with, without) = (highest(Some(bars)), highest(None));
    assert!(with > without + 0.005, "{with} {without}");
}

/// A prism of `facets` sides round the drum of 60 x 24 mm, one side left out if `hole`.
fn prism(facets: u32, hole: bool) -> Vec<u8> {
    let mut stl = String::from("solid liner\n");
    let corner = |k: u32, z: f64| {
        let a = std::f64::consts::TAU * f64::from(k) / f64::from(facets);
        [0.03 * a.cos(), 0.03 * a.sin(), z]
    };
    // Three rings along the axis, so that a side can miss in the middle.
    let rings = [-0.0125, -0.004, 0.004, 0.0125];
    for (n, z) in rings.windows(2).enumerate() {
        for k in 0..facets {
            if hole && n == 1 && k == 5 {
                continue;
            }
            let j = (k + 1) % facets;
            let (a, b) = (corner(k, z[0]), corner(j, z[0]));
            let (c, d) = (corner(j, z[1]), corner(k, z[1]));
            for t in [[a, b, c], [a, c, d]] {
                stl.push_str("facet normal 0 0 0\nouter loop\n");
                for [x, y, z] in t {
                    writeln!(stl, "vertex {x:e} {y:e} {z:e}").unwrap();
                }
                stl.push_str("endloop\nendfacet\n");
            }
        }
    }
    stl.push_str("endsolid liner\n");
    stl.into_bytes()
}

fn lined() -> drum_rig::rig_schema::Rig {
    let mut rig = small(80);
    rig.drum.liner = Some("liner.stl".into());
    rig
}

#[test]
fn a_liner_holds_the_bed_as_the_mantle_does() {
    let options = Options { liner_stl: Some(prism(24, false)), ..Options::default() };
    let mut drum = Experiment::new(&lined(), &options).unwrap();
    drum.run(
        |_, p| if p.phase != Phase::Settling && p.turns > 0.2 { Flow::Stop } else { Flow::Go },
    )
    .unwrap();
    let exposure = drum.exposure();
    for p in &exposure.positions {
        // Beads of 2 mm radius inside a mantle of 30 mm.
        assert!(p.x.hypot(p.y) < 0.0282);
    }
    assert!(drum.centre_of_mass().x > 0.001);
}

#[test]
fn a_liner_with_a_hole_is_refused_with_its_place() {
    let options = Options { liner_stl: Some(prism(24, true)), ..Options::default() };
    match Experiment::new(&lined(), &options).map(|_| ()) {
        Err(Error::Leak { edges, x, y, z }) => {
            assert_eq!(edges, 4);
            assert!(x.hypot(y) > 0.029 && z.abs() < 0.0041);
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_liner_that_is_missing_unnamed_or_no_stl_is_refused() {
    let none = Options::default();
    let given = Options { liner_stl: Some(prism(24, false)), ..none.clone() };
    let broken = Options { liner_stl: Some(b"no surface".to_vec()), ..none.clone() };
    for (rig, options) in [(lined(), none), (small(10), given), (lined(), broken)] {
        let refused = Experiment::new(&rig, &options).map(|_| ());
        assert!(matches!(refused, Err(Error::Liner { .. })), "{refused:?}");
    }
}
