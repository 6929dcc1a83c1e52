//! Speed against error on five milliseconds of the paper's gear.

use std::sync::atomic::{AtomicBool, Ordering};

use pinwheel_engines::{Ending, Engine, EngineInfo, Halt, Native, Prepared, SharedModel, by_name};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;
use pinwheel_studies::bench::{Measure, Options, Stopped, WorkPrecision, run};
use pinwheel_studies::{Control, Progress, StudyError};

fn scene(sets: &[&str]) -> Scene {
    preset("paper", sets)
}

fn preset(name: &str, sets: &[&str]) -> Scene {
    let mut all = vec!["solver.duration_s=0.005".parse().unwrap()];
    all.extend(sets.iter().map(|set| set.parse().unwrap()));
    Scene::load(name, &all).unwrap().into_scene()
}

fn options(methods: &[&str]) -> Options {
    Options {
        repeats: 1,
        methods: methods.iter().map(|&name| name.to_owned()).collect(),
        ..Options::default()
    }
}

/// Native solver as a peer: without counts of work, and failing at long steps.
struct Peer;

impl Engine for Peer {
    fn info(&self) -> EngineInfo<'_> {
        EngineInfo::own("peer", SharedModel::SharedLaw)
    }
    fn version(&self) -> String {
        "1".to_owned()
    }
    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        let step_s = gearbox.scene.solver.step_s;
        let native = Native::LAGRANGE.prepare(gearbox)?;
        Ok(Box::new(move |control: &Control<'_>| {
            let mut run = native(control)?;
            run.stats.rhs_calls = 0;
            if step_s > 2e-5 {
                run.ending = Ending::Diverged {
                    time_s: 0.001,
                    quantity: "everything".to_owned(),
                };
            }
            Ok(run)
        }))
    }
}

fn study(methods: &[&str]) -> WorkPrecision {
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(Native::REDUCED), Box::new(Peer)];
    run(&scene(&[]), &engines, &options(methods), &Control::quiet()).unwrap()
}

#[test]
fn errors_fall_at_the_order_and_the_reference_is_converged() {
    let study = study(&["rk2", "rk4", "dopri5", "dop853"]);
    assert!(study.complete);
    assert_eq!(study.windows[0].name, "whole");
    // Measured 3e-9 (dopri5 at 1e-11 against rk4 at 1.3e-6 s).
    let distance = study.reference_errors[0].force_l2;
    assert!(distance > 0.0 && distance < 1e-7, "{distance:e}");
    let error = |method: &str, setting: f64| {
        let series = study.series.iter().find(|s| s.method == method).unwrap();
        let point = series
            .points
            .iter()
            .find(|p| (p.setting / setting - 1.0).abs() < 1e-6);
        point.unwrap().errors[0].force_l2
    };
    let order = (error("rk2", 1e-5) / error("rk2", 5e-6)).log2();
    // Measured 1.99; the rest comes from contacts that open and close.
    assert!((order - 2.0).abs() < 0.2, "{order}");
    // RK4 has order 4 only between changes of contact.
    let order = (error("rk4", 2e-5) / error("rk4", 1e-5)).log2();
    assert!(order > 2.0, "{order}");
    for method in ["dopri5", "dop853"] {
        assert!(error(method, 1e-8) < 1e-2 * error(method, 1e-4), "{method}");
    }
    // Each point also has errors of torques and largest errors.
    let point = &study.series[0].points[2];
    assert!(point.errors[0].torque_l2 > 0.0 && point.errors[0].force_max > 0.0);
}

#[test]
fn engines_that_do_not_count_or_diverge_have_their_place() {
    let study = study(&["dopri5"]);
    let peer = study.series.last().unwrap();
    assert_eq!((peer.label().as_str(), peer.order), ("peer", None));
    assert!(matches!(peer.points[0].ending, Ending::Diverged { time_s, .. } if time_s == 0.001));
    assert!(peer.points[0].errors.is_empty());
    assert!(peer.points(0, Measure::Rhs).is_empty());
    assert!(peer.points(0, Measure::Cpu).len() >= 3);

    let ranking = study.ranking(0, 1e-3);
    let lead = ranking.advantage.unwrap();
    assert_eq!(
        (lead.native.as_str(), lead.peer.as_str()),
        ("native-reduced dopri5", "peer")
    );
    assert!(lead.ratio.is_finite() && ranking.entries[1].rhs_calls.is_none());
}

#[test]
fn csv_and_json_can_be_read_back() {
    let study = study(&["rk4"]);
    let mut bytes = Vec::new();
    study.table().write_csv(&mut bytes).unwrap();
    let mut reader = csv::Reader::from_reader(bytes.as_slice());
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let points: usize = study.series.iter().map(|s| s.points.len()).sum();
    assert_eq!(rows.len(), points);
    let first = &study.series[0].points[0];
    assert_eq!(&rows[0][column("method")], "rk4");
    let read: f64 = rows[0][column("whole_force_l2")].parse().unwrap();
    assert_eq!(read, first.errors[0].force_l2);
    let step: f64 = rows[0][column("step_s")].parse().unwrap();
    assert_eq!(step, first.setting);
    let peer = rows.iter().find(|row| &row[0] == "peer").unwrap();
    assert_eq!(
        (&peer[column("status")], &peer[column("rhs_calls")]),
        ("diverged", "")
    );
    let value = serde_json::to_value(&study).unwrap();
    assert_eq!(
        value["series"][0]["points"][0]["outcome"]["state"],
        "finished"
    );
    assert_eq!(value["windows"][0]["name"], "whole");
}

/// A study stopped during its second series keeps the first, and is marked incomplete.
#[test]
fn what_was_measured_survives_a_stop() {
    let stop = AtomicBool::new(false);
    let progress = |progress: Progress<'_>| {
        if progress.piece.starts_with("native-lagrange") {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let control = Control::new(&stop, &progress);
    let scene = scene(&[]);
    let engines: Vec<Box<dyn Engine>> = ["native-reduced", "native-lagrange"]
        .iter()
        .map(|name| by_name(name, &scene).unwrap())
        .collect();
    let study = run(&scene, &engines, &options(&["rk4"]), &control).unwrap();
    assert!(!study.complete);
    assert_ne!(study.series[0].stopped, Stopped::Interrupted);
    assert!(!study.series[0].points.is_empty());
    assert_eq!(study.series[1].stopped, Stopped::Interrupted);

    stop.store(true, Ordering::Relaxed);
    assert!(matches!(
        run(&scene, &engines, &options(&["rk4"]), &control),
        Err(StudyError::Cancelled)
    ));
}

/// Cost of an RV gear, in right-hand sides, at a force error of 1e-4 over 5 ms: 683, 1551 and 3368.
#[test]
fn regress_an_rv_gear_on_the_bench() {
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(Native::REDUCED)];
    let methods = ["etd-adams", "dopri5", "rk4"];
    let scene = preset("rv-40e-like", &[]);
    let study = run(&scene, &engines, &options(&methods), &Control::quiet()).unwrap();
    let entries = study.ranking(0, 1e-4).entries;
    let costs = methods.map(|method| {
        let entry = entries.iter().find(|entry| entry.label.ends_with(method));
        let cost = entry.unwrap().rhs_calls.unwrap();
        assert!(cost.reached(), "{method}: {cost:?}");
        cost.value()
    });
    println!("{costs:?}");
    assert!(
        costs[0] < 0.7 * costs[1] && costs[1] < 0.7 * costs[2],
        "{costs:?}"
    );
}

#[test]
fn friction_has_a_reference_of_its_own() {
    let scene = scene(&[
        "contact.friction_coefficient=0.1",
        "solver.duration_s=0.002",
    ]);
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(Native::REDUCED)];
    let study = run(&scene, &engines, &options(&["imex2"]), &Control::quiet()).unwrap();
    assert_eq!(study.reference.second.method, "imex2-adaptive");
    // Measured 6e-6; see the module for the two methods.
    assert!(study.reference_errors[0].force_l2 < 1e-4);
    assert!(study.series[0].points.last().unwrap().errors[0].force_l2 < 1e-3);
}
