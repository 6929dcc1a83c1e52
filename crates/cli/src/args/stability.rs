//! Arguments of `pinwheel stability`.

use std::path::PathBuf;

use clap::Args;

/// `pinwheel stability`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pinwheel stability --quick  everything on short runs: about a minute
  pinwheel stability                          the whole study: some minutes
  pinwheel stability hard-steel my-gear.toml  these scenes alone
  pinwheel stability --resume  go on with a study that was stopped

Writes DIR/index.html (see `pinwheel open`), DIR/summary.json (everything) and
DIR/stability.csv (one line a scene and method). Ctrl-C keeps the pieces that
are done; --resume does the rest.

Exit status 1: there is a scene that no method gives within 1 %.")]
pub(crate) struct StabilityArgs {
    /// Scene files or presets [default: every hard-* preset, the long run, and the published model above C = 8].
    #[arg(value_name = "SCENE")]
    pub(crate) scenes: Vec<String>,
    #[command(flatten)]
    pub(crate) solvers: super::Solvers,
    /// Shorter runs.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Pieces worked on at a time [default: as many as there are cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Go on with the stopped study in the output folder.
    #[arg(long)]
    pub(crate) resume: bool,
    /// Output folder; an earlier output there is replaced as a whole [default: out/stability].
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace the output folder even if it holds files of other origin.
    #[arg(long)]
    pub(crate) force: bool,
}
