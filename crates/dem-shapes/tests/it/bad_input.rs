//! Every refusal names what, the value, and what was expected.

use dem_shapes::glam::DVec3;
use dem_shapes::{
    AsphericalKind, Ball, BiconvexTablet, ClumpMass, ClumpShape, Fidelity, FidelityOptions,
    FlatTablet, RingTabletSpec, ShapeError, Sphere, aspherical_clump, union_properties,
};

use crate::{coated, flat, open_ring};

const BALL: Sphere = Sphere::new(DVec3::ZERO, 1.0);

#[test]
fn spheres_that_are_none_are_named_by_their_place() {
    assert_eq!(union_properties(&[], 1e-9), Err(ShapeError::NoSpheres));
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let got = union_properties(&[BALL, Sphere::new(DVec3::X, radius)], 1e-9);
        assert!(matches!(got, Err(ShapeError::SphereRadius { index: 1, .. })), "{got:?}");
    }
    let center = DVec3::new(0.0, f64::NAN, 0.0);
    let got = union_properties(&[Sphere::new(center, 1.0)], 1e-9);
    assert!(matches!(got, Err(ShapeError::SphereCenter { index: 0, .. })), "{got:?}");
}

#[test]
fn tolerances_that_cannot_be_met_are_refused() {
    for value in [0.0, 1e-16, 0.5, -1.0, f64::NAN] {
        let got = union_properties(&[BALL], value);
        assert!(matches!(got, Err(ShapeError::Tolerance { .. })), "{value}: {got:?}");
    }
}

#[test]
fn sizes_that_leave_the_range_of_numbers_are_refused() {
    for radius in [1e-100, 1e-70, 1e70, 1e120, 1e300] {
        let got = union_properties(&[Sphere::new(DVec3::ZERO, radius)], 1e-9);
        assert!(matches!(got, Err(ShapeError::OutOfRange { .. })), "{radius}: {got:?}");
    }
    // Far apart for their size: the distance has no digits left for the sizes.
    let far = Sphere::new(DVec3::X * 1e300, 1.0);
    assert!(union_properties(&[BALL, far], 1e-9).is_err());
}

#[test]
fn dimensions_of_solids_are_checked() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Ball::new(bad).is_err());
        assert!(FlatTablet::new(bad, 1.0).is_err() && FlatTablet::new(1.0, bad).is_err());
        assert!(BiconvexTablet::new(bad, 1.0, 2.0).is_err());
        assert!(BiconvexTablet::new(1.0, 1.0, bad).is_err());
    }
    assert!(BiconvexTablet::new(1.0, -0.1, 2.0).is_err());
    assert_eq!(
        BiconvexTablet::new(4.0, 2.0, 3.0),
        Err(ShapeError::CrownTooSmall { crown_radius: 3.0, radius: 4.0 })
    );
    let tablet = BiconvexTablet::new(4.0, 2.0, 9.0).unwrap();
    assert!(tablet.volume_sd(-0.1, 0.0, 0.0).is_err());
    assert!(tablet.volume_sd(0.1, f64::NAN, 0.0).is_err());
}

#[test]
fn tablets_that_fall_apart_are_refused() {
    let few = RingTabletSpec { ring_spheres: 2, ..flat() };
    assert_eq!(few.build(), Err(ShapeError::TooFewRingSpheres { count: 2, minimum: 3 }));
    let got = RingTabletSpec { ring_radius: 10e-3, ..open_ring() }.build();
    let Err(ShapeError::NotConnected { gap, .. }) = got else { panic!("{got:?}") };
    let expected = 2.0 * (10e-3 * (std::f64::consts::PI / 10.0).sin() - 1.747e-3);
    assert!((gap - expected).abs() < 1e-15);
    // Neighbours apart, but held by the middle sphere.
    let held = RingTabletSpec { ring_spheres: 3, ..coated(3.5e-3) };
    assert!(held.build().is_ok());
    assert!(RingTabletSpec { ring_radius: 4.2e-3, ..held }.build().is_err());
    for bad in [0.0, -1.0, f64::NAN] {
        assert!(RingTabletSpec { ring_radius: bad, ..flat() }.build().is_err());
        assert!(RingTabletSpec { sphere_radius: bad, ..flat() }.build().is_err());
        assert!(RingTabletSpec { middle_radius: Some(bad), ..flat() }.build().is_err());
    }
}

#[test]
fn volumes_out_of_reach_name_the_reach() {
    for target in [1e-9, 1e-6] {
        let got = open_ring().with_union_volume(target);
        let Err(ShapeError::VolumeOutOfReach { minimum, maximum, .. }) = got else {
            panic!("{got:?}")
        };
        // All in the middle: one sphere; just touching: ten.
        let one = BALL.volume() * 1.747e-3_f64.powi(3);
        assert!((minimum / one - 1.0).abs() < 1e-9 && (maximum / one - 10.0).abs() < 1e-8);
    }
    assert!(flat().with_union_volume(f64::NAN).is_err());
}

#[test]
fn masses_aspect_ratios_and_options_are_checked() {
    for bad in [0.0, -2.0, f64::NAN, f64::INFINITY] {
        assert!(ClumpShape::from_spheres(&[BALL], ClumpMass::Density(bad), 1e-9).is_err());
        assert!(ClumpShape::from_spheres(&[BALL], ClumpMass::Total(bad), 1e-9).is_err());
    }
    for (kind, bad) in [
        (AsphericalKind::Dumbbell, 2.01),
        (AsphericalKind::Rod, 3.01),
        (AsphericalKind::Trefoil, 2.2),
        (AsphericalKind::Rod, 0.99),
        (AsphericalKind::Rod, f64::NAN),
    ] {
        let got = aspherical_clump(kind, bad, 1e-3, ClumpMass::Density(2500.0));
        assert!(matches!(got, Err(ShapeError::AspectRatio { .. })), "{got:?}");
    }
    let solid = Ball::new(1.0).unwrap();
    for options in [
        FidelityOptions { rays: 1, ..Default::default() },
        FidelityOptions { distance_tolerance: -1.0, ..Default::default() },
        FidelityOptions { volume_tolerance: 0.0, ..Default::default() },
    ] {
        assert!(Fidelity::measure(&[BALL], &solid, &options).is_err());
    }
}

#[test]
fn messages_say_what_where_and_what_was_expected() {
    let text = union_properties(&[Sphere::new(DVec3::X, -2.0)], 1e-9).unwrap_err().to_string();
    assert_eq!(text, "sphere 0 has radius -2 m: expected a finite number above zero");
    let text = FlatTablet::new(1.0, 0.0).unwrap_err().to_string();
    assert_eq!(text, "height (m) is 0: expected a finite number above zero");
}
