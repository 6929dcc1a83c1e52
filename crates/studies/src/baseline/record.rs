//! Making a baseline: converged runs, accepted runs, and what roundings do to them.

use pinwheel_gearbox::contacts::Kernel;
use pinwheel_scene::CheckedScene;

use super::cases::{SceneCase, Way};
use super::error::{BaselineError, FORMAT};
use super::file::{
    Acceptance, Baseline, CaseQuantity, CaseRecord, Head, Made, ReferenceQuantity, ReferenceRecord,
    SceneRecord,
};
use super::limits;
use super::quantised::{quantum, to_line};
use super::quantity::{Values, rms};
use super::runner::{Costs, Finished, Job, Outcome, run_all};
use super::{Options, reference};
use crate::StudyError;
use crate::control::Control;

/// Runs everything and puts it together; `accepted` is the history, the reason for this record at its end.
///
/// # Errors
/// Stopped, or a run of the set does not come to its end.
pub fn record(
    made: Made,
    accepted: Vec<Acceptance>,
    options: &Options,
    control: &Control<'_>,
) -> Result<Baseline, BaselineError> {
    let chosen: Vec<&SceneCase> = options.scenes()?;
    let mut jobs = Vec::new();
    for case in &chosen {
        jobs.extend(reference::jobs(&load(case, None)?.into_scene()));
        for way in options.ways(case)? {
            jobs.extend(case_jobs(case, &way, options)?);
        }
    }
    let mut outcomes = run_all(&jobs, options.threads, control)?.into_iter();
    let mut scenes = Vec::new();
    for case in chosen {
        scenes.push(scene_record(case, options, &mut outcomes)?);
    }
    Ok(Baseline {
        head: Head {
            format: FORMAT,
            scenes: scenes.iter().map(|scene| scene.scene.clone()).collect(),
            made,
            solvers: options.solvers.clone(),
            accepted,
        },
        scenes,
    })
}

/// A scene of the set by one choice, or as it is.
pub(super) fn load(case: &SceneCase, way: Option<&Way<'_>>) -> Result<CheckedScene, BaselineError> {
    let sets = way.map_or(&[][..], |way| way.sets);
    Ok(case.scene(sets).map_err(StudyError::from)?)
}

/// The run that is kept or checked.
pub(super) fn plain_job(
    case: &SceneCase,
    way: &Way<'_>,
    options: &Options,
) -> Result<Job, BaselineError> {
    Ok(Job {
        label: format!("{}, {}", case.name, way.name),
        scene: load(case, Some(way))?.into_scene(),
        kernel: options.kernel,
        repeats: options.repeats,
        solver: way.solver.map(str::to_owned),
    })
}

/// The run that is kept, then those that differ from it by roundings.
fn case_jobs(
    case: &SceneCase,
    way: &Way<'_>,
    options: &Options,
) -> Result<Vec<Job>, BaselineError> {
    let plain = plain_job(case, way, options)?;
    let mut jobs = vec![plain.clone()];
    jobs.extend(roundings(&plain));
    Ok(jobs)
}

/// The same run by other vector instructions and the scalar loop, with the wheels' inertia one digit up and down, and
/// with the external sleeves' radius one digit up and down. The inertia leaves statics alone; the radius moves where a
/// start in equilibrium is found, which without load is known to little more than a rounding of the dimensions.
pub(super) fn roundings(plain: &Job) -> Vec<Job> {
    let plain = Job {
        repeats: 0,
        ..plain.clone()
    };
    let by = |kernel| Job {
        kernel,
        ..plain.clone()
    };
    let moved = |digit: fn(f64) -> f64| {
        let mut job = plain.clone();
        let moment = &mut job.scene.mass.wheel.moment_kg_m2;
        *moment = digit(*moment);
        job
    };
    let placed = |digit: fn(f64) -> f64| {
        let mut job = plain.clone();
        let radius = &mut job.scene.gear.external_sleeve_radius_m;
        *radius = digit(*radius);
        job
    };
    // A solver from outside has no loop of ours that could be chosen.
    let loops = match plain.solver {
        Some(_) => Vec::new(),
        None => [Kernel::Avx2, Kernel::Portable, Kernel::Scalar]
            .map(by)
            .into(),
    };
    let digits = [
        moved(f64::next_up),
        moved(f64::next_down),
        placed(f64::next_up),
        placed(f64::next_down),
    ];
    loops.into_iter().chain(digits).collect()
}

fn scene_record(
    case: &SceneCase,
    options: &Options,
    outcomes: &mut impl Iterator<Item = Outcome>,
) -> Result<SceneRecord, BaselineError> {
    let mut next = |choice: &str| -> Result<Finished, BaselineError> {
        let missing = || Err("the run is missing".to_owned());
        outcomes
            .next()
            .unwrap_or_else(missing)
            .map_err(|reason| BaselineError::DoesNotHold {
                scene: case.name.to_owned(),
                choice: choice.to_owned(),
                reason,
            })
    };
    let (fine, coarse) = (next("converged")?, next("converged")?);
    let gearbox =
        pinwheel_gearbox::Gearbox::new(&load(case, None)?).map_err(|source| StudyError::Scene {
            scene: case.name.to_owned(),
            source,
        })?;
    let penetration = gearbox.error_scales().length;
    let reference = ReferenceRecord {
        settings: reference::settings(),
        quantities: fine
            .values
            .iter()
            .zip(&coarse.values)
            .map(|(fine, coarse)| reference_quantity(fine, coarse, penetration))
            .collect(),
    };
    let mut cases = Vec::new();
    for way in options.ways(case)? {
        let plain = next(way.name)?;
        let mut varied = Vec::new();
        for _ in roundings(&plain_job(case, &way, options)?) {
            varied.push(next(way.name)?);
        }
        cases.push(CaseRecord {
            choice: way.name.to_owned(),
            set: way
                .sets
                .iter()
                .map(|(key, value)| format!("{key}={value}"))
                .collect(),
            costs: plain.costs,
            count_spread: varied
                .iter()
                .map(|run| spread(&run.costs, &plain.costs))
                .fold(0.0, f64::max),
            quantities: (0..plain.values.len())
                .filter_map(|k| {
                    let reference = reference.quantity(plain.values[k].quantity.key)?;
                    let others: Vec<&Values> =
                        varied.iter().filter_map(|run| run.values.get(k)).collect();
                    Some(case_quantity(&plain.values[k], &others, reference))
                })
                .collect(),
        });
    }
    Ok(SceneRecord {
        scene: case.name.to_owned(),
        why: case.why.to_owned(),
        preset: case.preset.to_owned(),
        set: case.changes(),
        reference,
        cases,
    })
}

/// Share by which two runs differ in right-hand sides.
fn spread(a: &Costs, b: &Costs) -> f64 {
    a.right_hand_sides.abs_diff(b.right_hand_sides) as f64 / b.right_hand_sides.max(1) as f64
}

fn reference_quantity(fine: &Values, coarse: &Values, penetration: f64) -> ReferenceQuantity {
    let size = match fine.quantity.key {
        // Driver and load, in this order.
        "energy" => fine
            .all()
            .take(2)
            .fold(0.0, |most: f64, x| most.max(x.abs())),
        "joint_drift" => penetration,
        _ => fine.rms(),
    };
    let scale = size.max(f64::MIN_POSITIVE);
    let quantum = quantum(fine.peak().max(scale), limits::REFERENCE_QUANTUM);
    let own_error = (fine.distance(coarse) / scale).max(0.3 * quantum / scale);
    ReferenceQuantity {
        key: fine.quantity.key.to_owned(),
        scale,
        own_error,
        quantum,
        courses: fine
            .kept()
            .iter()
            .map(|channel| to_line(channel, quantum))
            .collect(),
    }
}

fn case_quantity(
    plain: &Values,
    varied: &[&Values],
    reference: &ReferenceQuantity,
) -> CaseQuantity {
    let (scale, key) = (reference.scale, plain.quantity.key);
    let converged = reference.samples().unwrap_or_default();
    let differences: Vec<Vec<f64>> = plain
        .kept()
        .iter()
        .zip(&converged)
        .map(|(ours, base)| ours.iter().zip(base).map(|(a, b)| a - b).collect())
        .collect();
    let share = if key == "joint_drift" {
        1e-12
    } else {
        limits::COURSE_QUANTUM
    };
    let quantum = quantum(plain.peak().max(scale), share).max(reference.quantum.min(scale * share));
    let rounding = varied
        .iter()
        .map(|other| plain.distance(other) / scale)
        .fold(0.0, f64::max);
    CaseQuantity {
        key: key.to_owned(),
        mean: plain.mean(),
        peak: plain.peak(),
        sketch: plain.sketch(),
        error: rms(differences.iter().flatten().copied()) / scale,
        rounding,
        quantum,
        differences: differences
            .iter()
            .map(|channel| to_line(channel, quantum))
            .collect(),
    }
}
