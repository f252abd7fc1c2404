#![no_main]
//! Any bytes: decoded within the limits, then measured.

use drum_vision::{Context, VisionConfig, decode, measure_frame};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let mut config = VisionConfig::default();
    config.decode.max_pixels = 250_000;
    if let Ok(frame) = decode::decode_bytes(data, &config.decode)
        && let Ok(m) = measure_frame(&frame, &config, Context::default())
    {
        for r in m.four() {
            assert!(r.value.is_finite() && r.sd.is_finite() && r.sd >= 0.0, "{r:?}");
        }
    }
});
