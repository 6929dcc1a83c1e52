//! Hard cases: suitable methods succeed, the others fail with an error.

#![allow(clippy::print_stdout)] // measured figures, for whoever resets a limit

use pinwheel_engines::Ending;
use pinwheel_scene::{Detection, PRESETS};
use pinwheel_tests::runs::{self, attempt, finished as run, scene};
use pinwheel_timeseries::TimeSeries;

const FORCES: [&str; 2] = ["external_sleeve_force_n", "internal_sleeve_force_n"];

fn forces_of(time_series: &TimeSeries) -> Vec<&[f64]> {
    FORCES
        .iter()
        .flat_map(|quantity| runs::channels(time_series, quantity))
        .collect()
}

fn relative(computed: &TimeSeries, reference: &TimeSeries, names: &[&str]) -> f64 {
    runs::relative(computed, reference, names, (0.0, f64::INFINITY))
}

/// Every hard preset ends in both forms with plausible forces for its load, or with an error that states time and quantity.
/// Largest force measured among those that end: 2.1 kN (`hard-all-open`, where the discs fall through their full play); ten
/// times that is implausible.
#[test]
fn hard_presets_run_or_say_why() {
    let hard: Vec<&str> = PRESETS
        .iter()
        .map(|preset| preset.name)
        .filter(|name| name.starts_with("hard-"))
        .collect();
    assert!(hard.len() > 20);
    for name in hard {
        // The long run has its own test below. Constraints make feathers a hundred times as dear as any other preset.
        let limit = ["0.01", "0.0005"][usize::from(name == "hard-feather-sleeves")];
        let limit = [("solver.duration_s", limit)];
        for engine in ["native-reduced", "native-lagrange"] {
            let run = attempt(engine, &scene(name, &limit));
            match run.ending {
                Ending::Finished => {
                    assert!(
                        name != "hard-steel",
                        "Heun at 1e-5 s is far beyond its limit there"
                    );
                    let forces = forces_of(&run.time_series);
                    let largest = forces
                        .iter()
                        .flat_map(|f| f.iter())
                        .fold(0.0, |a: f64, x| a.max(*x));
                    println!("{name}, {engine}: largest force {largest:.1} N");
                    assert!(
                        forces.iter().all(|f| f.iter().all(|x| x.is_finite())),
                        "{name}, {engine}"
                    );
                    assert!(largest < 2.2e4, "{name}, {engine}: {largest} N");
                }
                Ending::Diverged { time_s, quantity } => {
                    assert_eq!(name, "hard-steel", "{engine}: {quantity}");
                    assert!(time_s < 0.01 && run.time_series.len() < 101);
                }
                Ending::Unsupported { reason } => {
                    assert!(!reason.is_empty());
                }
                other => panic!("{name}, {engine}: {other}"),
            }
        }
    }
}

/// Constraint drift of the Lagrange form over 10 s, half a million steps, stays below 1e-12 m, and its output angle equals that
/// of the reduced form.
#[test]
fn hard_lagrange_form_does_not_drift_over_ten_seconds() {
    let scene = scene(
        "paper",
        &[
            ("solver.duration_s", "10.0"),
            ("solver.step_s", "2e-5"),
            ("solver.sample_s", "1e-2"),
        ],
    );
    let (lagrange, reduced) = std::thread::scope(|scope| {
        let reduced = scope.spawn(|| run("native-reduced", &scene));
        let lagrange = run("native-lagrange", &scene);
        (lagrange, reduced.join().unwrap())
    });
    let drift = lagrange.stats.joint_drift_m.unwrap();
    let angle = ["output_angle_rad"];
    let (off, forces) = (
        relative(&lagrange.time_series, &reduced.time_series, &angle),
        relative(&lagrange.time_series, &reduced.time_series, &FORCES),
    );
    println!("drift {drift:.1e} m; angle {off:.1e}, forces {forces:.1e} relative");
    assert!(drift < 1e-12, "{drift:e}");
    assert!(off < 1e-12 && forces < 1e-7, "{off:e} {forces:e}");
}

/// Implicit friction at the paper's step: forces within 1.2e-3 and driver torque within 5e-3 of a run that resolves the
/// friction, falling at least with the power 1.4 of the step (measured 1.14e-3, 4.9e-3 and 1.51); explicit Heun has 8.9e-3
/// and 3.4e-2 there.
#[test]
fn hard_friction_at_the_papers_step() {
    let at = |integrator: &str, step: &str| {
        let settings = [
            ("solver.duration_s", "0.05"),
            ("solver.integrator", integrator),
            ("solver.step_s", step),
        ];
        run("native-reduced", &scene("paper-friction", &settings)).time_series
    };
    let reference = at("rk2", "1e-7");
    let error = |integrator: &str, step: &str| {
        let time_series = at(integrator, step);
        let driver = relative(&time_series, &reference, &["input_torque_n_m"]);
        let forces = relative(&time_series, &reference, &FORCES);
        println!("{integrator} at {step} s: forces {forces:.2e}, driver torque {driver:.2e}");
        (forces, driver)
    };
    let (coarse, fine) = (error("imex2", "1e-5"), error("imex2", "2e-6"));
    assert!(coarse.0 < 1.2e-3 && coarse.1 < 5e-3, "{coarse:?}");
    let order = (coarse.0 / fine.0).ln() / 5.0_f64.ln();
    println!("order {order:.2}");
    assert!(order > 1.4, "{order}");
    let explicit = error("rk2", "1e-5");
    assert!(explicit.1 > 3.0 * coarse.1, "{explicit:?}");
}

/// Steel: Dormand-Prince stays stable and within 1e-2 in the transient, with fewer evaluations than Heun at 2e-6 s, near
/// its stability limit (measured 2.1e-4 in 37 000; Heun has an error of 47 % in 50 000).
#[test]
fn hard_steel_by_an_adaptive_method() {
    let at = |integrator: &str, step: &str, tolerance: &str| {
        let settings = [
            ("solver.duration_s", "0.05"),
            ("solver.integrator", integrator),
            ("solver.step_s", step),
            ("solver.tolerance", tolerance),
        ];
        run("native-reduced", &scene("steel", &settings))
    };
    let reference = at("rk4", "2e-7", "1e-6");
    let adaptive = at("dopri5", "1e-6", "1e-6");
    let heun = at("rk2", "2e-6", "1e-6");
    let error = relative(&adaptive.time_series, &reference.time_series, &FORCES);
    let explicit = relative(&heun.time_series, &reference.time_series, &FORCES);
    println!(
        "dopri5 {error:.1e} in {}; Heun at 2e-6 s {explicit:.1e} in {}",
        adaptive.stats.rhs_calls, heun.stats.rhs_calls
    );
    assert!(error < 1e-2, "{error:e}");
    assert!(adaptive.stats.rhs_calls < heun.stats.rhs_calls);
}

/// Friction on pins of 1e-11 kg m^2: with explicit methods spins jump while the forces look plausible (Heun: 1e-2 off). The
/// energy balance shows it: 36 times the converted energy (RK4), 130 times (Heun); for every correct run of any preset it
/// stays below 0.16.
#[test]
fn hard_explicit_friction_on_feathers_fails_loudly() {
    for integrator in ["rk2", "rk4"] {
        for engine in ["native-reduced", "native-lagrange"] {
            let settings = [
                ("solver.duration_s", "0.005"),
                ("solver.integrator", integrator),
            ];
            match attempt(engine, &scene("hard-feather-sleeves", &settings)).ending {
                Ending::Diverged { quantity, .. } => {
                    println!("{integrator}, {engine}: {quantity}");
                    assert!(quantity.contains("energy"), "{integrator}: {quantity}");
                }
                other => panic!("{integrator}, {engine}: {other}"),
            }
        }
    }
    let settings = [("solver.duration_s", "0.005")];
    let _ = run("native-reduced", &scene("hard-feather-sleeves", &settings));
}

/// Method and error bound for a hard scene.
struct Served {
    scene: &'static str,
    /// Method at 1e-5 s, or at the scene's tolerance if it takes one.
    by: &'static str,
    /// Largest relative L2 error of the forces over the first 0.01 s: 1.5 times the measured one. Not judged without
    /// forces.
    bound: f64,
}

/// One row a hard preset. The first choice of `auto` is `etd-adams` without friction, `rodas5p` with it, RK4 for points;
/// its target is 1e-3.
#[rustfmt::skip]
const SERVED: &[Served] = &[
    Served { scene: "hard-adhesive", by: "auto", bound: 3.7e-6 },
    Served { scene: "hard-all-open", by: "auto", bound: 4.4e-5 },
    Served { scene: "hard-backlash-0.1", by: "auto", bound: 1.6e-4 },
    Served { scene: "hard-backlash-1", by: "auto", bound: 1.8e-4 },
    Served { scene: "hard-bearing-clearance", by: "auto", bound: 6.2e-5 },
    Served { scene: "hard-damping-0", by: "auto", bound: 3.0e-5 },
    Served { scene: "hard-damping-1", by: "auto", bound: 5.6e-5 },
    Served { scene: "hard-damping-512", by: "auto", bound: 6.9e-6 },
    Served { scene: "hard-damping-64", by: "auto", bound: 8.1e-6 },
    Served { scene: "hard-feather-sleeves", by: "auto", bound: 1.8e-5 },
    Served { scene: "hard-forty-sleeves", by: "auto", bound: 5.0e-6 },
    Served { scene: "hard-friction-light-sleeves", by: "auto", bound: 2.9e-5 },
    Served { scene: "hard-friction-narrow", by: "auto", bound: 2.8e-5 },
    Served { scene: "hard-friction-wide", by: "auto", bound: 8.4e-6 },
    Served { scene: "hard-load-doubled", by: "auto", bound: 6.7e-6 },
    Served { scene: "hard-load-removed", by: "auto", bound: 1.5e-5 },
    Served { scene: "hard-load-reversal", by: "auto", bound: 2.8e-5 },
    Served { scene: "hard-load-reversed", by: "auto", bound: 1.5e-5 },
    Served { scene: "hard-load-step", by: "auto", bound: 7.0e-5 },
    Served { scene: "hard-long-run", by: "auto", bound: 3.5e-5 },
    Served { scene: "hard-one-sleeve", by: "auto", bound: 1.6e-5 },
    Served { scene: "hard-points-120", by: "auto", bound: 6.6e-5 },
    Served { scene: "hard-points-16000", by: "auto", bound: 8.1e-5 },
    Served { scene: "hard-points-600", by: "auto", bound: 8.1e-5 },
    Served { scene: "hard-ramp-1e-7", by: "auto", bound: 4.3e-5 },
    Served { scene: "hard-ramp-1e-9", by: "auto", bound: 3.0e-5 },
    Served { scene: "hard-rpm-20", by: "auto", bound: 2.0e-5 },
    Served { scene: "hard-rpm-6000", by: "auto", bound: 3.3e-5 },
    Served { scene: "hard-rv-crank-loose", by: "auto", bound: 1.6e-6 },
    Served { scene: "hard-rv-crank-phase", by: "auto", bound: 1.2e-6 },
    Served { scene: "hard-rv-reversal", by: "auto", bound: 3.2e-6 },
    Served { scene: "hard-steel", by: "auto", bound: 2.0e-4 },
    Served { scene: "hard-steel-damped", by: "auto", bound: 9.0e-6 },
    Served { scene: "hard-stiffness-0.1", by: "auto", bound: 3.7e-4 },
    Served { scene: "hard-stiffness-0.1-damped", by: "auto", bound: 1.8e-5 },
    Served { scene: "hard-zero-load", by: "auto", bound: 0.0 },
    Served { scene: "hard-zero-load-friction", by: "auto", bound: 0.0 },
];

/// A method solves every third hard preset within a stated bound of a converged run (`dopri5` at 1e-9; with friction `imex2` at
/// 2.5e-7 s; with points RK4 at 5e-7 s). The baseline judges nearly all of them, too.
#[test]
fn hard_presets_are_served_within_their_bounds() {
    served(3);
}

#[test]
#[ignore = "weekly: 7 s for every hard preset"]
fn hard_presets_are_all_served_within_their_bounds() {
    served(1);
}

fn served(every: usize) {
    let hard = PRESETS.iter().map(|preset| preset.name);
    let hard: Vec<&str> = hard.filter(|name| name.starts_with("hard-")).collect();
    let listed: Vec<&str> = SERVED.iter().map(|row| row.scene).collect();
    assert_eq!(listed, hard, "every hard preset has its row");
    let mut exceeded = Vec::new();
    for row in SERVED.iter().step_by(every) {
        let at = |integrator: &str, step: &str, tolerance: &str| {
            let settings = [
                ("solver.duration_s", "0.01"),
                ("solver.sample_s", "1e-4"),
                ("solver.integrator", integrator),
                ("solver.step_s", step),
                ("solver.tolerance", tolerance),
            ];
            run("native-reduced", &scene(row.scene, &settings)).time_series
        };
        let own = scene(row.scene, &[]);
        let (contact, tolerance) = (own.contact, own.solver.tolerance.to_string());
        let converged = if contact.friction_coefficient > 0.0 {
            at("imex2", "2.5e-7", "1e-6")
        } else if contact.detection == Detection::Points {
            at("rk4", "5e-7", "1e-6")
        } else {
            at("dopri5", "1e-5", "1e-9")
        };
        let computed = at(row.by, "1e-5", &tolerance);
        let forces = |time_series: &TimeSeries| {
            let groups = forces_of(time_series);
            let all = groups.iter().flat_map(|g| g.iter());
            all.fold(0.0, |most: f64, &force| most.max(force))
        };
        if forces(&converged) < 1e-9 {
            // Without load and gap both have only rounding errors for forces.
            println!("{}: no forces, {:.1e} N", row.scene, forces(&computed));
            assert!(forces(&computed) < 1e-9, "{}", row.scene);
            continue;
        }
        let error = relative(&computed, &converged, &FORCES);
        println!("{} by {}: {error:.2e}", row.scene, row.by);
        if !(error <= row.bound) {
            exceeded.push(format!("{}: {error:.2e} > {:.2e}", row.scene, row.bound));
        }
    }
    assert!(exceeded.is_empty(), "{exceeded:#?}");
}
