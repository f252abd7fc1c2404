//! Faint reflexes on the surface: stretches that are brighter than the rest of it.
//!
//! A reflex on the front plate only adds light. Saturated ones are hidden pixel by pixel ([`super::prepare`]); one that
//! is not saturated shows as a stretch of the surface on which the background beside the edge, or the brightest part of the line
//! across it, lies above what the other lines show. What varies along the whole surface (powder, grains, uneven light)
//! raises the scatter and with it the bar.
//!
//! Such stretches are measured like any other (without them most surfaces are read worse), but they are reported and
//! carry an uncertainty of their own.

use crate::statistics::median_in_place;

/// One line across the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trace {
    /// Place along the surface, pixels.
    pub(crate) u: f64,
    /// Grey above the edge and of the line's brightest part, where seen.
    pub(crate) greys: [Option<f64>; 2],
}

/// Excess over the trend that makes a reflex, robust standard deviations.
const SIGMAS: f64 = 5.0;
/// The least such excess, fraction of the contrast (difference of the two traces).
const LEAST: f64 = 0.15;
/// Length over which a trace is averaged, and the least length of a reflex, fraction of the radius.
const LENGTH: f64 = 0.03;

/// Stretches `(from, to)` of the surface that a reflex lights, flanks included.
pub(crate) fn lit_stretches(traces: &[Trace], radius: f64) -> Vec<(f64, f64)> {
    let typical = |k: usize| {
        let mut held: Vec<f64> = traces.iter().filter_map(|t| t.greys[k]).collect();
        median_in_place(&mut held)
    };
    let (Some(dark), Some(bright)) = (typical(0), typical(1)) else {
        return Vec::new();
    };
    let least = LEAST * (bright - dark).abs();
    let mut lit = vec![false; traces.len()];
    for k in 0..2 {
        let points = averaged(traces, k, 0.5 * LENGTH * radius);
        let Some((trend, scatter)) = robust_line(&points) else { continue };
        let bar = (SIGMAS * scatter).max(least);
        for &(i, u, grey) in &points {
            lit[i] |= grey - (trend[0] + trend[1] * u) > bar;
        }
    }
    let mut runs: Vec<(f64, f64)> = Vec::new();
    for (t, _) in traces.iter().zip(&lit).filter(|(_, l)| **l) {
        match runs.last_mut() {
            Some(run) if t.u - run.1 < LENGTH * radius => run.1 = t.u,
            _ => runs.push((t.u, t.u)),
        }
    }
    // Flanks: a bell whose crest is seen over a length goes on for half of it at either side.
    runs.into_iter()
        .filter(|r| r.1 - r.0 > 0.5 * LENGTH * radius)
        .map(|r| {
            let flank = (0.5 * (r.1 - r.0)).max(LENGTH * radius);
            (r.0 - flank, r.1 + flank)
        })
        .collect()
}

/// Index, place and mean grey of the lines within `reach` of each line.
fn averaged(traces: &[Trace], k: usize, reach: f64) -> Vec<(usize, f64, f64)> {
    traces
        .iter()
        .enumerate()
        .filter_map(|(i, t)| {
            let from = traces.partition_point(|o| o.u < t.u - reach);
            let to = traces.partition_point(|o| o.u <= t.u + reach);
            let held: Vec<f64> = traces[from..to].iter().filter_map(|o| o.greys[k]).collect();
            crate::statistics::mean(&held).map(|grey| (i, t.u, grey))
        })
        .collect()
}

/// Line of least moduli and the robust standard deviation about it.
fn robust_line(points: &[(usize, f64, f64)]) -> Option<([f64; 2], f64)> {
    if points.len() < 16 {
        return None;
    }
    let mut weights = vec![1.0; points.len()];
    let mut line = [0.0; 2];
    let mut scatter = 0.0;
    for _ in 0..20 {
        let (mut n, mut su, mut sg, mut suu, mut sug) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (&(_, u, g), w) in points.iter().zip(&weights) {
            n += w;
            su += w * u;
            sg += w * g;
            suu += w * u * u;
            sug += w * u * g;
        }
        let det = n * suu - su * su;
        if det <= 0.0 {
            return None;
        }
        line[1] = (n * sug - su * sg) / det;
        line[0] = (sg - line[1] * su) / n;
        let mut moduli: Vec<f64> =
            points.iter().map(|&(_, u, g)| (g - line[0] - line[1] * u).abs()).collect();
        weights = moduli.iter().map(|m| 1.0 / m.max(0.3)).collect();
        scatter = 1.4826 * median_in_place(&mut moduli)?;
    }
    Some((line, scatter))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bright_stretch_is_found_and_even_light_is_not() {
        let trace = |extra: f64| -> Vec<Trace> {
            (0..400)
                .map(|k| {
                    let u = f64::from(k) - 200.0;
                    let spot = extra * (-0.5 * ((u - 50.0) / 15.0).powi(2)).exp();
                    let ripple = 2.0 * (0.7 * u).sin();
                    let light = 30.0 + 0.02 * u + ripple + spot;
                    Trace { u, greys: [Some(light), Some(light + 150.0)] }
                })
                .collect()
        };
        assert!(lit_stretches(&trace(0.0), 200.0).is_empty());
        let found = lit_stretches(&trace(60.0), 200.0);
        assert_eq!(found.len(), 1);
        assert!(found[0].0 < 35.0 && found[0].1 > 65.0, "{found:?}");
    }
}
