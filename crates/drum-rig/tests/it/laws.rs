//! Every combination of contact laws runs, and every name makes a difference.

use std::collections::BTreeSet;

use drum_rig::rig_schema::{Cohesion, NormalLaw, RollingLaw, TangentialLaw};
use drum_rig::{Error, Experiment, Options};

use crate::rigs::{small, turned_for, with, without};

const NORMAL: [NormalLaw; 3] =
    [NormalLaw::Hertz, NormalLaw::LinearSpringDashpot, NormalLaw::WaltonBraun];
const TANGENTIAL: [TangentialLaw; 5] = [
    TangentialLaw::Mindlin,
    TangentialLaw::MindlinTotalSpring,
    TangentialLaw::MindlinDeresiewicz,
    TangentialLaw::LinearSpring,
    TangentialLaw::WaltonBraun,
];
const ROLLING: [RollingLaw; 6] = [
    RollingLaw::None,
    RollingLaw::ConstantTorque,
    RollingLaw::ViscousCapped,
    RollingLaw::SpringDashpot,
    RollingLaw::Zhu,
    RollingLaw::AbsoluteSpin,
];

#[test]
fn all_combinations_of_laws_run_and_differ() {
    let mut hashes = BTreeSet::new();
    let mut count = 0;
    for normal in NORMAL {
        for tangential in TANGENTIAL {
            for rolling in ROLLING {
                for tail in [false, true] {
                    if tail && normal == NormalLaw::WaltonBraun {
                        continue;
                    }
                    let mut rig = small(40);
                    if rolling == RollingLaw::None {
                        rig = without(&without(&rig, "rolling.pp"), "rolling.mantle");
                    }
                    rig.contact.normal = normal;
                    rig.contact.tangential = tangential;
                    rig.contact.rolling = rolling;
                    rig.contact.attractive_tail = tail;
                    hashes.insert(turned_for(&rig, 0.02).state_hash());
                    count += 1;
                }
            }
        }
    }
    assert_eq!(hashes.len(), count);
}

#[test]
fn cohesive_beds_hold_more_contacts_than_dry_ones() {
    let contacts = |cohesion, path: &str, value| {
        let mut rig = small(100);
        rig.contact.cohesion = cohesion;
        let drum = turned_for(&with(&rig, &[(path, value)]), 0.3);
        drum.coordination().0
    };
    let dry = turned_for(&small(100), 0.3).coordination().0;
    for (cohesion, path, value) in [
        // Pull-off 1.5 pi w R* = 9.4 mN, 11 times the weight of a bead (0.82 mN).
        (Cohesion::Jkr, "cohesion.surface_energy_j_m2", 1.0),
        (Cohesion::Dmt, "cohesion.surface_energy_j_m2", 1.0),
        (Cohesion::SimplifiedJkr, "cohesion.energy_density_j_m3", 1e5),
        // 2 pi R gamma = 0.9 mN.
        (Cohesion::Capillary, "cohesion.liquid_fraction", 0.01),
    ] {
        let wet = contacts(cohesion, path, value);
        assert!(wet > dry + 0.2, "{cohesion:?}: {wet} against {dry}");
    }
}

#[test]
fn an_adhesive_law_without_adhesion_is_hertz_with_its_tail() {
    let mut jkr = small(60);
    jkr.contact.cohesion = Cohesion::Jkr;
    let mut hertz = small(60);
    hertz.contact.attractive_tail = true;
    let (a, b) = (turned_for(&jkr, 0.05), turned_for(&hertz, 0.05));
    // The same laws by two static products: equal up to rounding that collisions amplify.
    let d = a.centre_of_mass() - b.centre_of_mass();
    assert!(d.length() < 1e-4, "{d}");
}

#[test]
fn laws_that_exclude_each_other_are_refused() {
    let mut linear = small(40);
    linear.contact.cohesion = Cohesion::Jkr;
    linear.contact.normal = NormalLaw::LinearSpringDashpot;
    let mut tail = small(40);
    tail.contact.normal = NormalLaw::WaltonBraun;
    tail.contact.attractive_tail = true;
    for rig in [linear, tail] {
        let refused = Experiment::new(&rig, &Options::default()).map(|_| ());
        assert!(matches!(refused, Err(Error::Contradiction { .. })), "{refused:?}");
    }
}
