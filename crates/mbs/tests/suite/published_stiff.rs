//! Stiff problems for methods with a Jacobian: the solution, not the stiffness, must limit the step.

use pinwheel_mbs::integrators::{StepSettings, Stepper, start};
use pinwheel_mbs::{Jacobian, OdeSystem, Structure};

use super::bounds;
use super::published;
use bounds::holds;
use published::{number, numbers, table, worst};

/// Van der Pol's equation in second-order form, with or without its own derivatives.
struct VanDerPol {
    epsilon: f64,
    knows_its_slopes: bool,
}

impl OdeSystem for VanDerPol {
    fn dimension(&self) -> usize {
        2
    }

    fn derivative(&mut self, _: f64, y: &[f64], dydt: &mut [f64]) {
        dydt[0] = y[1];
        dydt[1] = ((1.0 - y[0] * y[0]) * y[1] - y[0]) / self.epsilon;
    }

    fn structure(&self) -> Structure {
        Structure::SecondOrder {
            is_leaf: vec![false],
        }
    }

    fn jacobian(&mut self, _: f64, y: &[f64], jacobian: &mut Jacobian) -> bool {
        if !self.knows_its_slopes {
            return false;
        }
        let Jacobian { position, rate, .. } = jacobian;
        let position = position.as_mut().expect("of second order");
        position.add(0, 0, (-2.0 * y[0] * y[1] - 1.0) / self.epsilon);
        rate.add(0, 0, (1.0 - y[0] * y[0]) / self.epsilon);
        true
    }
}

/// Both jumps of a period are before the end: the tolerance is met there, too, with few steps.
#[test]
fn published_van_der_pol() {
    let data = table("van-der-pol");
    let (end, exact) = (number(&data, "time_s"), numbers(&data, "value"));
    for (knows_its_slopes, tolerance, limit) in [
        // Measured: 3.2e-7 in 616 steps and 5.6e-11 in 7 450.
        (true, 1e-6, 1e-6),
        (true, 1e-10, 1e-9),
        (false, 1e-6, 1e-6),
        (false, 1e-10, 1e-9),
    ] {
        let mut system = VanDerPol {
            epsilon: number(&data, "epsilon"),
            knows_its_slopes,
        };
        let settings = StepSettings {
            step: 1e-6,
            tolerance,
        };
        let start_y = [2.0, 0.0];
        let mut run = start(rodas5p(), settings, 0.0, &start_y).expect("registered");
        while run.time() < end {
            run.step(&mut system).expect("finite");
        }
        let mut y = start_y;
        run.interpolate(&mut system, end, &mut y);
        let (error, counts) = (worst(&y, &exact), run.counts());
        println!("{tolerance:e}, own derivatives {knows_its_slopes}: {error:.1e}, {counts:?}");
        let what = format!("own derivatives {knows_its_slopes}, tolerance {tolerance:e}");
        holds(rodas5p(), &format!("{what}: error"), error, ..limit);
        // An explicit method needs more than 1e6 steps, of epsilon each.
        holds(
            rodas5p(),
            &format!("{what}: steps"),
            counts.steps as f64,
            ..2e4,
        );
        assert!(counts.jacobians >= counts.steps);
    }
}

fn rodas5p() -> &'static str {
    "rodas5p"
}

/// [Prothero & Robinson 1974]: y' = lambda (y - phi) + phi', phi = sin(10 + t). Nonautonomous, of arbitrary stiffness.
struct ProtheroRobinson {
    lambda: f64,
}

impl OdeSystem for ProtheroRobinson {
    fn dimension(&self) -> usize {
        1
    }

    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) {
        dydt[0] = self.lambda * (y[0] - (10.0 + t).sin()) + (10.0 + t).cos();
    }

    /// Unit scales, with which a tolerance of 1 accepts every step.
    fn scale(&self, _: &[f64], scale: &mut [f64]) {
        scale.fill(1.0);
    }
}

/// Returns the largest errors over steps of `h` up to 2, at their ends and inside.
fn prothero_robinson(lambda: f64, h: f64) -> [f64; 2] {
    let mut system = ProtheroRobinson { lambda };
    let (mut ends, mut inside): (f64, f64) = (0.0, 0.0);
    let (mut t, mut y) = (0.0, [10_f64.sin()]);
    while t < 2.0 - 1e-9 {
        // A new run for every step: its first step is the requested one, at a tolerance that accepts it.
        let settings = StepSettings {
            step: h,
            tolerance: 1.0,
        };
        let mut run: Box<dyn Stepper> = start(rodas5p(), settings, t, &y).expect("registered");
        run.step(&mut system).expect("finite");
        run.interpolate(&mut system, t + 0.4 * h, &mut y);
        inside = inside.max((y[0] - (10.0 + t + 0.4 * h).sin()).abs());
        y.copy_from_slice(run.state());
        t = run.time();
        ends = ends.max((y[0] - (10.0 + t).sin()).abs());
    }
    [ends, inside]
}

/// Order 5 without stiffness. If lambda h is large, the error at the ends is h^4/(lambda h), a million times smaller, and that
/// of the interpolant h^4.
#[test]
fn published_prothero_robinson_orders() {
    for (lambda, least) in [(-1.0, [4.75, 4.75]), (-1e2, [3.0, 3.6]), (-1e6, [2.8, 3.6])] {
        let (coarse, fine) = (
            prothero_robinson(lambda, 0.1),
            prothero_robinson(lambda, 0.05),
        );
        for (k, what) in ["ends", "interpolant"].into_iter().enumerate() {
            let order = (coarse[k] / fine[k]).log2();
            println!(
                "lambda {lambda:e}, {what}: {:.1e} {:.1e}, order {order:.2}",
                coarse[k], fine[k]
            );
            holds(
                rodas5p(),
                &format!("order of the {what}, lambda {lambda:e}"),
                order,
                least[k]..,
            );
        }
    }
}
