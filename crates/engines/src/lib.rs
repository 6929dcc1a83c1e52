//! Engines behind one trait: the native solver and the peers it is checked against.
//!
//! ```text
//!             prepare                    run
//!  Gearbox ──────────> dyn Prepared ──────────> Run { time_series, ending, stats, uncertainty }
//!
//!  ending: finished; diverged, with the samples until then; unsupported, absent, failed or timed out, with the reason
//!
//!  native-reduced, native-lagrange, native-resolved        Pinwheel's solver
//!  rapier-*, mujoco-*, exudyn-*                            bodies and time integration of other projects,
//!     ...-shared-law: Pinwheel's contact forces            ...-own-contact: also their contact
//!  recorded, kept                                          earlier results of a live engine
//!  external                                                solvers that the user names by a manifest
//! ```
//!
//! ```
//! use pinwheel_engines::{Control, by_name};
//! use pinwheel_scene::Scene;
//!
//! let paper = Scene::load("paper", &["solver.duration_s=0.002".parse()?])?;
//! let engine = by_name("native-lagrange", &paper).ok_or("no such engine")?;
//! let run = engine.run(&paper, &Control::quiet())?;
//! assert_eq!((run.time_series.len(), run.stats.bodies), (21, 28));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(feature = "crossval")]
#[doc(hidden)] // for tests
pub mod cache;
mod control;
mod engine;
mod env;
pub mod external;
mod info;
pub mod kept;
mod known;
mod native;
mod own_contact;
#[doc(hidden)] // for tests
pub mod process;
#[cfg(feature = "python")]
pub mod python;
#[cfg(feature = "rapier")]
#[doc(hidden)] // for tests
pub mod rapier;
pub mod recorded;
#[cfg(any(feature = "rapier", feature = "python"))]
mod refusals;
mod registry;
#[cfg(feature = "crossval")]
mod solvers;
#[doc(hidden)] // for tests
pub mod spring;
mod stopping;

pub use control::{Cancelled, Control, Progress};
pub use engine::{Ending, Engine, Halt, Prepared, Run, RunStats, SharedModel};
pub use info::{AccuracySetting, EngineInfo, Form, Refinement, family};
pub use known::{info, known};
pub use native::Native;
pub use own_contact::OwnContact;
pub use registry::{by_name, full_name, lacking, needs, registry, remedies, remedy};
pub use stopping::stop_preparing;
