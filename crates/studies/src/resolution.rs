//! Check of a scene's step by a second run at twice the step (or ten times the tolerance).
//!
//! [`ladder::error`] gives the run's error from the change of the forces. It does not show an error that is equal at both
//! steps. If the coarser run fails, the run is repeated at half its step (a tenth of its tolerance) instead; that distance
//! is the error itself.
//!
//! For named methods; `auto` and `native-resolved` include a verification ([`pinwheel_gearbox::resolve`]).

use pinwheel_gearbox::resolve::convergence_of;
use pinwheel_gearbox::{Distance, Gearbox, unfollowed};
use pinwheel_mbs::integrators::{Family, method};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::ladder;
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::control::{of_scene, run_compiled};

/// Largest relative L2 distance to the coarser run of a resolved run; beyond it the run's own error is about 0.1 or more.
/// Measured over the presets, 0.05 s at 1e-5 s: those within 0.1 of their converged run move by 0.25 at most
/// (`hard-damping-0` with Heun, 0.05 off); `hard-all-open` with Heun moves by 0.56 (0.36 off), `steel` with RK4 by 0.79
/// (0.79 off).
pub const MOST: f64 = 0.3;

/// Largest relative L2 distance to the finer run of a resolved run, which is the run's error.
pub const MOST_TO_FINER: f64 = 0.1;

/// Factor between the tolerances of the two runs.
const DECADE: f64 = 10.0;

/// Evidence by a second run of the same scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Resolution {
    /// Setting of the second run as text, e.g. `a step of 2e-5 s`.
    pub other: String,
    /// Distance of the two runs; `None` if the second run failed too.
    pub moved: Option<Distance>,
    /// Estimated error of the run from the requested time on, by [`ladder::error`]. `None` if both runs have too few common
    /// samples there, or explicit steps do not resolve the friction ([`unfollowed`]).
    pub error: Option<Distance>,
    /// Largest distance of a resolved run.
    pub most: f64,
    /// Failure of the coarser run, after which a finer one was made.
    pub failure: Option<String>,
    /// Evaluations of the forces by the second run, as a share of those of the run itself.
    pub cost: f64,
}

impl Resolution {
    /// True if the forces and the driver's torque change by no more than `most`; false without a second run.
    pub fn holds(&self) -> bool {
        self.moved.is_some_and(|d| d.worst() <= self.most)
    }

    /// Returns the evidence as one sentence.
    pub fn sentence(&self) -> String {
        let shown = match self.moved {
            Some(d) => format!(
                "at {} the forces move by {:.1e}, the driver's torque by {:.1e} (relative L2)",
                self.other, d.forces, d.driver_torque
            ),
            None => format!("at {} the run fails too", self.other),
        };
        let cost = format!("looking cost {:.2} of the run", self.cost);
        match &self.failure {
            Some(failure) => {
                format!("coarser, the run fails ({failure}): it is near its limit; {shown}; {cost}")
            }
            None => format!("{shown}; {cost}"),
        }
    }
}

/// Repeats the native run of `gearbox` that gave `time_series` in `evaluations` of the forces, with every other sample.
/// `watch` receives the simulated time and returns true to stop. The error is that from the time `from_s` on. Only for
/// named methods: `auto` verifies its own run.
///
/// # Errors
/// Cancelled, or a scene that cannot be modelled.
pub fn check(
    gearbox: &Gearbox,
    (time_series, evaluations): (&TimeSeries, u64),
    from_s: f64,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<Resolution, StudyError> {
    let mut spent = 0;
    let mut again = |factor: f64| {
        let (other, words) = refined(gearbox, factor)?;
        let run = run_compiled(&other, watch)?;
        spent += run.counts.evaluations;
        Ok::<_, StudyError>((run, words, spent as f64 / evaluations.max(1) as f64))
    };
    let coarser = again(0.5)?;
    let failure = coarser.0.ending.failure();
    let finished = coarser.0.ending.is_finished();
    let (run, other, cost) = if finished { coarser } else { again(2.0)? };
    let (pair, most) = match finished {
        true => ([&run.time_series, time_series], MOST),
        false => ([time_series, &run.time_series], MOST_TO_FINER),
    };
    let moved = run.ending.is_finished();
    let moved = moved.then(|| gearbox.distance(pair[0], pair[1]));
    let error = moved.and_then(|moved| {
        let left = error(gearbox, pair, from_s)?;
        Some(if finished { left } else { left.plus(&moved) })
    });
    Ok(Resolution {
        other,
        moved,
        error,
        most,
        failure,
        cost,
    })
}

/// Returns the error of the second of two runs, one refinement finer than the first.
fn error(gearbox: &Gearbox, pair: [&TimeSeries; 2], from_s: f64) -> Option<Distance> {
    let (scene, info) = (&gearbox.scene, method(&gearbox.scene.solver.integrator)?);
    let is_stepped = info.family == Family::Explicit && !info.adaptive;
    if is_stepped && unfollowed(scene, scene.solver.step_s).is_some() {
        return None;
    }
    let [coarser, finer] = pair.map(|time_series| {
        let rows: Vec<usize> = time_series.window(from_s, f64::INFINITY).collect();
        time_series.select(&rows)
    });
    // Two samples or fewer give no estimate.
    let enough = coarser.len().min(finer.len()) > 2;
    let apart = enough.then(|| gearbox.distance(&coarser, &finer))?;
    let ratio = if info.adaptive { DECADE } else { 2.0 };
    let method = convergence_of(info, scene);
    let error = ladder::error(&[(apart, ratio)], None, method, f64::EPSILON);
    (!error.worst().is_nan()).then(|| error.torque_as_forces())
}

/// Returns the gearbox at a step `factor` times finer, or at a tolerance ten times finer (coarser for a `factor` below 1), with
/// half of its samples, and the setting in words. The initial state is kept.
fn refined(gearbox: &Gearbox, factor: f64) -> Result<(Gearbox, String), StudyError> {
    let name = &gearbox.scene.solver.integrator;
    let adaptive = method(name).is_some_and(|m| m.adaptive);
    let other = gearbox.with_solver(|solver| {
        if adaptive {
            solver.tolerance /= if factor > 1.0 { DECADE } else { 1.0 / DECADE };
        } else {
            solver.step_s /= factor;
        }
        if factor < 1.0 && 4.0 * solver.sample_s <= solver.duration_s {
            solver.sample_s *= 2.0;
        }
    });
    let other = other.map_err(|fault| of_scene(&gearbox.scene, fault.into()))?;
    let solver = &other.scene.solver;
    let words = if adaptive {
        format!("a tolerance of {:.0e}", solver.tolerance)
    } else {
        format!("a step of {:e} s", solver.step_s)
    };
    Ok((other, words))
}
