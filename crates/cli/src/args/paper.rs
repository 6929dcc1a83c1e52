//! The command line of `pinwheel paper`.

use std::path::PathBuf;

use clap::Args;
use pinwheel::studies::paper::NAMES;

use crate::failure::Failure;

/// `pinwheel paper`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pinwheel paper  every figure and every claim, a few minutes
  pinwheel paper --figures 9,12,spectra
      these figures alone, without the claims
  pinwheel paper --against rapier-own-contact-hook

Writes DIR/index.html (`pinwheel open` shows it), DIR/summary.json (numbers and
verdicts) and the curves of every figure, DIR/<figure>/courses.csv.")]
pub(crate) struct PaperArgs {
    /// Figures to draw, separated by commas: 5 to 18, spectra [default: all, and the claims].
    #[arg(long, value_name = "5,6,..", value_delimiter = ',')]
    pub(crate) figures: Vec<String>,
    /// Engine that stands in Adams' place in Fig. 10 [default: the first that finds contacts itself
    /// of exudyn, MuJoCo, rapier; live if this build has it, else recorded].
    #[arg(long, value_name = "NAME")]
    pub(crate) against: Option<String>,
    /// Output folder; an earlier output there is replaced as a whole.
    #[arg(long, value_name = "DIR", default_value = "out/paper")]
    pub(crate) out: PathBuf,
    /// Replace the output folder even if it holds files of other origin.
    #[arg(long)]
    pub(crate) force: bool,
}

impl PaperArgs {
    /// The figures asked for, by their names.
    pub(crate) fn wanted(&self) -> Result<Vec<String>, Failure> {
        self.figures
            .iter()
            .map(|word| {
                let name = word
                    .trim()
                    .trim_start_matches("fig-")
                    .trim_start_matches('0');
                if NAMES.contains(&name) {
                    return Ok(name.to_owned());
                }
                Err(Failure::input(format!(
                    "--figures: there is no figure `{word}`; name some of {}",
                    NAMES.join(", ")
                )))
            })
            .collect()
    }
}
