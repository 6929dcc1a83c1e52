//! Arguments of `pinwheel calibrate`.

use std::ops::Range;

use clap::Args;

use super::OutArgs;

/// `pinwheel calibrate`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/calibrate.txt").trim_ascii_end())]
pub(crate) struct CalibrateArgs {
    /// Scene files or presets [default: the study's own].
    #[arg(value_name = "SCENE")]
    pub(crate) scenes: Vec<String>,
    /// Random gears beside the presets, by their seeds.
    #[arg(long, value_name = "FROM..TO", default_value = "1000..1024", value_parser = seeds, conflicts_with = "scenes")]
    pub(crate) gears: Range<u64>,
    /// Engines, separated by commas [default: all of this build that refine by themselves].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) engines: Vec<String>,
    /// Seconds that the runs of one engine on one gear may take before it is refined no further.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0)]
    pub(crate) longest: f64,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

fn seeds(text: &str) -> Result<Range<u64>, &'static str> {
    let ends = text.split_once("..");
    let range = ends.and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?));
    range
        .filter(|range| !range.is_empty() && range.end - range.start <= 10_000)
        .ok_or("a range of seeds is written like 1000..1024")
}
