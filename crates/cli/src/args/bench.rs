//! Arguments of `pinwheel bench`.

use clap::Args;

use super::{OutArgs, SceneArgs};

/// `pinwheel bench`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/bench.txt").trim_ascii_end())]
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
    /// Relative L2 force error over the complete run at which the engines are ranked.
    #[arg(long, value_name = "ERROR", default_value_t = 1e-4)]
    pub(crate) target: f64,
    /// CPU seconds permitted to a run of a peer; the native solver gets a tenth.
    #[arg(long, value_name = "S", default_value_t = 20.0)]
    pub(crate) longest: f64,
    /// Largest number of runs of one setting, of which minimum and median are shown; long ones get fewer.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) repeats: u16,
    #[command(flatten)]
    pub(crate) solvers: super::Solvers,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}
