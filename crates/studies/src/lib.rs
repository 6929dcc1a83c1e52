//! Studies: each takes data, returns data, and prints nothing.
//!
//! ```text
//!  scene, engines, files ──> run(input, control) ──> Outcome ──> write(folder)   CSV, JSON
//!                                  │                    └──────> pages           HTML, terminal
//!                       progress, Ctrl-C, threads
//! ```
//!
//! [`single::run`] runs one scene on one engine, [`comparison::run`] on several and compares them, [`sweep`] runs a scene
//! with lists and ranges of its keys, [`paper::run`] recomputes the paper's figures, [`baseline::check`] reports changes of
//! the solver's results, [`bench::run`] the cost of accuracy. A [`Control`] stops them and receives their progress; `write`
//! of a result stores it as files in a [`folder`], with a [`Provenance`].
//!
//! Example: one run, and the check that its step resolves the scene:
//!
//! ```
//! use pinwheel_gearbox::Gearbox;
//! use pinwheel_scene::Scene;
//! use pinwheel_studies::{Control, choice, single};
//!
//! let paper = Scene::load("paper", &["solver.duration_s=0.01".parse()?])?;
//! let engine = choice::find("native", &paper)?;
//! let outcome = single::run(&Gearbox::new(&paper)?, engine.as_ref(), true, &Control::quiet())?;
//! assert!(outcome.run.ending.is_finished() && outcome.resolution.is_some_and(|r| r.holds()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Example: a sweep, which [`sweep::execute`] runs on all cores with storage of every finished run:
//!
//! ```
//! use pinwheel_studies::sweep::{Plan, Sweep};
//!
//! let text = "scene = 'paper'\n[vary]\ngear.backlash_m = { from = 0.0, to = 6e-4, points = 4 }";
//! let plan = Plan::new(Sweep::from_toml(text, "mine.toml".as_ref())?, &[])?;
//! assert_eq!((plan.len(), plan.run(1)?.scene.gear.backlash_m), (4, 2e-4));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`stability::Atlas`] shows stable formulations and integrators for every hard scene; it runs on several threads and
//! continues after a stop. [`divergence::horizon`] computes the time over which two runs that differ by a rounding stay
//! together, [`resolution::check`] checks that a run's step resolves its scene. All results serialise.

mod balances;
pub mod band;
pub mod baseline;
pub mod bench;
pub mod choice;
pub mod comparison;
pub mod conformance;
mod control;
pub mod design;
pub mod design_diff;
pub mod divergence;
pub mod effect;
mod error;
pub mod explained;
pub mod explore;
mod fourier;
pub mod junit;
pub mod motion;
pub mod paper;
mod pool;
pub mod provenance;
pub mod recording;
pub mod reference;
pub mod resolution;
pub mod results;
pub mod rng;
mod sampling;
pub mod single;
pub mod stability;
pub mod stages;
pub mod sweep;

pub use pinwheel_files::{file, folder, output};

pub use control::{Control, Progress};
pub use error::StudyError;
pub use provenance::Provenance;

/// Private items for the tests of this crate.
#[doc(hidden)]
pub mod internals {
    pub use crate::balances::branches::hysteresis;
    pub use crate::balances::poses::{MOST, MOST_OF_ALL, Poses};
    pub use crate::baseline::cases::sets;
    pub use crate::baseline::judge::{case, cost, quantity};
    pub use crate::bench::front::{cost_at, front};
    pub use crate::bench::norms::errors;
    pub use crate::bench::ranking::advantage;
    pub use crate::bench::settings::settings;
    pub use crate::comparison::outlook::{Foretold, Outlook, left_s};
    pub use crate::comparison::refine::Refiner;
    pub use crate::conformance::TRIALS;
    pub use crate::design::drawing::discs;
    pub use crate::design::joint::{LEVELS, springs};
    pub use crate::fourier::{resampled, resolves};
    pub use crate::paper::backlash::turn_to_touch;
    pub use crate::paper::figure::{Measured, number};
    pub use crate::paper::read::{off, roughness};
    pub use crate::paper::spectrum::{SAMPLES, TURNS, amplitudes, predicted, share};
    pub use crate::paper::statements::{Statement, Statements};
    pub use crate::paper::write::table;
    pub use crate::pool::map;
    pub use crate::sweep::axis::values;
    pub use crate::sweep::plan::in_words;
    pub use crate::sweep::tolerance::{clopper_pearson, figure, quantile};
}
