//! How often the verdict is right, over many data sets.

use calib::attribution::Verdict;

use super::world::{ALL, Drum, EFFECTS, attribution, measure, simulators, strengths};

#[test]
fn null_sets_raise_at_most_four_alarms_in_two_hundred() {
    let (base, effects) = (Drum(None), simulators());
    let mut alarms = Vec::new();
    for seed in 0..200 {
        let mu = 0.25 + 0.002 * seed as f64;
        let data = measure(1000 + seed, mu, &strengths(&[]), 1.0);
        let verdict = attribution(data, &base, &effects, &ALL).verdict().expect("is well posed");
        if verdict != Verdict::None {
            alarms.push((seed, verdict));
        }
    }
    println!("{} alarms: {alarms:?}", alarms.len());
    assert!(alarms.len() <= 4, "{alarms:?}");
}

#[test]
fn confusion() {
    let (base, effects) = (Drum(None), simulators());
    for (k, e) in EFFECTS.iter().enumerate() {
        for part in [0.3, 0.6, 0.9] {
            let s = part * e.1.1;
            let mut counts = std::collections::BTreeMap::new();
            for seed in 0..10 {
                let data = measure(5000 + 10 * k as u64 + seed, 0.4, &strengths(&[(k, s)]), 1.0);
                let v = attribution(data, &base, &effects, &ALL).verdict().expect("is well posed");
                *counts.entry(format!("{v:?}")).or_insert(0) += 1;
            }
            println!("{} {s}: {counts:?}", e.0);
        }
    }
}
