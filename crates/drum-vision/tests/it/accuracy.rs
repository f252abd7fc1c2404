//! Errors on frames of known silhouette stay within the stated limits; a larger set is printed by the example `accuracy`.

use drum_vision::VisionConfig;
use rayon::prelude::*;

use crate::scenes::{self, Case, Outcome, quantile};

const SIZE: (u32, u32) = (484, 324);

fn outcomes(make: fn(u64, (u32, u32)) -> Case, n: u64) -> (Vec<Outcome>, usize) {
    let config = VisionConfig::default();
    let all: Vec<_> = (1000..1000 + n)
        .into_par_iter()
        .map(|k| scenes::outcome(&make(k, SIZE), &config))
        .collect();
    let total = all.len();
    let good: Vec<Outcome> = all.into_iter().filter_map(Result::ok).collect();
    let rejected = total - good.len();
    (good, rejected)
}

fn error(all: &[Outcome], k: usize, p: f64) -> f64 {
    quantile(&all.iter().map(|o| o.error[k].abs()).collect::<Vec<_>>(), p)
}

#[track_caller]
fn covers(all: &[Outcome]) {
    for k in 0..4 {
        let inside = all.iter().filter(|o| o.error[k].abs() <= 2.0 * o.sd[k]).count();
        let share = inside as f64 / all.len() as f64;
        // 92 to 97 % were seen on 500 frames of this size (VALIDATION.md); of 120 frames 88 % may be seen by chance.
        assert!(share >= 0.88, "response {k}: covered in {share:.2}");
    }
}

#[test]
fn clean_frames_are_read_to_a_sixth_of_a_degree() {
    let (good, rejected) = outcomes(scenes::clean, 120);
    assert_eq!(rejected, 0);
    for k in 0..2 {
        // 0.15 deg on the full set at full size; at a quarter of the width grains are 2 to 4 px.
        assert!(error(&good, k, 0.95) < 0.2, "{}", error(&good, k, 0.95));
        assert!(error(&good, k + 2, 0.95) < 0.2, "{}", error(&good, k + 2, 0.95));
    }
    covers(&good);
}

#[test]
fn degraded_frames_are_read_to_half_a_degree() {
    let (good, rejected) = outcomes(scenes::degraded, 120);
    assert!(rejected <= 6, "{rejected} of 120 rejected");
    for k in 0..2 {
        assert!(error(&good, k, 0.95) < 0.5, "{}", error(&good, k, 0.95));
        assert!(error(&good, k + 2, 0.95) < 0.5, "{}", error(&good, k + 2, 0.95));
    }
    covers(&good);
    for o in &good {
        let failed = o.error.iter().any(|e| e.abs() > 0.5);
        assert!(!failed || !o.warnings.is_empty(), "an error of {:?} without a warning", o.error);
    }
}
