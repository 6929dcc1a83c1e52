//! What a gear's runs are held against: two runs by methods and settings that nothing else here takes.

use pinwheel_gearbox::{Frequencies, Gearbox, native};
use pinwheel_mbs::integrators::method;
use pinwheel_scene::{Detection, FrictionLaw, Scene};
use pinwheel_timeseries::TimeSeries;

/// Method and setting (tolerance, or radians of the contacts' oscillation a step).
pub type Setting = (&'static str, f64);

/// A reference and the one that confirms it, for a run by the method `by`.
#[must_use]
pub fn settings(scene: &Scene, by: &str) -> [Setting; 2] {
    let contact = &scene.contact;
    let has_friction = contact.friction_coefficient > 0.0;
    let convex = has_friction && contact.friction_law == FrictionLaw::Regularised;
    let found = Frequencies::of(scene);
    let stiff = found.friction_1_s > 100.0 * found.contact_rad_s;
    match contact.detection {
        Detection::Points if convex => [("imex2", 0.004), ("imex2", 0.0015)],
        Detection::Points => [("rk4", 0.004), ("rk4", 0.0015)],
        Detection::Exact if !has_friction => [("dop853", 1e-11), ("dopri5", 1e-12)],
        Detection::Exact if !convex => [("dop853", 1e-9), ("dopri5", 1e-11)],
        Detection::Exact if by == "dopri5" => [("imex2-adaptive", 1e-5), ("dopri5", 1e-11)],
        Detection::Exact if stiff => [("imex2", 0.001), ("imex2-adaptive", 2e-6)],
        Detection::Exact => [("dopri5", 1e-8), ("dopri5", 1e-10)],
    }
}

/// The scene's time series by such a setting; `None` where it does not get through.
#[must_use]
pub fn run(scene: &Scene, (integrator, setting): Setting) -> Option<TimeSeries> {
    let radian = 1.0 / Frequencies::of(scene).contact_rad_s;
    let mut scene = scene.clone();
    let solver = &mut scene.solver;
    integrator.clone_into(&mut solver.integrator);
    if method(integrator).is_some_and(|method| method.adaptive) {
        solver.tolerance = setting;
    } else {
        solver.step_s = setting * radian;
    }
    let gearbox = Gearbox::new(&scene.check().ok()?).ok()?;
    let ran = native::run(&gearbox, &mut |_| false).ok()?;
    Some(ran.whole().ok()?.time_series)
}
