//! exudyn, MuJoCo, Simbody and IDA against the native solver, live and recorded.
//!
//! Limits are measured figures times a margin; each is beside its measurement.

#![allow(clippy::print_stdout)] // measured figures, for whoever resets a limit

mod accuracy;
mod cycloidgen;
mod floating;
mod guards;
mod joint;
mod law;
mod own_gear;
mod package;
mod program;
mod recordings;
mod solvers;

use pinwheel_engines::{Cancelled, Control, Ending, Halt, Progress, by_name};
use pinwheel_scene::Scene;
use pinwheel_tests::runs::{self, attempt, channels, native, run, scene};
use pinwheel_timeseries::TimeSeries;

const MUJOCO: &str = "mujoco-shared-law";
const EXPLICIT: &str = "exudyn-shared-law-explicit";
const CONSTRAINED: &str = "exudyn-shared-law-constrained";
const MUJOCO_OWN: &str = "mujoco-own-contact";
const EXUDYN_OWN: &str = "exudyn-own-contact";
const SHARED: [&str; 3] = [MUJOCO, EXPLICIT, CONSTRAINED];
const ALL: [&str; 5] = [MUJOCO, EXPLICIT, CONSTRAINED, MUJOCO_OWN, EXUDYN_OWN];

const QUANTITIES: [&str; 4] = [
    "input_torque_n_m",
    "output_torque_n_m",
    "external_sleeve_force_n",
    "internal_sleeve_force_n",
];

/// Returns the error of one quantity from a time on.
fn relative(time_series: &TimeSeries, reference: &TimeSeries, quantity: &str, from_s: f64) -> f64 {
    runs::relative(time_series, reference, &[quantity], (from_s, f64::INFINITY))
}

/// Returns the largest of the four quantities' errors.
fn worst(time_series: &TimeSeries, reference: &TimeSeries, from_s: f64) -> f64 {
    QUANTITIES
        .iter()
        .map(|quantity| relative(time_series, reference, quantity, from_s))
        .fold(0.0, f64::max)
}

fn assert_within(what: &str, error: f64, limit: f64) {
    println!("{what}: {error:.2e} (limit {limit:.1e})");
    assert!(error < limit, "{what}: {error:e}, limit {limit:e}");
}

fn assert_same_bits(a: &TimeSeries, b: &TimeSeries, what: &str) {
    assert_eq!(a.len(), b.len());
    for (x, y) in a.channels().iter().zip(b.channels()) {
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&x.values), bits(&y.values), "{what}: {}", x.name);
    }
}
