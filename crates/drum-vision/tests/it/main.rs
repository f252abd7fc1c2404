//! Claims about drum-vision, one module a subject.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]
#![expect(clippy::print_stderr, reason = "a skipped test says why")]

mod accuracy;
mod bad_input;
mod independent;
mod oracles;
mod other_renderer;
mod photographs;
mod scenes;
mod series;
mod settings;
