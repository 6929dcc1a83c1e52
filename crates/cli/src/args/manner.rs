//! Options for the program's output.

use anstream::ColorChoice;
use clap::Args;

use super::named::{Named, named};

/// Output options of every command.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct Manner {
    /// No progress; of a study only the place of its results.
    #[arg(long, short, global = true, hide = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Also list the written files, and every engine's figures in a comparison.
    #[arg(long, short, global = true, hide = true)]
    pub(crate) verbose: bool,
    /// Colours.
    #[arg(long, value_name = "WHEN", global = true, hide = true, value_parser = named(COLOURS), default_value = "auto")]
    pub(crate) color: ColorChoice,
    /// Results as JSON (of the command, if it takes `--json`).
    #[arg(skip)]
    pub(crate) json: bool,
    /// Name of the command.
    #[arg(skip)]
    pub(crate) command: &'static str,
}

/// Use of colours.
const COLOURS: &[Named<ColorChoice>] = &[
    ("auto", "Where a terminal shows them", ColorChoice::Auto),
    (
        "always",
        "In pipes and files as well",
        ColorChoice::AlwaysAnsi,
    ),
    ("never", "Nowhere", ColorChoice::Never),
];
