//! Claims about the frames, one module a subject.

mod truth;
