//! The program `pinwheel`: arguments, progress, exit codes, nothing else.
//!
//! The exit status is explained by `args::STATUS`.
//! Results go to stdout, progress to stderr: a bar on a terminal, elsewhere a line a minute.
//!
//! A library, so that the extension module of the Python package holds the program too.

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

/// Carries out one command line, whose first word is the program's name, and returns the exit status. Once in a process: it
/// installs the handler of Ctrl-C.
#[must_use]
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

/// glibc gives a large block back to the system when it is freed, unless a larger one was freed before: without this a sweep
/// has every page of its results mapped and cleared anew for each run, which costs a fast run a tenth of its time. Nothing of
/// this block is ever touched. 32 MiB is the most that glibc learns from (mallopt(3), `M_MMAP_THRESHOLD`).
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
