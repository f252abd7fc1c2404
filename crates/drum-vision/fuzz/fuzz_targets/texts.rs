#![no_main]
//! Any text as configuration and as side-car.

use drum_vision::{RegionSidecar, VisionConfig};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(config) = VisionConfig::from_toml(text) {
        config.check().expect("a configuration that was read is in range");
    }
    if let Ok(region) = RegionSidecar::from_text(text) {
        region.check().expect("a side-car that was read is valid");
        let _ = region.contains(10.0, 10.0);
    }
});
