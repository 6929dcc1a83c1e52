//! Arguments of `pinwheel sweep`.

use std::path::PathBuf;

use clap::Args;

use super::OutArgs;

/// `pinwheel sweep`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/sweep.txt").trim_ascii_end())]
pub(crate) struct SweepArgs {
    /// Sweep file (TOML); see docs/sweeps.md.
    pub(crate) file: PathBuf,
    /// Override a key of every run, e.g. solver.duration_s=0.1.
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Engines instead of the file's, separated by commas.
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) engines: Vec<String>,
    /// Runs at a time [default: one a core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Continue after the finished runs of an earlier attempt.
    #[arg(long)]
    pub(crate) resume: bool,
    /// List the runs without running them.
    #[arg(long)]
    pub(crate) list: bool,
    #[command(flatten)]
    pub(crate) solvers: super::Solvers,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}
