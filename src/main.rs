//! The command `optimize`.

use std::process::ExitCode;

fn main() -> ExitCode {
    flexbody::cli::run(std::env::args_os())
}
