//! The gearbox in motion: the native solver's own time series, pair by pair.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::study::Block;
use pinwheel_engines::Cancelled;
use pinwheel_gearbox::native::{self, NativeError};
use pinwheel_gearbox::resolve;
use pinwheel_gearbox::{Gearbox, GearboxError, auto};
use pinwheel_scene::{CheckedScene, Formulation, Scene};
use pinwheel_timeseries::TimeSeries;

mod picture;

pub(crate) use picture::{Animation, markup};
use picture::{needed, sampling};

/// Limit of the cost of a picture where the scene's own method fails, evaluations: a few seconds.
const BUDGET: u64 = 3_000_000;

/// A gearbox's motion for a place beside the first screen, over as long as a page holds. It begins at its second half, where the
/// start-up transient has died down. Empty where there is nothing to show, as when the run diverges at once.
///
/// # Errors
/// `cancel` was set.
pub(crate) fn aside(gearbox: &Gearbox, cancel: &AtomicBool) -> Result<Vec<Block>, Cancelled> {
    let scene = &gearbox.scene;
    let (step, duration) = sampled(scene);
    let title = format!("{}, native solver", scene.name);
    let found = window(gearbox, &title, (0.0, duration), step, cancel)?;
    Ok(found.map_or_else(Vec::new, |(view, _)| {
        let heading = Block::heading("The gearbox in motion");
        vec![heading, Block::Html(markup(&[view], 0.5 * duration))]
    }))
}

/// Distance of the samples of a scene's motion, and the time that a page shows, s.
pub(crate) fn sampled(scene: &Scene) -> (f64, f64) {
    let (step, stretch) = sampling(scene);
    (step, scene.solver.duration_s.min(stretch))
}

/// A gearbox's motion from `from_s` to `to_s`, recorded anew every `step` seconds with the channels that a picture needs.
/// Pictures beside each other share both.
///
/// # Errors
/// `cancel` was set.
pub(crate) fn window(
    gearbox: &Gearbox,
    title: &str,
    (from_s, to_s): (f64, f64),
    step: f64,
    cancel: &AtomicBool,
) -> Result<Option<(Animation, TimeSeries)>, Cancelled> {
    let recording = gearbox.with_solver(|solver| {
        solver.formulation = Formulation::Reduced;
        // No denser than the scene's own samples on short runs, which would only be straight lines.
        solver.sample_s = step.min(to_s);
        solver.duration_s = to_s;
    });
    let channels = needed(&gearbox.scene);
    let recording = recording.map_err(GearboxError::from);
    let Ok(gearbox) = recording.and_then(|gearbox| gearbox.with_channels(channels)) else {
        return Ok(None);
    };
    let watch = &mut |_| cancel.load(Ordering::Relaxed);
    let mut run = match native::run_at_samples(&gearbox, watch) {
        Ok(run) => run,
        Err(NativeError::Stopped) => return Err(Cancelled),
        Err(_) => return Ok(None),
    };
    let mut title = title.to_owned();
    if !run.ending.is_finished() {
        // Forces that run away are no picture of the gear where another method gets through.
        match resolve::run_resolved(&gearbox, auto::TARGET, BUDGET, watch) {
            Ok((other, _)) if other.ending.is_finished() => {
                title.push_str(", by a method that gets through");
                run = other;
            }
            Err(NativeError::Stopped) => return Err(Cancelled),
            // What there is until then is worth seeing.
            _ => title.push_str(", until it diverges"),
        }
    }
    let span = (from_s, to_s);
    let view = Animation::of(title, &gearbox.scene, &run.time_series, span);
    Ok(view.map(|view| (view, run.time_series)))
}

/// The gearboxes of scenes side by side, over the same time; `None` where there is nothing to show.
///
/// # Errors
/// `cancel` was set.
pub(crate) fn beside(
    scenes: [(&str, &CheckedScene); 2],
    span: (f64, f64),
    step: f64,
    begin_s: f64,
    cancel: &AtomicBool,
) -> Result<Option<Block>, Cancelled> {
    let mut views = Vec::new();
    for (title, scene) in scenes {
        if let Ok(gearbox) = Gearbox::new(scene) {
            let found = window(&gearbox, title, span, step, cancel)?;
            views.extend(found.map(|(view, _)| view));
        }
    }
    Ok((!views.is_empty()).then(|| Block::Html(markup(&views, begin_s))))
}
