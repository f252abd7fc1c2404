//! "Background" mode: the surface from a person's polygon and grey window, for powdery drums.
//!
//! After section 4.4 of the thesis: inside of the polygon the pixels within the grey window count as bed, and
//! so does everything below the topmost of them in its column; the drum's circle cuts the rest.

use super::columns::curve_of_mask;
use super::edge::Curve;
use super::prepare::Prepared;
use crate::config::VisionConfig;
use crate::error::VisionError;
use crate::filter::median::{median_binary, median_u8};
use crate::frame::{Frame, Window};
use crate::sidecar::RegionSidecar;

/// Traces the surface inside of a region.
///
/// # Errors
/// [`VisionError::RegionEmpty`], [`VisionError::Invalid`] for a region drawn on a frame of another size, and
/// the errors of a traced surface.
pub fn trace_region(
    frame: &Frame,
    prepared: &Prepared,
    region: &RegionSidecar,
    config: &VisionConfig,
) -> Result<Curve, VisionError> {
    region.check()?;
    let (fw, fh) = (frame.width(), frame.height());
    if let Some([w, h]) = region.size_px
        && (w as usize, h as usize) != (fw, fh)
    {
        return Err(VisionError::Invalid {
            what: "size_px",
            detail: format!("region drawn on {w} x {h} pixels, frame has {fw} x {fh}"),
        });
    }
    let (w, h) = (prepared.plane.width, prepared.plane.height);
    let (x0, y0) = prepared.origin_px;
    let window = Window { x0: x0 as usize, y0: y0 as usize, width: w, height: h };
    let side = super::prepare::default_window(prepared.circle.radius_px);
    let grey = median_u8(&frame.grey(window).to_u8(), w, h, side, side);
    let c = prepared.circle;
    let [low, high] = region.window;
    let mut mask = vec![false; w * h];
    let mut inside = 0usize;
    for y in 0..h {
        for x in 0..w {
            let r = (x as f64 - c.x_px).hypot(y as f64 - c.y_px);
            if r < c.radius_px && region.contains(x as f64 + x0, y as f64 + y0) {
                inside += 1;
                mask[y * w + x] = (low..=high).contains(&grey[y * w + x]);
            }
        }
    }
    if inside == 0 {
        return Err(VisionError::RegionEmpty);
    }
    let majority = ((10.0 * c.radius_px / 450.0).round() as usize).max(3);
    let clean = median_binary(&mask, w, h, majority);
    let mut filled = vec![false; w * h];
    let limit = 0.985 * c.radius_px;
    for x in 0..w {
        let Some(top) = (0..h).find(|&y| clean[y * w + x]) else {
            continue;
        };
        for y in top..h {
            let r = (x as f64 - c.x_px).hypot(y as f64 - c.y_px);
            filled[y * w + x] = r < limit && (r > prepared.hub_px || prepared.hub_px == 0.0);
        }
    }
    let mut curve = curve_of_mask(&filled, prepared, config, 1)?;
    // A person follows the surface to a pixel or two between corners; the scatter of columns does not show that.
    curve.level_shift_px.fill(0.4);
    curve.level_scatter = 1.0;
    Ok(curve)
}
