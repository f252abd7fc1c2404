//! Observers: right numbers, no influence.

use dem_core::observe::{
    CollisionEnergy, CoordinationNumber, LaceyIndex, Observer, PairKind, Stress,
    VelocityDistribution,
};
use dem_core::prelude::*;

use crate::scenes::{Model, Random, bead_material, drum, model};

#[test]
fn observers_change_no_bit() {
    let mut alone = drum(300, 2.0, 1).build().unwrap();
    let mut watched = drum(300, 2.0, 1).build().unwrap();
    let mut contacts = CoordinationNumber::new(7);
    let mut collisions = CollisionEnergy::new(1e-12, 1e-3);
    let mut speeds = VelocityDistribution::new(50, 0.18, 0.01, 10.0, 30);
    let mut mixing = LaceyIndex::new(100, 0.01, 4, |id| id.0.is_multiple_of(2));
    let mut stress = Stress::new(11, DVec3::splat(-0.04), DVec3::splat(0.04));
    alone.run(2000).unwrap();
    let observers: &mut [&mut dyn Observer] =
        &mut [&mut contacts, &mut collisions, &mut speeds, &mut mixing, &mut stress];
    watched.run_observed(2000, observers).unwrap();
    assert_eq!(alone.state_hash(), watched.state_hash());
    assert_eq!(contacts.series.len(), 2000 / 7);
    assert_eq!(mixing.series.len(), 20);
    assert!(collisions.histograms().len() >= 2 && stress.pressure() > 0.0);
    assert!(speeds.mean() > 0.1);
}

#[test]
fn a_head_on_collision_is_booked_once_with_its_energy() {
    let mut b = WorldBuilder::<Model>::new(1e-6);
    let m = b.material(bead_material());
    b.pair_law(m, m, model(0.3, 0.9, 0.0)).domain(DVec3::splat(-0.1), DVec3::splat(0.1));
    b.wall(Wall::plane(DVec3::X * 0.012, DVec3::NEG_X, m));
    b.sphere(Sphere::at(DVec3::X * -4e-3, 3e-3, m).with_velocity(DVec3::X));
    let hit = b.sphere(Sphere::at(DVec3::X * 4e-3, 3e-3, m));
    let mut w = b.build().unwrap();
    let mass = w.mass(hit);
    let mut collisions = CollisionEnergy::new(1e-9, 1e-2);
    w.run_observed(12_000, &mut [&mut collisions]).unwrap();
    let pairs = &collisions.histograms()[&PairKind::Particles(m, m)];
    // First m*/2 v^2 = m/4; the wall throws the second one back at the first.
    let first = 0.25 * mass;
    assert!(pairs.collisions >= 1);
    let top = pairs.shares().filter(|s| s.1 > 0.0).last().unwrap().0;
    // A bin is a tenth of a decade wide.
    assert!((top / first).log10().abs() < 0.1, "{top:e} {first:e}");
    assert_eq!(collisions.histograms()[&PairKind::Wall(m, 0)].collisions, 1);
}

#[test]
fn stress_under_a_column_is_its_weight_over_the_area() {
    // A column of spheres in a square shaft, one sphere wide and frictionless.
    let mut b = WorldBuilder::<Model>::new(1e-5);
    let m = b.material(bead_material());
    b.pair_law(m, m, model(0.0, 0.3, 0.0)).domain(DVec3::splat(-0.1), DVec3::splat(0.1));
    b.gravity(DVec3::NEG_Z * 9.81);
    b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m));
    let r = 3e-3;
    for k in 0..8 {
        b.sphere(Sphere::at(DVec3::Z * (r + 2.0 * r * f64::from(k)), r, m));
    }
    let mut w = b.build().unwrap();
    w.run(60_000).unwrap();
    let mut stress = Stress::new(1, DVec3::new(-r, -r, 0.0), DVec3::new(r, r, 2.0 * r * 8.0));
    w.run_observed(1, &mut [&mut stress]).unwrap();
    // Mean over the height: each gap between k spheres carries the weight of those above.
    let weight = w.mass(ParticleId(0)) * 9.81;
    let branches = (0..8).map(|k| if k == 0 { r * 8.0 } else { 2.0 * r * f64::from(8 - k) });
    let expected = branches.sum::<f64>() * weight / (4.0 * r * r * 16.0 * r);
    // Branches are shorter by the overlaps, a thousandth of the radius.
    assert!((stress.mean().z_axis.z / expected - 1.0).abs() < 3e-3);
}

#[test]
fn a_random_mixture_has_index_one_and_a_sorted_one_zero() {
    let mut random = Random(9);
    let points: Vec<DVec3> = (0..20_000).map(|_| random.vector()).collect();
    let shuffled: Vec<bool> = (0..20_000).map(|_| random.next() < 0.4).collect();
    let mixed = points.iter().copied().zip(shuffled);
    let sorted = points.iter().map(|p| (*p, p.x < -0.2));
    // Scatter of a variance over 1000 cells: sqrt(2/1000) of S_R^2, i.e. 0.045 / 20.
    assert!((LaceyIndex::index(mixed, 0.2, 5).unwrap() - 1.0).abs() < 0.01);
    assert!(LaceyIndex::index(sorted, 0.2, 5).unwrap().abs() < 0.01);
}
