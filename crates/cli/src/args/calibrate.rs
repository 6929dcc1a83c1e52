//! Arguments of `pinwheel calibrate`.

use clap::Args;

use super::OutArgs;

/// `pinwheel calibrate`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pinwheel calibrate  stated uncertainties against true errors: some minutes
  pinwheel calibrate --gears 100..140            the same on other random gears
  pinwheel calibrate --power  the smallest faults that a comparison tells
  pinwheel calibrate --power my-gear.toml --engines rapier-shared-law

Writes DIR/summary.json with every case. docs/verdicts.md says what the tables
mean.

Exit status 1: less than 95 of 100 errors are within what was stated, what was
stated is 5 times the error or more in the median, or (--power) a fault of the
size in the table is not told, or a right gear is said to differ.")]
pub(crate) struct CalibrateArgs {
    /// Scene files or presets [default: the study's own].
    #[arg(value_name = "SCENE")]
    pub(crate) scenes: Vec<String>,
    /// Which faults a comparison tells, instead of how honest its uncertainties are.
    #[arg(long)]
    pub(crate) power: bool,
    /// Random gears beside the presets, by their seeds.
    #[arg(long, value_name = "FROM..TO", default_value = "1000..1024", conflicts_with_all = ["power", "scenes"])]
    pub(crate) gears: String,
    /// Engines, separated by commas [default: all of this build with a ladder of their own; --power: of the shared law].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) engines: Vec<String>,
    /// Seconds that the runs of one engine on one gear may take before it is refined no further.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0)]
    pub(crate) longest: f64,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}
