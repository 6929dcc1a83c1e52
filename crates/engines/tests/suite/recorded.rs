//! Recordings.

use pinwheel_engines::RunStats;
use pinwheel_engines::recorded::*;
use pinwheel_scene::Scene;
use pinwheel_timeseries::{RecordedUncertainty, TimeSeries};

fn recording() -> Recording {
    let mut time_series = TimeSeries::new(vec![0.0, 1e-3, 2e-3]).unwrap();
    let mut push = |name: &str, values: [f64; 3]| time_series.push(name, values.to_vec()).unwrap();
    push(
        "external_sleeve_force_n_0",
        [0.0, 123.456_789_012, -0.000_000_04],
    );
    push("external_sleeve_force_n_1", [1.5, 1e-12, 2.0]);
    Recording {
        engine: "mujoco-shared-law".to_owned(),
        version: "mujoco 1".to_owned(),
        date: "2026-01-31".to_owned(),
        command: "pinwheel record".to_owned(),
        machine: "x".to_owned(),
        digits: 7,
        stats: RunStats::default(),
        scene: Scene::load("paper", &[]).unwrap().into_scene(),
        uncertainty: vec![RecordedUncertainty {
            quantity: "external_sleeve_force_n".to_owned(),
            from_s: 0.0,
            to_s: 2e-3,
            l2: Some(1e-3),
            linf: Some(2e-3),
            mean: None,
            peak: None,
            rms: Some(5e-4),
        }],
        time_series,
    }
}

#[test]
fn numbers_keep_their_digits_and_no_more() {
    let csv = recording().csv();
    assert_eq!(
        csv,
        "time_s,external_sleeve_force_n_0,external_sleeve_force_n_1\n0,0,1.5\n0.001,123.4568,0\n0.002,0,2\n"
    );
}

#[test]
fn written_and_read() {
    let made = recording();
    let (description, csv) = made.write().unwrap();
    let read = Recording::read(&description, &csv).unwrap();
    assert_eq!(read.scene, made.scene);
    assert_eq!(read.stats, made.stats);
    assert_eq!(read.uncertainty, made.uncertainty);
    assert_eq!(read.time_series.len(), 3);
    assert!(Recording::read(&description.replace("engine", "motor"), &csv).is_err());
    assert!(Recording::read(&description, &csv.replace("1.5", "x")).is_err());
}

#[test]
fn stands_for_its_own_scene_only() {
    let recording = recording();
    let mut scene = Scene::load("paper", &[]).unwrap().into_scene();
    scene.name = "mine".to_owned();
    scene.solver.integrator = "rk4".to_owned();
    scene.solver.duration_s = 0.0015;
    assert!(recording.is_of(&scene));
    assert_eq!(recording.at_samples_of(&scene).time_s(), [0.0, 1e-3]);
    // Samples that a run would not have are left out.
    scene.solver.sample_s = 7e-4;
    assert_eq!(recording.at_samples_of(&scene).time_s(), [0.0]);
    scene.gear.backlash_m = 1e-5;
    assert!(!recording.is_of(&scene));
    scene.gear.backlash_m = 0.0;
    // Each kind of engine has its own setting.
    let by_tolerance = Recording {
        engine: "ida-shared-law".to_owned(),
        ..recording.clone()
    };
    assert!(by_tolerance.is_of(&scene));
    scene.solver.tolerance *= 0.1;
    assert!(recording.is_of(&scene) && !by_tolerance.is_of(&scene));
    scene.solver.duration_s = 1.0;
    assert!(!recording.is_of(&scene), "too long");
}

#[test]
fn embedded_recordings_are_sound() {
    for (scene, engine) in list() {
        let recording = find(scene, engine).unwrap().unwrap();
        assert_eq!(recording.engine, engine);
        assert_eq!(recording.scene.name, scene);
        assert!(recording.time_series.len() > 100, "{scene} {engine}");
        assert!(may_be_missing(engine));
    }
}
