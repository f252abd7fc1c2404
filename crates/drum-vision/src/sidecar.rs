//! The region side-car: what a person points out on a frame that no threshold can read.

use crate::error::VisionError;
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

/// A polygon around the bed and the grey window that belongs to it.
///
/// The polygon needs care only along the free surface: elsewhere it may run outside of the
/// drum, whose circle cuts it. Written as TOML or JSON beside the frame:
///
/// ```
/// let text = r#"
/// polygon_px = [[20.0, 60.5], [80.0, 30.0], [110.0, 120.0], [15.0, 110.0]]
/// window = [90, 255]
/// "#;
/// let region = drum_vision::RegionSidecar::from_text(text)?;
/// assert_eq!(region.window, [90, 255]);
/// # Ok::<(), drum_vision::VisionError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct RegionSidecar {
    /// Name of the frame on which it was drawn; for the reader, not checked.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub image: Option<String>,
    /// Width and height of that frame, pixels; a frame of another size is refused.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub size_px: Option<[u32; 2]>,
    /// Corners, column and row in pixels of the frame (centres at whole numbers).
    pub polygon_px: Vec<[f64; 2]>,
    /// Lowest and highest grey level (0 to 255) that counts as bed within the polygon.
    pub window: [u8; 2],
    /// Drum circle given along with the region, if the frame does not show one: centre column, row and radius.
    #[cfg_attr(feature = "serde", serde(default, skip_serializing_if = "Option::is_none"))]
    pub circle_px: Option<[f64; 3]>,
}

impl RegionSidecar {
    /// Checks corners and window.
    ///
    /// # Errors
    /// [`VisionError::Invalid`] names what is wrong.
    pub fn check(&self) -> Result<(), VisionError> {
        let bad = |what, detail: String| Err(VisionError::Invalid { what, detail });
        if self.polygon_px.len() < 3 || self.polygon_px.len() > 10_000 {
            let n = self.polygon_px.len();
            return bad("polygon_px", format!("{n} corners, expected 3 to 10000"));
        }
        if let Some(p) = self.polygon_px.iter().find(|p| !p.iter().all(|v| v.abs() < 1e6)) {
            return bad("polygon_px", format!("corner {p:?} is not a pixel position"));
        }
        if self.window[0] >= self.window[1] {
            let [lo, hi] = self.window;
            return bad("window", format!("[{lo}, {hi}], expected the lower level first"));
        }
        if let Some([x, y, r]) = self.circle_px
            && !(x.is_finite() && y.is_finite() && r.is_finite() && r >= 8.0)
        {
            return bad(
                "circle_px",
                format!("[{x}, {y}, {r}], expected centre and radius in pixels"),
            );
        }
        Ok(())
    }

    /// Reads TOML or JSON (recognised by its first brace).
    ///
    /// # Errors
    /// [`VisionError::Parse`] with the parser's message, or [`VisionError::Invalid`].
    #[cfg(feature = "serde")]
    pub fn from_text(text: &str) -> Result<Self, VisionError> {
        let parse = |detail| VisionError::Parse { what: "region side-car".into(), detail };
        let region: Self = if text.trim_start().starts_with('{') {
            serde_json::from_str(text).map_err(|e| parse(e.to_string()))?
        } else {
            toml::from_str(text).map_err(|e| parse(e.to_string()))?
        };
        region.check()?;
        Ok(region)
    }

    /// Reads a side-car file.
    ///
    /// # Errors
    /// [`VisionError::Read`], or as [`RegionSidecar::from_text`].
    #[cfg(feature = "serde")]
    pub fn from_file(path: &std::path::Path) -> Result<Self, VisionError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| VisionError::Read { path: path.to_path_buf(), source })?;
        Self::from_text(&text)
    }

    /// Whether a point lies inside of the polygon (even-odd rule).
    #[must_use]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        let n = self.polygon_px.len();
        let mut inside = false;
        for k in 0..n {
            let ([ax, ay], [bx, by]) = (self.polygon_px[k], self.polygon_px[(k + 1) % n]);
            if (ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax) {
                inside = !inside;
            }
        }
        inside
    }
}
