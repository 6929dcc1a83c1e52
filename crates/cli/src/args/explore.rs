//! Arguments of `pinwheel explore`.

use clap::Args;

use super::SceneArgs;

/// `pinwheel explore`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/explore.txt").trim_ascii_end())]
pub(crate) struct ExploreArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Port on this machine; 0: any free one [default: 7347, or any if that is taken].
    #[arg(long, value_name = "PORT")]
    pub(crate) port: Option<u16>,
    /// Print the address without opening a browser.
    #[arg(long)]
    pub(crate) print: bool,
    /// For a frame of another page, as in a notebook: print an address that works any number of times, and end with the
    /// standard input.
    #[arg(long)]
    pub(crate) embed: bool,
}
