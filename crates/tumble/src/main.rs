//! Command line of Tumble: parses, composes, shows progress, writes tables, pictures and reports.
#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a command line prints")]

mod calibrated;
mod cli;
mod command;
mod experiment;
mod given;
mod input;
mod output;
mod pages;
mod report;

use std::process::ExitCode;

use clap::Parser;

use crate::cli::{Cli, Command};
use crate::input::is_input_fault;

fn main() -> ExitCode {
    let cli = Cli::parse();
    pages::ask_for_large_ones();
    let done = match &cli.command {
        Command::Cases(args) => command::cases::run(args),
        Command::Fit(args) => command::fit::run(args),
        Command::Calibrate(args) => command::calibrate::run(args),
        Command::CloseLoop(args) => command::close_loop::run(args),
        Command::Simulate(args) => command::simulate::run(args),
        Command::Design(args) => command::design::run(args),
        Command::Run(args) => command::run::run(args),
        Command::Export(args) => command::export::run(args),
        Command::Measure(args) => command::measure::run(args),
        Command::Roi(args) => command::roi::run(args),
        Command::Film(args) => command::film::run(args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            // 2: the input is at fault, and the same call will fail again; 1: the machine is.
            ExitCode::from(if is_input_fault(&error) { 2 } else { 1 })
        }
    }
}
