//! Arguments of `pinwheel solver`, and `--solver` of other commands.

use std::path::PathBuf;

use clap::{Args, Subcommand};
use pinwheel::engines::external::{
    self,
    scaffold::{LANGUAGES, Language},
};

use super::named::named;
use super::{OutArgs, SceneArgs};
use crate::failure::Failure;

/// Solvers of the user that join the engines.
#[derive(Debug, Args)]
pub(crate) struct Solvers {
    /// Manifest of your own solver that joins, see docs/solvers.md; may be repeated. The program runs it.
    #[arg(long = "solver", id = "solver", value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
}

impl Solvers {
    /// Registers the solvers and returns their names.
    pub(crate) fn join(&self) -> Result<Vec<String>, Failure> {
        let joined = self.files.iter().map(|file| external::admit(file));
        let names: Result<_, _> = joined.collect();
        names.map_err(Failure::input)
    }

    /// Returns the only engine of `names` and the solvers; `native` if there is none.
    pub(crate) fn only(&self, names: &[String]) -> Result<String, Failure> {
        let joined = self.join()?;
        let mut all = names.iter().chain(&joined);
        match (all.next(), all.next()) {
            (None, _) => Ok("native".to_owned()),
            (Some(one), None) => Ok(one.clone()),
            _ => Err(Failure::input(
                "one engine runs here; name one, or compare one scene by several",
            )),
        }
    }

    /// Returns `names` and those of the solvers, each once; empty, for all engines, if `names` is empty.
    pub(crate) fn join_named(&self, names: &[String]) -> Result<Vec<String>, Failure> {
        let joined = self.join()?;
        let mut all = names.to_vec();
        if !names.is_empty() {
            all.extend(joined.into_iter().filter(|name| !names.contains(name)));
        }
        Ok(all)
    }
}

/// `pinwheel solver`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/solver.txt").trim_ascii_end())]
pub(crate) struct SolverArgs {
    #[command(subcommand)]
    pub(crate) action: SolverAction,
}

/// Action on a solver.
#[derive(Debug, Subcommand)]
pub(crate) enum SolverAction {
    /// Write a small working solver into a new folder.
    #[command(after_help = include_str!("../../help/solver-new.txt"))]
    New {
        /// Language of the solver.
        #[arg(long, value_parser = named(&LANGUAGES))]
        language: Language,
        /// Name of the solver and its folder: small letters, digits and `-`.
        name: String,
    },
    /// Check the properties of a solver that comparisons need: signs, grid, order, refusals, endings.
    #[command(after_help = include_str!("../../help/solver-check.txt"))]
    Check {
        /// Manifest of the solver.
        file: PathBuf,
        /// Write the findings as a JUnit file, too, for CI systems.
        #[arg(long, value_name = "FILE")]
        junit: Option<PathBuf>,
        #[command(flatten)]
        out: OutArgs,
    },
    /// Write the job folder of a scene, to try a solver by hand.
    Job {
        #[command(flatten)]
        scene: SceneArgs,
        /// New folder.
        folder: PathBuf,
    },
    /// Print the folder of libpinwheel_law, for the linker.
    Library,
}
