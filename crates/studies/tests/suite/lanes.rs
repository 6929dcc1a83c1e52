//! Concurrent engines: results equal sequential ones, only one engine at a time runs in Python, and a stop ends all.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use pinwheel_engines::{Control, Engine, EngineInfo, Halt, Prepared, SharedModel, by_name};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Override, Scene};
use pinwheel_studies::comparison::{self, Effort, Input, Lanes};
use pinwheel_studies::{Progress, StudyError};

/// Native solver under another name, with a requested duration.
struct Peer {
    name: &'static str,
    in_python: bool,
    pause: Duration,
    /// Current and largest number of runs, of engines in Python and of all.
    running: Arc<[AtomicUsize; 4]>,
}

impl Engine for Peer {
    fn info(&self) -> EngineInfo<'_> {
        EngineInfo {
            in_python: self.in_python,
            ..EngineInfo::own(self.name, SharedModel::SharedLaw)
        }
    }

    fn version(&self) -> String {
        "1".to_owned()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        let gearbox = gearbox.clone();
        Ok(Box::new(move |control: &Control<'_>| {
            let counted = |from: usize, change: &dyn Fn(&AtomicUsize) -> usize| {
                let now = change(&self.running[from]);
                self.running[from + 1].fetch_max(now, Ordering::Relaxed);
            };
            let places = [(0, self.in_python), (2, true)].into_iter();
            let places: Vec<usize> = places
                .filter(|place| place.1)
                .map(|place| place.0)
                .collect();
            let up = |n: &AtomicUsize| n.fetch_add(1, Ordering::Relaxed) + 1;
            let down = |n: &AtomicUsize| n.fetch_sub(1, Ordering::Relaxed) - 1;
            places.iter().for_each(|place| counted(*place, &up));
            let begun = Instant::now();
            let duration_s = gearbox.scene.solver.duration_s;
            let share = || begun.elapsed().as_secs_f64() / self.pause.as_secs_f64();
            while share() < 1.0 && !control.reached(share() * duration_s) {
                std::thread::sleep(Duration::from_millis(1));
            }
            let native = by_name("native-reduced", &gearbox.scene).unwrap();
            let silent = Control::silent(control.cancel);
            let run = native
                .prepare(&gearbox)
                .and_then(|prepared| prepared(&silent));
            places.iter().for_each(|place| counted(*place, &down));
            run
        }))
    }
}

fn gearbox() -> Gearbox {
    let sets = [("solver.duration_s", "0.004"), ("solver.integrator", "rk4")];
    let sets = sets.map(|(key, value)| Override::new(key, value));
    Gearbox::new(&Scene::load("paper", &sets).unwrap()).unwrap()
}

fn peers(pause_ms: u64) -> (Vec<Box<dyn Engine>>, Arc<[AtomicUsize; 4]>) {
    let running: Arc<[AtomicUsize; 4]> = Arc::default();
    let peer = |(name, in_python)| -> Box<dyn Engine> {
        let (pause, running) = (Duration::from_millis(pause_ms), Arc::clone(&running));
        Box::new(Peer {
            name,
            in_python,
            pause,
            running,
        })
    };
    let names = [
        ("a", true),
        ("b", false),
        ("c", true),
        ("d", false),
        ("e", true),
    ];
    (names.map(peer).into(), running)
}

fn compared(
    engines: &[Box<dyn Engine>],
    jobs: usize,
    control: &Control<'_>,
) -> Result<String, StudyError> {
    let gearbox = gearbox();
    let input = Input {
        gearbox: &gearbox,
        engines,
        data: &[],
    };
    let lanes = Lanes {
        jobs,
        ..Lanes::default()
    };
    let mut outcome = comparison::run_on(&input, Effort::of(&gearbox.scene), &lanes, control)?;
    for engine in &mut outcome.comparison.engines {
        (engine.cost.wall_s, engine.cost.cpu_s) = (0.0, 0.0);
        // The cost of a refinement is a ratio of times.
        engine.refinement = None;
    }
    let series = outcome.participants.iter().map(|one| &one.time_series);
    let series: Vec<_> = series.map(|one| (one.time_s(), one.channels())).collect();
    Ok(format!(
        "{} {series:?}",
        serde_json::to_string(&outcome.comparison).unwrap()
    ))
}

#[test]
fn crossval_jobs_change_no_bit() {
    let scene = gearbox().scene;
    let mut engines = vec![by_name("native-reduced", &scene).unwrap()];
    engines.extend(peers(3).0);
    let quiet = Control::quiet();
    let one = compared(&engines, 1, &quiet).unwrap();
    for jobs in [2, 7] {
        assert!(
            compared(&engines, jobs, &quiet).unwrap() == one,
            "{jobs} jobs"
        );
    }
}

#[test]
fn one_interpreter_runs_one_engine() {
    for (jobs, expected) in [(1, [1, 1]), (5, [1, 3])] {
        let (engines, running) = peers(40);
        compared(&engines, jobs, &Control::quiet()).unwrap();
        let most = [1, 3].map(|k| running[k].load(Ordering::Relaxed));
        assert_eq!(most, expected, "{jobs} jobs");
    }
}

#[test]
fn a_stop_ends_all() {
    let (engines, running) = peers(20_000);
    let (stop, begun) = (AtomicBool::new(false), Instant::now());
    let pieces = Mutex::new(Vec::new());
    let progress = |at: Progress<'_>| pieces.lock().unwrap().push(at.piece.to_owned());
    let control = Control::new(&stop, &progress);
    let stopped = std::thread::scope(|scope| {
        scope.spawn(|| {
            while running[2].load(Ordering::Relaxed) < 3 && begun.elapsed().as_secs() < 4 {
                std::thread::sleep(Duration::from_millis(2));
            }
            stop.store(true, Ordering::Relaxed);
        });
        compared(&engines, 3, &control)
    });
    assert!(matches!(stopped, Err(StudyError::Cancelled)), "{stopped:?}");
    assert!(begun.elapsed() < Duration::from_secs(4));
    // Progress names all running engines, in their order.
    let pieces = pieces.lock().unwrap();
    assert!(pieces.iter().any(|piece| piece == "a, b, d"), "{pieces:?}");
}

/// Progress of every engine arrives with the remaining time, whose accuracy the test `outlook` measures.
#[test]
fn time_left_is_reported_while_engines_run() {
    let (mut engines, _) = peers(1000);
    engines.truncate(2);
    let reports = Mutex::new(Vec::new());
    let progress = |at: Progress<'_>| {
        let now = (at.piece.to_owned(), at.left_s);
        reports.lock().unwrap().push(now);
    };
    let stop = AtomicBool::new(false);
    compared(&engines, 2, &Control::new(&stop, &progress)).unwrap();
    let reports = reports.into_inner().unwrap();
    // The remaining time is unknown at the start.
    assert_eq!(reports[1].1, None);
    let left = |report: &(String, Option<f64>)| report.1.is_some_and(|left| left > 0.0);
    assert!(reports.iter().any(left), "{reports:?}");
}
