//! The two real photographs, where they are at hand.

use std::path::Path;

use drum_vision::{Context, VisionConfig, decode, measure_frame};

#[test]
fn real_photographs_are_measured_without_tuning() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/granudrum");
    let config = VisionConfig::default();
    // A rough reading by a column threshold that came with the pictures: angles to 1 deg, centre of area to 2 % of R
    // (the edge of a time-averaged bed is blurred over 5 pixels of 203).
    for (name, lin, mid, x, y) in
        [("mcc_15rpm.bmp", 37.6, 39.8, 24.5, 31.4), ("mcc_45rpm.bmp", 45.2, 50.7, 28.6, 26.9)]
    {
        let path = folder.join(name);
        if !path.exists() {
            eprintln!("skipped: {} is not there", path.display());
            return;
        }
        let frame = decode::decode_file(&path, &config.decode).unwrap();
        let m = measure_frame(&frame, &config, Context::default()).unwrap();
        let [a, b, c, d] = m.four();
        assert!((a.value - lin).abs() < 1.0 && (b.value - mid).abs() < 1.0, "{name}: {a:?} {b:?}");
        assert!((c.value - x).abs() < 2.0 && (d.value - y).abs() < 2.0, "{name}: {c:?} {d:?}");
        assert!(!m.bright_bed);
    }
}
