//! Arguments of `pinwheel explore`.

use clap::Args;

use super::SceneArgs;

/// `pinwheel explore`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/explore.txt").trim_ascii_end())]
pub(crate) struct ExploreArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Port on this machine [default: any that is free].
    #[arg(
        long,
        value_name = "PORT",
        default_value_t = 0,
        hide_default_value = true
    )]
    pub(crate) port: u16,
    /// Print the address and open no browser.
    #[arg(long)]
    pub(crate) print: bool,
}
