//! Common tests of every method of the registry.

use pinwheel_mbs::OdeSystem;
use pinwheel_mbs::integrators::{
    METHODS, MethodInfo, Segments, StepError, StepSettings, Stepper, start,
};

use super::bounds;
use bounds::holds;

/// Smooth non-linear, non-autonomous problem with the solution y = (sin t, exp(cos t)).
struct Smooth;

impl OdeSystem for Smooth {
    fn dimension(&self) -> usize {
        2
    }

    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) {
        dydt[0] = y[1].ln() + (y[0] - t.sin()) * 0.5;
        dydt[1] = -y[0] * y[1];
    }
}

fn exact(t: f64) -> [f64; 2] {
    [t.sin(), t.cos().exp()]
}

fn stepper(name: &str, step: f64, tolerance: f64) -> Box<dyn Stepper> {
    start(name, StepSettings { step, tolerance }, 0.0, &exact(0.0)).expect("registered")
}

/// Returns the error at t = 2 at step ends, and the largest error of the interpolant up to there.
fn errors(name: &str, step: f64) -> (f64, f64) {
    let mut system = Smooth;
    let mut run = stepper(name, step, 1e-8);
    let mut y = [0.0; 2];
    let mut inside: f64 = 0.0;
    while run.time() < 2.0 - 1e-9 {
        let before = run.time();
        run.step(&mut system).unwrap();
        for share in [0.25, 0.5, 0.9] {
            let t = before + share * (run.time() - before);
            run.interpolate(&mut system, t, &mut y);
            inside = inside
                .max((y[0] - exact(t)[0]).abs())
                .max((y[1] - exact(t)[1]).abs());
        }
    }
    let end = exact(run.time());
    (
        (run.state()[0] - end[0])
            .abs()
            .max((run.state()[1] - end[1]).abs()),
        inside,
    )
}

#[test]
fn fixed_steps_have_their_order() {
    for method in METHODS.iter().filter(|m| !m.adaptive) {
        let (coarse, fine) = (errors(method.name, 0.02), errors(method.name, 0.01));
        let order = (coarse.0 / fine.0).log2();
        let expected = f64::from(method.order);
        let near = expected - 0.25..expected + 0.25;
        holds(method.name, "order of the ends", order, near);
        // The interpolant is a cubic, order 4 at most, and never spoils a second-order method.
        let dense = (coarse.1 / fine.1).log2();
        let least = expected.min(4.0) - 0.25;
        holds(method.name, "order of the interpolant", dense, least..);
    }
}

#[test]
fn adaptive_methods_follow_their_tolerance() {
    for method in METHODS.iter().filter(|m| m.adaptive) {
        let mut last = f64::INFINITY;
        // A second-order method would need 1e6 steps, with their rounding, for 1e-11.
        let tolerances = if method.order < 4 {
            [1e-3, 1e-4, 1e-5, 1e-6]
        } else {
            [1e-5, 1e-7, 1e-9, 1e-11]
        };
        let mut steps = Vec::new();
        for tolerance in tolerances {
            let mut system = Smooth;
            let mut run = stepper(method.name, 0.1, tolerance);
            let (mut worst, mut y): (f64, _) = (0.0, [0.0; 2]);
            while run.time() < 2.0 {
                let before = run.time();
                run.step(&mut system).unwrap();
                // Not in the middle, where a fraction and its complement are equal.
                let inside = 0.7 * before + 0.3 * run.time();
                for t in [inside, run.time()] {
                    run.interpolate(&mut system, t, &mut y);
                    worst = worst
                        .max((y[0] - exact(t)[0]).abs())
                        .max((y[1] - exact(t)[1]).abs());
                }
            }
            let what = format!("error at a tolerance of {tolerance:e}");
            holds(method.name, &what, worst, ..30.0 * tolerance);
            holds(
                method.name,
                &format!("{what}, after a larger one"),
                worst,
                ..last,
            );
            last = worst;
            steps.push(run.counts().steps as f64);
        }
        let power = (steps[3] / steps[1]).ln() / (tolerances[1] / tolerances[3]).ln();
        let MethodInfo {
            name, step_power, ..
        } = method;
        println!(
            "{name}: steps grow with the power {power:.2} of the tolerance; INFO.step_power is {step_power:.2}"
        );
        holds(
            name,
            "power over that of INFO",
            power / step_power,
            0.4..1.6,
        );
    }
}

#[test]
fn a_restart_continues_exactly() {
    for method in METHODS.iter().filter(|m| !m.adaptive) {
        let mut system = Smooth;
        let mut full = stepper(method.name, 1.0 / 64.0, 1e-8);
        for _ in 0..10 {
            full.step(&mut system).unwrap();
        }
        let settings = StepSettings {
            step: 1.0 / 64.0,
            tolerance: 1e-8,
        };
        let mut rest = start(method.name, settings, full.time(), full.state()).expect("registered");
        for _ in 0..10 {
            full.step(&mut system).unwrap();
            rest.step(&mut system).unwrap();
        }
        assert_eq!(full.state(), rest.state(), "{}", method.name);
    }
}

#[test]
fn interpolation_does_not_disturb_the_run() {
    for method in METHODS {
        let mut system = Smooth;
        let (mut watched, mut alone) = (
            stepper(method.name, 0.05, 1e-6),
            stepper(method.name, 0.05, 1e-6),
        );
        let mut y = [0.0; 2];
        for _ in 0..20 {
            watched.step(&mut system).unwrap();
            alone.step(&mut system).unwrap();
            let t = watched.time() - 0.013;
            watched.interpolate(&mut system, t, &mut y);
            assert_eq!(watched.state(), alone.state(), "{}", method.name);
        }
    }
}

/// System with y' = NaN from t = 1 on.
struct Broken;

impl OdeSystem for Broken {
    fn dimension(&self) -> usize {
        1
    }

    fn derivative(&mut self, t: f64, _: &[f64], dydt: &mut [f64]) {
        dydt[0] = if t < 1.0 { 1.0 } else { f64::NAN };
    }
}

#[test]
fn a_state_that_is_not_finite_is_an_error() {
    for method in METHODS {
        let settings = StepSettings {
            step: 0.3,
            tolerance: 1e-6,
        };
        let mut run: Box<dyn Stepper> =
            start(method.name, settings, 0.0, &[0.0]).expect("registered");
        let outcome = (0..10_000).find_map(|_| run.step(&mut Broken).err());
        assert!(outcome.is_some(), "{}: ran on over NaN", method.name);
        holds(
            method.name,
            "last state",
            run.state()[0],
            f64::MIN..f64::MAX,
        );
    }
}

#[test]
fn unknown_methods_are_refused() {
    let settings = StepSettings {
        step: 0.3,
        tolerance: 1e-6,
    };
    assert!(start("euler", settings, 0.0, &[0.0, 1.0]).is_none());
}

/// Derivatives of Smooth, with a record of the calls and scales of another unit.
struct Noted {
    calls: u64,
    settled: Vec<f64>,
    unit: f64,
}

impl Noted {
    fn new(unit: f64) -> Self {
        Self {
            calls: 0,
            settled: Vec::new(),
            unit,
        }
    }
}

impl OdeSystem for Noted {
    fn dimension(&self) -> usize {
        2
    }

    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.calls += 1;
        Smooth.derivative(t, y, dydt);
    }

    fn scale(&self, _: &[f64], scale: &mut [f64]) {
        scale.fill(self.unit);
    }

    fn project(&mut self, t: f64, _: &mut [f64]) {
        self.settled.push(t);
    }
}

fn noted(name: &str, tolerance: f64) -> Box<dyn Stepper> {
    let settings = StepSettings {
        step: 0.05,
        tolerance,
    };
    start(name, settings, 0.0, &exact(0.0)).expect("registered")
}

#[test]
fn evaluations_are_counted() {
    for method in METHODS {
        let (mut system, mut run) = (Noted::new(1.0), noted(method.name, 1e-6));
        let mut y = [0.0; 2];
        for steps in 1..=20 {
            run.step(&mut system).unwrap();
            let inside = run.time() - 0.3 * run.next_step().min(0.01);
            // A sample of a method with implicit stages is a separate step, which does not count.
            if !method.name.starts_with("imex") {
                run.interpolate(&mut system, inside, &mut y);
            }
            let counts = run.counts();
            assert_eq!(counts.evaluations, system.calls, "{}", method.name);
            assert_eq!(counts.steps, steps, "{}", method.name);
        }
    }
}

/// Every returned state is projected onto the invariants of its own time.
#[test]
fn states_are_settled_at_their_time() {
    for method in METHODS {
        let (mut system, mut run) = (Noted::new(1.0), noted(method.name, 1e-6));
        let mut y = [0.0; 2];
        for _ in 0..20 {
            let before = run.time();
            run.step(&mut system).unwrap();
            let last = system.settled.last().copied();
            assert_eq!(last, Some(run.time()), "{}", method.name);
            let inside = 0.5 * (before + run.time());
            run.interpolate(&mut system, inside, &mut y);
            let last = system.settled.last().copied();
            assert_eq!(last, Some(inside), "{}", method.name);
        }
    }
}

/// States at a step's end, and before the first step, are not interpolated.
#[test]
fn ends_are_not_interpolated() {
    for method in METHODS {
        let mut run = stepper(method.name, 0.05, 1e-6);
        let mut y = [0.0; 2];
        for _ in 0..5 {
            run.interpolate(&mut Smooth, run.time(), &mut y);
            assert_eq!(y, run.state(), "{}", method.name);
            run.step(&mut Smooth).unwrap();
        }
    }
}

/// Errors are measured in tolerances times the scale: a scale 16 times larger acts as a tolerance 16 times larger; for a method
/// of order 2, whose errors are bounded by tolerance^(3/2), a scale 64 times larger.
#[test]
fn the_scale_is_the_unit_of_the_tolerance() {
    for method in METHODS.iter().filter(|m| m.adaptive) {
        let unit = if method.order < 4 { 64.0 } else { 16.0 };
        let (mut one, mut run) = (Noted::new(1.0), noted(method.name, 16e-7));
        let (mut other, mut same) = (Noted::new(unit), noted(method.name, 1e-7));
        for _ in 0..20 {
            run.step(&mut one).unwrap();
            same.step(&mut other).unwrap();
            let off = (run.time() - same.time()).abs();
            holds(method.name, "difference of the times, s", off, ..1e-12);
        }
    }
}

#[test]
fn steps_can_be_shortened() {
    for method in METHODS {
        let mut run = stepper(method.name, 0.05, 1e-4);
        for _ in 0..10 {
            let (before, wanted) = (run.time(), run.next_step());
            run.shorten(1e-3);
            let next = run.next_step();
            run.step(&mut Smooth).unwrap();
            let taken = run.time() - before;
            if method.adaptive {
                holds(method.name, "step, s", taken, 0.0..1e-3 + 1e-12);
            } else {
                assert_eq!(next, wanted, "{}", method.name);
            }
        }
    }
}

fn goes_on(what: &str, mut full: Box<dyn Stepper>, mut rest: Box<dyn Stepper>) {
    for _ in 0..12 {
        full.step(&mut Smooth).unwrap();
    }
    let (bytes, before) = (full.save(), rest.save());
    for wrong in [&[][..], &bytes[..bytes.len() / 2]] {
        assert!(!rest.restore(wrong), "{what}: {} bytes", wrong.len());
        assert!(rest.save() == before, "{what}: not what it was");
    }
    assert!(rest.restore(&bytes), "{what}: refused");
    for _ in 0..12 {
        full.step(&mut Smooth).unwrap();
        rest.step(&mut Smooth).unwrap();
        assert_eq!(full.time(), rest.time(), "{what}");
        assert_eq!(full.state(), rest.state(), "{what}");
    }
    assert_eq!(full.counts(), rest.counts(), "{what}");
}

#[test]
fn a_saved_run_goes_on_exactly() {
    let settings = StepSettings {
        step: 0.02,
        tolerance: 1e-6,
    };
    for method in METHODS {
        let run = || stepper(method.name, 0.02, 1e-6);
        goes_on(method.name, run(), run());
        let segments = || {
            let breaks = [0.013, 0.301, 1e9];
            Box::new(Segments::start(method.name, settings, 0.0, &exact(0.0), &breaks).unwrap())
        };
        goes_on(
            &format!("{} in segments", method.name),
            segments(),
            segments(),
        );
    }
}

/// Derivatives that are not finite at the start are reported at once, not after ever shorter steps.
#[test]
fn slopes_that_are_not_finite_at_the_start_are_named() {
    for method in METHODS.iter().filter(|m| m.adaptive) {
        let settings = StepSettings {
            step: 0.3,
            tolerance: 1e-6,
        };
        let mut run: Box<dyn Stepper> =
            start(method.name, settings, 2.0, &[0.5]).expect("registered");
        let outcome = run.step(&mut Broken);
        let expected = StepError::NotFinite { time: 2.0 };
        assert_eq!(outcome, Err(expected), "{}", method.name);
        assert_eq!(run.state(), [0.5], "{}", method.name);
    }
}
