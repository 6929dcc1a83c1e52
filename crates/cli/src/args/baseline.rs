//! Arguments of `pinwheel baseline`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use pinwheel::gearbox::contacts::Kernel;

/// `pinwheel baseline`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pinwheel baseline check          what moved since the accepted results?
  pinwheel baseline record before  keep the present state under a name,
  pinwheel baseline check before   and see what your change does to it
  pinwheel baseline record --accept \"dopri5: other step control, errors halved\"
  pinwheel baseline record mine --solver mine/solver.toml
      the same for your own solver (docs/solvers.md)

A baseline is a folder of text files in reference/baselines/: results, errors
against converged runs and counts of a fixed set of short scenes. Run it in the
project's folder, or name --dir.")]
pub(crate) struct BaselineArgs {
    #[command(subcommand)]
    pub(crate) action: Action,
}

/// What to do with it.
#[derive(Debug, Subcommand)]
pub(crate) enum Action {
    /// Run the set and keep its results as a baseline.
    Record(RecordBaselineArgs),
    /// Run the set and say what moved: results, accuracy or cost.
    Check(CheckArgs),
    /// List the baselines with the reasons for which they were accepted.
    List(ListArgs),
}

/// Which baseline.
#[derive(Debug, Args)]
pub(crate) struct Which {
    /// Name of the baseline.
    #[arg(default_value = "accepted")]
    pub(crate) name: String,
    /// Folder of the baselines.
    #[arg(long, value_name = "DIR", default_value = "reference/baselines")]
    pub(crate) dir: PathBuf,
}

/// How the set is run.
#[derive(Debug, Args)]
pub(crate) struct Running {
    /// Scenes of the set, separated by commas [default: all].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
    #[command(flatten)]
    pub(crate) solvers: super::Solvers,
    /// Threads; results do not depend on their number, times a little [default: 1].
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..))]
    pub(crate) threads: u8,
}

/// `pinwheel baseline record`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pinwheel baseline record mine
  pinwheel baseline record --accept \"sleeves of Fig. 3, not assumed ones\"

An existing baseline is only replaced with --accept; the reason joins the dated
list in its baseline.toml. Look at `pinwheel baseline check` first, and at the
diff before you commit it.")]
pub(crate) struct RecordBaselineArgs {
    #[command(flatten)]
    pub(crate) which: Which,
    /// Why the results may change: one sentence, kept in the baseline.
    #[arg(long, value_name = "REASON")]
    pub(crate) accept: Option<String>,
    #[command(flatten)]
    pub(crate) running: Running,
}

/// `pinwheel baseline check`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pinwheel baseline check
  pinwheel baseline check before --only paper,steel --out out/my-change
  pinwheel baseline check --loop scalar
      the same results without vector instructions?

Writes DIR/index.html (before and after, overlaid, by what moved most) and
DIR/summary.json. Exit status 1 if anything is worse: an error or a count above
its limit, or a run that diverges.")]
pub(crate) struct CheckArgs {
    #[command(flatten)]
    pub(crate) which: Which,
    /// Contact loop.
    #[arg(long = "loop", value_enum, default_value_t = Loop::Best)]
    pub(crate) kernel: Loop,
    /// Times each run is repeated for its time; 0: no times.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8))]
    pub(crate) repeats: u8,
    /// Write the verdicts as a JUnit file, too, for CI systems.
    #[arg(long, value_name = "FILE")]
    pub(crate) junit: Option<PathBuf>,
    /// Let the time over all cases decide, too.
    #[arg(long)]
    pub(crate) judge_time: bool,
    #[command(flatten)]
    pub(crate) running: Running,
    /// Output folder; an earlier output there is replaced as a whole [default: out/baseline-<NAME>].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace the output folder even if it holds files of other origin.
    #[arg(long)]
    pub(crate) force: bool,
}

/// `pinwheel baseline list`.
#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  pinwheel baseline list --json")]
pub(crate) struct ListArgs {
    /// Folder of the baselines.
    #[arg(long, value_name = "DIR", default_value = "reference/baselines")]
    pub(crate) dir: PathBuf,
    /// Write JSON, for programs.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Contact loops by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Loop {
    /// The processor's best vector instructions.
    Best,
    /// AVX2 at most.
    Avx2,
    /// No vector instructions of the processor.
    Portable,
    /// One pair after the other.
    Scalar,
}

impl From<Loop> for Kernel {
    fn from(wanted: Loop) -> Self {
        match wanted {
            Loop::Best => Self::Lanes,
            Loop::Avx2 => Self::Avx2,
            Loop::Portable => Self::Portable,
            Loop::Scalar => Self::Scalar,
        }
    }
}
