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
    /// Author that the unit names [default: who makes Pinwheel].
    #[arg(long, value_name = "NAME")]
    pub(crate) author: Option<String>,
    /// Write what was made as JSON, for programs.
    #[arg(long)]
    pub(crate) json: bool,
}
