//! Recording of a baseline: converged runs, accepted runs, and their change under perturbed rounding.

use std::collections::BTreeMap;

use pinwheel_gearbox::contacts::Kernel;
use pinwheel_scene::Scene;
use pinwheel_timeseries::Ending;

use super::cases::{SceneCase, scenes};
use super::file::{
    Acceptance, Baseline, CaseSnapshot, Converged, FORMAT, Made, QuantitySnapshot, SceneSnapshot,
};
use super::runner::{Finished, Job, RunResult, run_all};
use super::snapshot::{Quantity, Statistics};
use super::{Options, Planned};
use crate::control::{Control, compile};
use crate::{StudyError, reference};

/// Case that was not recorded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// Name of the scene.
    pub scene: String,
    /// Name of the solver or its choice.
    pub choice: String,
    /// Reason why the case was left out.
    pub reason: String,
}

impl LeftOut {
    fn new(case: &SceneCase, plan: &Planned<'_>, reason: String) -> Self {
        Self {
            scene: case.name.clone(),
            choice: plan.name.to_owned(),
            reason,
        }
    }

    /// Returns the case with the ending of its run as the reason.
    ///
    /// # Errors
    /// An ending that no case of the set may have.
    fn ended(case: &SceneCase, plan: &Planned<'_>, ending: Ending) -> Result<Self, StudyError> {
        let reason = match ending {
            Ending::Unsupported { reason } => reason,
            // A solver of a user may run away on a hard scene; methods of the set are chosen so that they do not.
            Ending::Diverged { .. } if plan.job.solver.is_some() => ending.to_string(),
            _ => return Err(broken(case, plan.name, &ending)),
        };
        Ok(Self::new(case, plan, reason))
    }
}

/// Result of recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// New baseline, with the earlier entries of scenes that were not requested.
    pub baseline: Baseline,
    /// Names of the scenes that were run.
    pub scenes: Vec<String>,
    /// Cases that a solver refuses, or without a result.
    pub left_out: Vec<LeftOut>,
}

/// Runs the requested scenes and replaces their entries of the `earlier` baseline, for the stated `reason`.
///
/// # Errors
/// Stopped, a baseline of other solvers, or a run of the set that does not come to its end.
pub fn record(
    made: Made,
    earlier: Option<Baseline>,
    reason: &str,
    options: &Options,
    control: &Control<'_>,
) -> Result<Record, StudyError> {
    if let Some(earlier) = &earlier {
        earlier.made_by(&options.solvers)?;
    }
    let mut left_out = Vec::new();
    let (mut jobs, mut plans) = (Vec::new(), Vec::new());
    for case in options.scenes()? {
        let planned = options.planned(case)?.into_iter();
        let (refused, planned): (Vec<_>, Vec<_>) = planned.partition(|plan| plan.refused.is_some());
        left_out.extend(refused.into_iter().map(|plan| {
            let reason = plan.refused.clone().unwrap_or_default();
            LeftOut::new(case, &plan, reason)
        }));
        jobs.extend(planned.iter().map(|plan| plan.job.clone()));
        plans.push((case, planned));
    }
    // First, and alone: a solver that does not work ends the recording before the long converged runs.
    let mut results = run_all(&jobs, options.threads, control)?.into_iter();
    let (mut jobs, mut finished) = (Vec::new(), Vec::new());
    for (case, planned) in plans {
        let mut runs = Vec::new();
        for plan in planned {
            match next(&mut results) {
                Ok(run) => runs.push((plan, run)),
                Err(ending) => left_out.push(LeftOut::ended(case, &plan, ending)?),
            }
        }
        if runs.is_empty() {
            continue;
        }
        jobs.extend(converged_jobs(&case.scene(&[])?.into_scene()));
        jobs.extend(runs.iter().flat_map(|(plan, _)| roundings(&plan.job)));
        finished.push((case, runs));
    }
    let mut results = run_all(&jobs, options.threads, control)?.into_iter();
    let mut recorded = Vec::new();
    for (case, runs) in finished {
        let scene = scene(case, runs, &mut results, &mut left_out)?;
        recorded.extend((!scene.cases.is_empty()).then_some(scene));
    }
    let only = match options.only.as_slice() {
        [] => String::new(),
        only => format!(" (only {})", only.join(", ")),
    };
    let (kept, mut accepted) = earlier.map_or_else(Default::default, |it| (it.scenes, it.accepted));
    accepted.push(Acceptance {
        date: made.date.clone(),
        reason: format!("{reason}{only}"),
    });
    let asked =
        |scene: &SceneSnapshot| options.only.is_empty() || options.only.contains(&scene.name);
    let names = recorded.iter().map(|scene| scene.name.clone()).collect();
    recorded.extend(kept.into_iter().filter(|scene| !asked(scene)));
    // In the order of the set; scenes no longer in it stay at the end until everything is recorded anew.
    let order = |scene: &SceneSnapshot| scenes().iter().position(|case| case.name == scene.name);
    recorded.sort_by_key(|scene| order(scene).unwrap_or(usize::MAX));
    Ok(Record {
        baseline: Baseline {
            format: FORMAT,
            solvers: options.solvers.clone(),
            made,
            accepted,
            scenes: recorded,
        },
        scenes: names,
        left_out,
    })
}

impl Record {
    /// Returns every case that was run with its quantity of the largest error against the converged run, largest first.
    pub fn errors(&self) -> Vec<(&SceneSnapshot, &CaseSnapshot, Quantity, f64)> {
        let scenes = self.baseline.scenes.iter();
        let scenes = scenes.filter(|scene| self.scenes.contains(&scene.name));
        let cases = scenes.flat_map(|scene| scene.cases.iter().map(move |case| (scene, case)));
        let farthest = cases.filter_map(|(scene, case)| {
            // Energy and joint errors are balances of a run, not signals of the engine.
            let signals = case.quantity.iter().filter(|(quantity, _)| {
                !matches!(quantity, Quantity::Energy | Quantity::JointDrift)
            });
            let (quantity, worst) = signals.max_by(|(_, a), (_, b)| a.error.total_cmp(&b.error))?;
            Some((scene, case, *quantity, worst.error))
        });
        let mut farthest: Vec<_> = farthest.collect();
        farthest.sort_by(|(.., a), (.., b)| b.total_cmp(a));
        farthest
    }
}

/// Returns the jobs of the converged run and of the coarser one that gives its error.
fn converged_jobs(scene: &Scene) -> [Job; 2] {
    let [second, first] = reference::settings(scene, "dopri5");
    [first, second].map(|setting| Job {
        label: format!("{}, converged by {}", scene.name, setting.0),
        scene: reference::scene(scene, setting),
        kernel: Kernel::Lanes,
        solver: None,
    })
}

/// Returns jobs that repeat the run under perturbed rounding: with other vector instructions and the scalar loop, and with
/// the discs' inertia and the ring pins' radius one digit up and down. The inertia does not change statics; the radius
/// changes the initial equilibrium, which without load is accurate to little more than a rounding of the dimensions.
fn roundings(plain: &Job) -> Vec<Job> {
    let by = |kernel| Job {
        kernel,
        ..plain.clone()
    };
    let mut jobs: Vec<Job> = [Kernel::Avx2, Kernel::Portable, Kernel::Scalar]
        .map(by)
        .into();
    // A user's solver does not run the native contact loop.
    jobs.retain(|job| job.solver.is_none());
    for digit in [f64::next_up, f64::next_down] {
        let (mut heavier, mut wider) = (plain.clone(), plain.clone());
        let moment = &mut heavier.scene.mass.wheel.moment_kg_m2;
        *moment = digit(*moment);
        let radius = &mut wider.scene.gear.external_sleeve_radius_m;
        *radius = digit(*radius);
        jobs.extend([heavier, wider]);
    }
    jobs
}

fn next(results: &mut impl Iterator<Item = RunResult>) -> RunResult {
    let result = results.next();
    result.unwrap_or_else(|| Err(Ending::failed("the run is missing")))
}

fn broken(case: &SceneCase, choice: &str, ending: &Ending) -> StudyError {
    StudyError::Broken(format!("{}, {choice}: {ending}", case.name))
}

fn scene(
    case: &'static SceneCase,
    runs: Vec<(Planned<'_>, Finished)>,
    results: &mut impl Iterator<Item = RunResult>,
    left_out: &mut Vec<LeftOut>,
) -> Result<SceneSnapshot, StudyError> {
    let mut truth = || next(results).map_err(|ending| broken(case, "converged", &ending));
    let (fine, coarse) = (truth()?, truth()?);
    let gearbox = compile(&case.scene(&[])?.into_scene())?;
    let converged = converged(fine, &coarse, gearbox.error_scales().length);
    let mut cases = Vec::new();
    for (plan, plain) in runs {
        let varied: Vec<RunResult> = roundings(&plan.job).iter().map(|_| next(results)).collect();
        let varied = match varied.into_iter().collect::<Result<Vec<_>, _>>() {
            Ok(varied) => varied,
            Err(ending) => {
                left_out.push(LeftOut::ended(case, &plan, ending)?);
                continue;
            }
        };
        // Relative difference of two runs in right-hand sides.
        let count = plain.costs.right_hand_sides;
        let spread = |run: &Finished| {
            run.costs.right_hand_sides.abs_diff(count) as f64 / count.max(1) as f64
        };
        let snapshot = CaseSnapshot {
            choice: plan.name.to_owned(),
            set: plan.sets.to_vec(),
            costs: plain.costs,
            count_spread: varied.iter().map(spread).fold(0.0, f64::max),
            quantity: quantities(&plain, &varied, &converged),
        };
        match snapshot.sound(&converged) {
            Ok(()) => cases.push(snapshot),
            Err(reason) => left_out.push(LeftOut::new(case, &plan, reason)),
        }
    }
    Ok(SceneSnapshot {
        name: case.name.clone(),
        why: case.why.clone(),
        preset: case.preset().to_owned(),
        set: case.changes(),
        converged,
        cases,
    })
}

fn converged(fine: Finished, coarse: &Finished, penetration: f64) -> BTreeMap<Quantity, Converged> {
    let of = |(quantity, statistics): (Quantity, Statistics)| {
        let size = match quantity {
            // Driver and load, in this order.
            Quantity::Energy => {
                let works = statistics.mean.iter().take(2);
                works.fold(0.0, |most: f64, x| most.max(x.abs()))
            }
            Quantity::JointDrift => penetration,
            _ => statistics.whole_rms(),
        };
        let scale = size.max(f64::MIN_POSITIVE);
        let other = coarse.statistics.get(&quantity);
        let distance = other.and_then(|other| statistics.distance(other));
        let converged = Converged {
            scale,
            own_error: distance.unwrap_or(0.0) / scale,
            statistics,
        };
        (quantity, converged)
    };
    fine.statistics.into_iter().map(of).collect()
}

fn quantities(
    plain: &Finished,
    varied: &[Finished],
    converged: &BTreeMap<Quantity, Converged>,
) -> BTreeMap<Quantity, QuantitySnapshot> {
    let of = |(&quantity, statistics): (&Quantity, &Statistics)| {
        let converged = converged.get(&quantity)?;
        let others = varied.iter().map(|run| run.statistics.get(&quantity));
        let apart = others.filter_map(|other| statistics.distance(other?));
        let snapshot = QuantitySnapshot {
            error: statistics.distance(&converged.statistics)? / converged.scale,
            rounding: apart.fold(0.0, f64::max) / converged.scale,
            statistics: statistics.clone(),
        };
        Some((quantity, snapshot))
    };
    plain.statistics.iter().filter_map(of).collect()
}
