//! Arguments of `pinwheel stability`.

use clap::Args;

use super::OutArgs;

/// `pinwheel stability`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/stability.txt").trim_ascii_end())]
pub(crate) struct StabilityArgs {
    /// Scene files or presets [default: every hard-* preset].
    #[arg(value_name = "SCENE")]
    pub(crate) scenes: Vec<String>,
    #[command(flatten)]
    pub(crate) solvers: super::Solvers,
    /// Shorter runs.
    #[arg(long)]
    pub(crate) quick: bool,
    /// Scenes at a time [default: as many as there are cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Continue the stopped study in the output folder.
    #[arg(long)]
    pub(crate) resume: bool,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}
