//! Whether the same run is the same: for any number of threads to the bit, across contact loops to a bound.

use pinwheel_gearbox::contacts::Kernel;
use serde::Serialize;

use super::Options;
use super::error::BaselineError;
use super::quantity::Values;
use super::record::plain_job;
use super::runner::{Finished, Job, Outcome, run_all};
use crate::control::Control;

/// The bits of one case.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Fingerprint {
    /// Scene and solver.
    pub case: String,
    /// Hash of every bit of every value and of all counts; 0 if the run diverged.
    pub bits: u64,
}

/// How far one case lies apart when other contact loops compute it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spread {
    /// Scene and solver.
    pub case: String,
    /// Largest difference of any quantity among the loops in lanes (AVX-512, AVX2, none), as a share of the quantity's
    /// root mean square; infinite if a run diverged.
    pub vectors: f64,
    /// Same for the scalar loop against the lanes.
    pub scalar: f64,
    /// Most right-hand sides that a loop needed over the fewest.
    pub counts: f64,
}

/// Runs the set and takes its fingerprints.
///
/// # Errors
/// Stopped, or a scene of the set cannot be modelled.
pub fn fingerprints(
    options: &Options,
    control: &Control<'_>,
) -> Result<Vec<Fingerprint>, BaselineError> {
    let jobs = jobs(options, &[options.kernel])?;
    let outcomes = run_all(&jobs, options.threads, control)?;
    let named = jobs.into_iter().zip(outcomes);
    Ok(named
        .map(|(job, outcome)| Fingerprint {
            case: job.label,
            bits: outcome.map_or(0, |run| bits(&run)),
        })
        .collect())
}

/// Runs the set by every contact loop.
///
/// # Errors
/// Stopped, or a scene of the set cannot be modelled.
pub fn across_loops(
    options: &Options,
    control: &Control<'_>,
) -> Result<Vec<Spread>, BaselineError> {
    let jobs = jobs(options, &Kernel::ALL)?;
    let outcomes = run_all(&jobs, options.threads, control)?;
    let loops = Kernel::ALL.len();
    let cases = jobs.chunks(loops).zip(outcomes.chunks(loops));
    Ok(cases
        .map(|(jobs, runs)| spread(jobs[0].label.clone(), runs))
        .collect())
}

/// One job a case and loop, the loops of a case together.
fn jobs(options: &Options, loops: &[Kernel]) -> Result<Vec<Job>, BaselineError> {
    let mut jobs = Vec::new();
    for case in options.scenes()? {
        for choice in case.choices {
            let job = Job {
                repeats: 0,
                ..plain_job(case, &choice.into(), options)?
            };
            jobs.extend(loops.iter().map(|&kernel| Job {
                kernel,
                ..job.clone()
            }));
        }
    }
    Ok(jobs)
}

/// `runs`: by the loops of [`Kernel::ALL`], the scalar one last.
fn spread(case: String, runs: &[Outcome]) -> Spread {
    let finished: Vec<&Finished> = runs.iter().flatten().collect();
    if finished.len() < runs.len() {
        let lost = f64::INFINITY;
        return Spread {
            case,
            vectors: lost,
            scalar: lost,
            counts: lost,
        };
    }
    let counts = || finished.iter().map(|run| run.costs.right_hand_sides as f64);
    let (lanes, scalar) = finished.split_at(finished.len() - 1);
    let farthest = |others: &[&Finished]| {
        let first = finished.first();
        let pairs = first
            .iter()
            .flat_map(|first| others.iter().map(|other| apart(first, other)));
        pairs.fold(0.0, f64::max)
    };
    Spread {
        case,
        vectors: farthest(lanes),
        scalar: farthest(scalar),
        counts: counts().fold(0.0, f64::max) / counts().fold(f64::INFINITY, f64::min),
    }
}

/// Largest difference of any quantity, as a share of its size. Joint errors are left out: they are nothing but rounding.
fn apart(a: &Finished, b: &Finished) -> f64 {
    let share = |(a, b): (&Values, &Values)| {
        let distance = a.distance(b);
        if distance == 0.0 {
            0.0
        } else {
            distance / a.rms()
        }
    };
    let pairs = a.values.iter().zip(&b.values);
    pairs
        .filter(|(a, _)| a.quantity.key != "joint_drift")
        .map(share)
        .fold(0.0, f64::max)
}

/// FNV-1a over all bits.
fn bits(run: &Finished) -> u64 {
    let costs = &run.costs;
    let counts = [
        costs.right_hand_sides,
        costs.steps,
        costs.rejections,
        costs.newton_steps,
    ];
    let values = run.values.iter().flat_map(Values::all).map(f64::to_bits);
    pinwheel_files::fnv(values.chain(counts).flat_map(u64::to_le_bytes))
}
