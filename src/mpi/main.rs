//! The command `optimize-mpi`.

use std::process::ExitCode;

fn main() -> ExitCode {
    flexbody::mpi::run(std::env::args_os())
}
