//! The program starts itself anew for the sake of large pages: nobody but the machine notices.
#![cfg(target_os = "linux")]

use std::process::{Command, Output};

/// Run `tumble` with the variable of the allocator as given, or without it.
fn run(tunables: Option<&str>, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tumble"));
    match tunables {
        Some(given) => command.env("GLIBC_TUNABLES", given),
        None => command.env_remove("GLIBC_TUNABLES"),
    };
    command.args(args).output().expect("the binary starts")
}

#[test]
fn what_is_said_and_how_it_ends_is_the_same_with_large_pages_and_without() {
    let missing = ["calibrate", "no such case", "--json"];
    for (args, code) in [(&["cases"][..], 0), (&missing, 2), (&["no-command"], 2)] {
        let (anew, left_alone) = (run(None, args), run(Some(""), args));
        assert_eq!(anew.status.code(), Some(code), "{args:?}");
        assert_eq!(anew, left_alone, "{args:?}");
    }
}
