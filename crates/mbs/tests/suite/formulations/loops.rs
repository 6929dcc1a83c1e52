//! Closed loops.

use super::bounds::holds;
use super::{Weight, body, run, weight};
use pinwheel_mbs::{
    BodyState, Driver, Formulation, Lagrange, Mechanism, Motion, OdeSystem, Revolute, Stabilisation,
};

#[test]
fn a_closed_loop_stays_closed() {
    // Parallelogram of three rods, of which the middle one translates.
    let rod = |name: &str, x: f64, y: f64, angle: f64| {
        body(
            name,
            1.0,
            1.0 / 12.0,
            BodyState {
                x,
                y,
                angle,
                ..BodyState::default()
            },
        )
    };
    let up = std::f64::consts::FRAC_PI_2;
    let mut m = Mechanism {
        bodies: vec![
            rod("left", 0.0, 0.5, up),
            rod("top", 0.7, 1.0, 0.0),
            rod("right", 1.4, 0.5, up),
        ],
        revolutes: vec![
            Revolute {
                parent: None,
                parent_point: [0.0, 0.0],
                child: 0,
                child_point: [-0.5, 0.0],
            },
            Revolute {
                parent: Some(0),
                parent_point: [0.5, 0.0],
                child: 1,
                child_point: [-0.7, 0.0],
            },
            Revolute {
                parent: None,
                parent_point: [1.4, 0.0],
                child: 2,
                child_point: [-0.5, 0.0],
            },
            Revolute {
                parent: Some(2),
                parent_point: [0.5, 0.0],
                child: 1,
                child_point: [0.7, 0.0],
            },
        ],
        drivers: Vec::new(),
    };
    for (k, speed) in [(0, -0.5), (1, -1.0), (2, -0.5)] {
        m.bodies[k].start.vx = speed;
        m.bodies[k].start.rate = if k == 1 { 0.0 } else { 1.0 };
    }
    let forces = Weight {
        masses: vec![1.0; 3],
        spring: 0.0,
    };
    let mut system = Lagrange::new(m, forces, Stabilisation::Projection).unwrap();
    let y = run(&mut system, 5e-4, 0.3);
    holds(
        "rk4",
        "joint error, m",
        system.joint_error(0.3, &y),
        ..1e-13,
    );
    holds(
        "rk4",
        "difference of the cranks, rad",
        (y[2] - y[8]).abs(),
        ..1e-10,
    );
    holds("rk4", "tilt of the top, rad", y[5].abs(), ..1e-10);
}

/// A driven parallelogram that violates its constraints is projected onto them, speeds included.
#[test]
fn loops_are_closed_from_a_distance() {
    let rod = |name: &str, x: f64, y: f64, angle: f64| {
        let start = BodyState {
            x,
            y,
            angle,
            ..BodyState::default()
        };
        body(name, 1.0, 0.1, start)
    };
    let pin = |parent, parent_point, child, child_point| Revolute {
        parent,
        parent_point,
        child,
        child_point,
    };
    let up = std::f64::consts::FRAC_PI_2;
    let m = Mechanism {
        bodies: vec![
            rod("left", 0.0, 0.5, up),
            rod("top", 0.7, 1.0, 0.0),
            rod("right", 1.4, 0.5, up),
        ],
        revolutes: vec![
            pin(None, [0.0, 0.0], 0, [-0.5, 0.0]),
            pin(Some(0), [0.5, 0.0], 1, [-0.7, 0.0]),
            pin(None, [1.4, 0.0], 2, [-0.5, 0.0]),
            pin(Some(2), [0.5, 0.0], 1, [0.7, 0.0]),
        ],
        drivers: vec![Driver {
            parent: None,
            child: 0,
            motion: Motion {
                from_s: 0.0,
                angle: up,
                rate: 2.0,
                acceleration: 0.0,
            },
            ..Driver::default()
        }],
    };
    let forces = weight(&m);
    let mut system = Lagrange::new(m, forces, Stabilisation::Projection).unwrap();
    let mut y = system.initial();
    for (k, y) in y.iter_mut().enumerate() {
        *y += 0.01 * (1.0 + k as f64).sin();
    }
    let t = 0.05;
    system.project(t, &mut y);
    let angle = up + 2.0 * t;
    let (s, c) = angle.sin_cos();
    let expected = [
        [0.5 * c, 0.5 * s, angle],
        [0.7 + c, s, 0.0],
        [1.4 + 0.5 * c, 0.5 * s, angle],
        [-s, c, 2.0],
        [-2.0 * s, 2.0 * c, 0.0],
        [-s, c, 2.0],
    ];
    for (k, (actual, expected)) in y.iter().zip(expected.iter().flatten()).enumerate() {
        let off = (actual - expected).abs();
        holds("projection", &format!("error of y[{k}]"), off, ..1e-12);
    }
    holds(
        "projection",
        "joint error, m",
        system.joint_error(t, &y),
        ..1e-13,
    );
}
