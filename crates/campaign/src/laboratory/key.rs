//! Content hashes: what a motion and what a measured row depend on.

use drum_rig::Options;
use rig_schema::{Layer, Rig};

use crate::Resolution;

/// Version of what turns parameters into motions; a change of it empties the cache.
const MOTION: &str = concat!(env!("CARGO_PKG_VERSION"), "/6");

/// Version of what turns motions into responses (film and reader); a change of it has kept motions
/// filmed and measured anew.
const RESPONSES: &str = concat!(env!("CARGO_PKG_VERSION"), "/7");

/// Key of a motion: the rig without its names, camera and reader, and how it is sampled.
pub(crate) fn motion(rig: &Rig, options: &Options) -> blake3::Hash {
    let bare = rig.motion();
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
    let seen = rig.settings.of_layers(|layer| layer != Layer::Physics);
    let text = format!("{RESPONSES} responses {motion} {seen:?} {resolution:?} {frames}");
    blake3::hash(text.as_bytes())
}
