//! Engines behind one trait: the native solver and the peers it is checked against.
//!
//! ```text
//!             prepare                    run
//!  Gearbox ──────────> dyn Prepared ──────────> Run { time_series, ending, stats, uncertainty }
//!
//!  ending: finished; diverged, with what there is until then; unsupported, absent, failed or timed out, with the reason
//!
//!  native-reduced, native-lagrange, native-resolved        our solver
//!  rapier-*, mujoco-*, exudyn-*                            bodies and time integration of others,
//!     ...-shared-law: our contact forces                   their contact too: ...-own-contact
//!  recorded                                                what a live engine gave earlier
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
mod cache;
mod control;
mod engine;
pub mod external;
mod own_contact;
mod process;
#[cfg(feature = "python")]
pub mod python;
#[cfg(feature = "rapier")]
mod rapier;
pub mod recorded;
mod registry;
#[cfg(feature = "crossval")]
mod solvers;
mod stopping;

pub use control::{Cancelled, Control, Progress};
pub use engine::{
    AccuracySetting, Ending, Engine, Halt, Prepared, Refinement, Run, RunStats, SharedModel,
};
pub use own_contact::OwnContact;
pub use registry::{
    EngineInfo, Form, Native, by_name, family, full_name, info, known, lacking, registry,
};
pub use stopping::stop_preparing;

/// The value of an environment variable; one that is empty is as good as none.
pub(crate) fn variable(name: &str) -> Option<std::ffi::OsString> {
    std::env::var_os(name).filter(|value| !value.is_empty())
}
