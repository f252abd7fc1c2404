//! Claims about drum-vision, one module a subject.

mod accuracy;
mod bad_input;
mod oracles;
mod photographs;
mod scenes;
mod series;
mod settings;
