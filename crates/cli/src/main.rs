//! The program `pinwheel`: arguments, progress, exit codes, nothing else.
//!
//! Exit status: 0 done and within limits; 1 ran, but a limit was exceeded; 2 bad input or usage;
//! 3 an engine is missing, diverged or failed; 130 stopped by the user.
//! Results go to stdout, progress to stderr and only when that is a terminal.

mod args;
mod commands;
mod failure;
mod folder;
mod interrupt;
mod progress;
mod screen;

use std::process::ExitCode;

use crate::args::Command;
use crate::failure::Failure;

fn main() -> ExitCode {
    let outcome = args::parse().and_then(|command| match command {
        None => Ok(0),
        Some(command) => interrupt::install().and_then(|()| dispatch(&command)),
    });
    let code = outcome.unwrap_or_else(|failure: Failure| {
        screen::complain(&failure.message);
        failure.code
    });
    ExitCode::from(code)
}

fn dispatch(command: &Command) -> Result<u8, Failure> {
    match command {
        Command::Run(args) => commands::run::run(args),
        Command::Compare(args) => commands::compare::compare(args),
        Command::Bench(args) => commands::bench::bench(args),
        Command::Explain(args) => commands::explain::explain(args),
        Command::Init(args) => commands::design::init(args),
        Command::Design(args) => commands::design::design(args),
        Command::Fmu(args) => commands::fmu::fmu(args),
        Command::Sweep(args) => commands::sweep::sweep(args),
        Command::Engines(args) => commands::engines::engines(args),
        Command::Laws(args) => commands::laws::laws(args),
        Command::Schema { job: false } => {
            screen::show_json(&pinwheel::scene::schema::schema()).map(|()| 0)
        }
        Command::Schema { job: true } => {
            screen::show_json(&pinwheel::engines::external::job_schema()).map(|()| 0)
        }
        Command::Solver(args) => commands::solver::solver(args),
        Command::Paper(args) => commands::paper::paper(args),
        Command::Baseline(args) => commands::baseline::baseline(args),
        Command::Calibrate(args) => commands::calibrate::calibrate(args),
        Command::Stability(args) => commands::stability::stability(args),
        Command::Record(args) => commands::record::record(args),
        Command::Open(args) => commands::open::open(args),
        Command::Completions { shell } => commands::shell::completions(*shell),
        Command::Man { out } => commands::shell::man(out.as_deref()),
    }
}
