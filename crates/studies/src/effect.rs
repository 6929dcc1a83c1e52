//! Settings without effect, identified by computing a result again without each of them.

use std::time::Duration;

use pinwheel_engines::{Cancelled, Engine, Run, SharedModel};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Override, Scene};

use crate::StudyError;
use crate::control::{Control, Progress, TimeLimit};
use crate::design::DesignResult;
use crate::explained::explain;

/// Longest wall time of a repeated run.
const LONGEST_RUN: Duration = Duration::from_secs(2);
/// Longest wall time of a repeated design.
const LONGEST_DESIGN: Duration = Duration::from_secs(6);
/// Number of samples that are compared before the rest of a run; most settings affect them.
const FIRST: f64 = 10.0;

/// Settings of a command line, with the resulting scene.
#[derive(Debug, Clone, Copy)]
pub struct Settings<'a> {
    /// Scene file or preset.
    pub spec: &'a str,
    /// Settings as typed.
    pub sets: &'a [Override],
    /// Scene with all settings, compiled.
    pub gearbox: &'a Gearbox,
}

impl Settings<'_> {
    /// Returns the indices in `sets` of settings without which the scene is equal, or its results are `equal`. Excludes
    /// labels and settings without which the scene is invalid.
    fn without_effect(
        self,
        mut equal: impl FnMut(&Gearbox) -> Result<bool, StudyError>,
    ) -> Result<Vec<usize>, StudyError> {
        let mut idle = Vec::new();
        for (place, set) in self.sets.iter().enumerate() {
            // Labels have no effect on purpose.
            if ["name", "description"].contains(&set.key()) {
                continue;
            }
            let others = [&self.sets[..place], &self.sets[place + 1..]].concat();
            let Ok(without) = Scene::load(self.spec, &others) else {
                continue;
            };
            let is_idle = without == self.gearbox.scene
                || Gearbox::new(&without).map_or(Ok(false), |without| equal(&without))?;
            idle.extend(is_idle.then_some(place));
        }
        Ok(idle)
    }

    /// Returns the indices of settings without which `run`, of the scene on `engine`, is equal to the bit in all samples,
    /// steps and evaluations. Long runs and runs of a user's solver are not repeated.
    ///
    /// # Errors
    /// Cancelled.
    pub fn idle_in_run(
        self,
        engine: &dyn Engine,
        run: &Run,
        control: &Control<'_>,
    ) -> Result<Vec<usize>, StudyError> {
        let takes_long = run.stats.wall_s > LONGEST_RUN.as_secs_f64();
        let is_other = engine.track() != SharedModel::Native;
        if takes_long || is_other || !run.ending.is_finished() {
            return Ok(Vec::new());
        }
        let at = control.piece(Progress::new(0, 1, "without single settings"));
        let first = |gearbox: &Gearbox| -> Result<Option<Run>, Cancelled> {
            let short = gearbox.with_solver(|solver| {
                solver.duration_s = solver.duration_s.min(FIRST * solver.sample_s);
            });
            let run = short.ok().map(|short| engine.run_compiled(&short, &at));
            run.transpose()
        };
        let with = first(self.gearbox)?;
        let times = |gearbox: &Gearbox| gearbox.scene.solver.sample_times_s();
        self.without_effect(|without| {
            Ok(times(without) == times(self.gearbox)
                && equal(with.as_ref(), first(without)?.as_ref())
                && equal(Some(run), Some(&engine.run_compiled(without, &at)?)))
        })
    }

    /// Returns the indices of settings without which a run of the scene on the native `engine` is equal to the bit; empty
    /// if the run takes more than two seconds.
    ///
    /// # Errors
    /// Cancelled.
    pub fn idle(
        self,
        engine: &dyn Engine,
        control: &Control<'_>,
    ) -> Result<Vec<usize>, StudyError> {
        let limit = TimeLimit {
            most: LONGEST_RUN,
            suggested_limit_s: 1.0,
            outside: false,
        };
        let at = control.piece(Progress::new(0, 1, engine.name()));
        let run = limit.run(engine, self.gearbox, &at)?;
        self.idle_in_run(engine, &run, control)
    }

    /// Returns the indices of [`idle`](Self::idle) without which the explanation of the scene, its model and its derived
    /// dimensions, is equal too.
    ///
    /// # Errors
    /// Cancelled.
    pub fn idle_in_explanation(
        self,
        engine: &dyn Engine,
        control: &Control<'_>,
    ) -> Result<Vec<usize>, StudyError> {
        let own = explain(self.gearbox);
        let alike = self.without_effect(|without| {
            let other = explain(without);
            Ok(other.model == own.model && other.derived == own.derived)
        })?;
        let mut idle = self.idle(engine, control)?;
        idle.retain(|place| alike.contains(place));
        Ok(idle)
    }

    /// Returns the indices of settings without which the design `design` is equal to the bit, and its other results are
    /// `equal`; empty if `design` took more than some seconds.
    ///
    /// # Errors
    /// Cancelled.
    pub fn idle_in_design(
        self,
        design: &DesignResult,
        took: Duration,
        control: &Control<'_>,
        mut equal: impl FnMut(&DesignResult) -> bool,
    ) -> Result<Vec<usize>, StudyError> {
        if took > LONGEST_DESIGN {
            return Ok(Vec::new());
        }
        self.without_effect(|without| match design.repeated(without, control) {
            Ok(Some(other)) => Ok(equal(&other)),
            Err(StudyError::Cancelled) => Err(StudyError::Cancelled),
            // No design, or another one, without this setting.
            _ => Ok(false),
        })
    }
}

fn equal(one: Option<&Run>, other: Option<&Run>) -> bool {
    let cost = |run: &Run| (run.stats.steps, run.stats.rhs_calls);
    one.zip(other).is_some_and(|(one, other)| {
        one.ending == other.ending
            && cost(one) == cost(other)
            && one.time_series == other.time_series
    })
}
