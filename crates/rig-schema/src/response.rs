//! The four numbers that a picture of a turning drum gives.

use std::fmt;

/// A response: what is measured on a photograph or a simulated frame.
///
/// ```
/// use rig_schema::Response;
/// assert_eq!(Response::AorMid.column(), "aor_mid_deg");
/// assert_eq!(Response::from_column("cen_x_pct"), Some(Response::CenX));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Response {
    /// Angle of the least-squares line through the whole bed surface, degrees.
    AorLin,
    /// Angle of the line through the second and third quarter of the surface, degrees.
    AorMid,
    /// Distance of the bed's centre of area from the axis towards the raised side, percent of the
    /// drum's radius.
    CenX,
    /// Distance of the bed's centre of area below the axis, percent of the drum's radius.
    CenY,
}

impl Response {
    /// All four, in the order of every table and covariance.
    pub const ALL: [Self; 4] = [Self::AorLin, Self::AorMid, Self::CenX, Self::CenY];

    /// Position in [`Response::ALL`].
    pub fn index(self) -> usize {
        self as usize
    }

    /// Column of the mean in a table of responses.
    pub fn column(self) -> &'static str {
        ["aor_lin_deg", "aor_mid_deg", "cen_x_pct", "cen_y_pct"][self.index()]
    }

    /// Column of the standard deviation over the frames.
    pub fn sd_column(self) -> &'static str {
        ["aor_lin_sd", "aor_mid_sd", "cen_x_sd", "cen_y_sd"][self.index()]
    }

    /// Short name used in keys that join two responses (`cov_lin_mid`).
    pub fn short(self) -> &'static str {
        ["lin", "mid", "x", "y"][self.index()]
    }

    /// The largest that it can be, to either side: a slope is at most upright, a centre of area within the drum.
    pub fn most(self) -> f64 {
        [90.0, 90.0, 100.0, 100.0][self.index()]
    }

    /// Unit for labels.
    pub fn unit(self) -> &'static str {
        ["deg", "deg", "% R", "% R"][self.index()]
    }

    /// Name for labels in a picture.
    pub fn label(self) -> &'static str {
        ["AoR whole", "AoR middle", "centre x", "centre y"][self.index()]
    }

    /// Name for headings.
    pub fn title(self) -> &'static str {
        [
            "angle of repose, whole",
            "angle of repose, middle",
            "centre of area, x",
            "centre of area, y",
        ][self.index()]
    }

    /// The response whose mean stands in `column`.
    pub fn from_column(column: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|r| r.column() == column)
    }
}

impl fmt::Display for Response {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.column())
    }
}
