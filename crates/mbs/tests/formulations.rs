//! The two formulations on mechanisms whose motion is known.

use approx::assert_relative_eq;
use pinwheel_mbs::integrators::{StepSettings, Stepper, start};
use pinwheel_mbs::{
    Body, BodyState, Driver, Forces, Formulation, Lagrange, Mechanism, MechanismError, Motion,
    Reduced, Revolute, Stabilisation, Wrench,
};

mod bounds;
use bounds::holds;

/// Weight, and a spring on every body's angle that makes the motion less simple.
struct Weight {
    masses: Vec<f64>,
    spring: f64,
}

impl Forces for Weight {
    fn apply(&mut self, _: f64, bodies: &[BodyState], loads: &mut [Wrench]) {
        for ((load, body), mass) in loads.iter_mut().zip(bodies).zip(&self.masses) {
            load.fy -= 9.81 * mass;
            load.moment -= self.spring * body.angle;
        }
    }
}

fn body(name: &str, mass: f64, moment: f64, start: BodyState) -> Body {
    Body {
        name: name.into(),
        mass,
        moment,
        start,
    }
}

fn run<F: Formulation>(system: &mut F, step: f64, end: f64) -> Vec<f64> {
    let y = system.initial();
    let settings = StepSettings {
        step,
        tolerance: 1e-8,
    };
    let mut run: Box<dyn Stepper<F>> = start("rk4", settings, 0.0, &y).expect("registered");
    while run.time() < end - 1e-9 {
        run.step(system).unwrap();
    }
    run.state().to_vec()
}

/// A hub on the ground, driven or not, that carries two bodies at their centres, plus one on the ground.
fn carousel(driven: bool) -> Mechanism {
    let at = |x: f64, y: f64, rate: f64| BodyState {
        x,
        y,
        angle: 0.0,
        vx: -2.0 * y,
        vy: 2.0 * x,
        rate,
    };
    let pin = |parent, parent_point, child| Revolute {
        parent,
        parent_point,
        child,
        child_point: [0.0; 2],
    };
    Mechanism {
        bodies: vec![
            body(
                "hub",
                2.0,
                0.5,
                BodyState {
                    rate: 2.0,
                    ..BodyState::default()
                },
            ),
            body("a", 1.0, 0.1, at(0.6, 0.2, -1.0)),
            body("b", 3.0, 0.2, at(-0.3, 0.4, 0.5)),
            body(
                "c",
                1.0,
                0.3,
                BodyState {
                    x: 5.0,
                    rate: 1.0,
                    ..BodyState::default()
                },
            ),
        ],
        revolutes: vec![
            pin(None, [0.0; 2], 0),
            pin(Some(0), [0.6, 0.2], 1),
            pin(Some(0), [-0.3, 0.4], 2),
            pin(None, [5.0, 0.0], 3),
        ],
        drivers: if driven {
            vec![Driver {
                parent: None,
                child: 0,
                motion: Motion {
                    from_s: 0.0,
                    angle: 0.0,
                    rate: 2.0,
                    acceleration: -0.7,
                },
            }]
        } else {
            Vec::new()
        },
    }
}

fn weight(m: &Mechanism) -> Weight {
    Weight {
        masses: m.bodies.iter().map(|b| b.mass).collect(),
        spring: 0.8,
    }
}

#[test]
fn reduced_and_lagrange_form_move_alike() {
    for driven in [false, true] {
        let m = carousel(driven);
        let mut reduced = Reduced::new(m.clone(), weight(&m), &[]).unwrap();
        let mut lagrange = Lagrange::new(m.clone(), weight(&m), Stabilisation::Projection).unwrap();
        let (y, z) = (run(&mut reduced, 1e-3, 1.0), run(&mut lagrange, 1e-3, 1.0));
        let torques: Vec<f64> = lagrange.observe(1.0, &z).driver_torques.to_vec();
        let bodies: Vec<BodyState> = lagrange.observe(1.0, &z).bodies.to_vec();
        let seen = reduced.observe(1.0, &y);
        for (a, b) in seen.bodies.iter().zip(&bodies) {
            for (what, a, b) in [
                ("x", a.x, b.x),
                ("vy", a.vy, b.vy),
                ("angle", a.angle, b.angle),
            ] {
                holds(
                    "rk4",
                    &format!("difference of {what}"),
                    (a - b).abs(),
                    ..1e-12,
                );
            }
        }
        for (a, b) in seen.driver_torques.iter().zip(&torques) {
            assert_relative_eq!(a, b, max_relative = 1e-11);
        }
    }
}

#[test]
fn free_fall_of_a_compound_pendulum_keeps_its_energy() {
    let start = BodyState {
        x: 0.5,
        ..BodyState::default()
    };
    let m = Mechanism {
        bodies: vec![body("rod", 2.0, 0.1, start)],
        revolutes: vec![Revolute {
            parent: None,
            parent_point: [0.0; 2],
            child: 0,
            child_point: [-0.5, 0.0],
        }],
        drivers: Vec::new(),
    };
    let forces = Weight {
        masses: vec![2.0],
        spring: 0.0,
    };
    for stabilisation in [
        Stabilisation::None,
        Stabilisation::Baumgarte { rate: 50.0 },
        Stabilisation::Projection,
    ] {
        let forces = Weight {
            masses: forces.masses.clone(),
            spring: 0.0,
        };
        let mut system = Lagrange::new(m.clone(), forces, stabilisation).unwrap();
        let y = run(&mut system, 1e-3, 3.0);
        let energy =
            0.5 * 2.0 * (y[3] * y[3] + y[4] * y[4]) + 0.05 * y[5] * y[5] + 2.0 * 9.81 * y[1];
        let drift = system.joint_error(3.0, &y);
        println!("{stabilisation:?}: energy {energy:.1e} J, drift {drift:.1e} m");
        // RK4 at 1 ms, 3 s; measured: energy 1.3e-9, 1.6e-8, 1e-11 J and drift 8e-11, 3e-10, 0 m.
        let run = format!("rk4, {stabilisation:?}");
        holds(&run, "energy, J", energy.abs(), ..1e-7);
        let bound = if stabilisation == Stabilisation::Projection {
            1e-15
        } else {
            1e-9
        };
        holds(&run, "joint error, m", drift, ..bound);
    }
}

#[test]
fn a_closed_loop_stays_closed() {
    // A parallelogram of three rods, the middle one translating.
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

#[test]
fn what_cannot_be_reduced_is_said() {
    let mut m = carousel(false);
    m.revolutes[1].child_point = [0.1, 0.0];
    let forces = weight(&m);
    assert!(matches!(
        Reduced::new(m.clone(), forces, &[]),
        Err(MechanismError::NotReducible(_))
    ));
    m.revolutes[1] = Revolute {
        parent: Some(9),
        ..m.revolutes[1]
    };
    let forces = weight(&m);
    assert!(matches!(
        Reduced::new(m, forces, &[]),
        Err(MechanismError::Body { .. })
    ));
}

/// Baumgarte's feedback makes every constraint error obey phi'' + 2 b phi' + b^2 phi = 0: an error that starts at rest
/// falls as (1 + b t) exp(-b t), in joints and drivers alike. Without the feedback of positions it would stay.
#[test]
fn baumgartes_feedback_is_that_of_a_critically_damped_oscillator() {
    const RATE: f64 = 50.0;
    const OFF: f64 = 1e-4;
    let mut m = carousel(true);
    // The body on the ground beside its pin, the hub beside its driver; each alone, so that no error feeds another.
    m.bodies[3].start.x += OFF;
    m.bodies[0].start.angle = OFF;
    m.bodies.truncate(4);
    m.revolutes.retain(|r| r.parent.is_none());
    for body in &mut m.bodies[1..3] {
        body.start = BodyState::default();
    }
    let mut forces = weight(&m);
    forces.masses.fill(0.0);
    let stabilisation = Stabilisation::Baumgarte { rate: RATE };
    let mut system = Lagrange::new(m, forces, stabilisation).unwrap();
    for end in [0.02, 0.06, 0.1] {
        let y = run(&mut system, 1e-3, end);
        let wanted = OFF * (1.0 + RATE * end) * (-RATE * end).exp();
        let joint = system.joint_error(end, &y);
        let driver = y[2] - (2.0 * end - 0.35 * end * end);
        // Measured: 4e-6 of the start's error, RK4's at a twentieth of 1/b.
        for (what, found) in [("joint", joint), ("driver", driver)] {
            let off = (found - wanted).abs() / OFF;
            holds("rk4", &format!("{what}, share of its start"), off, ..2e-5);
        }
    }
}
