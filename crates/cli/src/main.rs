//! Program `pinwheel`; see the library beside it.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(pinwheel_cli::main(std::env::args_os().collect()))
}
