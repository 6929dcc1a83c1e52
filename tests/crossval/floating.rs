//! Wheels that float: on the bearing of one eccentric, and on the cranks of RV gears.

use super::*;

const RAPIER: &str = "rapier-shared-law";

/// Measured over the first millisecond, the largest of four quantities: explicit engines 2e-6 and less (bearings begin steeply), rapier's leapfrog and
/// exudyn's implicit steps of second order as below.
#[test]
fn crossval_floating_wheels() {
    for (preset, sets) in runs::FLOATING {
        let base = [
            ("solver.duration_s", "0.001"),
            ("solver.sample_s", "2e-5"),
            ("solver.step_s", "5e-7"),
            ("solver.tolerance", "1e-10"),
        ];
        let scene = scene(preset, &[&base, *sets].concat());
        let reference = native(&scene, "dopri5", 1e-6);
        let engines = [
            (MUJOCO, 1e-5),
            (EXPLICIT, 1e-5),
            (CONSTRAINED, 1e-2),
            (RAPIER, 1e-3),
        ];
        let found = engines.map(|(engine, _)| worst(&run(engine, &scene), &reference, 0.0));
        println!("{preset} {sets:?}: {found:?}");
        for ((engine, limit), found) in engines.into_iter().zip(found) {
            assert_within(&format!("{preset}, {engine}"), found, limit);
        }
    }
}
