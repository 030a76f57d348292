//! The program `yamanami`: every job of the library from the command line.
//!
//! Results go to stdout, progress and notes to stderr. Exit code 0 is success, 1 failure, 2 misuse.
#![forbid(unsafe_code)]

mod args;
mod commands;
mod failure;
mod inputs;
mod out;
mod pictures;
mod progress;
mod text;
mod values;
#[cfg(feature = "viewer")]
mod view;

use clap::Parser;
use failure::Failure;
use std::process::ExitCode;

fn main() -> ExitCode {
    let result = commands::Program::parse().run().and_then(|()| out::flush());
    match result {
        // nobody reads on: not our failure
        Ok(()) | Err(Failure::PipeClosed) => ExitCode::SUCCESS,
        Err(Failure::Failed(line)) => {
            progress::note(&format!("error: {line}"));
            ExitCode::from(1)
        }
        Err(Failure::Misuse(line)) => {
            progress::note(&format!("error: {line}"));
            ExitCode::from(2)
        }
    }
}
