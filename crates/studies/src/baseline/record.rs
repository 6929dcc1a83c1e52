//! Making a baseline: converged runs, accepted runs, and what roundings do to them.

use std::collections::BTreeMap;

use pinwheel_gearbox::contacts::Kernel;
use pinwheel_scene::Scene;

use super::Options;
use super::cases::{SceneCase, Way};
use super::file::{
    Acceptance, Baseline, CaseSnapshot, Converged, FORMAT, Made, QuantitySnapshot, SceneSnapshot,
};
use super::runner::{Finished, Job, RunResult, run_all};
use super::snapshot::{Quantity, Statistics};
use crate::control::{Control, compile};
use crate::{StudyError, reference};

/// Runs everything and puts it together; `accepted` is the history, the reason for this record at its end.
///
/// # Errors
/// Stopped, or a run of the set does not come to its end.
pub fn record(
    made: Made,
    accepted: Vec<Acceptance>,
    options: &Options,
    control: &Control<'_>,
) -> Result<Baseline, StudyError> {
    let chosen = options.scenes()?;
    let mut jobs = Vec::new();
    for case in &chosen {
        jobs.extend(converged_jobs(&case.scene(&[])?.into_scene()));
        for way in options.ways(case)? {
            let plain = plain_job(case, &way, options)?;
            jobs.push(plain.clone());
            jobs.extend(roundings(&plain));
        }
    }
    let mut results = run_all(&jobs, options.threads, control)?.into_iter();
    let mut scenes = Vec::new();
    for case in chosen {
        scenes.push(scene(case, options, &mut results)?);
    }
    Ok(Baseline {
        format: FORMAT,
        solvers: options.solvers.clone(),
        made,
        accepted,
        scenes,
    })
}

/// The run that is kept or checked.
pub(super) fn plain_job(
    case: &SceneCase,
    way: &Way<'_>,
    options: &Options,
) -> Result<Job, StudyError> {
    Ok(Job {
        label: format!("{}, {}", case.name, way.name),
        scene: case.scene(way.sets)?.into_scene(),
        kernel: options.kernel,
        solver: way.solver.map(str::to_owned),
    })
}

/// The converged run and the one that tells its error.
fn converged_jobs(scene: &Scene) -> [Job; 2] {
    let [second, first] = reference::settings(scene, "dopri5");
    [first, second].map(|setting| Job {
        label: format!("{}, converged by {}", scene.name, setting.0),
        scene: reference::scene(scene, setting),
        kernel: Kernel::Lanes,
        solver: None,
    })
}

/// The same run by other vector instructions and the scalar loop, with the wheels' inertia one digit up and down, and
/// with the external sleeves' radius one digit up and down. The inertia leaves statics alone; the radius moves where a
/// start in equilibrium is found, which without load is known to little more than a rounding of the dimensions.
fn roundings(plain: &Job) -> Vec<Job> {
    let by = |kernel| Job {
        kernel,
        ..plain.clone()
    };
    let mut jobs: Vec<Job> = [Kernel::Avx2, Kernel::Portable, Kernel::Scalar]
        .map(by)
        .into();
    // A solver from outside has no loop of ours that could be chosen.
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

fn scene(
    case: &'static SceneCase,
    options: &Options,
    results: &mut impl Iterator<Item = RunResult>,
) -> Result<SceneSnapshot, StudyError> {
    let mut next = |choice: &str| {
        let result = results.next();
        let result = result.unwrap_or_else(|| Err("the run is missing".to_owned()));
        result.map_err(|reason| StudyError::Broken(format!("{}, {choice}: {reason}", case.name)))
    };
    let (fine, coarse) = (next("converged")?, next("converged")?);
    let gearbox = compile(&case.scene(&[])?.into_scene())?;
    let converged = converged(fine, &coarse, gearbox.error_scales().length);
    let mut cases = Vec::new();
    for way in options.ways(case)? {
        let plain = next(way.name)?;
        let mut varied = Vec::new();
        for _ in roundings(&plain_job(case, &way, options)?) {
            varied.push(next(way.name)?);
        }
        // Share by which two runs differ in right-hand sides.
        let count = plain.costs.right_hand_sides;
        let spread = |run: &Finished| {
            run.costs.right_hand_sides.abs_diff(count) as f64 / count.max(1) as f64
        };
        cases.push(CaseSnapshot {
            choice: way.name.to_owned(),
            set: way.sets.to_vec(),
            costs: plain.costs,
            count_spread: varied.iter().map(spread).fold(0.0, f64::max),
            quantity: quantities(&plain, &varied, &converged),
        });
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
