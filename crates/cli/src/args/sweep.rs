//! Arguments of `pinwheel sweep`.

use std::path::PathBuf;

use clap::Args;
use pinwheel::studies::sweep::Shard;

use super::OutArgs;

/// `pinwheel sweep`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pinwheel sweep reference/sweeps/backlash.toml
  pinwheel sweep my-sweep.toml --jobs 4 --out out/mine
  pinwheel sweep my-sweep.toml --resume  go on after a stop or a kill
  pinwheel sweep my-sweep.toml --list    what would be run
  pinwheel sweep my-sweep.toml --shard 3/8 a part, on a machine of its own
  pinwheel sweep my-sweep.toml --gather  the results of all parts

A sweep file names a base scene and what to vary:
  scene = \"paper\"
  [vary]
  gear.backlash_m = { from = 0.0, to = 1.0e-3, points = 11 }
  contact.damping_n_s_m = [8.0, 64.0]

Writes DIR/results.csv and DIR/results.parquet (a row a run: the same whatever
--jobs), DIR/costs.csv, DIR/index.html, DIR/summary.json and DIR/runs/. Until
all runs are done, finished ones stand in DIR.unfinished, each whole; --resume
takes them, and those of an earlier output in DIR, as far as the sweep still
asks for them.")]
pub(crate) struct SweepArgs {
    /// Sweep file (TOML); see docs/sweeps.md.
    pub(crate) file: PathBuf,
    /// Override a key of every run's scene, e.g. --set solver.duration_s=0.1; may be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Engines instead of the file's, separated by commas.
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) engines: Vec<String>,
    /// Runs at a time [default: one a core].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Go on with the runs an earlier attempt finished.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Run one part of several, e.g. 3/8: every eighth run, the third first. Parts may run at once, on machines that share
    /// the output's disk; one that is begun again goes on.
    #[arg(long, value_name = "I/N", conflicts_with_all = ["list", "resume", "gather"])]
    pub(crate) shard: Option<Shard>,
    /// Write the results of shards that are all done, and run nothing.
    #[arg(long, conflicts_with_all = ["list", "resume", "jobs"])]
    pub(crate) gather: bool,
    /// List the runs, and run none.
    #[arg(long)]
    pub(crate) list: bool,
    #[command(flatten)]
    pub(crate) solvers: super::Solvers,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}
