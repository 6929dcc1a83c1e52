//! Comparison of every pair of engines on the presets, live and recorded, with the table of limits.

#![allow(clippy::print_stdout)] // measured figures, for whoever resets a limit

mod table;

use pinwheel_compare::limits::{Friction, fits};
use pinwheel_compare::metrics::PairMetrics;
use pinwheel_compare::quantities::derive;
use pinwheel_compare::windows::{SETTLING_S, windows};
use pinwheel_compare::{Metric, SharedModel};
use pinwheel_engines::{Control, Engine, by_name, recorded};
use pinwheel_scene::{CheckedScene, Scene};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::{View, rows_at};
use table::{Limit, TABLE};

/// Run of a preset by one engine.
struct Ran {
    name: String,
    track: SharedModel,
    step_s: f64,
    time_series: TimeSeries,
}

fn ran(engine: &dyn Engine, scene: &CheckedScene) -> Ran {
    let run = engine.run(scene, &Control::quiet()).unwrap();
    Ran {
        name: engine.name().to_owned(),
        track: engine.track(),
        step_s: run.stats.step_s,
        time_series: run.time_series,
    }
}

/// Returns the shared model of two engines for the table; `None` if they must not be compared.
fn track_of(a: &Ran, b: &Ran) -> Option<SharedModel> {
    match (a.track, b.track) {
        (a, b) if a == b => Some(a),
        (SharedModel::Native, other) | (other, SharedModel::Native) => Some(other),
        _ => None,
    }
}

fn suits(friction: Friction, scene: &CheckedScene) -> bool {
    match friction {
        Friction::Any => true,
        Friction::With => scene.contact.friction_coefficient > 0.0,
        Friction::Without => scene.contact.friction_coefficient == 0.0,
    }
}

fn step_suits(run: &Ran, largest_s: Option<f64>) -> bool {
    // The mean step of an adaptive run is a quotient, so rounding is permitted.
    largest_s.is_none_or(|most| run.step_s > 0.0 && run.step_s <= most * (1.0 + 1e-9))
}

/// Returns the limit of a pair among rows of one track, window, quantity and metric: of the first row for both; or, for two
/// foreign engines, the sum of both limits to a native run.
fn limit(rows: &[&Limit], scene: &CheckedScene, a: &Ran, b: &Ran) -> Option<f64> {
    let about = |row: &&&Limit, engine: &Ran, other: &Ran| {
        fits(row.engine, &engine.name)
            && fits(row.against, &other.name)
            && step_suits(engine, row.step_at_most_s)
            && step_suits(other, row.against_step_at_most_s)
    };
    let rows = rows.iter().filter(|row| suits(row.friction, scene));
    let own = rows
        .clone()
        .find(|row| about(row, a, b) || about(row, b, a));
    let foreign = [a, b].iter().all(|run| run.track != SharedModel::Native);
    let to_native = |engine: &Ran| {
        let about = |row: &&&Limit| {
            fits(row.against, SharedModel::Native.as_str())
                && fits(row.engine, &engine.name)
                && row.against_step_at_most_s.is_none()
                && step_suits(engine, row.step_at_most_s)
        };
        Some(rows.clone().find(about)?.limit)
    };
    own.map(|row| row.limit)
        .or_else(|| foreign.then(|| Some(to_native(a)? + to_native(b)?))?)
}

/// Checks every pair of runs against the table, in windows of the table's own; returns the number of judged figures of each
/// engine.
fn hold(preset: &str, scene: &CheckedScene, runs: &[Ran]) -> Vec<usize> {
    let mut judged = vec![0; runs.len()];
    let (parts, _) = windows(&runs[0].time_series, SETTLING_S, &[]);
    for (n, b) in runs.iter().enumerate() {
        for (m, a) in runs[..n].iter().enumerate() {
            let Some(track) = track_of(a, b) else {
                continue;
            };
            // A recording has fewer samples, at which both are compared.
            let fewer = a.time_series.len().min(b.time_series.len());
            let times = if a.time_series.len() == fewer { a } else { b };
            let at = |run: &Ran| {
                let rows = rows_at(times.time_series.time_s(), run.time_series.time_s());
                run.time_series
                    .select(&rows.collect::<Option<Vec<_>>>().unwrap())
            };
            let (of_a, of_b) = (at(a), at(b));
            for (window, quantity) in parts
                .iter()
                .flat_map(|w| derive([&of_a, &of_b]).into_iter().map(move |q| (w, q)))
            {
                let samples = of_a.window(window.from_s, window.to_s);
                let view = |time_series| View::of(time_series, &quantity.channels, samples.clone());
                let Some((x, y)) = view(&of_a).zip(view(&of_b)) else {
                    continue;
                };
                let metrics = PairMetrics::of(&x, &y, &of_a.time_s()[samples.clone()]).unwrap();
                for metric in Metric::of_pairs() {
                    let rows: Vec<&Limit> = TABLE
                        .iter()
                        .filter(|row| {
                            row.metric == metric
                                && row.window == window.kind
                                && fits(row.quantity, &quantity.name)
                                && fits(row.track, track.as_str())
                        })
                        .collect();
                    let Some(limit) = limit(&rows, scene, a, b) else {
                        continue;
                    };
                    let value = (metric.row().of)(&metrics).unwrap();
                    let what = format!(
                        "{preset} {} {} {} {}: {value:.2e} (limit {limit:.1e})",
                        a.name,
                        b.name,
                        window.kind.word(),
                        quantity.name
                    );
                    println!("{what}");
                    assert!(value <= limit, "{what}");
                    judged[n] += 1;
                    judged[m] += 1;
                }
            }
        }
    }
    judged
}

fn holds(preset: &str, engines: &[&str], set: &[&str]) -> Vec<Ran> {
    let set: Vec<_> = set.iter().map(|&text| text.parse().unwrap()).collect();
    let scene = Scene::load(preset, &set).unwrap();
    let mut runs: Vec<Ran> = ["native-resolved"]
        .iter()
        .chain(engines)
        .map(|name| ran(by_name(name, &scene).unwrap().as_ref(), &scene))
        .collect();
    let recorded_scene = Scene::load(preset, &[]).unwrap();
    for (_, engine) in recorded::list().filter(|&(name, _)| name == preset) {
        let recording = recorded::instead(engine, &recorded_scene, "of this test").unwrap();
        let mut run = ran(recording.as_ref(), &recorded_scene);
        let samples = run.time_series.window(0.0, scene.solver.duration_s);
        run.time_series = run.time_series.select(&samples.collect::<Vec<_>>());
        runs.push(run);
    }
    let judged = hold(preset, &scene, &runs);
    for (run, judged) in runs.iter().zip(judged).skip(1) {
        assert!(judged >= 3, "{preset} {}: {judged} judged", run.name);
    }
    runs
}

const OURS: [&str; 5] = [
    "native-reduced",
    "native-lagrange",
    "rapier-shared-law",
    "rapier-own-contact-hook",
    "rapier-own-contact-colliders",
];

/// The paper's law creates 1 % of the power; the spring of rapier's colliders has a potential, so the driver gives what the
/// load takes, 22/15 N m: measured 0.06 %.
#[test]
fn crossval_limits_hold_on_paper() {
    let runs = holds("paper", &OURS, &["solver.duration_s=0.5"]);
    for (engine, wanted_n_m, limit) in [(OURS[2], 1.4529, 1e-3), (OURS[4], 22.0 / 15.0, 3e-3)] {
        let run = runs.iter().find(|run| run.name == engine).unwrap();
        let window = run.time_series.window(0.3, f64::INFINITY);
        let torque = &run.time_series.channel("input_torque_n_m").unwrap()[window];
        let mean = torque.iter().sum::<f64>() / torque.len() as f64;
        assert!((mean / wanted_n_m - 1.0).abs() < limit, "{engine}: {mean}");
    }
}

/// At half the step, at which the start-up oscillation is resolved as well as without backlash at the paper's step.
#[test]
fn crossval_limits_hold_with_backlash() {
    holds("backlash-0.6", &OURS[..3], &["solver.step_s=5e-6"]);
}

/// rapier's shared law has explicit friction, and native engines have no limit with friction at this step.
#[test]
#[ignore = "weekly: 8 s; `crossval_rapier` judges both engines"]
fn crossval_limits_hold_with_friction() {
    holds("paper-friction", &OURS[3..], &[]);
}

/// No engine resolves `steel` at its step of 1e-5 s: its limits are those of its recorded engines' own tests.
#[test]
fn crossval_limits_hold_with_other_pins() {
    holds("eleven-pins", &OURS[..2], &[]);
    holds("forty-pins", &OURS[..2], &[]);
}

#[test]
fn rows_have_a_margin() {
    for row in TABLE {
        assert!(row.limit > 0.0 && row.limit.is_finite(), "{row:?}");
        let measured = row.measured.unwrap();
        assert!(measured > 0.0 && measured <= row.limit, "{row:?}");
        assert!(row.reason.ends_with('.'), "{row:?}");
    }
}
