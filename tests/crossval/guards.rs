//! Intentional faults, and use of the process after them.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use pinwheel_faults::{Armed, Fault};

use super::*;

/// Guards: each intentional fault is an error, and the process remains usable.
#[test]
fn crossval_python_guards() {
    let short = scene("paper", &[("solver.duration_s", "0.002")]);
    let clean = SHARED.map(|engine| run(engine, &short));
    for fault in [Fault::NanLoads, Fault::HugeLoads] {
        for (engine, before) in SHARED.iter().zip(&clean) {
            let armed = Armed::with(fault);
            let run = attempt(engine, &short);
            drop(armed);
            match run.ending {
                Ending::Diverged { time_s, quantity } => {
                    println!("{engine} {fault:?}: t = {time_s} s, {quantity}");
                    assert!(time_s > 0.0 && time_s <= 0.002, "{time_s}");
                    let kept = &run.time_series;
                    assert!(!kept.is_empty() && kept.len() < before.len());
                    assert!(
                        kept.channels()
                            .iter()
                            .all(|channel| channel.values.iter().all(|v| v.is_finite()))
                    );
                }
                other => panic!("{engine} {fault:?}: {other:?}"),
            }
            assert_same_bits(&self::run(engine, &short), before, engine);
        }
    }
    let armed = Armed::with(Fault::FrozenLoads);
    let text = attempt(MUJOCO, &short).ending.to_string();
    drop(armed);
    assert!(text.contains("frozen") && text.contains("stages"), "{text}");
    assert_same_bits(&run(MUJOCO, &short), &clean[0], MUJOCO);
}

/// Real steel at a step far beyond the stability limit: MuJoCo would reset its state, exudyn report success.
#[test]
fn crossval_python_silent_blow_up_is_an_error() {
    let steel = scene(
        "steel",
        &[
            ("solver.step_s", "1e-3"),
            ("solver.sample_s", "1e-3"),
            ("solver.duration_s", "0.05"),
        ],
    );
    for engine in SHARED {
        let run = attempt(engine, &steel);
        match run.ending {
            Ending::Diverged { quantity, .. } => {
                println!("{engine}: {quantity}");
                assert!(!run.time_series.is_empty());
            }
            other => panic!("{engine} did not diverge: {other:?}"),
        }
    }
}

#[test]
fn crossval_python_repeats_and_alternates() {
    let scene = scene("eleven-pins", &[("solver.duration_s", "0.002")]);
    let other = self::scene("paper", &[("solver.duration_s", "0.001")]);
    let first = ALL.map(|engine| run(engine, &scene));
    for (engine, before) in ALL.iter().zip(&first) {
        let _ = run(MUJOCO, &other);
        assert_same_bits(&run(engine, &scene), before, engine);
    }
    // Two at a time, on separate threads.
    std::thread::scope(|scope| {
        for (engine, before) in ALL.iter().zip(&first).take(2) {
            let scene = &scene;
            scope.spawn(move || assert_same_bits(&run(engine, scene), before, engine));
        }
    });
}

#[test]
fn crossval_python_progress_and_stop() {
    let scene = scene("paper", &[("solver.duration_s", "0.01")]);
    for engine in ALL {
        let (cancel, at_s) = (AtomicBool::new(false), Mutex::new(Vec::new()));
        let progress = |at: Progress<'_>| {
            let [time_s, _] = at.simulated_s.unwrap();
            at_s.lock().unwrap().push(time_s);
            if time_s > 4.5e-4 {
                cancel.store(true, Ordering::Relaxed);
            }
        };
        let control = Control::new(&cancel, &progress);
        let outcome = by_name(engine, &scene)
            .unwrap()
            .run(&scene.clone().check().unwrap(), &control);
        assert!(matches!(outcome, Err(Cancelled)), "{engine}");
        let at_s = at_s.into_inner().unwrap();
        let wanted: Vec<f64> = (0..=5).map(|k| f64::from(k) * 1e-4).collect();
        assert_eq!(at_s.len(), wanted.len(), "{engine}: {at_s:?}");
        assert!(at_s.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}

#[test]
fn crossval_python_refuses_what_it_cannot_honour() {
    let reason = |engine: &str, scene: &Scene| match by_name(engine, scene)
        .unwrap()
        .supports(&scene.clone().check().unwrap())
    {
        Err(Halt::Ended(Ending::Unsupported { reason })) => reason,
        other => panic!("{engine}: {other:?}"),
    };
    for engine in [MUJOCO_OWN, EXUDYN_OWN] {
        assert!(reason(engine, &scene("paper-friction", &[])).contains("friction_coefficient"));
        assert!(reason(engine, &scene("steel", &[])).contains("ramp"));
        let sealed = scene("paper", &[("bearings.input_seal_n_m", "0.1")]);
        assert!(reason(engine, &sealed).contains("bearings.input_seal_n_m"));
        // Under another law they get equally stiff balls.
        let law = scene("paper", &[("contact.law", "\"constant\"")]);
        let soft = [("contact.stiffness_multiplier", "0.01")];
        assert!(reason(engine, &scene("modified", &soft)).contains("rotational_rad"));
        assert!(reason(engine, &scene("toleranced", &soft)).contains("gear.errors"));
        by_name(engine, &law)
            .unwrap()
            .supports(&law.clone().check().unwrap())
            .unwrap();
    }
}

/// The package reads the program's output: every preset, every key.
#[test]
fn crossval_python_reads_every_preset() {
    for preset in pinwheel_scene::PRESETS {
        let mut scene = Scene::load(preset.name, &[]).unwrap().into_scene();
        scene.solver.duration_s = 1e-5;
        scene.solver.step_s = scene.solver.step_s.min(1e-5);
        scene.solver.sample_s = 1e-5;
        let run = attempt(MUJOCO, &scene);
        match run.ending {
            Ending::Finished => assert_eq!(run.time_series.len(), 2, "{}", preset.name),
            // Divergence is the point of some hard presets.
            Ending::Diverged { .. } => {}
            other => panic!("{}: {other}", preset.name),
        }
    }
}
