//! Arguments of `pinwheel paper`.

use clap::Args;
use pinwheel::studies::paper::named;

use super::OutArgs;

/// `pinwheel paper`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/paper.txt").trim_ascii_end())]
pub(crate) struct PaperArgs {
    /// Figures to draw, separated by commas: 5 to 18, spectra, damping [default: all].
    #[arg(long, value_name = "5,6,..", value_delimiter = ',', value_parser = named)]
    pub(crate) figures: Vec<String>,
    /// Engine that replaces Adams in Fig. 10 [default: the first with its own contact detection of exudyn, MuJoCo, rapier;
    /// live if in this build, else recorded].
    #[arg(long, value_name = "NAME")]
    pub(crate) against: Option<String>,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}
