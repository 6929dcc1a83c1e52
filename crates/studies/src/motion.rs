//! Motion of the gearbox for drawings on pages: time series of the native solver by pairs.

use std::f64::consts::{PI, TAU};

use pinwheel_engines::{Cancelled, Control};
use pinwheel_gearbox::native::{self, NativeError};
use pinwheel_gearbox::{Gearbox, GearboxError, auto, resolve};
use pinwheel_scene::{CheckedScene, Formulation, Scene, speed_profile};
use pinwheel_timeseries::{TimeSeries, columns};

/// Largest number of evaluations for a picture after the scene's method fails: a few seconds.
const BUDGET: u64 = 3_000_000;
/// Largest size of one gearbox's samples as 16-bit numbers, before packing, bytes.
pub const BYTES: usize = 360_000;
/// Samples per passage of a disc from pin to pin, which resolve the forces.
const PER_SLEEVE: f64 = 24.0;
/// Radians in a minute of arc.
const ARCMIN: f64 = PI / (180.0 * 60.0);

/// Motion of one gearbox over an interval of time.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Name of the gearbox and of the method.
    pub title: String,
    /// Scene of the gearbox.
    pub scene: CheckedScene,
    /// Samples with all of [`channels`], evenly spaced.
    pub time_series: TimeSeries,
    /// Begin and end of the interval, s.
    pub span_s: (f64, f64),
    /// Time at which the animation begins, s.
    pub begin_s: f64,
}

impl Motion {
    /// Computes a gearbox's motion over the longest time for a page. The animation begins at its second half, after the
    /// start-up transient. `None` without a motion, for example if the run diverges at once.
    ///
    /// # Errors
    /// Cancelled.
    pub fn of(gearbox: &Gearbox, control: &Control<'_>) -> Result<Option<Self>, Cancelled> {
        let scene = &gearbox.scene;
        let (step, duration) = sampled(scene);
        let title = format!("{}, native solver", scene.name);
        let motion = Self::over(gearbox, &title, (0.0, duration), step, control)?;
        Ok(motion.map(|motion| Self {
            begin_s: 0.5 * duration,
            ..motion
        }))
    }

    /// Computes a gearbox's motion from `from_s` to `to_s`, recorded again every `step` seconds with the channels for a
    /// picture. Adjacent pictures share both.
    ///
    /// # Errors
    /// Cancelled.
    pub fn over(
        gearbox: &Gearbox,
        title: &str,
        (from_s, to_s): (f64, f64),
        step: f64,
        control: &Control<'_>,
    ) -> Result<Option<Self>, Cancelled> {
        let recording = gearbox.with_solver(|solver| {
            solver.formulation = Formulation::Reduced;
            // Samples no denser than the scene's on short runs, which would give only straight lines.
            solver.sample_s = step.min(to_s);
            solver.duration_s = to_s;
        });
        let names = needed(&gearbox.scene);
        let recording = recording.map_err(GearboxError::from);
        let Ok(gearbox) = recording.and_then(|gearbox| gearbox.with_channels(names)) else {
            return Ok(None);
        };
        let watch = &mut |time_s| control.reached(time_s);
        let mut run = match native::run_at_samples(&gearbox, watch) {
            Ok(run) => run,
            Err(NativeError::Stopped) => return Err(Cancelled),
            Err(_) => return Ok(None),
        };
        let mut title = title.to_owned();
        if !run.ending.is_finished() {
            // Diverging forces do not show the gear if another method finishes.
            match resolve::run_resolved(&gearbox, auto::TARGET, BUDGET, watch) {
                Ok((other, _)) if other.ending.is_finished() => {
                    title.push_str(", by a method that finishes");
                    run = other;
                }
                Err(NativeError::Stopped) => return Err(Cancelled),
                // The motion until the divergence is shown.
                _ => title.push_str(", until it diverges"),
            }
        }
        Ok(Some(Self {
            title,
            scene: gearbox.scene.clone(),
            time_series: run.time_series,
            span_s: (from_s, to_s),
            begin_s: from_s,
        }))
    }

    /// Computes the motions of two scenes over the same time, except those without a motion.
    ///
    /// # Errors
    /// Cancelled.
    pub fn beside(
        scenes: [(&str, &CheckedScene); 2],
        span: (f64, f64),
        step: f64,
        control: &Control<'_>,
    ) -> Result<Vec<Self>, Cancelled> {
        let mut all = Vec::new();
        for (title, scene) in scenes {
            if let Ok(gearbox) = Gearbox::new(scene) {
                all.extend(Self::over(&gearbox, title, span, step, control)?);
            }
        }
        Ok(all)
    }
}

/// Returns the sampling interval of a scene's motion, and the time shown on a page, s.
pub fn sampled(scene: &Scene) -> (f64, f64) {
    let turn = TAU / speed_profile::fastest_rad_s(&scene.drive).abs().max(1e-9);
    let sleeve = turn / scene.gear.external_sleeves as f64;
    // Vibration of the discs on their contacts, about 1 kHz, must be resolved too.
    let step = (sleeve / PER_SLEEVE).min(2e-4);
    let samples = BYTES / (2 * channels(scene).len());
    let longest = step * samples.saturating_sub(1) as f64;
    (step, scene.solver.duration_s.min(longest))
}

/// True if discs move relative to their eccentrics.
pub fn floats(scene: &Scene) -> bool {
    scene.bearings.eccentric.is_some()
}

/// Returns the additional channels for a motion (`output.channels` of the scene).
fn needed(scene: &Scene) -> Vec<String> {
    let mut needed = vec![
        "transmission_error_arcmin",
        "wheel_transmission_error_arcmin_*",
        "wheel_*_external_normal_force_n_*",
        "wheel_*_internal_normal_force_n_*",
    ];
    if floats(scene) {
        needed.extend([
            "eccentric_bearing_offset_x_m_*",
            "eccentric_bearing_offset_y_m_*",
        ]);
    }
    needed.into_iter().map(str::to_owned).collect()
}

/// Returns the channels of a motion in their order, each with its factor: torques, angles in rad, forces, offsets in mm.
pub fn channels(scene: &Scene) -> Vec<(String, f64)> {
    let gear = &scene.gear;
    let mut channels = vec![
        (columns::INPUT_TORQUE.to_owned(), 1.0),
        (columns::OUTPUT_TORQUE.to_owned(), 1.0),
        ("transmission_error_arcmin".to_owned(), ARCMIN),
    ];
    let error = |i| (format!("wheel_transmission_error_arcmin_{i}"), ARCMIN);
    channels.extend((0..gear.wheels).map(error));
    for i in 0..gear.wheels {
        for (kind, count) in [
            ("external", gear.external_sleeves),
            ("internal", gear.internal_sleeves),
        ] {
            let force = |n| (format!("wheel_{i}_{kind}_normal_force_n_{n}"), 1.0);
            channels.extend((0..count).map(force));
        }
    }
    if floats(scene) {
        let offset = |(i, axis)| (format!("eccentric_bearing_offset_{axis}_m_{i}"), 1e3);
        let axes = (0..gear.wheels).flat_map(|i| [(i, "x"), (i, "y")]);
        channels.extend(axes.map(offset));
    }
    channels
}
