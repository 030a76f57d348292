//! The program `yamanami`: every job of the library from the command line.
//!
//! Results go to stdout, progress and notes to stderr. Exit code 0 is success, 1 failure, 2 misuse.
#![deny(unsafe_code)]

mod args;
mod commands;
#[cfg(feature = "serve")]
mod databases;
mod failure;
mod inputs;
mod out;
mod pictures;
mod places;
mod progress;
mod text;
mod values;
#[cfg(feature = "viewer")]
mod view;

use failure::Failure;
use std::process::ExitCode;

/// Software Vulkan drivers complain on stderr where no desktop session has set this; any folder will do.
fn quieten_drivers() {
    if cfg!(target_os = "linux") && std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        #[expect(unsafe_code, reason = "the environment may only be changed before there are threads")]
        // SAFETY: called first thing in `main`, while this is the only thread.
        unsafe {
            std::env::set_var("XDG_RUNTIME_DIR", std::env::temp_dir());
        }
    }
}

fn main() -> ExitCode {
    quieten_drivers();
    let result = commands::Program::of_arguments().run().and_then(|()| out::flush());
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
