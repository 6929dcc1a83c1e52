//! The three rapier engines against the native solver, and against closed forms.
//!
//! Limits are measured figures times a margin; each is beside its measurement.

#![allow(clippy::print_stdout)] // measured figures, for whoever resets a limit

use std::sync::atomic::AtomicBool;

use pinwheel_engines::{Cancelled, Control, Ending, Halt, by_name};
use pinwheel_scene::{FrictionLaw, Scene, Start};
use pinwheel_tests::runs::{self, attempt, channels, native, run, scene};
use pinwheel_timeseries::TimeSeries;

const SHARED: &str = "rapier-shared-law";
const HOOK: &str = "rapier-own-contact-hook";
const COLLIDERS: &str = "rapier-own-contact-colliders";

const TORQUES: [&str; 2] = ["input_torque_n_m", "output_torque_n_m"];
const FORCES: [&str; 2] = ["external_sleeve_force_n", "internal_sleeve_force_n"];
const BOTH: [&str; 4] = [TORQUES[0], TORQUES[1], FORCES[0], FORCES[1]];

fn relative(
    time_series: &TimeSeries,
    reference: &TimeSeries,
    quantity: &str,
    from_s: f64,
    to_s: f64,
) -> f64 {
    runs::relative(time_series, reference, &[quantity], (from_s, to_s))
}

/// Returns the mean over the window and the channels.
fn mean(time_series: &TimeSeries, quantity: &str, from_s: f64, to_s: f64) -> f64 {
    let window = time_series.window(from_s, to_s);
    let channels = channels(time_series, quantity);
    let sum: f64 = channels
        .iter()
        .map(|channel| channel[window.clone()].iter().sum::<f64>())
        .sum();
    sum / (channels.len() * window.len()) as f64
}

fn assert_close(
    time_series: &TimeSeries,
    reference: &TimeSeries,
    quantities: &[&str],
    (from_s, to_s): (f64, f64),
    limit: f64,
) {
    for quantity in quantities {
        let error = relative(time_series, reference, quantity, from_s, to_s);
        println!("{quantity} {from_s}-{to_s} s: {error:.2e} (limit {limit:.1e})");
        assert!(
            error < limit,
            "{quantity} in {from_s}-{to_s} s: {error:e}, limit {limit:e}"
        );
    }
}

/// Compares means over a turn of the input after the start-up.
fn assert_mean(time_series: &TimeSeries, reference: &TimeSeries, quantity: &str, limit: f64) {
    let [got, wanted] = [time_series, reference].map(|run| mean(run, quantity, 0.25, 0.313));
    let error = (got / wanted - 1.0).abs();
    println!("mean {quantity}: {got:.5} against {wanted:.5}, {error:.2e} (limit {limit:.1e})");
    assert!(error < limit, "mean {quantity}: {got} against {wanted}");
}

/// Measured 7.5e-5 at 2e-6 s, the leapfrog's own error: its scheme on the reduced equations, without rapier, has as much. A first-order scheme has 1e-3 here.
#[test]
fn crossval_rapier_shared_law_transient() {
    let at = |step_s: &str| {
        scene(
            "paper",
            &[("solver.duration_s", "0.05"), ("solver.step_s", step_s)],
        )
    };
    let fine = run(SHARED, &at("2e-6"));
    let reference = native(&at("2e-6"), "rk4", 2e-6);
    assert_close(&fine, &reference, &BOTH, (0.0, 0.05), 2e-4);

    // Second order: twice the step gives four times the error.
    let coarse = run(SHARED, &at("4e-6"));
    let error = |time_series: &TimeSeries| relative(time_series, &reference, FORCES[0], 0.0, 0.05);
    let ratio = error(&coarse) / error(&fine);
    println!("error ratio of steps 4e-6 and 2e-6: {ratio:.2}");
    assert!((3.8..4.2).contains(&ratio), "{ratio}");
}

/// Other numbers of pins, holes and discs, and play. Measured 2e-5 to 9e-5 at 2e-6 s, 3e-4 with play, where every pin comes
/// into contact with an impact.
#[test]
fn crossval_rapier_shared_law_other_gears() {
    for (preset, limit) in [
        ("eleven-pins", 2e-4),
        ("forty-pins", 2e-4),
        ("backlash-0.6", 1e-3),
    ] {
        println!("{preset}");
        let scene = scene(
            preset,
            &[("solver.duration_s", "0.03"), ("solver.step_s", "2e-6")],
        );
        let time_series = run(SHARED, &scene);
        let reference = native(&scene, "rk4", 2e-6);
        assert_close(&time_series, &reference, &BOTH, (0.0, 0.03), limit);
    }
}

/// Sleeves with friction on their pins and seals of the shafts, with rigidly supported and floating discs: the driver
/// supplies both losses.
#[test]
fn crossval_rapier_losses_beside_contacts() {
    let rubs = [
        ("bearings.sleeve_friction_coefficient", "0.05"),
        ("bearings.sleeve_bore_m", "0.008"),
        ("bearings.input_seal_n_m", "0.1"),
        ("bearings.output_seal_n_m", "0.3"),
    ];
    for (preset, sets, step, limit) in [
        ("paper", &rubs[..], "2e-6", 2e-4),
        ("needle-bearings", &[], "2e-7", 1e-3),
    ] {
        println!("{preset}");
        let base = [
            ("drive.start", "\"equilibrium\""),
            ("solver.integrator", "\"dopri5\""),
            ("solver.duration_s", "0.001"),
            ("solver.sample_s", "2e-5"),
            ("solver.step_s", step),
        ];
        let scene = scene(preset, &[sets, &base].concat());
        let time_series = run(SHARED, &scene);
        let reference = native(&scene, "dopri5", 2e-6);
        assert_close(&time_series, &reference, &BOTH, (0.0, 0.001), limit);
    }
}

/// From static equilibrium there is no start-up transient, so 1e-5 s suffices from the first sample on: measured 2.4e-5.
#[test]
fn crossval_rapier_from_equilibrium() {
    let settings = [
        ("drive.start", "\"equilibrium\""),
        ("solver.duration_s", "0.05"),
    ];
    let scene = scene("paper", &settings);
    let reference = native(&scene, "rk4", 5e-6);
    for engine in [SHARED, HOOK] {
        let time_series = run(engine, &scene);
        assert_close(&time_series, &reference, &BOTH, (0.0, 0.05), 1e-4);
    }
}

/// A ring as output: its pins hang on it, and the contacts' loads turn with it. A ring that is light beside its pins (1.4e-4 kg m^2 with
/// 3e-3 of pins) takes more sweeps over the joints than there are, and diverges.
#[test]
fn crossval_rapier_a_ring_that_turns() {
    let settings = [
        ("drive.output", "\"ring\""),
        ("drive.start", "\"equilibrium\""),
        ("mass.output_shaft.moment_kg_m2", "1e-3"),
        ("solver.duration_s", "0.02"),
    ];
    let scene = scene("paper", &settings);
    let reference = native(&scene, "rk4", 5e-6);
    assert_close(&run(SHARED, &scene), &reference, &BOTH, (0.0, 0.02), 1e-4);
}

/// Every law reaches rapier in both ways, the conservative one with its force along the profile. Measured 6e-6 to 7.2e-5.
#[test]
fn crossval_rapier_other_laws() {
    for law in ["paper-conservative", "constant", "lankarani-nikravesh"] {
        println!("{law}");
        let law = format!("\"{law}\"");
        let settings = [
            ("contact.law", law.as_str()),
            ("solver.duration_s", "0.02"),
            ("solver.step_s", "2e-6"),
        ];
        let scene = scene("paper", &settings);
        let reference = native(&scene, "rk4", 2e-6);
        for engine in [SHARED, HOOK] {
            let time_series = run(engine, &scene);
            assert_close(&time_series, &reference, &BOTH, (0.0, 0.02), 2e-4);
        }
    }
}

/// Without friction rapier's contact solver must pass the native normal force unchanged, as the shared law does; the table of
/// limits judges the error of the step.
#[test]
fn crossval_rapier_hook_without_friction() {
    let scene = scene("paper", &[("solver.duration_s", "0.05")]);
    let [hook, shared] = [HOOK, SHARED].map(|engine| run(engine, &scene));
    assert_close(&hook, &shared, &BOTH, (0.0, 0.05), 2e-4);
}

/// Implicit Coulomb friction against a native run that resolves the scene's friction, within 2e-3, by the table of limits in steady
/// motion too: 1.3e-3 in the driver torque, 1.2e-3 and 4.4e-4 in the forces, mostly the creep below the ramp speed, which Coulomb
/// friction lacks. Start-up, 2e-6 s: 1.5e-3 in the driver torque, 9.8e-4 in the output's, 6.4e-4 in the forces.
///
/// At 1e-5 s the start-up has 9.3e-4 in the forces and 2.5e-3 in the driver torque: contacts begin to stick or
/// slide up to a step late, and each such sample is up to 0.05 N m off (5e-6 s: 2.1e-3).
#[test]
fn crossval_rapier_hook_with_friction() {
    let scene = scene("paper-friction", &[("solver.duration_s", "0.05")]);
    let time_series = run(HOOK, &scene);
    let reference = run("native-resolved", &scene);
    assert_close(&time_series, &reference, &FORCES, (0.0, 0.05), 2e-3);
    assert_close(&time_series, &reference, &TORQUES, (0.0, 0.05), 5e-3);
    let fine = self::scene(
        "paper-friction",
        &[("solver.duration_s", "0.05"), ("solver.step_s", "2e-6")],
    );
    let fine = run(HOOK, &fine);
    assert_close(&fine, &reference, &BOTH, (0.0, 0.05), 2e-3);
}

/// Light pins make friction fifty times stiffer: a native run at 2e-7 s has an error of 6 % in the driver torque, one at
/// 2e-8 s has none. The hook at 1e-5 s: measured 9.1e-4 over 0.05 s.
#[test]
fn crossval_rapier_hook_with_light_sleeves() {
    let settings = [
        ("solver.duration_s", "0.01"),
        ("contact.friction_coefficient", "0.1"),
    ];
    let scene = scene("eleven-pins", &settings);
    let time_series = run(HOOK, &scene);
    let reference = native(&scene, "rk2", 2e-8);
    assert_close(&time_series, &reference, &FORCES, (0.0, 0.01), 2e-3);
    assert_close(&time_series, &reference, &TORQUES, (0.0, 0.01), 5e-3);
}

/// rapier alone. Means only, because a linear spring spreads the load over the pins otherwise; the paper's gear is judged by
/// the table of limits. Measured: eleven-pins 0.4 % torque, 3.9 and 5.1 % forces; backlash-0.6 0.7 %, 0.8 and 4.9 %.
#[test]
fn crossval_rapier_colliders_means_of_other_gears() {
    for preset in ["eleven-pins", "backlash-0.6"] {
        println!("{preset}");
        let scene = scene(preset, &[("solver.duration_s", "0.313")]);
        let time_series = run(COLLIDERS, &scene);
        let reference = native(&scene, "rk4", 1e-5);
        for quantity in TORQUES {
            assert_mean(&time_series, &reference, quantity, 1.5e-2);
        }
        for quantity in FORCES {
            assert_mean(&time_series, &reference, quantity, 0.1);
        }
    }
}

#[test]
fn crossval_rapier_repeats_to_the_bit() {
    for engine in [SHARED, HOOK, COLLIDERS] {
        let scene = scene("paper-friction", &[("solver.duration_s", "0.02")]);
        let (once, again) = (run(engine, &scene), run(engine, &scene));
        assert_eq!(once.len(), 201);
        for (a, b) in once.channels().iter().zip(again.channels()) {
            let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&a.values), bits(&b.values), "{engine}: {}", a.name);
        }
    }
}

/// Real steel at 1e-4 s is far beyond the stability limit of an explicit normal force.
#[test]
fn crossval_rapier_divergence_is_an_error() {
    for engine in [SHARED, HOOK] {
        let scene = scene(
            "steel",
            &[("solver.step_s", "1e-4"), ("solver.duration_s", "0.05")],
        );
        let run = attempt(engine, &scene);
        match run.ending {
            Ending::Diverged { time_s, quantity } => {
                println!("{engine}: t = {time_s} s, {quantity}");
                assert!(time_s > 0.0 && time_s < 0.05);
                assert!(!quantity.is_empty());
                let kept = &run.time_series;
                assert!(kept.len() < 501 && !kept.is_empty());
                assert!(kept.time_s().iter().all(|t| *t < time_s + 1e-12));
                let finite = |values: &[f64]| values.iter().all(|x| x.is_finite());
                assert!(
                    kept.channels()
                        .iter()
                        .all(|channel| finite(&channel.values))
                );
            }
            other => panic!("{engine} did not diverge: {other:?}"),
        }
    }
}

#[test]
fn crossval_rapier_refuses_what_it_cannot_honour() {
    let reason = |engine: &str, scene: &Scene| match by_name(engine, scene)
        .unwrap()
        .supports(&scene.clone().check().unwrap())
    {
        Err(Halt::Ended(Ending::Unsupported { reason })) => {
            // The run refuses with equal text.
            let ending = attempt(engine, scene).ending;
            assert_eq!(ending, Ending::unsupported(&reason));
            reason
        }
        other => panic!("{engine}: {other:?}"),
    };
    for engine in [SHARED, HOOK, COLLIDERS] {
        let duration = scene("paper", &[("solver.duration_s", "0.0100033")]);
        assert!(reason(engine, &duration).contains("solver.duration_s"));
    }
    for engine in [HOOK, COLLIDERS] {
        let mut friction = scene("paper-friction", &[]);
        friction.contact.friction_law = FrictionLaw::Adams;
        friction.solver.integrator = "auto".to_owned();
        assert!(reason(engine, &friction).contains("contact.friction_law"));
        // Losses outside the contacts.
        let friction = ("bearings.sleeve_friction_coefficient", "0.05");
        for sets in [
            &[("bearings.input_seal_n_m", "0.1")][..],
            &[("bearings.output_seal_n_m", "0.1")],
            &[friction, ("bearings.sleeve_bore_m", "0.01")],
        ] {
            let (lossy, key) = (scene("paper", sets), sets[0].0);
            assert!(reason(engine, &lossy).contains(key));
        }
    }
    for engine in [SHARED, HOOK] {
        let uneven = scene("paper", &[("solver.step_s", "3e-5")]);
        assert!(reason(engine, &uneven).contains("solver.step_s"));
    }
    for engine in [HOOK, COLLIDERS] {
        for (keys, named) in [
            (
                &[
                    ("bearings.sleeve_friction_coefficient", "0.05"),
                    ("bearings.sleeve_bore_m", "0.008"),
                ][..],
                "bearings.sleeve_friction_coefficient",
            ),
            (
                &[("bearings.input_seal_n_m", "0.1")],
                "bearings.input_seal_n_m",
            ),
            (
                &[
                    ("contact.friction_coefficient", "0.1"),
                    ("gear.internal_sleeves_turn", "false"),
                ],
                "gear.internal_sleeves_turn",
            ),
        ] {
            assert!(reason(engine, &scene("paper", keys)).contains(named));
        }
    }
    assert!(reason(COLLIDERS, &scene("paper-rough", &[])).contains("contact.detection"));
    let equilibrium = scene("paper", &[("drive.start", "\"equilibrium\"")]);
    assert!(reason(COLLIDERS, &equilibrium).contains("drive.start"));
}

#[test]
fn crossval_rapier_stops_when_asked() {
    for engine in [SHARED, HOOK, COLLIDERS] {
        let scene = scene("paper", &[]);
        let cancel = AtomicBool::new(true);
        let control = Control::new(&cancel, &|_| {});
        let outcome = by_name(engine, &scene)
            .unwrap()
            .run(&scene.clone().check().unwrap(), &control);
        assert!(matches!(outcome, Err(Cancelled)), "{engine}");
    }
}

/// Channels of rapier's bodies against the native run: bearing forces from its accelerations, pairs from its states;
/// unavailable ones are missing and noted.
#[test]
fn channels_agree_or_are_missing() {
    let scene = scene(
        "paper",
        &[
            ("solver.duration_s", "0.05"),
            ("drive.start", "equilibrium"),
            ("output.channels", "*"),
        ],
    );
    let native = native(&scene, "dopri5", 1e-5);
    for (engine, pairs) in [(SHARED, true), (HOOK, true), (COLLIDERS, false)] {
        let mut scene = scene.clone();
        if !pairs {
            // Its spring is another law, with another equilibrium.
            scene.drive.start = Start::Kinematic;
            scene.solver.duration_s = 0.002;
        }
        let run = runs::finished(engine, &scene);
        let notes = run.stats.notes.join(" ");
        assert_eq!(notes.contains("does not know"), !pairs, "{engine}: {notes}");
        let time_series = &run.time_series;
        let missing = native.channels().len() - time_series.channels().len();
        assert_eq!(missing, if pairs { 0 } else { 2 * 24 * 12 + 2 }, "{engine}");
        assert!(time_series.channel("external_contact_ratio_1").is_some());
        if !pairs {
            continue;
        }
        // Measured 1.6e-5 to 3.3e-5, stiffness 1.7e-6: the leapfrog's own error, as in the forces.
        for (quantity, limit) in [
            ("eccentric_bearing_force_n", 2e-4),
            ("eccentric_bearing_tangential_force_n", 2e-4),
            ("external_pin_force_x_n", 2e-4),
            ("internal_pin_force_n", 2e-4),
            ("transmission_error_arcmin", 2e-4),
            ("wheel_1_external_penetration_m", 2e-4),
            ("wheel_0_external_stiffness_n_m15", 2e-5),
            ("wheel_0_internal_normal_force_n", 2e-4),
        ] {
            let off = relative(time_series, &native, quantity, 0.01, 0.05);
            println!("{engine} {quantity}: {off:.1e}");
            assert!(off < limit, "{engine} {quantity}: {off:e}");
        }
    }
}

/// A load that jumps between two steps. Measured over the first 0.012 s at 2e-6 s: 2.0e-5 (22 to 44 N m) and 9.7e-5 (22 to
/// -22 N m through a backlash of 0.6 mm), and 25 times as much at 1e-5 s: second order, over the jump too.
#[test]
fn crossval_rapier_load_changes() {
    for (preset, limit) in [("hard-load-doubled", 4e-5), ("hard-load-reversal", 2e-4)] {
        let at = |step_s: &str| {
            scene(
                preset,
                &[
                    ("solver.duration_s", "0.012"),
                    ("solver.step_s", step_s),
                    ("solver.tolerance", "1e-10"),
                ],
            )
        };
        let reference = native(&at("1e-5"), "dopri5", 1e-5);
        for engine in [SHARED, HOOK] {
            let time_series = run(engine, &at("2e-6"));
            assert_close(&time_series, &reference, &FORCES, (0.0, 0.012), limit);
        }
    }
}

/// A modified profile and errors of single parts under the scene's own law: native in both formulations, rapier with the law
/// as a load and through its contacts, from equilibrium. Measured 1.7e-13 between the formulations, 3.6e-7 with rapier.
#[test]
fn crossval_rapier_deviations() {
    for preset in ["modified", "toleranced"] {
        let scene = scene(
            preset,
            &[
                ("contact.stiffness_multiplier", "0.01"),
                ("solver.duration_s", "0.02"),
                ("solver.step_s", "2e-6"),
            ],
        );
        let reference = native(&scene, "rk4", 2e-6);
        let lagrange = {
            let mut scene = scene.clone();
            scene.solver.formulation = pinwheel_scene::Formulation::Lagrange;
            native(&scene, "rk4", 2e-6)
        };
        assert_close(&lagrange, &reference, &BOTH, (0.0, 0.02), 1e-11);
        for engine in [SHARED, HOOK] {
            assert_close(&run(engine, &scene), &reference, &BOTH, (0.0, 0.02), 1e-6);
        }
    }
}

/// rapier's own collisions include the deviations: its mean forces change like the native solver's.
#[test]
fn crossval_rapier_colliders_deviations() {
    for preset in ["modified", "toleranced"] {
        let scene = scene(
            preset,
            &[
                ("contact.stiffness_multiplier", "0.01"),
                ("drive.start", "kinematic"),
                ("solver.duration_s", "0.313"),
                ("solver.sample_s", "1e-4"),
            ],
        );
        let time_series = run(COLLIDERS, &scene);
        let reference = native(&scene, "auto", 1e-5);
        assert_mean(&time_series, &reference, TORQUES[0], 0.015);
        for quantity in FORCES {
            assert_mean(&time_series, &reference, quantity, 0.1);
        }
    }
}
