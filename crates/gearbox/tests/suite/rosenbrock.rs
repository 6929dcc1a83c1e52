//! RODAS5P on gears with friction: against a method that shares only the forces, and against itself with differences.

use super::common;

use common::{distance, run};
use pinwheel_gearbox::contacts::Kernel;

/// Measured at a tolerance of 1e-6: 1.7e-5, 4.6e-6 and 8e-7 from imex2-adaptive at 1e-5, with 0.43, 0.13 and 0.02 of its
/// evaluations. Windows include the start-up, where contacts switch most.
#[test]
fn hard_friction_is_resolved_in_fewer_evaluations() {
    for (preset, duration, limit, fewer) in [
        ("paper-friction", "0.003", 4e-5, 0.6),
        ("hard-friction-light-sleeves", "0.002", 1e-5, 0.2),
        ("hard-feather-sleeves", "0.001", 2e-6, 0.03),
    ] {
        let window = ("solver.duration_s", duration);
        let by = |method: &str, tolerance: &str| {
            let (method, tolerance) = (
                ("solver.integrator", method),
                ("solver.tolerance", tolerance),
            );
            run(preset, Kernel::Lanes, &[window, method, tolerance])
        };
        let (rodas, imex) = (by("rodas5p", "1e-6"), by("imex2-adaptive", "1e-5"));
        let error = distance(&rodas, &imex);
        println!(
            "{preset}: {error:.1e}, {:?} after {:?}",
            rodas.counts, imex.counts
        );
        assert!(error < limit, "{preset}: {error:e}, bound {limit:e}");
        let share = rodas.counts.evaluations as f64 / imex.counts.evaluations as f64;
        assert!(
            share < fewer,
            "{preset}: {share} of the evaluations, bound {fewer}"
        );
    }
}

/// Differences replace the derivatives that the scalar loop lacks, and those of the Lagrange form.
#[test]
fn differences_give_the_same_run() {
    let sets = [
        ("solver.integrator", "rodas5p"),
        ("solver.tolerance", "1e-7"),
        ("solver.duration_s", "0.001"),
    ];
    for preset in ["paper", "paper-friction"] {
        let own = run(preset, Kernel::Lanes, &sets);
        assert!(own.counts.evaluations < 14 * own.counts.steps);
        let differences = run(preset, Kernel::Scalar, &sets);
        let lagrange = [&sets[..], &[("solver.formulation", "lagrange")]].concat();
        let lagrange = run(preset, Kernel::Lanes, &lagrange);
        for (name, other) in [("scalar", differences), ("lagrange", lagrange)] {
            let error = distance(&other, &own);
            println!(
                "{preset}, {name}: {error:.1e}, {:?} {:?}",
                own.counts, other.counts
            );
            assert!(error < 1e-5, "{preset}, {name}: {error:e}");
        }
    }
}

/// A rising load contributes to df/dt. Measured at 1e-8: 7.5e-8 in 189 steps; without the load's slope 4 195 steps.
#[test]
fn hard_a_rising_load_costs_no_order() {
    let window = [
        ("solver.duration_s", "0.004"),
        ("drive.load_ramp_s", "0.004"),
    ];
    let by = |method: &str, tolerance: &str| {
        let solver = [
            ("solver.integrator", method),
            ("solver.tolerance", tolerance),
        ];
        run("paper", Kernel::Lanes, &[&window[..], &solver].concat())
    };
    let rodas = by("rodas5p", "1e-8");
    let (error, steps) = (distance(&rodas, &by("dopri5", "1e-11")), rodas.counts.steps);
    println!("{error:.1e} in {steps} steps");
    assert!(error < 3e-7, "rodas5p: error {error:e}, bound 3e-7");
    assert!(steps < 400, "rodas5p: {steps} steps, bound 400");
}

/// All processors take equal steps; results differ by rounding, measured 1.6e-13.
#[test]
fn regress_the_steps_do_not_depend_on_the_processor() {
    let sets = [
        ("solver.integrator", "rodas5p"),
        ("solver.tolerance", "1e-6"),
        ("solver.duration_s", "0.01"),
    ];
    let here = run("paper-friction", Kernel::Lanes, &sets);
    for kernel in [Kernel::Avx2, Kernel::Portable] {
        let there = run("paper-friction", kernel, &sets);
        let error = distance(&there, &here);
        println!(
            "{kernel:?}: {error:.1e} {:?} {:?}",
            there.counts, here.counts
        );
        assert_eq!(there.counts, here.counts, "rodas5p, {kernel:?}");
        assert!(error < 1e-11, "rodas5p, {kernel:?}: {error:e}, bound 1e-11");
    }
}
