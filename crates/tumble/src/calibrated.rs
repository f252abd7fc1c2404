//! Parameters that a calibration or a closed loop has found, from the JSON that it wrote.

use std::path::Path;

use serde_json::Value;

use crate::input::{self, InputError};

/// Paths and values of `result.json` (`tumble calibrate`) or `closed_loop.json` (`tumble close-loop`): where an effect is named
/// the frictions that were fitted with it and its strength, else the calibrated ones.
pub(crate) fn settings(path: &Path) -> anyhow::Result<Vec<(String, f64)>> {
    let text = input::read(path)?;
    let found = serde_json::from_str(&text.text).ok().and_then(|result| of(&result));
    let unknown = || InputError::NotCalibrated { path: text.name };
    Ok(found.filter(|found| !found.is_empty()).ok_or_else(unknown)?)
}

fn of(result: &Value) -> Option<Vec<(String, f64)>> {
    if let Some(detail) = result.get("detail") {
        let named = matches!(result.get("verdict")?.as_str()?, "effect" | "class");
        let with = detail.get("after").filter(|after| named && !after.is_null());
        return pairs(match with {
            Some(after) => after.get("at")?,
            None => detail.get("calibrated")?,
        });
    }
    let all = result.get("friction")?.as_array()?;
    let joint = all.iter().find(|f| f.get("omega_rpm").is_some_and(Value::is_null))?;
    let mut found = vec![("friction.pp".to_owned(), joint.get("mu_pp")?.as_f64()?)];
    if let Some(wall) = result.get("mu_wall").filter(|wall| !wall.is_null()) {
        found.push(("friction.mantle".to_owned(), wall.get("value")?.as_f64()?));
    }
    Some(found)
}

/// Rows that begin with a path and a value.
fn pairs(rows: &Value) -> Option<Vec<(String, f64)>> {
    let pair = |row: &Value| {
        let row = row.as_array()?;
        Some((row.first()?.as_str()?.to_owned(), row.get(1)?.as_f64()?))
    };
    rows.as_array()?.iter().map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Option<Vec<(String, f64)>> {
        of(&serde_json::from_str(text).unwrap())
    }

    #[test]
    fn an_effect_comes_with_its_own_friction_and_nothing_with_the_calibrated_one() {
        let closed = |verdict: &str| {
            found(&format!(
                r#"{{"verdict": "{verdict}", "detail": {{"calibrated": [["friction.pp", 0.8, null]],
                "after": {{"at": [["friction.pp", 0.26], ["cohesion.energy_density_j_m3", 9104.0]]}}}}}}"#
            ))
            .unwrap()
        };
        let with = [("friction.pp", 0.26), ("cohesion.energy_density_j_m3", 9104.0)];
        let own = |of: &[(&str, f64)]| -> Vec<(String, f64)> {
            of.iter().map(|(p, v)| ((*p).to_owned(), *v)).collect()
        };
        assert_eq!(closed("effect"), own(&with));
        assert_eq!(closed("class"), own(&with));
        assert_eq!(closed("none"), own(&[("friction.pp", 0.8)]));
        assert_eq!(closed("unknown"), own(&[("friction.pp", 0.8)]));
    }

    #[test]
    fn a_calibration_gives_the_friction_of_all_speeds() {
        let text = r#"{"friction": [{"omega_rpm": 4.0, "mu_pp": 0.2}, {"omega_rpm": null, "mu_pp": 0.3}],
            "mu_wall": {"value": 0.7}}"#;
        let expected = [("friction.pp".to_owned(), 0.3), ("friction.mantle".to_owned(), 0.7)];
        assert_eq!(found(text).unwrap(), expected);
        assert_eq!(found(r#"{"cases": []}"#), None);
    }
}
