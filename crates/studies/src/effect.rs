//! Settings that do nothing: a run made again without each of them.

use pinwheel_engines::{Cancelled, Engine, Run, SharedModel};
use pinwheel_scene::{CheckedScene, Override, Scene};

use crate::control::{Control, Progress};
use crate::single::Outcome;

/// Longest run that is made again, s of wall time.
const LONGEST_S: f64 = 2.0;
/// Samples of a run by which most settings show that they do something, and the rest of it need not be made.
const FIRST: f64 = 10.0;

/// Returns the places in `sets` of those without which the run `outcome` is equal to the bit, in all samples, steps and evaluations. A
/// setting that no valid scene goes without is none of them, and no run of minutes or of another's solver is made again for this.
///
/// # Errors
/// Cancelled.
pub fn idle(
    spec: &str,
    sets: &[Override],
    engine: &dyn Engine,
    outcome: &Outcome,
    control: &Control<'_>,
) -> Result<Vec<usize>, Cancelled> {
    let takes_long = outcome.run.stats.wall_s > LONGEST_S;
    if takes_long || outcome.track != SharedModel::Native || !outcome.run.ending.is_finished() {
        return Ok(Vec::new());
    }
    let at = control.piece(Progress::new(0, 1, "without single settings"));
    let first = |scene: &CheckedScene| {
        let short = scene.changed(|scene| {
            let solver = &mut scene.solver;
            solver.duration_s = solver.duration_s.min(FIRST * solver.sample_s);
        });
        short.map(|scene| engine.run(&scene, &at)).ok().transpose()
    };
    let with = first(&outcome.scene)?;
    let mut idle = Vec::new();
    for place in 0..sets.len() {
        // Labels are there for people.
        if ["name", "description"].contains(&sets[place].key()) {
            continue;
        }
        let others = [&sets[..place], &sets[place + 1..]].concat();
        let Ok(without) = Scene::load(spec, &others) else {
            continue;
        };
        let times = |scene: &Scene| scene.solver.sample_times_s();
        let same = without == outcome.scene
            || times(&without) == times(&outcome.scene)
                && equal(with.as_ref(), first(&without)?.as_ref())
                && equal(Some(&outcome.run), Some(&engine.run(&without, &at)?));
        idle.extend(same.then_some(place));
    }
    Ok(idle)
}

fn equal(one: Option<&Run>, other: Option<&Run>) -> bool {
    let cost = |run: &Run| (run.stats.steps, run.stats.rhs_calls);
    one.zip(other).is_some_and(|(one, other)| {
        one.ending == other.ending
            && cost(one) == cost(other)
            && one.time_series == other.time_series
    })
}
