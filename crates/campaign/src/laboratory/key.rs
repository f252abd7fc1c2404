//! Content hashes: what a motion and what a measured row depend on.

use drum_rig::Options;
use rig_schema::{Layer, Rig, Settings, namespace};

use crate::Resolution;

/// Version of what turns parameters into motions; a change of it empties the cache.
const MOTION: &str = concat!(env!("CARGO_PKG_VERSION"), "/2");

/// Version of what turns motions into responses (film and reader); a change of it has kept motions
/// filmed and measured anew.
const RESPONSES: &str = concat!(env!("CARGO_PKG_VERSION"), "/3");

/// Key of a motion: the rig without its names, camera and reader, and how it is sampled.
pub(crate) fn motion(rig: &Rig, options: &Options) -> blake3::Hash {
    let mut bare = rig.clone();
    bare.name.clear();
    bare.title.clear();
    bare.settings = only(&rig.settings, |layer| layer == Layer::Physics);
    let liner = options.liner_stl.as_deref().map(blake3::hash);
    let sampling = Options { threads: 1, liner_stl: None, ..options.clone() };
    blake3::hash(format!("{MOTION} motion {bare:?} {sampling:?} {liner:?}").as_bytes())
}

/// Key of the measured row of a motion.
pub(crate) fn responses(
    motion: &blake3::Hash,
    rig: &Rig,
    resolution: Resolution,
    frames: usize,
) -> blake3::Hash {
    let seen = only(&rig.settings, |layer| layer != Layer::Physics);
    let text = format!("{RESPONSES} responses {motion} {seen:?} {resolution:?} {frames}");
    blake3::hash(text.as_bytes())
}

/// The given values of some layers.
fn only(settings: &Settings, keep: impl Fn(Layer) -> bool) -> Settings {
    let mut kept = Settings::default();
    for (path, value) in settings.iter() {
        if namespace::find(path).is_some_and(|p| keep(p.layer)) {
            // The value was accepted before.
            let _ = kept.set(path, value);
        }
    }
    kept
}
