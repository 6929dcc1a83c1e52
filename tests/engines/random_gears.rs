//! `auto` on untuned gears: no run reported as resolved may be wrong.
//!
//! `PINWHEEL_GEARS=1000` judges that number, `PINWHEEL_GEARS=300..900` others, `PINWHEEL_RUBBING=1` only those with
//! friction. The weekly workflow judges 300.

#![allow(
    clippy::print_stdout,
    reason = "the table of uncertainty against error is what one looks at"
)]

#[path = "../../crates/studies/tests/suite/gears.rs"]
mod gears;

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use pinwheel_engines::Control;
use pinwheel_gearbox::auto::TARGET;
use pinwheel_gearbox::resolve::{Uncertainty, run_resolved};
use pinwheel_gearbox::{Distance, Gearbox};
use pinwheel_scene::Scene;
use pinwheel_studies::reference;
use pinwheel_timeseries::Ending;
use pinwheel_timeseries::TimeSeries;

use gears::gear;

/// Number of gears in an ordinary test run.
const GEARS: u64 = 20;
/// Largest number of evaluations of a gear: the most expensive two per cent end as not resolved.
const BUDGET: u64 = 600_000;
/// Error in multiples of the target beyond which a failure is silent.
const SILENT: f64 = 3.0;

/// Judgement on one gear.
enum Outcome {
    /// Resolved, with the stated uncertainty and the true error.
    Judged(Uncertainty, Distance),
    /// Not resolved according to `auto` itself, with its reason.
    Unresolved(String),
    /// No reference: two reference runs disagree by more than the target.
    NoTruth(f64),
    /// Failure of every method.
    Failed(String),
}

fn judge(scene: &Scene) -> Outcome {
    let gearbox = match Gearbox::new(&scene.clone().check().unwrap()) {
        Ok(gearbox) => gearbox,
        Err(error) => return Outcome::Failed(error.to_string()),
    };
    let (run, uncertainty) = match run_resolved(&gearbox, TARGET, BUDGET, &mut |_| false) {
        Ok(resolved) => resolved,
        Err(error) => return Outcome::Failed(error.to_string()),
    };
    match &run.ending {
        Ending::Finished => {}
        // The test's budget did not suffice for one run.
        Ending::Diverged { quantity, .. } if quantity.contains("evaluations") => {
            return Outcome::Unresolved(quantity.clone());
        }
        ending => return Outcome::Failed(ending.to_string()),
    }
    if !uncertainty.is_resolved() {
        return Outcome::Unresolved(uncertainty.sentence());
    }
    let by = uncertainty.chosen().map_or("", |level| &level.integrator);
    let [first, second] = reference::settings(scene, by);
    let off = |truth: &TimeSeries| gearbox.distance(&run.time_series, truth);
    let quiet = AtomicBool::new(false);
    let solve = |way| reference::solve(scene, way, &Control::silent(&quiet)).ok();
    let truth = solve(first).map(|solution| solution.1);
    if let Some(truth) = &truth
        && off(truth).worst() <= TARGET
    {
        return Outcome::Judged(uncertainty, off(truth));
    }
    // Either may be wrong: the second reference decides, if converged.
    match (truth, solve(second).map(|solution| solution.1)) {
        (Some(first), Some(second)) => {
            let apart = gearbox.distance(&first, &second).worst();
            let error = off(&second);
            if apart <= TARGET || error.worst() <= TARGET {
                Outcome::Judged(uncertainty, error)
            } else {
                Outcome::NoTruth(apart)
            }
        }
        (None, Some(second)) => Outcome::Judged(uncertainty, off(&second)),
        _ => Outcome::NoTruth(f64::INFINITY),
    }
}

/// Returns the seeds to judge.
fn seeds() -> std::ops::Range<u64> {
    let asked = std::env::var("PINWHEEL_GEARS").unwrap_or_default();
    match asked.split_once("..") {
        Some((from, to)) => from.parse().unwrap()..to.parse().unwrap(),
        None => 0..asked.parse().unwrap_or(GEARS),
    }
}

/// Prints counts by decade of the stated uncertainty (rows) and of the true error (columns).
fn print_histogram(pairs: &[(f64, f64)]) {
    let decade = |x: f64| (x.max(1e-9).log10().floor() as i32).clamp(-9, 0);
    println!("uncertainty \\ true error, decades:");
    let columns: Vec<String> = (-9..=0).map(|d| format!("{d:>4}")).collect();
    println!("{:>6} {}", "", columns.join(""));
    for row in (-9..=-3).rev() {
        let counts = (-9..=0).map(|column| {
            let here = pairs.iter();
            let here = here.filter(|(u, e)| decade(*u) == row && decade(*e) == column);
            match here.count() {
                0 => "   .".to_owned(),
                count => format!("{count:>4}"),
            }
        });
        println!("{row:>6} {}", counts.collect::<String>());
    }
}

/// No random gear (6 to 60 pins, 1 to 4 discs, backlash, friction, all loads, laws and sizes) is silently wrong: a run
/// reported as resolved to 1e-3 is within 3e-3 of a reference by another method. See `print_histogram`'s table.
#[test]
fn crossval_no_random_gear_is_silently_wrong() {
    let seeds = seeds();
    let rubbing = std::env::var_os("PINWHEEL_RUBBING").is_some();
    let (next, outcomes) = (AtomicU64::new(seeds.start), Mutex::new(Vec::new()));
    let threads = std::thread::available_parallelism().map_or(2, std::num::NonZero::get);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= seeds.end {
                        break;
                    }
                    let scene = gear(seed).unwrap();
                    if rubbing && scene.contact.friction_coefficient == 0.0 {
                        continue;
                    }
                    let outcome = judge(&scene);
                    outcomes.lock().unwrap().push((seed, outcome));
                }
            });
        }
    });
    let mut pairs = Vec::new();
    let (mut silent, mut failed, mut refused, mut open) = (Vec::new(), Vec::new(), 0, 0);
    let mut costs = Vec::new();
    let outcomes = outcomes.into_inner().unwrap();
    let total = outcomes.len();
    for (seed, outcome) in outcomes {
        match outcome {
            Outcome::Judged(uncertainty, error) => {
                let stated = uncertainty.error.unwrap().worst();
                pairs.push((stated, error.worst()));
                costs.push(uncertainty.cost());
                if !(error.worst() <= SILENT * TARGET) {
                    silent.push(format!("{seed}: {stated:.1e} stated, {error:?}"));
                }
            }
            Outcome::Unresolved(why) => {
                refused += 1;
                println!("{seed}: {why}");
            }
            Outcome::NoTruth(apart) => {
                open += 1;
                println!("{seed}: references {apart:.1e} apart");
            }
            Outcome::Failed(why) => failed.push(format!("{seed}: {why}")),
        }
    }
    print_histogram(&pairs);
    costs.sort_by(f64::total_cmp);
    println!(
        "{} judged, {refused} stated as not resolved, {open} without a truth; cost {:.2} times a run in the median",
        pairs.len(),
        costs[costs.len() / 2]
    );
    assert!(failed.is_empty(), "{failed:#?}");
    assert!(silent.is_empty(), "{silent:#?}");
    // Refusing every gear, or judging none, would hide failures.
    assert!(refused * 20 <= total, "{refused} of {total} not resolved");
    assert!(open * 50 <= total, "{open} of {total} without a truth");
    assert!(costs[costs.len() / 2] <= 1.75, "{costs:?}");
}

/// A gear almost at rest, in which a contact begins between two samples: runs at all tolerances take equal steps there and
/// have a common error of 3e-7 while they differ by 4e-10. The stated uncertainty must include it.
#[test]
fn regress_what_all_runs_miss_alike_is_stated() {
    let scene = gear(726).unwrap();
    let Outcome::Judged(stated, off) = judge(&scene) else {
        panic!("it is resolved");
    };
    let stated = stated.error.unwrap().worst();
    println!("stated {stated:.1e}, off {:.1e}", off.worst());
    assert!(off.worst() <= stated, "{stated:e}: {off:?}");
}
