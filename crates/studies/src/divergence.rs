//! Time over which two runs that differ by one rounding stay together.
//!
//! The moment of inertia of the discs is moved to the next representable number. When the difference of the pin forces has
//! grown to a visible share, time series can no longer be compared point by point; beyond that horizon only statistics can.
//!
//! Both runs take the same fixed steps. A step control would turn a rounding into other steps, and the result would depend
//! on its tolerance.

use pinwheel_compare::Divergence;
use pinwheel_gearbox::{Frequencies, Gearbox};
use pinwheel_scene::{Fault, FrictionLaw, Scene};
use pinwheel_timeseries::norms::LoadMagnitude;
use pinwheel_timeseries::{TimeSeries, columns};

use crate::StudyError;
use crate::control::{of_scene, run_compiled};

/// Visible share of the largest force.
const VISIBLE: f64 = 1e-3;

/// Runs a scene twice, with RK4 or, under friction, with `imex2`, and steps of `step_rad` radians of its fastest oscillation
/// on the contacts (or the scene's, if shorter);
/// `watch` receives the simulated time and returns true to stop.
///
/// A run that does not finish, or has negligible forces, is a result with the reason.
///
/// # Errors
/// Cancelled, or a scene that cannot be modelled.
pub fn horizon(
    gearbox: &Gearbox,
    step_rad: f64,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<Divergence, StudyError> {
    let scene = &gearbox.scene;
    let has_friction = scene.slides();
    let convex = scene.contact.friction_law == FrictionLaw::Regularised;
    let method = if has_friction && convex {
        "imex2"
    } else {
        "rk4"
    };
    let refused = |fault: Fault| of_scene(scene, fault.into());
    let step_s = step_rad / Frequencies::of(scene).contact_rad_s;
    let still = gearbox
        .with_solver(|solver| {
            method.clone_into(&mut solver.integrator);
            solver.step_s = solver.step_s.min(step_s);
        })
        .map_err(refused)?;
    let mut moved = still.clone();
    let nudge = |scene: &mut Scene| {
        let moment = &mut scene.mass.wheel.moment_kg_m2;
        *moment = moment.next_up();
    };
    moved.scene = still.scene.changed(nudge).map_err(refused)?;
    let not_measured = |reason: &str| Divergence {
        horizon_s: None,
        largest_share: 0.0,
        told: format!("Not measured: {reason}."),
    };
    let mut both = Vec::new();
    for gearbox in [&still, &moved] {
        let run = run_compiled(gearbox, watch)?;
        if let Some(failure) = run.ending.failure() {
            return Ok(not_measured(&format!("the run ends {failure}")));
        }
        both.push(run.time_series);
    }
    let size = LoadMagnitude::of(&both[0]).peak_force_n;
    if size < still.least_force_n() {
        return Ok(not_measured("there are no forces to speak of"));
    }
    let share = shares(&both[0], &both[1], size);
    let largest_share = share.iter().fold(0.0, |most: f64, &s| most.max(s));
    let visible = share.iter().position(|&s| !(s <= VISIBLE));
    let horizon_s = visible.map(|k| both[0].time_s()[k]);
    let duration_s = scene.solver.duration_s;
    let text = match horizon_s {
        Some(t) => format!(
            "A change in the last digit becomes visible after {t:.4} s: later, time series are compared by their statistics only."
        ),
        None if largest_share == 0.0 => format!(
            "A change in the last digit changes no force within {duration_s} s: time series are compared point by point."
        ),
        None => format!(
            "A change in the last digit never grows beyond {largest_share:.1e} of the largest force within {duration_s} s: \
             time series are compared point by point."
        ),
    };
    Ok(Divergence {
        horizon_s,
        largest_share,
        told: text,
    })
}

/// Returns the largest difference of two runs' forces at each sample, as a share of `size`, N.
pub(crate) fn shares(a: &TimeSeries, b: &TimeSeries, size: f64) -> Vec<f64> {
    let mut share = vec![0.0_f64; a.len().min(b.len())];
    for prefix in [columns::EXTERNAL_FORCE, columns::INTERNAL_FORCE] {
        for (x, y) in a.group(prefix).iter().zip(b.group(prefix)) {
            for ((share, x), y) in share.iter_mut().zip(*x).zip(y) {
                *share = share.max((x - y).abs() / size);
            }
        }
    }
    share
}
