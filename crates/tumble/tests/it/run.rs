//! Running the binary in a folder of its own.

use std::path::Path;
use std::process::{Command, Output};

/// Run `tumble` with `args` in `folder`.
pub(crate) fn tumble(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tumble"))
        .args(args)
        .current_dir(folder)
        .output()
        .expect("the binary starts")
}

/// Standard output as text.
pub(crate) fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Standard error as text.
pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}
