//! The command line of `pinwheel bench`.

use clap::{Args, ValueEnum};

use super::{OutArgs, SceneArgs};

/// `pinwheel bench`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pinwheel bench paper                native and rapier, within three minutes
  pinwheel bench backlash-0.6 --engines native,rapier-shared-law
  pinwheel bench steel --longest 300  let the peers take the steps they need
  pinwheel bench paper --parts scaling --out out/scaling
  pinwheel bench paper --parts batch --set drive.start=equilibrium
                                      gears a second and core

Writes DIR/index.html (`pinwheel open` shows it), DIR/summary.json and, beside
them, DIR/bench.csv with a line a run, DIR/scaling.csv, DIR/mechanisms.csv and
DIR/batch.csv.
Ctrl-C ends the measurement and writes what there is; a second one leaves
nothing. CPU times are those of one thread; close other programs for figures to
rely on.")]
pub(crate) struct BenchArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Engines, separated by commas; `native` stands for both its forms [default: the native forms and
    /// every peer that shares the law; with friction, also those with friction of their own].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) engines: Vec<String>,
    /// Integrators of the native solver, separated by commas [default: all].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) methods: Vec<String>,
    /// Relative L2 force error over the whole run at which the engines are ranked.
    #[arg(long, value_name = "ERROR", default_value_t = 1e-4)]
    pub(crate) target: f64,
    /// CPU seconds that one run of a peer may take; the native solver gets a tenth.
    #[arg(long, value_name = "S", default_value_t = 20.0)]
    pub(crate) longest: f64,
    /// Runs of one setting at most, of which minimum and median are shown; long ones get fewer.
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub(crate) repeats: usize,
    /// What to measure, separated by commas.
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_values_t = Part::ALL)]
    pub(crate) parts: Vec<Part>,
    #[command(flatten)]
    pub(crate) solvers: super::Solvers,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

/// A part of the measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Part {
    /// The scene: error against cost of every engine and method.
    Scene,
    /// Cost against the number of wheels, sleeves and points.
    Scaling,
    /// Error against cost on published mechanisms.
    Mechanisms,
    /// Gears a second and core, as in a sweep.
    Batch,
}

impl Part {
    /// All.
    pub(crate) const ALL: [Self; 4] = [Self::Scene, Self::Scaling, Self::Mechanisms, Self::Batch];
}

impl From<Part> for pinwheel::studies::bench::Part {
    fn from(part: Part) -> Self {
        match part {
            Part::Scene => Self::Scene,
            Part::Scaling => Self::Scaling,
            Part::Mechanisms => Self::Mechanisms,
            Part::Batch => Self::Batch,
        }
    }
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Scene => "scene",
            Self::Scaling => "scaling",
            Self::Mechanisms => "mechanisms",
            Self::Batch => "batch",
        })
    }
}
