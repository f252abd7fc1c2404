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

/// Eight effects, seven of them physical. (A cohesion of 12 kJ/m3 crushes these soft beads: there is no measurement. A kinetic
/// friction below the static one was among the eight until it turned out that these measurements do not hold it: a bed that
/// flows knows of both only their product. Drums of 0.45 with 0.4 and 0.5 of it, of 0.3 with 0.7 of it calibrate to 0.18, 0.24
/// and 0.20 and lack nothing. A smooth wall is in its place, weaker and stronger than what a drum that lacks nothing shows.)
pub(crate) const DOSES: [Dose; 8] = [
    Dose { path: "rolling.pp", weak: 0.06, strong: 0.15, along: &["rolling.mantle"], law: "" },
    Dose {
        path: "cohesion.energy_density_j_m3",
        weak: 6000.0,
        strong: 9_000.0,
        along: &[],
        law: "contact = { cohesion = \"simplified_jkr\" }",
    },
    Dose { path: "friction.mantle", weak: 0.3, strong: 0.15, along: &[], law: "" },
    Dose { path: "fill.scale", weak: 0.9, strong: 1.15, along: &[], law: "" },
    Dose { path: "wall_layer.thickness_m", weak: 0.0015, strong: 0.003, along: &[], law: "" },
    Dose { path: "shape.aspect_ratio", weak: 1.2, strong: 1.5, along: &[], law: "" },
    Dose { path: "speed.scale", weak: 0.75, strong: 1.35, along: &[], law: "" },
    Dose { path: "camera.roll_deg", weak: 2.0, strong: -4.0, along: &[], law: "" },
];

/// Frictions between particles that drums have.
const FRICTIONS: [f64; 2] = [0.3, 0.45];

/// One case before it has a name.
pub(crate) fn truth(kind: &str, code: &str, friction: f64, effects: &[(&str, f64)]) -> Truth {
    Truth {
        case: String::new(),
        kind: kind.to_owned(),
        code: code.to_owned(),
        frictions: vec![("friction.pp".to_owned(), friction)],
        effects: effects.iter().map(|(p, v)| ((*p).to_owned(), *v)).collect(),
    }
}

/// All cases of the study, in an order that tells nothing.
pub(crate) fn all(seed: u64) -> Vec<Truth> {
    let mut list = Vec::new();
    let mut add = |kind: &str, effects: &[(&str, f64)]| {
        let friction = FRICTIONS[list.len() % FRICTIONS.len()];
        list.push(truth(kind, "tumble", friction, effects));
    };
    for d in &DOSES {
        add("single", &[(d.path, d.weak)]);
        add("single", &[(d.path, d.strong)]);
    }
    for _ in 0..4 {
        add("null", &[]);
    }
    let strong = |k: usize| (DOSES[k].path, DOSES[k].strong);
    for k in [0, 1, 4, 7] {
        add("removed", &[strong(k)]);
    }
    for (a, b) in [(1, 3), (0, 6)] {
        add("pair", &[strong(a), strong(b)]);
    }
    hide(&mut list, seed, 0);
    let mut more = second();
    hide(&mut more, seed, list.len());
    list.extend(more);
    list
}

/// Cases of a second round, most of them run by another code.
fn second() -> Vec<Truth> {
    let rolling = "rolling.pp";
    let cohesion = "cohesion.energy_density_j_m3";
    let (fill, layer, speed) = ("fill.scale", "wall_layer.thickness_m", "speed.scale");
    let smooth = "friction.mantle";
    let other = "liggghts";
    vec![
        truth("single", other, 0.3, &[(rolling, 0.06)]),
        truth("single", other, 0.45, &[(rolling, 0.15)]),
        truth("single", other, 0.45, &[(cohesion, 6000.0)]),
        truth("single", other, 0.3, &[(cohesion, 9000.0)]),
        truth("single", other, 0.3, &[(fill, 0.9)]),
        truth("single", other, 0.45, &[(fill, 1.15)]),
        truth("single", other, 0.3, &[(layer, 0.003)]),
        truth("single", other, 0.45, &[(speed, 0.75)]),
        truth("single", other, 0.3, &[("camera.roll_deg", -4.0)]),
        truth("single", "tumble", 0.3, &[(cohesion, 9000.0)]),
        truth("single", "tumble", 0.45, &[(smooth, 0.2)]),
        truth("null", other, 0.3, &[]),
        truth("null", other, 0.45, &[]),
        truth("removed", other, 0.45, &[(rolling, 0.15)]),
        truth("removed", other, 0.3, &[(fill, 1.15)]),
        truth("removed", "tumble", 0.3, &[("shape.aspect_ratio", 1.5)]),
        truth("removed", "tumble", 0.45, &[(speed, 1.35)]),
        truth("pair", "tumble", 0.3, &[(smooth, 0.15), (fill, 1.15)]),
        truth("pair", "tumble", 0.45, &[(rolling, 0.15), ("camera.roll_deg", -4.0)]),
    ]
}

/// Order by a hash, so that neighbours in name are not neighbours in kind, and name.
fn hide(list: &mut [Truth], seed: u64, first: usize) {
    list.sort_by_key(|t| *blake3::hash(format!("{seed} {t:?}").as_bytes()).as_bytes());
    for (k, t) in list.iter_mut().enumerate() {
        t.case = format!("case_{:02}", first + k);
    }
}
