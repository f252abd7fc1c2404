//! Where the inner edge of a blurred ring lies: a box of redness, blurred by a Gaussian, fitted to the mean profile.
//!
//! On a ring hardly wider than the blur the crest is lower than the ring's own redness, so that the point of half
//! the crest lies inside of the edge: with a width of 2.5 standard deviations by 0.25 of them. The model
//! `base + A/2 (erf((r - a) / (s sqrt 2)) - erf((r - b) / (s sqrt 2)))` has its edge at `a`.

use statrs::function::erf::erf;

use super::circle_fit::Circle;
use crate::frame::Plane;
use crate::linear::solve_normal;

/// Mean redness over the circumference against `r - radius`, from `-reach` to `+reach` in steps of half a pixel.
///
/// Of every four rays the one in the middle of the sorted values counts, so that a reflex on the ring does not.
#[must_use]
pub fn mean_profile(redness: &Plane, circle: Circle, reach: f64) -> Vec<(f64, f64)> {
    let rays = super::rim::ray_count(circle.radius_px);
    let n = (4.0 * reach).ceil() as usize + 1;
    let directions: Vec<(f64, f64)> = (0..rays)
        .map(|k| (std::f64::consts::TAU * k as f64 / rays as f64).sin_cos())
        .map(|(s, c)| (c, s))
        .collect();
    (0..n)
        .map(|k| {
            let d = 0.5 * k as f64 - reach;
            let r = circle.radius_px + d;
            let mut values: Vec<f64> = directions
                .iter()
                .map(|(c, s)| (circle.x_px + r * c, circle.y_px + r * s))
                .filter(|(x, y)| {
                    *x >= 0.0
                        && *y >= 0.0
                        && *x <= (redness.width - 1) as f64
                        && *y <= (redness.height - 1) as f64
                })
                .map(|(x, y)| redness.sample(x, y))
                .collect();
            values.sort_by(f64::total_cmp);
            // The middle half of the values.
            let (a, b) = (values.len() / 4, values.len() - values.len() / 4);
            (d, crate::statistics::mean(&values[a..b]).unwrap_or(0.0))
        })
        .collect()
}

/// Offset of the box's inner edge from the profile's origin and the blur's standard deviation, pixels.
///
/// `None` when the profile is no such ring or the fit does not settle.
#[must_use]
pub fn inner_edge(profile: &[(f64, f64)]) -> Option<(f64, f64)> {
    let crest = (0..profile.len()).max_by(|&a, &b| profile[a].1.total_cmp(&profile[b].1))?;
    let low = profile.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let half = 0.5 * (profile[crest].1 + low);
    let inner = profile[..crest].iter().rposition(|p| p.1 < half)?;
    let outer = crest + profile[crest..].iter().position(|p| p.1 < half)?;
    // Parameters: inner edge, width, blur, amplitude, base.
    let mut p = [
        profile[inner].0 + 0.25,
        profile[outer].0 - profile[inner].0,
        0.7,
        profile[crest].1 - low,
        low,
    ];
    let model = |p: &[f64; 5], r: f64| {
        let s = p[2] * std::f64::consts::SQRT_2;
        p[4] + 0.5 * p[3] * (erf((r - p[0]) / s) - erf((r - p[0] - p[1]) / s))
    };
    let misfit = |p: &[f64; 5]| profile.iter().map(|q| (q.1 - model(p, q.0)).powi(2)).sum::<f64>();
    let mut damping = 1e-3;
    let mut now = misfit(&p);
    for _ in 0..60 {
        let mut normal = [[0.0; 5]; 5];
        let mut right = [0.0; 5];
        for q in profile {
            let base = model(&p, q.0);
            let row: [f64; 5] = std::array::from_fn(|k| {
                let h = if k < 3 { 1e-4 } else { 1e-2 };
                let mut moved = p;
                moved[k] += h;
                (model(&moved, q.0) - base) / h
            });
            for i in 0..5 {
                right[i] += row[i] * (q.1 - base);
                for j in 0..5 {
                    normal[i][j] += row[i] * row[j];
                }
            }
        }
        for (k, row) in normal.iter_mut().enumerate() {
            row[k] *= 1.0 + damping;
            row[k] += 1e-12;
        }
        let step = solve_normal(&normal, &right)?;
        let mut next = p;
        next.iter_mut().zip(step).for_each(|(v, s)| *v += s);
        next[2] = next[2].clamp(0.15, 20.0);
        next[1] = next[1].clamp(0.3, 1e4);
        let then = misfit(&next);
        if then < now {
            let settled = now - then < 1e-9 * now;
            (p, now) = (next, then);
            damping = (0.3 * damping).max(1e-9);
            if settled {
                break;
            }
        } else {
            damping *= 8.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    let rms = (now / profile.len() as f64).sqrt();
    let reach = profile[profile.len() - 1].0;
    (rms < 0.12 * p[3] && p[0].abs() < 0.6 * reach && p[3] > 10.0).then_some((p[0], p[2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_edge_of_a_narrow_blurred_ring_is_found() {
        let (edge, width, blur) = (0.3, 4.0, 1.8);
        let s = blur * std::f64::consts::SQRT_2;
        let profile: Vec<(f64, f64)> = (0..49)
            .map(|k| 0.5 * f64::from(k) - 12.0)
            .map(|r| (r, 90.0 * 0.5 * (erf((r - edge) / s) - erf((r - edge - width) / s))))
            .collect();
        let (a, b) = inner_edge(&profile).unwrap();
        // The profile is the model itself: only the settling of the fit is left.
        assert!((a - edge).abs() < 1e-3 && (b - blur).abs() < 1e-3, "{a} {b}");
    }
}
