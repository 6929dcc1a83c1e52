//! How long two runs stay together that differ by one rounding.
//!
//! The moment of inertia of the wheels is moved to the next representable number. Where the
//! difference of the sleeve forces then grows to a visible share, time series can no longer be compared
//! point by point; beyond that horizon only statistics can.
//!
//! Both runs take the same fixed steps: a step control turns a rounding into another sequence of steps,
//! and then measures its own tolerance.

use pinwheel_gearbox::{Frequencies, Gearbox};
use pinwheel_scene::{Fault, FrictionLaw, Scene};
use pinwheel_timeseries::{TimeSeries, columns};
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::control::{of_scene, run_compiled};
use pinwheel_timeseries::norms::Level;

/// Share of the largest force that counts as visible.
pub const VISIBLE: f64 = 1e-3;

/// What a rounding grows to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Horizon {
    /// The scene.
    pub scene: String,
    /// Time from which the largest force difference exceeds [`VISIBLE`] of the largest force, s; `None`: not within the run.
    pub horizon_s: Option<f64>,
    /// Largest difference of the run, as a share of the largest force.
    pub largest_share: f64,
    /// Share in the last tenth of the run.
    pub last_share: f64,
    /// Sample times and shares, for a figure.
    pub time_s: Vec<f64>,
    /// See `time_s`.
    pub share: Vec<f64>,
    /// Length of the runs, s.
    pub duration_s: f64,
    /// Why there is no answer.
    pub refused: Option<String>,
}

impl Horizon {
    /// One sentence for the reader.
    #[must_use]
    pub fn sentence(&self) -> String {
        if let Some(reason) = &self.refused {
            return format!("Not measured: {reason}.");
        }
        match self.horizon_s {
            Some(t) => format!(
                "A change in the last digit becomes visible after {t:.4} s: later, time series are compared by their statistics only."
            ),
            None if self.largest_share == 0.0 => format!(
                "A change in the last digit changes no force within {} s: time series are compared point by point.",
                self.duration_s
            ),
            None => format!(
                "A change in the last digit never grows beyond {:.1e} of the largest force within {} s: time series are compared point by point.",
                self.largest_share, self.duration_s
            ),
        }
    }
}

/// Step of both runs in a study, in radians of the fastest oscillation on the contacts: 2e-6 s for the paper's gear.
pub const STEP_RAD: f64 = 0.02;

/// Runs a scene twice, with RK4 or, under friction, with `imex2`, and steps of `step_rad` radians of its fastest oscillation
/// on the contacts (or the scene's, if shorter);
/// `watch` receives the simulated time and returns true to stop.
///
/// A run that does not reach its end, or has no forces to speak of, is an answer with the reason.
///
/// # Errors
/// Cancelled, or a scene that cannot be modelled.
pub fn horizon(
    gearbox: &Gearbox,
    step_rad: f64,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<Horizon, StudyError> {
    let scene = &gearbox.scene;
    let has_friction = scene.contact.friction_coefficient > 0.0;
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
    let mut found = Horizon {
        scene: scene.name.clone(),
        horizon_s: None,
        largest_share: 0.0,
        last_share: 0.0,
        time_s: Vec::new(),
        share: Vec::new(),
        duration_s: scene.solver.duration_s,
        refused: None,
    };
    let mut both = Vec::new();
    for gearbox in [&still, &moved] {
        let run = run_compiled(gearbox, watch)?;
        if let Some(failure) = run.ending.failure() {
            found.refused = Some(format!("the run ends {failure}"));
            return Ok(found);
        }
        both.push(run.time_series);
    }
    let size = Level::of(&both[0]).peak_force_n;
    if size < still.least_force_n() {
        found.refused = Some("there are no forces to speak of".to_owned());
        return Ok(found);
    }
    let share = shares(&both[0], &both[1], size);
    let largest = |from: usize| share[from..].iter().fold(0.0, |most: f64, &s| most.max(s));
    found.largest_share = largest(0);
    found.last_share = largest(share.len() - share.len().div_ceil(10));
    found.time_s = both[0].time_s().to_vec();
    let visible = share.iter().position(|&s| !(s <= VISIBLE));
    found.horizon_s = visible.map(|k| found.time_s[k]);
    found.share = share;
    Ok(found)
}

fn shares(a: &TimeSeries, b: &TimeSeries, size: f64) -> Vec<f64> {
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
