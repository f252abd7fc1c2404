//! Table of what another code says of drums that are alike (CSV).

use crate::sheet::Sheet;
use crate::{Response, SchemaError};

/// Responses of another code less those of this one, for drums that lack nothing.
///
/// ```
/// use rig_schema::CodeDifferences;
/// let table = "pair,omega_rpm,aor_lin_deg,aor_mid_deg,cen_x_pct,cen_y_pct
/// 1,20,0.3,0.4,0.1,-0.2
/// 1,60,0.5,0.6,0.2,-0.1
/// ";
/// let d = CodeDifferences::parse("codes.csv", table)?;
/// assert_eq!(d.speeds_rpm, [20.0, 60.0]);
/// assert_eq!(d.pairs[0][1][0], 0.5);
/// # Ok::<(), rig_schema::SchemaError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CodeDifferences {
    /// Name of the file.
    pub file: String,
    /// Speeds that every pair has, ascending, rpm.
    pub speeds_rpm: Vec<f64>,
    /// For each pair of drums and each speed the four responses, deg, deg, % of R, % of R.
    pub pairs: Vec<Vec<[f64; 4]>>,
}

/// Rows of one pair.
struct Pair {
    name: f64,
    /// Line of the first.
    line: usize,
    /// By speed, rpm.
    rows: Vec<(f64, [f64; 4])>,
}

impl Pair {
    fn speeds(&self) -> Vec<f64> {
        self.rows.iter().map(|r| r.0).collect()
    }
}

impl CodeDifferences {
    /// Read a table; `file` is its name for errors.
    ///
    /// # Errors
    /// [`SchemaError`] for a missing or unknown column, a cell that is no finite number, a speed that stands
    /// twice in a pair, pairs with different speeds, or no rows.
    pub fn parse(file: &str, text: &str) -> Result<Self, SchemaError> {
        let mut known: Vec<&str> = vec!["pair", "omega_rpm"];
        known.extend(Response::ALL.iter().map(|r| r.column()));
        let sheet = Sheet::parse(file, text, &known)?;
        known.iter().try_for_each(|column| sheet.require(column))?;
        let mut pairs: Vec<Pair> = Vec::new();
        for record in &sheet.records {
            let name = sheet.number(record, "pair")?;
            let omega_rpm = sheet.positive(record, "omega_rpm")?;
            let mut four = [0.0; 4];
            for r in Response::ALL {
                four[r.index()] = sheet.number(record, r.column())?;
            }
            let at = pairs.iter().position(|p| p.name == name).unwrap_or_else(|| {
                pairs.push(Pair { name, line: record.line, rows: Vec::new() });
                pairs.len() - 1
            });
            let rows = &mut pairs[at].rows;
            if rows.iter().any(|r| r.0 == omega_rpm) {
                return Err(sheet.fault(
                    record,
                    format!("speed {omega_rpm} rpm stands twice in pair {name}"),
                    "one row a speed in each pair",
                ));
            }
            rows.push((omega_rpm, four));
        }
        pairs.iter_mut().for_each(|p| p.rows.sort_by(|a, b| a.0.total_cmp(&b.0)));
        let speeds_rpm = pairs[0].speeds();
        if let Some(other) = pairs.iter().find(|p| p.speeds() != speeds_rpm) {
            return Err(sheet.fault_at(
                other.line,
                format!("pair {} has other speeds than pair {}", other.name, pairs[0].name),
                "every pair at the same speeds",
            ));
        }
        let pairs = pairs.into_iter().map(|p| p.rows.into_iter().map(|r| r.1).collect()).collect();
        Ok(Self { file: file.to_owned(), speeds_rpm, pairs })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "pair,omega_rpm,aor_lin_deg,aor_mid_deg,cen_x_pct,cen_y_pct\n";

    #[test]
    fn pairs_are_gathered_and_sorted_by_speed() {
        let rows = "1,60,0.5,0.6,0.2,-0.1\n2,20,1,1,1,1\n1,20,0.3,0.4,0.1,-0.2\n2,60,2,2,2,2\n";
        let d = CodeDifferences::parse("codes.csv", &format!("{HEADER}{rows}")).unwrap();
        assert_eq!(d.speeds_rpm, [20.0, 60.0]);
        assert_eq!(d.pairs, [[[0.3, 0.4, 0.1, -0.2], [0.5, 0.6, 0.2, -0.1]], [[1.0; 4], [2.0; 4]]]);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        for (rows, line, what) in [
            ("1,20,0,0,0,0\n2,30,0,0,0,0\n", 3, "other speeds"),
            ("1,20,0,0,0,0\n1,20,0,0,0,0\n", 3, "stands twice"),
            ("1,-4,0,0,0,0\n", 2, "not above 0"),
            ("1,20,0,,0,0\n", 2, "no value"),
        ] {
            let e = CodeDifferences::parse("codes.csv", &format!("{HEADER}{rows}")).unwrap_err();
            let text = e.to_string();
            assert!(text.contains(what) && text.contains(&format!("codes.csv:{line}")), "{text}");
        }
        assert!(CodeDifferences::parse("codes.csv", HEADER).is_err());
        let short = "pair,omega_rpm,aor_lin_deg\n1,20,0\n";
        let text = CodeDifferences::parse("codes.csv", short).unwrap_err().to_string();
        assert!(text.contains("aor_mid_deg"), "{text}");
    }
}
