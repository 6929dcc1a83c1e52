//! Right-hand side that jumps: every method keeps its order in segments, and none over the jump.

use pinwheel_mbs::OdeSystem;
use pinwheel_mbs::integrators::{METHODS, MethodInfo, Segments, StepSettings, Stepper, start};

use super::bounds;
use bounds::holds;

/// Times at which the push changes: never at a step of 0.02 or half of it, and the ends of the second push's ramp.
const BREAKS: [f64; 3] = [0.507_3, 1.204_1, 1.404_1];
const END: f64 = 2.0;

/// System y'' = p(t) - y with p = 0, then 1, then a ramp to -1.
struct Pushed {
    /// Start of the segment; `None`: p depends on the time alone.
    segment: Option<f64>,
}

fn push(segment: f64, t: f64) -> f64 {
    match segment {
        l if l < BREAKS[0] => 0.0,
        l if l < BREAKS[1] => 1.0,
        l if l < BREAKS[2] => 1.0 - 2.0 * (t - BREAKS[1]) / (BREAKS[2] - BREAKS[1]),
        _ => -1.0,
    }
}

impl OdeSystem for Pushed {
    fn dimension(&self) -> usize {
        2
    }

    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) {
        dydt[0] = y[1];
        dydt[1] = push(self.segment.unwrap_or(t), t) - y[0];
    }

    fn restart_at(&mut self, from: f64) {
        self.segment = Some(from);
    }
}

const START: [f64; 2] = [0.5, 0.0];

/// Returns the exact solution at `t`: on each segment p, linear in time, is the particular solution.
fn exact(t: f64) -> [f64; 2] {
    let (mut y, mut from) = (START, 0.0);
    for to in BREAKS.into_iter().chain([f64::INFINITY]) {
        let end = t.min(to);
        let slope = (push(from, from + 0.1) - push(from, from)) / 0.1;
        let (a, b) = (y[0] - push(from, from), y[1] - slope);
        let (s, c) = (end - from).sin_cos();
        y = [push(from, end) + a * c + b * s, slope - a * s + b * c];
        from = to;
        if t <= to {
            break;
        }
    }
    y
}

fn off(y: &[f64], t: f64) -> f64 {
    let e = exact(t);
    (y[0] - e[0]).abs().max((y[1] - e[1]).abs())
}

/// Returns the largest error at steps' ends and middles, and the number of evaluations.
fn error(name: &str, step: f64, tolerance: f64, segments: bool) -> (f64, u64) {
    let settings = StepSettings { step, tolerance };
    let mut system = Pushed {
        segment: segments.then_some(0.0),
    };
    let mut run: Box<dyn Stepper> = if segments {
        Box::new(Segments::start(name, settings, 0.0, &START, &BREAKS).unwrap())
    } else {
        start(name, settings, 0.0, &START).unwrap()
    };
    let (mut worst, mut y): (f64, _) = (0.0, [0.0; 2]);
    while run.time() < END - 1e-9 {
        let before = run.time();
        run.step(&mut system).unwrap();
        assert!(
            !segments
                || BREAKS
                    .iter()
                    .all(|b| !(before < b - 1e-9 && run.time() > b + 1e-9)),
            "{name}: a step from {before} to {}",
            run.time()
        );
        let middle = 0.5 * (before + run.time());
        for t in [middle, run.time()] {
            run.interpolate(&mut system, t, &mut y);
            worst = worst.max(off(&y, t));
        }
    }
    (worst, run.counts().evaluations)
}

fn order(method: &MethodInfo, segments: bool) -> f64 {
    let at = |step: f64| error(method.name, step, 1e-6, segments).0;
    (at(0.02) / at(0.005)).log2() / 2.0
}

#[test]
fn hard_fixed_steps_keep_their_order_over_a_jump() {
    for method in METHODS.iter().filter(|m| !m.adaptive) {
        let (kept, lost) = (order(method, true), order(method, false));
        println!(
            "{}: order {kept:.2} in segments, {lost:.2} without",
            method.name
        );
        let expected = f64::from(method.order);
        holds(
            method.name,
            "order in segments",
            kept,
            expected - 0.3..expected + 0.3,
        );
        holds(method.name, "order over the jump", lost, ..1.4);
    }
}

/// In segments the tolerance is met at the cost of a smooth run. Without them the step control detects the jump and shortens
/// the steps towards it: measured 2.3 (`dopri5`), 5.3 (`dop853`) and 2.7 times (`rodas5p`) the evaluations, and 21 to 69 times
/// the error.
#[test]
fn hard_adaptive_steps_keep_their_tolerance_over_a_jump() {
    for method in METHODS.iter().filter(|m| m.adaptive) {
        let tolerance = if method.order < 4 { 1e-5 } else { 1e-10 };
        let (kept, calls) = error(method.name, 0.01, tolerance, true);
        let (lost, more) = error(method.name, 0.01, tolerance, false);
        println!(
            "{} at {tolerance:e}: {kept:.1e} in {calls} evaluations in segments, {lost:.1e} in {more} without",
            method.name
        );
        holds(method.name, "error in segments", kept, ..3.0 * tolerance);
        if method.order >= 4 {
            holds(method.name, "error over the jump", lost, 10.0 * kept..);
            let dearer = more as f64 / calls as f64;
            holds(
                method.name,
                "calls over the jump per call in segments",
                dearer,
                1.5..,
            );
        }
    }
}

/// A break at a step's end costs no step and leaves the grid unchanged.
#[test]
fn a_break_on_the_grid_shortens_nothing() {
    let step = 1.0 / 128.0;
    let settings = StepSettings {
        step,
        tolerance: 1e-6,
    };
    for method in METHODS.iter().filter(|m| !m.adaptive) {
        let mut system = Pushed { segment: Some(0.0) };
        let breaks = [32.0 * step, 64.0 * step + 1e-14];
        let mut run = Segments::start(method.name, settings, 0.0, &START, &breaks).unwrap();
        for n in 1..=128 {
            run.step(&mut system).unwrap();
            let off = (run.time() - f64::from(n) * step).abs();
            holds(
                method.name,
                &format!("distance of step {n} from the grid"),
                off,
                ..1e-13,
            );
        }
        assert_eq!(run.counts().steps, 128);
        assert_eq!(run.end(), f64::INFINITY);
    }
}

/// Segments without breaks equal the method itself, bit by bit.
#[test]
fn without_breaks_nothing_changes() {
    for method in METHODS {
        let settings = StepSettings {
            step: 0.01,
            tolerance: 1e-7,
        };
        let mut system = Pushed { segment: Some(0.0) };
        let mut plain: Box<dyn Stepper> = start(method.name, settings, 0.0, &START).unwrap();
        let mut segments = Segments::start(method.name, settings, 0.0, &START, &[]).unwrap();
        for _ in 0..50 {
            plain.step(&mut system).unwrap();
            segments.step(&mut system).unwrap();
            assert_eq!(plain.state(), segments.state(), "{}", method.name);
        }
        assert_eq!(plain.counts(), segments.counts());
    }
}
