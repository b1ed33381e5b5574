//! The `kinstep` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    kinstep::cli::run(std::env::args_os())
}
