//! The exponential multistep method on gears, against Dormand-Prince at a tight tolerance, for various samplings.

use super::common;

use common::{distance, run};
use pinwheel_gearbox::contacts::Kernel;
use pinwheel_gearbox::native::NativeRun;

fn by(preset: &str, method: &str, tolerance: &str, sets: &[(&str, &str)]) -> NativeRun {
    let solver = [
        ("solver.integrator", method),
        ("solver.tolerance", tolerance),
    ];
    run(preset, Kernel::Lanes, &[&solver, sets].concat())
}

/// Returns the kernel passes: evaluations, which include most samples, and Jacobians.
fn passes(run: &NativeRun) -> u64 {
    run.counts.evaluations + run.counts.jacobians
}

/// Measured: errors 0.36 to 3.4 of those of Dormand-Prince at equal tolerance, passes 0.26 to 0.46.
#[test]
fn gears_are_resolved_in_fewer_passes() {
    for (preset, sets) in [
        ("paper", &[("solver.duration_s", "0.1")][..]),
        ("forty-pins", &[("solver.duration_s", "0.05")]),
        ("backlash-0.6", &[("solver.duration_s", "0.1")]),
        ("steel", &[("solver.duration_s", "0.03")]),
        (
            "paper",
            &[
                ("solver.duration_s", "0.05"),
                ("solver.sample_s", "1.03e-4"),
            ],
        ),
        (
            "paper",
            &[("solver.duration_s", "0.05"), ("solver.sample_s", "7e-4")],
        ),
        ("hard-load-step", &[]),
        ("hard-load-reversal", &[("solver.duration_s", "0.1")]),
    ] {
        let exact = by(preset, "dopri5", "1e-11", sets);
        for tolerance in ["1e-6", "1e-7"] {
            let etd = by(preset, "etd-adams", tolerance, sets);
            let plain = by(preset, "dopri5", tolerance, sets);
            let off = distance(&etd, &exact) / distance(&plain, &exact);
            let share =
                passes(&etd) as f64 / (passes(&plain) + exact.time_series.len() as u64) as f64;
            println!("{preset} {sets:?} {tolerance}: errors {off:.2}, passes {share:.2}");
            assert!(
                off < 5.0,
                "{preset} {tolerance}: {off} of the error, bound 5"
            );
            assert!(
                share < 0.6,
                "{preset} {tolerance}: {share} of the passes, bound 0.6"
            );
        }
    }
}

/// All processors take equal steps.
#[test]
fn regress_the_steps_do_not_depend_on_the_processor() {
    for preset in ["paper", "backlash-0.6"] {
        let sets = [
            ("solver.integrator", "etd-adams"),
            ("solver.tolerance", "1e-6"),
            ("solver.duration_s", "0.1"),
        ];
        let here = run(preset, Kernel::Lanes, &sets);
        for kernel in [Kernel::Avx2, Kernel::Portable] {
            let there = run(preset, kernel, &sets);
            let error = distance(&there, &here);
            println!(
                "{preset} {kernel:?}: {error:.1e} {:?} {:?}",
                there.counts, here.counts
            );
            assert_eq!(there.counts, here.counts, "{preset}, {kernel:?}");
        }
    }
}
