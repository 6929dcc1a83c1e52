//! Arguments of `pinwheel baseline`.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use pinwheel::gearbox::contacts::Kernel;
use pinwheel::studies::baseline::Options;

use super::OutArgs;
use super::named::{Named, named};
use crate::failure::Failure;

/// `pinwheel baseline`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/baseline.txt").trim_ascii_end())]
pub(crate) struct BaselineArgs {
    #[command(subcommand)]
    pub(crate) action: Action,
}

/// Action on a baseline.
#[derive(Debug, Subcommand)]
pub(crate) enum Action {
    /// Run the set and store its results as a baseline.
    Record(RecordBaselineArgs),
    /// Run the set and report changes of results, accuracy or cost.
    Check(CheckArgs),
}

/// Selection of a baseline.
#[derive(Debug, Args)]
pub(crate) struct Which {
    /// Name of the baseline.
    #[arg(default_value = "accepted")]
    pub(crate) name: String,
    /// Folder of the baselines.
    #[arg(long, value_name = "DIR", default_value = "reference/baselines")]
    pub(crate) dir: PathBuf,
}

/// Options for running the set.
#[derive(Debug, Args)]
pub(crate) struct Running {
    /// Scenes of the set, separated by commas [default: all].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
    #[command(flatten)]
    solvers: super::Solvers,
    /// Runs at a time; results do not depend on it.
    #[arg(long, alias = "threads", value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..))]
    jobs: u8,
}

impl Running {
    /// Returns the options of a run, with the solvers of the user.
    pub(crate) fn options(&self) -> Result<Options, Failure> {
        Ok(Options {
            threads: self.jobs.into(),
            only: self.only.clone(),
            solvers: self.solvers.join()?,
            ..Options::default()
        })
    }
}

/// `pinwheel baseline record`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/baseline-record.txt").trim_ascii_end())]
pub(crate) struct RecordBaselineArgs {
    #[command(flatten)]
    pub(crate) which: Which,
    /// Reason for the change of results: one sentence, stored in the baseline.
    #[arg(long, value_name = "REASON")]
    pub(crate) accept: Option<String>,
    #[command(flatten)]
    pub(crate) running: Running,
}

/// `pinwheel baseline check`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/baseline-check.txt").trim_ascii_end())]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    pub(crate) which: Which,
    /// Contact loop.
    #[arg(long = "loop", value_parser = named(LOOPS), default_value = "best")]
    pub(crate) kernel: Kernel,
    /// Write the verdicts as a JUnit file, too, for CI systems.
    #[arg(long, value_name = "FILE")]
    pub(crate) junit: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) running: Running,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

/// Contact loops by name.
const LOOPS: &[Named<Kernel>] = &[
    (
        "best",
        "the processor's best vector instructions",
        Kernel::Lanes,
    ),
    ("avx2", "AVX2 at most", Kernel::Avx2),
    (
        "portable",
        "no vector instructions of the processor",
        Kernel::Portable,
    ),
    ("scalar", "one pair after the other", Kernel::Scalar),
];
