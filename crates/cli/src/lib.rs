//! Program `pinwheel`: arguments, progress, exit codes.
//!
//! `args::STATUS` explains the exit status. Results go to stdout, progress to stderr: a bar on a terminal, elsewhere a line
//! a minute.
//!
//! A library, because the Python package's extension module contains the program.

mod args;
mod commands;
mod failure;
mod folder;
mod interrupt;
mod loopback;
mod progress;
mod screen;
mod words;

use std::ffi::OsString;

use crate::args::Command;
use crate::failure::Failure;
pub use crate::words::within;

/// Runs one command line, which begins with the program's name, and returns the exit status. Call once a process: it
/// installs the handler of Ctrl-C.
pub fn main(words: Vec<OsString>) -> u8 {
    words::set(words);
    keep_freed_memory();
    interrupt::outlive_limits();
    let outcome = args::parse().and_then(|command| match command {
        None => Ok(0),
        Some(command) => interrupt::install().and_then(|()| dispatch(&command)),
    });
    outcome
        .inspect(|status| screen::annotate_answer(*status))
        .unwrap_or_else(|failure: Failure| {
            screen::complain(&failure.message);
            failure.code
        })
}

/// Prevents glibc from returning freed blocks to the system. It does so unless a larger block was freed before; a sweep
/// would then map and clear all pages of its results for each run, a tenth of a fast run's time. The block here is never
/// touched. glibc learns from at most 32 MiB (mallopt(3), `M_MMAP_THRESHOLD`).
fn keep_freed_memory() {
    const BYTES: usize = (32 << 20) - (1 << 16);
    drop(std::hint::black_box(Vec::<u8>::with_capacity(BYTES)));
}

fn dispatch(command: &Command) -> Result<u8, Failure> {
    let done = match command {
        Command::Compare(args) => return commands::compare::compare(args),
        Command::Design(args) => return commands::design::design(args),
        Command::Solver(args) => return commands::solver::solver(args),
        Command::Baseline(args) => return commands::baseline::baseline(args),
        Command::Stability(args) => return commands::stability::stability(args),
        Command::Record(args) => return commands::record::record(args),
        Command::Run(args) => commands::run::run(args),
        Command::Bench(args) => commands::bench::bench(args),
        Command::Sweep(args) => commands::sweep::sweep(args),
        Command::Explain(args) => commands::tell::explain(args),
        Command::Init(args) => commands::design::init(args),
        Command::Explore(args) => commands::explore::explore(args),
        Command::Fmu(args) => commands::fmu::fmu(args),
        Command::Engines(_) => commands::tell::engines(),
        Command::Laws(_) => commands::tell::laws(),
        Command::Schema { job } => commands::tell::schema(*job),
        Command::Paper(args) => commands::paper::paper(args),
        Command::Open(args) => commands::open::open(args),
        Command::Completions { shell } => commands::shell::completions(*shell),
    };
    done.map(|()| 0)
}
