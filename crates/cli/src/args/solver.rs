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
    /// Manifest of your own solver, which is run; repeatable.
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

    /// The one engine that `names` and they give, each counted once; `native` if there is none.
    pub(crate) fn only(&self, names: &[String]) -> Result<String, Failure> {
        let mut all = self.join()?;
        let others = names.iter().filter(|name| !all.contains(name));
        let others: Vec<String> = others.cloned().collect();
        let engines = match others.is_empty() {
            true => String::new(),
            false => format!(" --engines {}", others.join(",")),
        };
        let file = |file: &PathBuf| format!(" --solver {}", file.display());
        let files: String = self.files.iter().map(file).collect();
        all.extend(others);
        match all.as_slice() {
            [] => Ok("native".to_owned()),
            [one] => Ok(one.clone()),
            _ => Err(Failure::input(format!(
                "one engine runs here, not {}; leave one out, or type `pinwheel compare SCENE{engines}{files}`",
                all.join(" and ")
            ))),
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
    #[command(after_help = include_str!("../../help/solver-job.txt"))]
    Job {
        #[command(flatten)]
        scene: SceneArgs,
        /// New folder.
        folder: PathBuf,
    },
    /// Print the folder of libpinwheel_law, for the linker.
    #[command(after_help = include_str!("../../help/solver-library.txt"))]
    Library,
}
