//! The recordings: within the limits, and where live runs are.

use pinwheel_compare::{Context, Cost, Participant, Status, Verdict, limits};
use pinwheel_engines::{Engine, recorded};

use super::*;

/// Every recording whose step resolves its scene holds the limits of the one table against native-resolved.
#[test]
fn crossval_python_recordings_hold_the_limits() {
    for preset in recorded::RECORDED_SCENES {
        // At its own step of 1e-5 s steel is resolved by none: see the transient at a tenth of it.
        if preset == "steel" {
            continue;
        }
        let scene = scene(preset, &[]);
        let resolved = by_name("native-resolved", &scene).unwrap();
        let mut participants = vec![participant(resolved.as_ref(), &scene)];
        for (_, engine) in recorded::list().filter(|&(name, _)| name == preset) {
            let recording = recorded::instead(engine, &scene, "of this test").unwrap();
            participants.push(participant(recording.as_ref(), &scene));
        }
        let context = Context {
            scene: preset.to_owned(),
            guarded: Some(preset.to_owned()),
            duration_s: scene.solver.duration_s,
            load_n_m: Some(scene.drive.output_torque_n_m),
            input_speed_rad_s: Some(scene.drive.input_speed_rad_s),
            friction_coefficient: scene.contact.friction_coefficient,
            ..Context::default()
        };
        let comparison = pinwheel_compare::compare(&context, &participants, limits::TABLE).unwrap();
        for pair in &comparison.pairs {
            for entry in &pair.entries {
                for check in &entry.checks {
                    println!(
                        "{preset} {} {} {:?} {}: {:?} (limit {:e})",
                        pair.a, pair.b, entry.window, entry.quantity, check.value, check.limit
                    );
                }
                assert_ne!(
                    entry.verdict,
                    Verdict::Exceeded,
                    "{preset} {} {}",
                    pair.a,
                    pair.b
                );
            }
        }
        for engine in &comparison.engines[1..] {
            let judged = comparison
                .pairs
                .iter()
                .filter(|pair| pair.a == engine.name || pair.b == engine.name)
                .flat_map(|pair| &pair.entries)
                .filter(|entry| entry.verdict == Verdict::Within)
                .count();
            assert!(judged >= 4, "{preset} {}: {judged} judged", engine.name);
        }
        assert_eq!(comparison.counts.exceeded, 0, "{preset}");
    }
}

fn participant(engine: &dyn Engine, scene: &Scene) -> Participant {
    let run = engine
        .run(&scene.clone().check().unwrap(), &Control::quiet())
        .unwrap();
    Participant {
        name: engine.name().to_owned(),
        track: engine.track(),
        version: engine.version(),
        summary: engine.info().summary.to_owned(),
        differences: engine.info().differences.to_owned(),
        courses: run.courses,
        cost: Cost {
            step_s: run.stats.step_s,
            recorded: run.stats.recorded,
            ..Cost::default()
        },
        status: Status::Finished,
    }
}

/// A live run repeats its recording's first samples. Both come from the same pinned packages, so only the digits of
/// the recording part them on one machine; another processor's rounding grows in the transient. 1e-6 of a
/// quantity's peak, and half a unit of the recording's last digit, leave room for that and for nothing else.
#[test]
fn crossval_python_live_runs_stay_on_their_recordings() {
    let mut compared = 0;
    for (preset, engine) in recorded::list().filter(|(_, engine)| ALL.contains(engine)) {
        let recording = recorded::find(preset, engine).unwrap().unwrap();
        let mut scene = recording.scene.clone();
        // Friction iterates long.
        scene.solver.duration_s = if preset == "paper-friction" {
            0.003
        } else {
            0.012
        };
        let live = run(engine, &scene);
        assert_eq!(
            by_name(engine, &scene).unwrap().version(),
            recording.version
        );
        for quantity in QUANTITIES {
            let (ours, theirs) = (
                channels(&live, quantity),
                channels(&recording.courses, quantity),
            );
            let peak = theirs
                .iter()
                .flat_map(|c| c.iter())
                .fold(0.0_f64, |m, v| m.max(v.abs()));
            let limit = peak * (1e-6 + 5.0 * 10.0_f64.powi(-(recording.digits as i32)));
            let every = (recorded::SAMPLE_S / scene.solver.sample_s).round() as usize;
            for (a, b) in ours.iter().zip(&theirs) {
                for (k, value) in a.iter().step_by(every).enumerate() {
                    compared += 1;
                    assert!(
                        (value - b[k]).abs() <= limit,
                        "{preset} {engine} {quantity} at {k} ms: live {value}, recorded {}, limit {limit:e}",
                        b[k]
                    );
                }
            }
        }
    }
    println!("{compared} values compared");
    assert!(compared > 5_000);
}
