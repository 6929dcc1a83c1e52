//! The gearbox in motion: the native solver's own courses, pair by pair.

use std::sync::atomic::{AtomicBool, Ordering};

use pinwheel_courses::Courses;
use pinwheel_gearbox::native::{self, NativeError};
use pinwheel_gearbox::resolve::{self, Budget};
use pinwheel_gearbox::{Gearbox, GearboxError, auto};
use pinwheel_report::animation::{Animation, CHANNELS, Gear};
use pinwheel_scene as scene;
use pinwheel_scene::Scene;

use crate::PageError;

/// What a picture may cost where the scene's own method fails: a few seconds.
const BUDGET: Budget = Budget {
    evaluations: 3_000_000,
};

/// What is drawn of a gear.
fn gear(scene: &Scene) -> Gear {
    let gear = &scene.gear;
    Gear {
        eccentricity_m: gear.eccentricity_m,
        external_sleeves: gear.external_sleeves,
        shortening: gear.shortening,
        external_sleeve_radius_m: gear.external_sleeve_radius_m,
        internal_sleeves: gear.internal_sleeves,
        internal_sleeve_radius_m: gear.internal_sleeve_radius_m,
        internal_circle_radius_m: gear.internal_circle_radius_m,
        hole_radius_m: gear.hole_radius_m,
        wheels: gear.wheels,
        backlash_m: gear.backlash_m,
        input_speed_rad_s: scene.drive.input_speed_rad_s,
    }
}

/// The scene's motion over as long as a page holds, and the time to begin at, s: its second half, where the
/// start-up transient has died down. `None` where there is nothing to show, as when the run diverges at once.
///
/// # Errors
/// `cancel` was set.
pub fn of(scene: &Scene, cancel: &AtomicBool) -> Result<Option<(Animation, f64)>, PageError> {
    let (_, stretch) = gear(scene).sampling();
    let duration = scene.solver.duration_s.min(stretch);
    let title = format!("{}, native solver", scene.name);
    let found = window(scene, &title, (0.0, duration), cancel)?;
    Ok(found.map(|animation| (animation, 0.5 * duration)))
}

/// The scene's motion from `from_s` to `to_s`, recorded anew with the channels that a picture needs.
///
/// # Errors
/// `cancel` was set.
pub fn window(
    scene: &Scene,
    title: &str,
    (from_s, to_s): (f64, f64),
    cancel: &AtomicBool,
) -> Result<Option<Animation>, PageError> {
    let gear = gear(scene);
    let mut scene = scene.clone();
    scene.solver.formulation = scene::Formulation::Reduced;
    // No denser than the scene's own samples on short runs, which would only be straight lines.
    scene.solver.sample_s = gear.sampling().0.min(to_s);
    scene.solver.duration_s = to_s;
    scene.output.channels = CHANNELS.map(str::to_owned).to_vec();
    let built = scene.check().map_err(GearboxError::from);
    let Ok(gearbox) = built.and_then(|scene| Gearbox::new(&scene)) else {
        return Ok(None);
    };
    let watch = &mut |_| cancel.load(Ordering::Relaxed);
    let mut ran = native::run(&gearbox, watch);
    let mut title = title.to_owned();
    if matches!(ran, Err(NativeError::Diverged { .. })) {
        // Forces that run away are no picture of the gear where another method gets through.
        match resolve::run_resolved(&gearbox, auto::PROMISE, BUDGET, watch) {
            Ok((run, _)) => {
                title.push_str(", by a method that gets through");
                ran = Ok(run);
            }
            Err(NativeError::Stopped) => return Err(PageError::Cancelled),
            Err(_) => title.push_str(", until it diverges"),
        }
    }
    let courses: Courses = match ran {
        Ok(run) => run.courses,
        // What there is until then is worth seeing.
        Err(NativeError::Diverged { partial, .. }) => partial.courses,
        Err(NativeError::Stopped) => return Err(PageError::Cancelled),
        Err(NativeError::Model(_) | NativeError::Courses(_)) => return Ok(None),
    };
    Ok(Animation::of(title, &gear, &courses, (from_s, to_s)))
}
