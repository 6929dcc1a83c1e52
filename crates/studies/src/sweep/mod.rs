//! Sweeps as data: a base scene, lists or ranges of its keys, and the results to keep of every run.
//!
//! [`Sweep`] is the file, [`Plan`] makes each of its runs as a checked scene. [`execute`] runs them on all cores with finished
//! runs stored in a [`Journal`], and keeps the numbers of each in [`Rows`]; [`results`] returns them as a table. Every run is computed by one thread, so the numbers do
//! not depend on the number of threads.

pub(crate) mod axis;
mod execute;
mod file;
mod idle;
mod journal;
mod leaves;
mod output;
pub(crate) mod plan;
mod record;
mod results;
mod row;
mod sample;
mod specification;
mod spread;
mod statics;
pub(crate) mod tolerance;
mod written;

pub use axis::{Axis, Value};
pub use execute::{execute, find, perform, wanted_of};
pub use file::{KeepTimeSeries, Sweep};
pub use idle::idle;
pub use journal::{Begin, Journal};
pub use output::write;
pub use plan::{Guests, MOST_RUNS, Plan, PlannedRun};
pub use record::{Outcome, RunRecord};
pub use results::{broken, costs, results};
pub use row::{Row, Rows};
pub use sample::{Distribution, Method, Sample};
pub use specification::Limit;
pub use spread::WindowStatistics;
pub use statics::{STATICS, definition};
pub use tolerance::{FigureOfSample, Quantile, SampleResult, Sensitivity, Yield, tolerances};
pub use written::Written;
