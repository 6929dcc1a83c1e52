//! Arguments of `pinwheel fmu`.

use std::path::PathBuf;

use clap::Args;

use super::SceneArgs;

/// `pinwheel fmu`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/fmu.txt").trim_ascii_end())]
pub(crate) struct FmuArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// File to write; an earlier one is replaced [default: out/SCENE.fmu].
    #[arg(long, short, value_name = "FILE.fmu")]
    pub(crate) out: Option<PathBuf>,
    /// Author named in the unit [default: Pinwheel's].
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
    /// Write a description of the unit as JSON, for programs.
    #[arg(long)]
    pub(crate) json: bool,
}
