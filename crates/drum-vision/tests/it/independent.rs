//! A hundred frames of another renderer (fixtures/film/independent.py: numpy, SciPy and Pillow, another curve, another texture).

use drum_vision::{Context, VisionConfig, decode, measure_frame};
use rayon::prelude::*;

use crate::other_renderer::rows;
use crate::scenes::quantile;

#[test]
fn frames_of_another_renderer_are_read_within_the_limits() {
    let Some(rows) = rows() else { return };
    assert_eq!(rows.len(), 100);
    let config = VisionConfig::default();
    let all: Vec<_> = rows
        .par_iter()
        .map(|row| {
            let frame = decode::decode_file(&row.path, &config.decode).unwrap();
            measure_frame(&frame, &config, Context::default())
        })
        .collect();
    // Limits of clean and degraded frames in deg and % R; 5 % of the degraded ones may be refused.
    for (degraded, angle, centre, refused) in [(false, 0.15, 0.2, 0), (true, 0.5, 0.5, 2)] {
        let chosen: Vec<_> =
            rows.iter().zip(&all).filter(|(r, _)| r.degraded == degraded).collect();
        let good: Vec<_> =
            chosen.iter().filter_map(|(r, m)| m.as_ref().ok().map(|m| (*r, m))).collect();
        assert!(chosen.len() - good.len() <= refused);
        let mut covered = 0;
        for k in 0..4 {
            let errors: Vec<f64> =
                good.iter().map(|(r, m)| (m.four()[k].value - r.truth[k]).abs()).collect();
            let limit = if k < 2 { angle } else { centre };
            let p95 = quantile(&errors, 0.95);
            assert!(p95 <= limit, "degraded {degraded}, response {k}: {p95}");
            covered +=
                good.iter().zip(&errors).filter(|((_, m), e)| **e <= 2.0 * m.four()[k].sd).count();
        }
        let share = covered as f64 / (4 * good.len()) as f64;
        assert!((0.9..=1.0).contains(&share), "degraded {degraded}: covered {share}");
        for (r, m) in &good {
            let c = m.drum.fit.circle;
            // A fifth of a pixel of 118 to 136; JPEG rounds the ring's colour in blocks.
            assert!(
                (c.x_px - r.circle[0]).hypot(c.y_px - r.circle[1]) < 0.2,
                "{}",
                r.path.display()
            );
            assert!((c.radius_px - r.circle[2]).abs() < 0.3, "{}: {c:?}", r.path.display());
        }
    }
}
