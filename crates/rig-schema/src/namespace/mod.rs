//! The one namespace of parameters.
//!
//! The table is data: a new effect is a new row. The crate that acts on a layer maps its paths
//! to its own fields and tests that it knows every one of them.

mod camera;
mod measurement;
mod physics;

use crate::Parameter;
#[cfg(test)]
use crate::Sign;

/// Every parameter of the layer that moves particles.
pub use physics::PHYSICS;

/// Every parameter of the camera.
pub use camera::CAMERA;

/// Every parameter of measuring.
pub use measurement::MEASUREMENT;

/// All tables of parameters, physics first.
pub const PARAMETERS: [&[Parameter]; 3] = [PHYSICS, CAMERA, MEASUREMENT];

/// All parameters in the order of declaration.
pub fn iter() -> impl Iterator<Item = &'static Parameter> {
    PARAMETERS.into_iter().flatten()
}

/// The parameter with this path, if declared.
pub fn find(path: &str) -> Option<&'static Parameter> {
    iter().find(|p| p.path == path)
}

/// Names of the groups (first half of a path), each once, in the order of declaration.
pub fn groups() -> Vec<&'static str> {
    let mut groups = Vec::new();
    for p in iter() {
        if !groups.contains(&p.group()) {
            groups.push(p.group());
        }
    }
    groups
}

/// The declared path most like `path`, for an error that helps.
///
/// ```
/// assert_eq!(rig_schema::namespace::nearest("friction.p"), "friction.pp");
/// ```
pub fn nearest(path: &str) -> &'static str {
    let mut best = ("friction.pp", f64::MIN);
    for p in iter() {
        let likeness = strsim::normalized_damerau_levenshtein(path, p.path);
        if likeness > best.1 {
            best = (p.path, likeness);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_path_is_unique_and_has_a_group_and_a_name() {
        let mut seen = std::collections::BTreeSet::new();
        for p in iter() {
            assert!(seen.insert(p.path), "{} twice", p.path);
            assert!(!p.group().is_empty() && !p.name().is_empty(), "{}", p.path);
            assert!(p.range.0 < p.range.1, "{}", p.path);
            assert!(!p.meaning.is_empty() && !p.unit.is_empty(), "{}", p.path);
        }
    }

    #[test]
    fn nominal_values_lie_in_range_and_leave_room_on_the_side_of_the_sign() {
        for p in iter() {
            let Some(nominal) = p.nominal else { continue };
            assert!(p.accepts(nominal), "{}", p.path);
            let room = match p.sign {
                Sign::Positive => p.range.1 > nominal,
                Sign::Negative => p.range.0 < nominal,
                Sign::Either => p.range.0 < nominal && nominal < p.range.1,
            };
            assert!(room, "{}", p.path);
        }
    }
}
