//! Distances of the engines from the native solver.

use super::recordings::repeated;
use super::*;

/// Scenes with recordings whose start-up `crossval_python_shared_law_transient` runs.
pub(super) const TRANSIENTS: [&str; 4] = ["paper", "backlash-0.6", "eleven-pins", "forty-pins"];

/// Compares all three engines of the shared law with a converged run, within the limits of their methods, and with their
/// recordings.
fn assert_shared_law(
    what: &str,
    scene: &Scene,
    reference: &TimeSeries,
    explicit: f64,
    constrained: f64,
) {
    for (engine, limit) in [
        (MUJOCO, explicit),
        (EXPLICIT, explicit),
        (CONSTRAINED, constrained),
    ] {
        let live = run(engine, scene);
        assert_within(
            &format!("{what} {engine}"),
            worst(&live, reference, 0.0),
            limit,
        );
        let compared = repeated(engine, scene, &live);
        assert_eq!(compared > 0, TRANSIENTS.contains(&what), "{what} {engine}");
    }
}

/// Steady, live, at the paper's step: measured 2.8e-8 for Runge-Kutta 4, 2.2e-5 for the trapezoidal rule, from static equilibrium so that no
/// transient has to decay.
#[test]
fn crossval_python_shared_law_steady() {
    let settings = [
        ("drive.start", "\"equilibrium\""),
        ("solver.duration_s", "0.02"),
    ];
    let scene = scene("paper", &settings);
    let reference = native(&scene, "rk4", 1e-6);
    for (engine, limit) in [(MUJOCO, 1.3e-7), (EXPLICIT, 1.3e-7), (CONSTRAINED, 1e-4)] {
        let error = worst(&run(engine, &scene), &reference, 0.0);
        assert_within(engine, error, limit);
    }
}

/// The start-up transient, live. Measured at 1e-5 s: 8.3e-6 for Runge-Kutta 4 with the paper's gear, 2.6e-5 with backlash,
/// where pins come into contact with an impact; 2.8e-3 and 2.4e-3 for the implicit trapezoidal rule.
#[test]
fn crossval_python_shared_law_transient() {
    for (preset, settings, explicit, constrained) in [
        ("paper", vec![], 3e-5, 5e-3),
        ("backlash-0.6", vec![], 7e-5, 5e-3),
        ("eleven-pins", vec![], 1e-5, 2e-3),
        ("forty-pins", vec![], 1e-5, 4e-3),
        // Real steel oscillates ten times as fast and lifts off: a tenth of the step. Measured 5.3e-5.
        (
            "steel",
            vec![("solver.step_s", "1e-6"), ("solver.duration_s", "0.002")],
            1.6e-4,
            2e-2,
        ),
    ] {
        let scene = scene(
            preset,
            &[vec![("solver.duration_s", "0.005")], settings].concat(),
        );
        let reference = native(&scene, "rk4", scene.solver.step_s / 5.0);
        assert_shared_law(preset, &scene, &reference, explicit, constrained);
    }
}

/// The trapezoidal rule is of second order: half the step, a quarter of the error.
#[test]
fn crossval_python_constrained_order() {
    let at = |step_s: &str| {
        let scene = scene(
            "paper",
            &[("solver.duration_s", "0.01"), ("solver.step_s", step_s)],
        );
        let reference = native(&scene, "rk4", 1e-6);
        worst(&run(CONSTRAINED, &scene), &reference, 0.0)
    };
    let (coarse, fine) = (at("2e-5"), at("1e-5"));
    println!(
        "2e-5 s: {coarse:.2e}, 1e-5 s: {fine:.2e}, ratio {:.2}",
        coarse / fine
    );
    assert!((3.5..4.5).contains(&(coarse / fine)));
}

/// Friction: implicit at the paper's step, explicit at a step that resolves it.
#[test]
fn crossval_python_friction() {
    let scene = scene("paper-friction", &[("solver.duration_s", "0.003")]);
    let reference = native(&scene, "rk4", 1e-7);
    // Measured 5e-4 on the forces; single samples at which a contact begins to stick dominate the driver torque.
    let constrained = run(CONSTRAINED, &scene);
    assert_within(CONSTRAINED, worst(&constrained, &reference, 0.0), 1e-2);
    let mut fine = scene.clone();
    fine.solver.step_s = 2e-7;
    let attempt = runs::finished(MUJOCO, &fine);
    assert!(
        attempt
            .stats
            .notes
            .iter()
            .any(|note| note.contains("explicit"))
    );
    assert_within(MUJOCO, worst(&attempt.time_series, &reference, 0.0), 1e-3);
}

/// A load that jumps between two steps, live; through a backlash of 0.6 mm all contacts open and strike again. Measured
/// at 5e-6 s 8.1e-8 and 1.4e-5 for Runge-Kutta 4 of both peers, 2.4e-4 and 1.6e-3 for the trapezoidal rule.
#[test]
fn crossval_python_load_changes() {
    for (preset, explicit, constrained) in [
        ("hard-load-doubled", 3e-7, 7e-4),
        ("hard-load-reversal", 5e-5, 5e-3),
    ] {
        let settings = [
            ("solver.duration_s", "0.012"),
            ("solver.step_s", "5e-6"),
            ("solver.tolerance", "1e-10"),
        ];
        let scene = scene(preset, &settings);
        let reference = native(&scene, "dopri5", 1e-5);
        assert_shared_law(preset, &scene, &reference, explicit, constrained);
    }
}

/// Own contact, live: MuJoCo and exudyn from the law's equilibrium. Their beds carry the load some per cent differently, so
/// they start with an oscillation of a few per cent; means over it are compared. The recordings are judged on wave forms
/// after its decay.
#[test]
fn crossval_python_own_contact_live() {
    let settings = [
        ("drive.start", "\"equilibrium\""),
        ("solver.duration_s", "0.012"),
    ];
    let smaller = [
        ("gear.modification.equidistant_m", "2e-5"),
        ("gear.modification.radial_m", "-2e-5"),
    ];
    for changes in [&[][..], &smaller] {
        assert_own_means(&scene("paper", &[&settings, changes].concat()));
    }
}

fn assert_own_means(scene: &Scene) {
    let reference = native(scene, "rk4", 1e-5);
    let mean = |time_series: &TimeSeries, quantity: &str| {
        let window = time_series.window(0.004, 0.012);
        let channels = channels(time_series, quantity);
        let sum: f64 = channels
            .iter()
            .map(|c| c[window.clone()].iter().sum::<f64>())
            .sum();
        sum / (channels.len() * window.len()) as f64
    };
    for engine in [MUJOCO_OWN, EXUDYN_OWN] {
        let time_series = run(engine, scene);
        for (quantity, limit) in QUANTITIES.iter().zip(OWN_MEANS) {
            let error = (mean(&time_series, quantity) / mean(&reference, quantity) - 1.0).abs();
            assert_within(&format!("{engine} mean {quantity}"), error, limit);
        }
    }
}

/// Limits of the means of driver torque, output torque, external and internal forces. Measured 9.8e-3 (what the
/// paper's law creates in power), 3.2e-4, 1.5e-2 and 6.4e-4.
const OWN_MEANS: [f64; 4] = [1.5e-2, 1e-3, 2.2e-2, 2e-3];
