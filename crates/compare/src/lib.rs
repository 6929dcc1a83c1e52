//! Metrics, uncertainties and verdicts on the time series of several engines.
//!
//! [`compare`] takes runs on one sample grid, finished or not. For each pair of engines, window and quantity it returns the
//! distance and a verdict. No engine is the truth: every judged metric is free of direction. Time series may be of any kind;
//! load and efficiency, which only a gearbox has, are optional.
//!
//! ```text
//!  runs of engine A: step h, 2h, 4h ──> uA ─┐
//!                                           ├─ U = uA + uB ─┐   D <= U           agree, to U
//!  runs of engine B: step h, 2h, 4h ──> uB ─┘               ├── D >  U           differ, by at least D - U
//!  A at h against B at h ────────────────────────────> D ───┘   U > resolution   inconclusive, with the remedy
//! ```
//!
//! * [`uncertainty`]: numerical uncertainty u of a run, from the same engine's runs at coarser settings.
//! * [`verdict`]: the four verdicts.
//! * [`shown`]: evidence for what the user brought, and [`Comparison::exit_status`].
//! * [`model`]: engines with a contact model of their own, whose difference is an interval against a prediction.
//! * [`validation`]: measured data, by ASME V&V 20.
//! * [`metrics`]: every metric in one table.
//!
//! `docs/verdicts.md` explains all of it on one page.
//!
//! # Two engines of one law
//!
//! Both solve `x = sin t`, one with an error of `1e-4 (h/h0)^2`, the other of `1e-6 (h/h0)^4`:
//!
//! ```
//! use pinwheel_compare::uncertainty::Method;
//! use pinwheel_compare::*;
//! use pinwheel_timeseries::{TimeSeries, TimeSeriesError};
//!
//! fn run(error: f64) -> Result<TimeSeries, TimeSeriesError> {
//!     let time: Vec<f64> = (0..=1000).map(|k| f64::from(k) * 1e-3).collect();
//!     let x = time.iter().map(|t| (40.0 * t).sin() + error * (25.0 * t).cos()).collect();
//!     let mut time_series = TimeSeries::new(time)?;
//!     time_series.push("angle_rad", x)?;
//!     Ok(time_series)
//! }
//!
//! fn engine(name: &str, error: f64, order: i32) -> Result<(Participant, Evidence), TimeSeriesError> {
//!     let level = |refinement: f64| {
//!         let time_series = run(error * refinement.powi(order))?;
//!         Ok::<_, TimeSeriesError>(Level { setting: 1e-5 * refinement, run: Ok(time_series), wall_s: 0.0 })
//!     };
//!     let ladder = Ladder {
//!         method: Method::Step { order: order.into(), rough: None },
//!         finest: 1e-5,
//!         floor: 0.0,
//!         coarser: vec![level(2.0)?, level(4.0)?],
//!     };
//!     let participant = Participant {
//!         name: name.to_owned(),
//!         track: SharedModel::SharedLaw,
//!         version: String::new(),
//!         summary: String::new(),
//!         differences: String::new(),
//!         time_series: run(error)?,
//!         cost: Cost::default(),
//!         status: Status::Finished,
//!     };
//!     Ok((participant, Evidence::refinement(name, ladder)))
//! }
//!
//! let (second, of_second) = engine("second-order", 1e-4, 2)?;
//! let (fourth, of_fourth) = engine("fourth-order", 1e-6, 4)?;
//! let context = Context { duration_s: 1.0, ..Context::default() };
//! let evidence = [of_second, of_fourth];
//! let rules = Rules { evidence: &evidence, ..Rules::default() };
//! let comparison = compare(&context, &[second, fourth], &rules)?;
//!
//! let result = &comparison.pairs[0].entries[0].result;
//! assert_eq!(result.verdict, Verdict::Agree);
//! assert!(result.bound.is_some_and(|bound| (1e-4..2e-4).contains(&bound)), "{result:?}");
//! assert_eq!(comparison.exit_status(), 0);
//! assert_eq!(comparison.findings[0].line, "engines: agrees to 1.2e-4 (second-order and fourth-order)");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod balance;
mod compare;
pub mod comparison;
mod error;
mod findings;
mod grid;
mod judge;
pub mod limits;
mod matrix;
pub mod metrics;
pub mod model;
mod pairs;
mod participant;
pub mod quantities;
mod rules;
pub mod shown;
pub mod sprague_geers;
mod summary;
pub mod uncertainty;
pub mod validation;
pub mod verdict;
pub mod windows;

pub use compare::compare;
pub use comparison::Comparison;
pub use error::CompareError;
pub use limits::StatedLimit;
pub use metrics::Metric;
pub use participant::{
    Context, Cost, Divergence, Energy, Participant, Scales, SharedModel, Status,
};
pub use quantities::Quantity;
pub use rules::{RESOLUTION, Rules};
pub use summary::uncertainties;
pub use uncertainty::{Evidence, Ladder, Level, Uncertainty};
pub use validation::DataUncertainty;
pub use verdict::{Against, Assessment, Counts, Verdict};
pub use windows::{Window, WindowKind};

/// Private items that the tests of this crate reach; no part of the interface.
#[doc(hidden)]
pub mod internals {
    pub use crate::model::{account, predicted};
}
