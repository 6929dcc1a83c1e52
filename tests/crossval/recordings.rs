//! Recordings against live runs. `crossval_limits` checks them against limits.

use pinwheel_engines::recorded;

use super::accuracy::TRANSIENTS;
use super::*;

/// Checks that a live run repeats the first 4 ms of its recording, and returns the number of compared values: 0 without a
/// recording of the scene. Both come from the same pinned packages, so on one machine they differ only by the digits of the
/// recording; another processor's rounding grows in the transient. 1e-6 of a quantity's peak, and half a unit of the
/// recording's last digit, permit no more than that.
pub(super) fn repeated(engine: &str, scene: &Scene, live: &TimeSeries) -> usize {
    let mut all = recorded::list()
        .filter(|&(_, recorded)| recorded == engine)
        .filter_map(|(preset, _)| recorded::find(preset, engine)?.ok());
    let Some(recording) = all.find(|recording| recording.is_of(scene)) else {
        return 0;
    };
    assert_eq!(by_name(engine, scene).unwrap().version(), recording.version);
    let every = (recorded::SAMPLE_S / scene.solver.sample_s).round() as usize;
    let mut compared = 0;
    for quantity in QUANTITIES {
        let (ours, theirs) = (
            channels(live, quantity),
            channels(&recording.time_series, quantity),
        );
        let values = theirs.iter().flat_map(|channel| channel.iter());
        let peak = values.fold(0.0_f64, |most, value| most.max(value.abs()));
        let limit = peak * (1e-6 + 5.0 * 10.0_f64.powi(-(recording.digits as i32)));
        for (a, b) in ours.iter().zip(&theirs) {
            for (k, value) in a.iter().step_by(every).take(5).enumerate() {
                compared += 1;
                assert!(
                    (value - b[k]).abs() <= limit,
                    "{} {engine} {quantity} at {k} ms: live {value}, recorded {}, limit {limit:e}",
                    scene.name,
                    b[k]
                );
            }
        }
    }
    compared
}

/// Recordings of scenes, steps and engines that no other test runs live.
#[test]
fn crossval_python_live_runs_stay_on_their_recordings() {
    let elsewhere =
        |preset: &str, engine: &str| SHARED.contains(&engine) && TRANSIENTS.contains(&preset);
    let mut compared = 0;
    for (preset, engine) in recorded::list().filter(|(_, engine)| ALL.contains(engine)) {
        if elsewhere(preset, engine) {
            continue;
        }
        let scene = scene(preset, &[("solver.duration_s", "0.001")]);
        let number = repeated(engine, &scene, &run(engine, &scene));
        assert!(number > 0, "{preset} {engine}");
        compared += number;
    }
    println!("{compared} values compared");
    assert!(compared > 400, "{compared}");
}
