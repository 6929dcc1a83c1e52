//! Model of a checked scene as bodies, joints and contacts, and the native solver that runs it.
//!
//! ```text
//!  CheckedScene ─> Gearbox ─┬─> mechanism   bodies, revolutes, driver
//!                           ├─> contacts    every disc against every pin: points, law, friction
//!                           ├─> statics     the loaded gear at rest, also as a start
//!                           └─> native::run ─> time series, energy account
//!                               resolve::run_resolved: the same, refined until its verified error is within a target
//! ```
//!
//! ```
//! use pinwheel_gearbox::resolve::{BUDGET, run_resolved};
//! use pinwheel_gearbox::{Gearbox, native};
//! use pinwheel_scene::Scene;
//!
//! let paper = Scene::load("paper", &["solver.duration_s=0.005".parse()?])?;
//! let gearbox = Gearbox::new(&paper)?;
//! let run = native::run(&gearbox, &mut |_time_s| false)?;
//! assert_eq!(run.time_series.len(), 51);
//!
//! let (run, known) = run_resolved(&gearbox, 1e-3, BUDGET, &mut |_| false)?;
//! assert!(known.is_resolved() && run.counts.evaluations > 0, "{}", known.sentence());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod auto;
mod balance;
mod carrier;
pub mod channels;
pub mod contacts;
pub mod cosimulation;
mod efficiency;
pub mod energy;
mod error;
mod events;
mod explain;
mod forces;
mod frequencies;
mod gearbox;
mod geometry;
pub mod guard;
pub mod handles;
mod linear_signal;
pub mod native;
pub mod pressure;
mod recorder;
pub mod resolve;
mod ring_frame;
mod run_limits;
pub mod statics;

use pinwheel_scene::{self as scene, Layout, Sleeve, load_profile, speed_profile};

pub use carrier::Carrier;
pub use efficiency::Efficiency;
pub use error::GearboxError;
pub use explain::{Explanation, Statement, explain};
pub use frequencies::{Frequencies, friction_rate, unfollowed};
pub use gearbox::Gearbox;
pub use geometry::Geometry;
pub use pinwheel_timeseries::norms::{Distance, LoadFloor};
pub use recorder::Recorder;

/// Private items for the tests of this crate; not part of the interface.
#[doc(hidden)]
pub mod internals {
    pub use crate::balance::{Balance, elastic_j};
    pub use crate::contacts::detection::Touch;
    pub use crate::contacts::flanks::{Flanks, Seat};
    pub use crate::events::Event;
    pub use crate::forces::GearForces;
    pub use crate::resolve::uncertainty::remedy;
    pub use crate::run_limits::{Pace, SPAN};
}
