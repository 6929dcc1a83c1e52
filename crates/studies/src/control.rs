//! Runs within a study: time limits, and direct use of the native solver.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::Thread;
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;
use pinwheel_engines::{AccuracySetting, Cancelled, Ending, Engine, Run, by_name};
pub use pinwheel_engines::{Control, Progress};
use pinwheel_gearbox::native::{self, NativeError, NativeRun};
use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_scene::{Formulation, Scene};

use crate::StudyError;

/// Time limit of one run over a comparison's limit for all runs of an engine.
pub(crate) const WITHIN: u32 = 2;
/// Interval between two reads of the CPU clock, which cost time in a fast run.
const LOOK: Duration = Duration::from_millis(1);

/// Time limit of a run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TimeLimit {
    /// Longest time of a complete run.
    pub(crate) most: Duration,
    /// Value of the option `--longest` for a run of one second, s.
    pub(crate) suggested_limit_s: f64,
    /// True if the limit also applies, by wall time, to engines in separate programs, which have limits of their own.
    pub(crate) outside: bool,
}

impl TimeLimit {
    /// Runs the scene of `gearbox` on an engine, and stops it when its pace exceeds the limit. The run is then timed out
    /// with the expected time as the reason.
    pub(crate) fn run(
        self,
        engine: &dyn Engine,
        gearbox: &Gearbox,
        control: &Control<'_>,
    ) -> Result<Run, Cancelled> {
        let (stop, ended) = (AtomicBool::new(false), AtomicBool::new(false));
        let (begin, gave_up) = (OnceLock::new(), OnceLock::new());
        let looked_ns = AtomicU64::new(0);
        let by_wall = self.outside && engine.info().outside;
        let duration = gearbox.scene.solver.duration_s;
        let progress = |at: Progress<'_>| {
            (control.progress)(at);
            let Some([reached, _]) = at.simulated_s else {
                return;
            };
            // Runs in Python have their own thread, and report its time.
            let cpu = || at.cpu.unwrap_or_else(|| ThreadTime::now().as_duration());
            // Time counts from the first sample: installation of packages may precede it.
            let (wall, before) = begin.get_or_init(|| (Instant::now(), cpu()));
            let wall = wall.elapsed();
            let now_ns = wall.as_nanos() as u64;
            if now_ns < looked_ns.load(Ordering::Relaxed) + LOOK.as_nanos() as u64 {
                return;
            }
            looked_ns.store(now_ns, Ordering::Relaxed);
            // The lesser of CPU and wall time, so that a busy machine does not count.
            let took = if by_wall {
                wall
            } else {
                wall.min(cpu().saturating_sub(*before))
            };
            let time_s = reached - at.done as f64 * duration;
            // Not all engines report their progress.
            let pace = if time_s > 0.0 {
                took.as_secs_f64() * duration / time_s
            } else {
                took.as_secs_f64()
            };
            if took >= self.most / 10 && pace > self.most.as_secs_f64() {
                gave_up.get_or_init(|| (time_s, pace));
                stop.store(true, Ordering::Relaxed);
            }
        };
        let limited = control.limited(&stop, &progress);
        let ran = std::thread::scope(|scope| {
            // A stop by the user reaches the engine while it waits.
            let watch = scope.spawn(|| {
                while !ended.load(Ordering::Relaxed) {
                    if control.is_cancelled() {
                        stop.store(true, Ordering::Relaxed);
                    }
                    std::thread::park_timeout(Duration::from_millis(10));
                }
            });
            // Also after a panic of the engine.
            let _over = Over(&ended, watch.thread().clone());
            engine.run_compiled(gearbox, &limited)
        });
        match (ran, gave_up.get()) {
            (Err(Cancelled), Some(&(time_s, needs_s))) if !control.is_cancelled() => {
                Ok(Run::ended(Ending::TimedOut {
                    time_s,
                    reason: format!(
                        "one run of it would take about {needs_s:.0} s here; give it more time (--longest {:.0})",
                        (needs_s * self.suggested_limit_s).ceil()
                    ),
                }))
            }
            (ran, _) => ran,
        }
    }
}

/// Runs a scene on an engine of the registry.
pub(crate) fn run_on(name: &str, scene: &Scene, control: &Control<'_>) -> Result<Run, StudyError> {
    let gearbox = compile(scene)?;
    let Some(engine) = by_name(name, scene) else {
        let reason = format!("there is no engine `{name}`");
        return Ok(Run::ended(Ending::failed(reason)));
    };
    Ok(engine.run_compiled(&gearbox, control)?)
}

/// Runs a scene on the native solver.
pub(crate) fn run(scene: &Scene, control: &Control<'_>) -> Result<NativeRun, StudyError> {
    run_compiled(&compile(scene)?, &mut |_| control.is_cancelled())
}

/// Returns the scene in the reduced form, with a method and its step (s) or tolerance.
pub(crate) fn reduced_by(scene: &Scene, method: &str, setting: f64) -> Scene {
    let mut scene = scene.clone();
    scene.solver.formulation = Formulation::Reduced;
    method.clone_into(&mut scene.solver.integrator);
    AccuracySetting::of(method).set(&mut scene, setting);
    scene
}

/// Runs a scene that must finish.
pub(crate) fn complete(scene: &Scene, control: &Control<'_>) -> Result<NativeRun, StudyError> {
    let finished = run(scene, control)?.finished();
    finished.map_err(|ending| StudyError::reference(scene, ending))
}

/// Compiles a scene changed by a study, after checks.
pub(crate) fn compile(scene: &Scene) -> Result<Gearbox, StudyError> {
    let checked = scene.clone().check().map_err(GearboxError::from);
    checked
        .and_then(|scene| Gearbox::new(&scene))
        .map_err(|source| of_scene(scene, source))
}

/// Runs a compiled scene; `watch` as in [`native::run`].
pub(crate) fn run_compiled(
    gearbox: &Gearbox,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<NativeRun, StudyError> {
    native::run(gearbox, watch).map_err(|error| match error {
        NativeError::Stopped => StudyError::Cancelled,
        NativeError::Model(source) => of_scene(&gearbox.scene, source),
        NativeError::TimeSeries(source) => StudyError::TimeSeries(source),
        NativeError::Ended(ending) => StudyError::reference(&gearbox.scene, ending),
    })
}

pub(crate) fn of_scene(scene: &Scene, source: GearboxError) -> StudyError {
    StudyError::Scene {
        scene: scene.name.clone(),
        source,
    }
}

/// Ends the watch of a run on drop.
struct Over<'a>(&'a AtomicBool, Thread);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
        self.1.unpark();
    }
}
