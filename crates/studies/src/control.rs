//! Progress and cancellation of a study.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::Thread;
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;
use pinwheel_engines::{Engine, EngineError, Run, RunStats, by_name};
use pinwheel_gearbox::energy::EnergyAccount;
use pinwheel_gearbox::native::{self, NativeError, NativeRun};
use pinwheel_gearbox::{Gearbox, GearboxError};
use pinwheel_mbs::integrators::StepCounts;
use pinwheel_scene::Scene;

use crate::StudyError;

/// Where a study is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress<'a> {
    /// Pieces done.
    pub done: usize,
    /// Pieces in all.
    pub total: usize,
    /// The piece that is worked on, e.g. a scene's name.
    pub piece: &'a str,
    /// Simulated time of all pieces together, reached and in all, s, where pieces are runs.
    pub simulated_s: Option<[f64; 2]>,
}

impl<'a> Progress<'a> {
    /// The piece begins.
    #[must_use]
    pub fn new(done: usize, total: usize, piece: &'a str) -> Self {
        Self {
            done,
            total,
            piece,
            simulated_s: None,
        }
    }

    /// The piece, a run of `duration_s` as all others are, has come to `time_s`.
    fn reached(self, time_s: f64, duration_s: f64) -> Self {
        let at = self.done as f64 * duration_s + time_s;
        Self {
            simulated_s: Some([at, self.total as f64 * duration_s]),
            ..self
        }
    }

    /// The piece, its number, and the time left where simulated time passes; short, because what a terminal has no room
    /// for is cut off.
    #[must_use]
    pub fn sentence(&self, elapsed_s: f64) -> String {
        let mut text = String::new();
        if self.total > 1 {
            let number = (self.done + 1).min(self.total);
            text.push_str(&format!("{number} of {}, ", self.total));
        }
        text.push_str(self.piece);
        if let Some([at, of]) = self.simulated_s {
            let left = elapsed_s * (of - at).max(0.0) / at;
            if left.is_finite() {
                text.push_str(&format!(", {} left", span(left)));
            }
        }
        text
    }
}

/// Seconds, minutes or hours.
fn span(time_s: f64) -> String {
    if time_s < 90.0 {
        format!("{time_s:.0} s")
    } else if time_s < 5400.0 {
        format!("{:.0} min", time_s / 60.0)
    } else {
        format!("{:.1} h", time_s / 3600.0)
    }
}

/// One run may take this many times what a comparison gives all runs of an engine.
pub(crate) const WITHIN: u32 = 2;

/// Cancellation and progress.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Set from outside to stop; looked at in every sample of every run.
    pub cancel: &'a AtomicBool,
    /// Called at the beginning of every piece, and in every sample of a long run.
    pub progress: &'a (dyn Fn(Progress<'_>) + Sync),
}

impl Control<'_> {
    /// Never cancels, reports nothing.
    #[must_use]
    pub fn quiet() -> Control<'static> {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Control {
            cancel: &NEVER,
            progress: &|_| {},
        }
    }

    /// Whether to stop.
    pub(crate) fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Fails once asked to stop.
    pub(crate) fn check(&self) -> Result<(), StudyError> {
        if self.is_cancelled() {
            return Err(StudyError::Cancelled);
        }
        Ok(())
    }

    /// Runs the scene of `gearbox` on an engine as the piece `at`. What an engine does wrong is a result, not an error.
    pub(crate) fn engine(
        &self,
        engine: &dyn Engine,
        gearbox: &Gearbox,
        at: Progress<'_>,
    ) -> Result<Result<Run, EngineError>, StudyError> {
        self.check()?;
        let scene: &Scene = &gearbox.scene;
        let end = scene.solver.duration_s;
        let report = |time_s: f64| (self.progress)(at.reached(time_s, end));
        let control = pinwheel_engines::Control {
            cancel: self.cancel,
            progress: &report,
        };
        let prepared = engine.prepare(gearbox);
        let mut result = prepared.and_then(|prepared| prepared.run(&control));
        self.check()?;
        match &mut result {
            Ok(run) => run.note_missing_channels(scene),
            Err(EngineError::Diverged { partial, .. }) => partial.note_missing_channels(scene),
            Err(EngineError::Cancelled) => return Err(StudyError::Cancelled),
            Err(_) => {}
        }
        Ok(result)
    }

    /// As [`engine`](Self::engine), but given up once its pace says that it will take more than `most`: it is then an engine
    /// that cannot honour the scene, with what it would take as the reason.
    pub(crate) fn engine_within(
        &self,
        most: Duration,
        engine: &dyn Engine,
        gearbox: &Gearbox,
        at: Progress<'_>,
    ) -> Result<Result<Run, EngineError>, StudyError> {
        let (stop, ended) = (AtomicBool::new(false), AtomicBool::new(false));
        let (begin, needs_s) = (OnceLock::new(), OnceLock::new());
        let progress = |at: Progress<'_>| {
            (self.progress)(at);
            let Some([reached, all]) = at.simulated_s else {
                return;
            };
            let duration = all / at.total as f64;
            let share = (reached - at.done as f64 * duration) / duration;
            // From its first sample on: packages may have to be installed before. CPU time, where that is less: a busy
            // machine makes no engine slower than it is, and programs of their own have limits of their own.
            let (wall, cpu) = begin.get_or_init(|| (Instant::now(), ProcessTime::now()));
            let took = wall.elapsed().min(cpu.elapsed());
            // Not all engines say how far they are.
            let pace = if share > 0.0 {
                took.as_secs_f64() / share
            } else {
                took.as_secs_f64()
            };
            if took >= most / 10 && pace > most.as_secs_f64() {
                needs_s.get_or_init(|| pace);
                stop.store(true, Ordering::Relaxed);
            }
        };
        let limited = Control {
            cancel: &stop,
            progress: &progress,
        };
        let ran = std::thread::scope(|scope| {
            // The user's wish to stop reaches the engine wherever it waits.
            let watch = scope.spawn(|| {
                while !ended.load(Ordering::Relaxed) {
                    if self.is_cancelled() {
                        stop.store(true, Ordering::Relaxed);
                    }
                    std::thread::park_timeout(Duration::from_millis(10));
                }
            });
            // However the engine ends, a panic included.
            let _over = Over(&ended, watch.thread().clone());
            limited.engine(engine, gearbox, at)
        });
        match (ran, needs_s.get()) {
            (Err(StudyError::Cancelled), Some(needs_s)) if !self.is_cancelled() => {
                Ok(Err(EngineError::Unsupported {
                    engine: engine.name().to_owned(),
                    reason: format!(
                        "one run of it would take about {needs_s:.0} s here; give it more time (--longest {:.0})",
                        (needs_s / f64::from(WITHIN)).ceil()
                    ),
                }))
            }
            (ran, _) => ran,
        }
    }

    /// A watcher of a native run of `scene` that is the piece `at`: reports, and is true when the run must stop.
    pub(crate) fn watch<'s>(
        &'s self,
        scene: &Scene,
        at: Progress<'s>,
    ) -> impl FnMut(f64) -> bool + 's {
        let end = scene.solver.duration_s;
        move |time_s| {
            (self.progress)(at.reached(time_s, end));
            self.is_cancelled()
        }
    }

    /// Runs a scene; a divergence is a result, not an error.
    pub(crate) fn run(&self, scene: &Scene) -> Result<Ended, StudyError> {
        run(scene, &mut |_| self.cancel.load(Ordering::Relaxed))
    }

    /// Runs a scene that must reach its end.
    pub(crate) fn complete(&self, scene: &Scene) -> Result<NativeRun, StudyError> {
        match self.run(scene)? {
            Ended::Whole(run) => Ok(*run),
            Ended::Diverged {
                time_s, quantity, ..
            } => Err(StudyError::Reference {
                scene: scene.name.clone(),
                reason: format!("diverged at t = {time_s:.6} s: {quantity}"),
            }),
        }
    }
}

/// Runs a scene; `watch` as in [`native::run`].
pub(crate) fn run(scene: &Scene, watch: &mut dyn FnMut(f64) -> bool) -> Result<Ended, StudyError> {
    run_compiled(&compile(scene)?, watch)
}

/// The gearbox of a scene that a study has changed, checked again.
pub(crate) fn compile(scene: &Scene) -> Result<Gearbox, StudyError> {
    let checked = scene.clone().check().map_err(GearboxError::from);
    checked
        .and_then(|scene| Gearbox::new(&scene))
        .map_err(|source| of_scene(scene, source))
}

/// Runs what is compiled; `watch` as in [`native::run`].
pub(crate) fn run_compiled(
    gearbox: &Gearbox,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<Ended, StudyError> {
    match native::run(gearbox, watch) {
        Ok(run) => Ok(Ended::Whole(Box::new(run))),
        Err(NativeError::Diverged {
            time_s,
            quantity,
            partial,
        }) => Ok(Ended::Diverged {
            time_s,
            quantity,
            evaluations: partial.counts.evaluations,
        }),
        Err(NativeError::Stopped) => Err(StudyError::Cancelled),
        Err(NativeError::Model(source)) => Err(of_scene(&gearbox.scene, source)),
        Err(NativeError::Courses(source)) => Err(StudyError::Courses(source)),
    }
}

pub(crate) fn of_scene(scene: &Scene, source: GearboxError) -> StudyError {
    StudyError::Scene {
        scene: scene.name.clone(),
        source,
    }
}

/// Runs a scene on an engine of the registry, as [`run`] does on the native solver. The outer error of a scene that the engine
/// does not honour, or of a run that broke, is its reason.
pub(crate) fn run_on(
    name: &str,
    scene: &Scene,
    cancel: &AtomicBool,
) -> Result<Result<(Ended, RunStats), String>, StudyError> {
    let gearbox = compile(scene)?;
    let Some(engine) = by_name(name, scene) else {
        return Ok(Err(format!("there is no engine `{name}`")));
    };
    let control = pinwheel_engines::Control {
        cancel,
        progress: &|_| {},
    };
    let ran = engine
        .prepare(&gearbox)
        .and_then(|prepared| prepared.run(&control));
    match ran {
        Ok(run) => {
            let stats = run.stats;
            let ended = NativeRun {
                counts: StepCounts {
                    steps: stats.steps,
                    rejected: stats.rejected_steps,
                    evaluations: stats.rhs_calls,
                    jacobians: 0,
                },
                newton_steps: 0,
                degrees_of_freedom: stats.degrees_of_freedom,
                joint_drift_m: stats.joint_drift_m.unwrap_or(0.0),
                end_s: scene.solver.duration_s,
                energy: EnergyAccount::default(),
                courses: run.courses,
            };
            Ok(Ok((Ended::Whole(Box::new(ended)), stats)))
        }
        Err(EngineError::Diverged {
            time_s,
            quantity,
            partial,
            ..
        }) => {
            let evaluations = partial.stats.rhs_calls;
            let ended = Ended::Diverged {
                time_s,
                quantity,
                evaluations,
            };
            Ok(Ok((ended, partial.stats)))
        }
        Err(EngineError::Cancelled) => Err(StudyError::Cancelled),
        Err(
            error @ (EngineError::Unsupported { .. }
            | EngineError::Absent { .. }
            | EngineError::Failed { .. }),
        ) => Ok(Err(error.to_string())),
    }
}

/// Lets the watch of a run go once the run is over.
struct Over<'a>(&'a AtomicBool, Thread);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
        self.1.unpark();
    }
}

/// How a run ended.
pub(crate) enum Ended {
    Whole(Box<NativeRun>),
    Diverged {
        time_s: f64,
        quantity: String,
        evaluations: u64,
    },
}

impl Ended {
    /// Of the forces.
    pub(crate) fn evaluations(&self) -> u64 {
        match self {
            Self::Whole(run) => run.counts.evaluations,
            Self::Diverged { evaluations, .. } => *evaluations,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_counted_and_fit() {
        let piece = Progress::new(1, 4, "atlas of steel");
        assert_eq!(piece.sentence(1.0), "2 of 4, atlas of steel");
        let run = |at| Progress {
            simulated_s: Some([at, 0.6]),
            ..Progress::new(6, 12, "rapier-own-contact-colliders")
        };
        let line = run(0.3).sentence(12.0);
        assert_eq!(line, "7 of 12, rapier-own-contact-colliders, 12 s left");
        // `stability [============] 99m: ` stands before it.
        assert!(line.len() + 28 <= 80);
        assert!(run(1e-4).sentence(1.0).ends_with(", 1.7 h left"));
        assert!(run(0.0).sentence(1.0).ends_with("colliders"));
    }
}
