#![no_main]
//! A drawn drum with defects and settings taken from the input, so that the later stages are reached.

use drum_vision::config::{CircleSource, Definition, Polarity, SurfaceMethod, Threshold, Tone};
use drum_vision::{Context, Frame, RegionSidecar, VisionConfig, measure_frame};
use libfuzzer_sys::fuzz_target;

struct Bytes<'a>(std::slice::Iter<'a, u8>);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        self.0.next().copied().unwrap_or(0)
    }
    fn unit(&mut self) -> f64 {
        f64::from(self.byte()) / 255.0
    }
    fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n
    }
}

fuzz_target!(|data: &[u8]| {
    let mut b = Bytes(data.iter());
    let (w, h) = (48 + b.below(160), 48 + b.below(160));
    let (cx, cy) = (w as f64 * (0.3 + 0.4 * b.unit()), h as f64 * (0.3 + 0.4 * b.unit()));
    let r = w.min(h) as f64 * (0.1 + 0.6 * b.unit());
    let (slope, offset, bend) = (4.0 * b.unit() - 2.0, 2.4 * b.unit() - 1.2, 2.0 * b.unit() - 1.0);
    let (outside, back, bed) = (b.byte(), b.byte(), b.byte());
    let ring = 0.1 * b.unit();
    let mut rgb = Vec::with_capacity(3 * w * h);
    for y in 0..h {
        for x in 0..w {
            let (u, v) = ((x as f64 - cx) / r, (cy - y as f64) / r);
            let rho = u.hypot(v);
            let p = if rho < 1.0 {
                if v < offset + slope * u + bend * u * u { [bed; 3] } else { [back; 3] }
            } else if rho < 1.0 + ring {
                [210, 30, 30]
            } else {
                [outside; 3]
            };
            rgb.extend(p);
        }
    }
    // Blots: place, size, grey.
    for _ in 0..b.below(12) {
        let (x0, y0, side, grey) = (b.below(w), b.below(h), 1 + b.below(40), b.byte());
        for y in y0..(y0 + side).min(h) {
            for x in x0..(x0 + side).min(w) {
                rgb[3 * (y * w + x)..3 * (y * w + x) + 3].fill(grey);
            }
        }
    }
    let mut config = VisionConfig::default();
    config.bed.threshold = match b.below(3) {
        0 => Threshold::LocalContrast,
        1 => Threshold::Otsu,
        _ => Threshold::Fixed { level: f64::from(b.byte()) },
    };
    config.bed.tone = [Tone::Auto, Tone::Bright, Tone::Dark][b.below(3)];
    config.bed.hub = 0.5 * b.unit();
    config.bed.median_px = Some(1 + b.below(60));
    config.bed.wiener_px = Some(1 + b.below(60));
    config.bed.min_contrast = 2.0 * b.unit();
    config.bed.min_contrast_levels = 20.0 * b.unit();
    config.surface.method = [SurfaceMethod::SubPixel, SurfaceMethod::Columns][b.below(2)];
    config.surface.column_step_px = 1 + b.below(12);
    config.surface.min_visible = b.unit();
    config.response.definition = [Definition::Photograph, Definition::Edem][b.below(2)];
    config.response.hub_in_area = b.below(2) == 0;
    config.drum.polarity =
        [Polarity::Both, Polarity::DarkOnLight, Polarity::LightOnDark][b.below(3)];
    config.drum.source = match b.below(4) {
        0 => CircleSource::Ring,
        1 => CircleSource::Outline,
        2 => CircleSource::Circle { x_px: cx, y_px: cy, radius_px: r.max(8.0) },
        _ => CircleSource::Auto,
    };
    config.measure.threshold_bias = 0.6 * b.unit() - 0.3;
    let region = (b.below(3) == 0).then(|| RegionSidecar {
        image: None,
        size_px: None,
        polygon_px: (0..3 + b.below(6))
            .map(|_| [w as f64 * (1.4 * b.unit() - 0.2), h as f64 * (1.4 * b.unit() - 0.2)])
            .collect(),
        window: [b.byte(), b.byte()],
        circle_px: None,
    });
    let frame = Frame::from_rgb(w, h, rgb).expect("three samples were pushed for every pixel");
    let context = Context { reference: None, region: region.as_ref() };
    if let Ok(m) = measure_frame(&frame, &config, context) {
        for r in m.four() {
            assert!(r.value.is_finite() && r.sd.is_finite() && r.sd >= 0.0, "{r:?}");
        }
        let _ = drum_vision::overlay::overlay(&frame, &m);
    }
});
