//! Errors of a run against the reference by window: relative L2 and Linf of [`pinwheel_timeseries::norms`].

use pinwheel_compare::windows::{SETTLING_S, windows};
use pinwheel_scene::load_profile;
use pinwheel_scene::{Scene, Start};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::{LoadFloor, View, relative_l2, relative_linf};
use serde::Serialize;

/// Window of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Span {
    /// `whole`, `transient` or `steady`.
    pub name: String,
    /// Start, s, included.
    pub from_s: f64,
    /// End, s, included.
    pub to_s: f64,
}

/// Relative errors in one window; dimensionless.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Errors {
    /// Relative L2 error of all pin forces jointly.
    pub force_l2: f64,
    /// Relative Linf error of all pin forces jointly.
    pub force_max: f64,
    /// Relative L2 error of the driver torque.
    pub torque_l2: f64,
    /// Relative Linf error of the driver torque.
    pub torque_max: f64,
}

/// Returns the windows of a run: all of it, then its transient and its steady part if it is long enough.
pub(super) fn spans(scene: &Scene, time_series: &TimeSeries) -> Vec<Span> {
    let settling = match scene.drive.start {
        Start::Equilibrium => 0.0,
        Start::Kinematic => SETTLING_S,
    };
    let end = time_series.time_s().last().copied().unwrap_or(0.0);
    let span = |name: &str, from_s, to_s| Span {
        name: name.to_owned(),
        from_s,
        to_s,
    };
    let (mut parts, _) = windows(time_series, settling, &load_profile::breaks(&scene.drive));
    parts.retain(|window| window.to_s - window.from_s < end);
    parts.sort_by(|a, b| a.from_s.total_cmp(&b.from_s));
    let parts = parts.iter().map(|w| span(w.kind.word(), w.from_s, w.to_s));
    [span("whole", 0.0, end)].into_iter().chain(parts).collect()
}

/// Returns the errors of `a` against `b` in a window. Both have equal sample times.
pub fn errors(a: &TimeSeries, b: &TimeSeries, span: &Span, least: LoadFloor) -> Errors {
    let range = b.window(span.from_s, span.to_s);
    let forces = [a, b].map(|run| View::forces(run, range.clone()));
    let torque = [a, b].map(|run| View::driver_torque(run, range.clone()));
    Errors {
        force_l2: relative_l2(&forces[0], &forces[1], least.force_n),
        force_max: relative_linf(&forces[0], &forces[1], least.force_n),
        torque_l2: relative_l2(&torque[0], &torque[1], least.torque_n_m),
        torque_max: relative_linf(&torque[0], &torque[1], least.torque_n_m),
    }
}
