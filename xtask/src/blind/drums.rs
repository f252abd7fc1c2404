//! The drums of the blind study: which effects at which strengths.

use super::sealed::Truth;

/// One effect with two strengths.
pub(crate) struct Dose {
    pub(crate) path: &'static str,
    pub(crate) weak: f64,
    pub(crate) strong: f64,
    /// Parameters that take the same value.
    pub(crate) along: &'static [&'static str],
    /// Law that it needs, as a line of the rig file.
    pub(crate) law: &'static str,
}

/// Eight effects, seven of them physical.
pub(crate) const DOSES: [Dose; 8] = [
    Dose { path: "rolling.pp", weak: 0.06, strong: 0.15, along: &["rolling.mantle"], law: "" },
    Dose {
        path: "cohesion.energy_density_j_m3",
        weak: 6000.0,
        strong: 12_000.0,
        along: &[],
        law: "contact = { cohesion = \"simplified_jkr\" }",
    },
    Dose { path: "friction.kinetic_ratio", weak: 0.7, strong: 0.5, along: &[], law: "" },
    Dose { path: "fill.scale", weak: 0.9, strong: 1.15, along: &[], law: "" },
    Dose { path: "wall_layer.thickness_m", weak: 0.0015, strong: 0.003, along: &[], law: "" },
    Dose { path: "shape.aspect_ratio", weak: 1.2, strong: 1.5, along: &[], law: "" },
    Dose { path: "speed.scale", weak: 0.75, strong: 1.35, along: &[], law: "" },
    Dose { path: "camera.roll_deg", weak: 2.0, strong: -4.0, along: &[], law: "" },
];

/// Frictions between particles that drums have.
const FRICTIONS: [f64; 2] = [0.3, 0.45];

/// All cases of the study, in an order that tells nothing.
pub(crate) fn all(seed: u64) -> Vec<Truth> {
    let mut list = Vec::new();
    let mut add = |kind: &str, effects: Vec<(String, f64)>| {
        let friction = FRICTIONS[list.len() % FRICTIONS.len()];
        list.push(Truth {
            case: String::new(),
            kind: kind.to_owned(),
            code: "tumble".to_owned(),
            frictions: vec![("friction.pp".to_owned(), friction)],
            effects,
        });
    };
    let weak = |d: &Dose| (d.path.to_owned(), d.weak);
    let strong = |d: &Dose| (d.path.to_owned(), d.strong);
    for d in &DOSES {
        add("single", vec![weak(d)]);
        add("single", vec![strong(d)]);
    }
    for _ in 0..4 {
        add("null", Vec::new());
    }
    for k in [0, 1, 4, 7] {
        add("removed", vec![strong(&DOSES[k])]);
    }
    for (a, b) in [(1, 3), (0, 6)] {
        add("pair", vec![strong(&DOSES[a]), strong(&DOSES[b])]);
    }
    // Order by a hash: neighbours in name are not neighbours in kind.
    list.sort_by_key(|t| *blake3::hash(format!("{seed} {t:?}").as_bytes()).as_bytes());
    for (k, t) in list.iter_mut().enumerate() {
        t.case = format!("case_{k:02}");
    }
    list
}
