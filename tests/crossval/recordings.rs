//! Recordings against live runs. `crossval_limits` checks them against limits.

use pinwheel_engines::recorded;

use super::*;

/// A live run repeats its recording's first samples. Both come from the same pinned packages, so on one machine they differ
/// only by the digits of the recording; another processor's rounding grows in the transient. 1e-6 of a quantity's peak, and
/// half a unit of the recording's last digit, permit no more than that.
#[test]
fn crossval_python_live_runs_stay_on_their_recordings() {
    let mut compared = 0;
    for (preset, engine) in recorded::list().filter(|(_, engine)| ALL.contains(engine)) {
        let recording = recorded::find(preset, engine).unwrap().unwrap();
        let mut scene = recording.scene.clone();
        // Friction takes many iterations.
        scene.solver.duration_s = if preset == "paper-friction" {
            0.002
        } else {
            0.004
        };
        let live = run(engine, &scene);
        assert_eq!(
            by_name(engine, &scene).unwrap().version(),
            recording.version
        );
        for quantity in QUANTITIES {
            let (ours, theirs) = (
                channels(&live, quantity),
                channels(&recording.time_series, quantity),
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
    assert!(compared > 1_500);
}
