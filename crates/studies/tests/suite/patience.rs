//! Effort that a comparison spends on a foreign engine: coarsest run first, each setting once, limited time.

use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use cpu_time::ThreadTime;
use pinwheel_compare::{Comparison, SharedModel, Status};
use pinwheel_engines::{
    Cancelled, Control, Engine, EngineInfo, Halt, Prepared, Refinement, Run, by_name,
};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Override, Scene};
use pinwheel_studies::comparison::{self, Effort, Input};

/// Engine by our own solver that reports a fixed cost for each step.
struct Slow {
    track: SharedModel,
    second_per_step: f64,
    /// True if every sample takes that time in reality.
    works: bool,
    /// Requested steps, s.
    steps_s: Mutex<Vec<f64>>,
    /// Samples reported.
    samples: Mutex<usize>,
}

impl Slow {
    fn new(track: SharedModel, second_per_step: f64) -> Self {
        Self {
            track,
            second_per_step,
            works: false,
            steps_s: Mutex::default(),
            samples: Mutex::default(),
        }
    }
}

/// Borrowed engine, for comparisons, which own their engines.
struct Borrowed(&'static Slow);

impl Engine for Borrowed {
    fn info(&self) -> EngineInfo<'_> {
        let refined = self.0.track == SharedModel::SharedLaw;
        EngineInfo {
            refinement: refined.then_some(Refinement::step(4.0)),
            ..EngineInfo::own("slow", self.0.track)
        }
    }

    fn version(&self) -> String {
        "0".to_owned()
    }

    fn prepare<'a>(&'a self, gearbox: &Gearbox) -> Result<Prepared<'a>, Halt> {
        let gearbox = gearbox
            .with_solver(|solver| solver.integrator = "rk4".to_owned())
            .unwrap();
        Ok(Box::new(move |control: &Control<'_>| {
            let slow = self.0;
            let solver = &gearbox.scene.solver;
            slow.steps_s.lock().unwrap().push(solver.step_s);
            if slow.works {
                for time_s in solver.sample_times_s() {
                    *slow.samples.lock().unwrap() += 1;
                    let begin = ThreadTime::now();
                    while begin.elapsed().as_secs_f64() < slow.second_per_step {}
                    if control.reached(time_s) {
                        return Err(Cancelled.into());
                    }
                }
            }
            let native = by_name("native-reduced", &gearbox.scene).unwrap();
            let mut run = native.prepare(&gearbox)?(control)?;
            run.stats.cpu_s = slow.second_per_step * solver.duration_s / solver.step_s;
            run.stats.wall_s = run.stats.cpu_s;
            Ok::<Run, Halt>(run)
        }))
    }
}

fn gear() -> Gearbox {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/gears/single.toml");
    let short = Override::new("solver.duration_s", "0.004");
    Gearbox::new(&Scene::load(path.to_str().unwrap(), &[short]).unwrap()).unwrap()
}

fn compare(gearbox: &Gearbox, slow: &'static Slow, longest: Duration) -> Comparison {
    let engines: Vec<Box<dyn Engine>> = vec![Box::new(Borrowed(slow))];
    let input = Input {
        gearbox,
        engines: &engines,
        data: &[],
    };
    let effort = Effort {
        longest,
        ..Effort::of(&gearbox.scene)
    };
    comparison::run_with(&input, effort, &Control::quiet())
        .unwrap()
        .comparison
}

/// Three runs cost 1, 1/2 and 1/4, that is 1.75 times the finest, and none is repeated.
#[test]
fn a_study_that_fits_takes_each_run_once() {
    let gearbox = gear();
    let step_s = gearbox.scene.solver.step_s;
    let slow: &Slow = Box::leak(Box::new(Slow::new(SharedModel::SharedLaw, 1e-3)));
    let report = compare(&gearbox, slow, Duration::from_secs(30));
    let steps = slow.steps_s.lock().unwrap().clone();
    let cost: f64 = steps.iter().map(|step| step_s / step).sum();
    assert_eq!(steps.len(), 3, "{steps:?}");
    // Samples are multiples of steps, so the coarser steps are slightly below 2 and 4.
    assert!((1.75..1.9).contains(&cost), "{steps:?}");
    assert!(steps[0] > 3.0 * step_s && steps[1] == step_s, "{steps:?}");
    assert!(report.engines[0].refinement.as_ref().unwrap().cost.unwrap() < 1.9);
}

/// The coarsest run becomes the finest if finer ones would exceed the time limit.
#[test]
fn a_study_that_does_not_fit_begins_coarser() {
    let gearbox = gear();
    let solver = &gearbox.scene.solver;
    // The run at the scene's step would take 100 s.
    let second_per_step = 100.0 * solver.step_s / solver.duration_s;
    let slow: &Slow = Box::leak(Box::new(Slow::new(SharedModel::SharedLaw, second_per_step)));
    let report = compare(&gearbox, slow, Duration::from_secs(60));
    let steps = slow.steps_s.lock().unwrap().clone();
    assert!(
        steps.iter().all(|step| *step > 3.0 * solver.step_s),
        "{steps:?}"
    );
    assert_eq!(report.engines[0].status, Status::Finished);
    assert!(report.engines[0].refinement.is_some());
    let asked: f64 = steps.iter().map(|step| 100.0 * solver.step_s / step).sum();
    assert!(asked < 60.0, "{asked} s: {steps:?}");
}

/// A run whose pace predicts hours is stopped, and the reason names the remedy.
#[test]
fn hard_a_run_without_end_is_given_up() {
    let gearbox = gear();
    let slow = Slow {
        works: true,
        ..Slow::new(SharedModel::OwnContact, 0.025)
    };
    let slow: &Slow = Box::leak(Box::new(slow));
    let report = compare(&gearbox, slow, Duration::from_millis(100));
    let all = gearbox.scene.solver.sample_times_s().len();
    let reported = *slow.samples.lock().unwrap();
    assert!(reported < all / 2, "{reported} of {all}");
    let Status::TimedOut { reason, .. } = &report.engines[0].status else {
        panic!("{:?}", report.engines[0].status);
    };
    assert!(reason.contains("--longest"), "{reason}");
    assert_eq!(report.counts.exit_status(), 0);
}

/// Explicit steps that jump back and forth over the friction ramp do not resolve it, even if two such runs agree. Tested with a
/// Runge-Kutta method on either side of the step limit, and with a method that treats the ramp implicitly.
#[test]
fn hard_steps_that_chatter_resolve_nothing() {
    let refused = |method: &str, step_s: &str| {
        let sets = [
            ("contact.friction_coefficient", "0.1"),
            ("solver.integrator", method),
            ("solver.step_s", step_s),
            ("solver.sample_s", "1e-4"),
            ("solver.duration_s", "0.002"),
        ];
        let sets = sets.map(|(key, value)| Override::new(key, value));
        let gearbox = Gearbox::new(&Scene::load("paper", &sets).unwrap()).unwrap();
        let engines = [by_name("native-reduced", &gearbox.scene).unwrap()];
        let input = Input {
            gearbox: &gearbox,
            engines: &engines,
            data: &[],
        };
        let effort = Effort {
            obey: true,
            ..Effort::of(&gearbox.scene)
        };
        let outcome = comparison::run_with(&input, effort, &Control::quiet()).unwrap();
        let text = serde_json::to_string(&outcome.comparison.engines[0].uncertainty).unwrap();
        text.contains("do not follow the friction")
    };
    // The relaxation rate of the ramp is 9.5e5 1/s under the static force; the largest force may be twice as large.
    assert!(refused("rk4", "1.25e-6"));
    assert!(!refused("rk4", "1e-6"));
    assert!(!refused("imex2", "1e-5"));
}
