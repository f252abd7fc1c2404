//! Claims about the frames, one module a subject.

mod effects;
mod files;
mod independent;
mod silhouette;
mod spheres;
mod truth;
