//! Converged run of a scene, with a second, maximally independent run as evidence.
//!
//! | scene | reference | second run |
//! |---|---|---|
//! | exact contact, no friction | dopri5, tolerance 1e-12 | dop853, tolerance 1e-11 |
//! | regularised friction | dopri5, tolerance 1e-11 | imex2-adaptive, tolerance 1e-5 |
//! | regularised friction, stiff | rodas5p, tolerance 1e-9 | imex2, steps of 0.001 rad |
//! | other friction | dopri5, tolerance 1e-11 | dop853, tolerance 1e-9 |
//! | discrete points | rk4 or, with regularised friction, imex2, steps of 0.0015 rad | equal method, 0.004 rad |
//!
//! Radians refer to the contacts' oscillation. The distance of the two runs is the error of the worse of them, an upper
//! estimate for the reference. For judged runs by another method than dopri5, the second run with regularised friction also
//! uses dopri5 (1e-10 and 1e-8): sharper, and still independent of the judged run.

use pinwheel_engines::AccuracySetting;
use pinwheel_gearbox::Frequencies;
use pinwheel_scene::{Detection, FrictionLaw, Scene};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::{Distance, LoadFloor};
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::control::{Control, complete, reduced_by};

/// Method and setting: a tolerance, or a step in radians of the contacts' oscillation.
pub type Setting = (&'static str, f64);

/// Converged solution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solution {
    /// Integrator.
    pub method: String,
    /// Step (s) or tolerance.
    pub setting: f64,
    /// Number of right-hand-side calls.
    pub rhs_calls: u64,
}

/// Reference for the errors of runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Solution used as reference.
    pub solution: Solution,
    /// Second solution.
    pub second: Solution,
    /// Distance of both: an upper estimate of the reference's error.
    pub apart: Distance,
}

/// Returns the settings of the second run and the reference of a scene, for a run by the method `by`.
pub fn settings(scene: &Scene, by: &str) -> [Setting; 2] {
    let contact = &scene.contact;
    let has_friction = scene.slides();
    let convex = has_friction && contact.friction_law == FrictionLaw::Regularised;
    let rates = Frequencies::of(scene);
    let stiff = rates.friction_1_s > 100.0 * rates.contact_rad_s;
    match contact.detection {
        Detection::Points if convex => [("imex2", 0.004), ("imex2", 0.0015)],
        Detection::Points => [("rk4", 0.004), ("rk4", 0.0015)],
        Detection::Exact if !has_friction => [("dop853", 1e-11), ("dopri5", 1e-12)],
        Detection::Exact if !convex => [("dop853", 1e-9), ("dopri5", 1e-11)],
        Detection::Exact if stiff => [("imex2", 0.001), ("rodas5p", 1e-9)],
        Detection::Exact if by == "dopri5" => [("imex2-adaptive", 1e-5), ("dopri5", 1e-11)],
        Detection::Exact => [("dopri5", 1e-8), ("dopri5", 1e-10)],
    }
}

/// Returns the scene in the reduced form with a setting.
pub(crate) fn scene(scene: &Scene, (integrator, setting): Setting) -> Scene {
    let setting = match AccuracySetting::of(integrator) {
        AccuracySetting::Step => setting / Frequencies::of(scene).contact_rad_s,
        AccuracySetting::Tolerance => setting,
    };
    reduced_by(scene, integrator, setting)
}

/// Returns the scene's time series with a setting.
///
/// # Errors
/// Cancelled, a scene that cannot be modelled, or an unfinished run.
pub fn solve(
    scene: &Scene,
    setting: Setting,
    control: &Control<'_>,
) -> Result<(Solution, TimeSeries), StudyError> {
    let scene = self::scene(scene, setting);
    let run = complete(&scene, control)?;
    let method = scene.solver.integrator.clone();
    let solution = Solution {
        setting: AccuracySetting::of(&method).get(&scene),
        method,
        rhs_calls: run.counts.evaluations,
    };
    Ok((solution, run.time_series))
}

/// Makes both runs of a scene, with fixed steps `coarser` times as long, and returns them, the reference first; calls `announce`
/// before each.
///
/// # Errors
/// Errors of [`solve`].
pub(crate) fn run(
    scene: &Scene,
    coarser: f64,
    control: &Control<'_>,
    announce: &mut dyn FnMut(&str),
) -> Result<(Reference, [TimeSeries; 2]), StudyError> {
    let [second, first] = settings(scene, "dopri5");
    let mut solve = |(method, mut setting): Setting| {
        if AccuracySetting::of(method) == AccuracySetting::Step {
            setting *= coarser;
        }
        announce(&format!("reference: {method}, {setting:.2e}"));
        solve(scene, (method, setting), control)
    };
    let (solution, own) = solve(first)?;
    let (second, other) = solve(second)?;
    let reference = Reference {
        solution,
        second,
        apart: Distance::between(&other, &own, LoadFloor::default()),
    };
    Ok((reference, [own, other]))
}
