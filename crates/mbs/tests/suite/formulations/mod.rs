//! Both formulations on mechanisms with known motion.

use super::bounds;
mod friction;
mod loops;

use approx::assert_relative_eq;
use bounds::holds;
use pinwheel_mbs::integrators::{StepSettings, Stepper, start};
use pinwheel_mbs::{
    Body, BodyState, Detail, Driver, ErrorScales, Forces, Formulation, Lagrange, Mechanism,
    MechanismError, Motion, OdeSystem, Reduced, Revolute, Stabilisation, Wrench,
};

/// Weight, and a spring on every body's angle for a less simple motion.
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
    let mut run: Box<dyn Stepper> = start("rk4", settings, 0.0, &y).expect("registered");
    while run.time() < end - 1e-9 {
        run.step(system).unwrap();
    }
    run.state().to_vec()
}

/// Position of the carousel's hub, away from the origin, so that no distance is measured from there.
const HUB: [f64; 2] = [1.5, -0.7];

/// Returns a hub on the ground, driven or not, that carries two bodies at their centres, plus one on the ground.
fn carousel(driven: bool) -> Mechanism {
    let at = |x: f64, y: f64, rate: f64| BodyState {
        x: HUB[0] + x,
        y: HUB[1] + y,
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
                    x: HUB[0],
                    y: HUB[1],
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
                    y: HUB[1],
                    rate: 1.0,
                    ..BodyState::default()
                },
            ),
        ],
        revolutes: vec![
            pin(None, HUB, 0),
            pin(Some(0), [0.6, 0.2], 1),
            pin(Some(0), [-0.3, 0.4], 2),
            pin(None, [5.0, HUB[1]], 3),
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
                ..Driver::default()
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
        let free = if driven { 3 } else { 4 };
        assert_eq!(reduced.degrees_of_freedom(), free);
        assert_eq!(lagrange.degrees_of_freedom(), 12);
        let (y, z) = (run(&mut reduced, 1e-3, 1.0), run(&mut lagrange, 1e-3, 1.0));
        let torques: Vec<f64> = lagrange
            .observe(1.0, &z, Detail::Everything)
            .driver_torques
            .to_vec();
        let bodies: Vec<BodyState> = lagrange
            .observe(1.0, &z, Detail::Everything)
            .bodies
            .to_vec();
        let reactions: Vec<[f64; 2]> = lagrange
            .observe(1.0, &z, Detail::Everything)
            .reactions
            .unwrap()
            .to_vec();
        assert_eq!(reduced.joint_error(1.0, &y), 0.0);
        let observed = reduced.observe(1.0, &y, Detail::Everything);
        for (a, b) in observed.bodies.iter().zip(&bodies) {
            for (what, a, b) in [
                ("x", a.x, b.x),
                ("y", a.y, b.y),
                ("angle", a.angle, b.angle),
                ("vx", a.vx, b.vx),
                ("vy", a.vy, b.vy),
                ("rate", a.rate, b.rate),
            ] {
                holds(
                    "rk4",
                    &format!("difference of {what}"),
                    (a - b).abs(),
                    ..1e-12,
                );
            }
        }
        for (a, b) in observed.driver_torques.iter().zip(&torques) {
            assert_relative_eq!(a, b, max_relative = 1e-11);
        }
        let actual = observed.reactions.unwrap().iter().flatten();
        for (a, b) in actual.zip(reactions.iter().flatten()) {
            assert_relative_eq!(a, b, max_relative = 1e-10);
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
fn what_cannot_be_reduced_is_refused() {
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
    type Change = fn(&mut Mechanism);
    let changes: [(&str, Change); 4] = [
        ("held twice", |m| m.revolutes.push(m.revolutes[3])),
        ("not held", |m| {
            let driven = m.drivers[0].child;
            m.revolutes.retain(|revolute| revolute.child != driven);
        }),
        ("carrier of `b`", |m| m.revolutes[2].parent = Some(1)),
        ("moves a body against another", |m| {
            m.drivers[0].parent = Some(3)
        }),
    ];
    for (reason, change) in changes {
        let mut m = carousel(true);
        change(&mut m);
        let forces = weight(&m);
        let error = Reduced::new(m, forces, &[]).err().expect(reason);
        assert!(error.to_string().contains(reason), "{error}");
    }
}

#[test]
fn bad_input_values_and_indices_are_refused() {
    type Change = fn(&mut Mechanism);
    let values: [Change; 9] = [
        |m| m.bodies[1].mass = 0.0,
        |m| m.bodies[1].mass = f64::INFINITY,
        |m| m.bodies[1].moment = -1.0,
        |m| m.bodies[1].moment = f64::INFINITY,
        |m| m.revolutes[1].child_point[1] = f64::NAN,
        |m| m.drivers[0].motion.from_s = f64::INFINITY,
        |m| m.drivers[0].motion.angle = f64::INFINITY,
        |m| m.drivers[0].motion.rate = f64::INFINITY,
        |m| m.drivers[0].motion.acceleration = f64::NAN,
    ];
    for (k, change) in values.iter().enumerate() {
        let mut m = carousel(true);
        change(&mut m);
        assert!(
            matches!(m.check(), Err(MechanismError::Value { .. })),
            "{k}"
        );
    }
    let indices: [Change; 5] = [
        |m| m.revolutes[1].child = 4,
        |m| m.revolutes[1].parent = Some(4),
        |m| m.revolutes[1].parent = Some(1),
        |m| m.drivers[0].child = 4,
        |m| m.drivers[0].parent = Some(0),
    ];
    for (k, change) in indices.iter().enumerate() {
        let mut m = carousel(true);
        change(&mut m);
        assert!(matches!(m.check(), Err(MechanismError::Body { .. })), "{k}");
    }
}

/// Under Baumgarte's feedback every constraint error obeys phi'' + 2 b phi' + b^2 phi = 0: an error that starts at rest falls
/// as (1 + b t) exp(-b t), for joints and drivers. Without the feedback of positions it would stay.
#[test]
fn baumgartes_feedback_is_that_of_a_critically_damped_oscillator() {
    const RATE: f64 = 50.0;
    const OFF: f64 = 1e-4;
    let mut m = carousel(true);
    // Body on the ground off its pin, and hub off its driver's angle; each alone, so that the errors do not interact.
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
        // Measured: 4e-6 of the initial error, by RK4 at a twentieth of 1/b.
        for (what, error) in [("joint", joint), ("driver", driver)] {
            let off = (error - wanted).abs() / OFF;
            holds("rk4", &format!("{what}, share of its start"), off, ..2e-5);
        }
    }
}

/// A driver between two bodies prescribes the difference of their angles, in every formulation.
#[test]
fn a_driver_between_two_bodies_keeps_their_difference() {
    let motion = Motion {
        from_s: 0.1,
        angle: 0.2,
        rate: -3.0,
        acceleration: 0.9,
    };
    for stabilisation in [
        Stabilisation::None,
        Stabilisation::Baumgarte { rate: 50.0 },
        Stabilisation::Projection,
    ] {
        let mut m = carousel(false);
        let (angle, rate, _) = motion.at(0.0);
        m.bodies[1].start.angle = angle;
        m.bodies[1].start.rate = 2.0 + rate;
        m.drivers.push(Driver {
            parent: Some(0),
            child: 1,
            motion,
            ..Driver::default()
        });
        let forces = weight(&m);
        let mut system = Lagrange::new(m, forces, stabilisation).unwrap();
        let y = run(&mut system, 1e-3, 0.5);
        let (angle, rate, _) = motion.at(0.5);
        let method = format!("rk4, {stabilisation:?}");
        // Measured: 2.4e-9 with Baumgarte's feedback, by RK4 at a twentieth of 1/b; below 1e-10 without.
        let off = (y[5] - y[2] - angle).abs();
        holds(&method, "angle off the driver's, rad", off, ..1e-8);
        let off = (y[17] - y[14] - rate).abs();
        holds(&method, "rate off the driver's, rad/s", off, ..1e-8);
    }
}

/// A body without a moment rotates uniformly, and is no unknown.
#[test]
fn idle_bodies_turn_uniformly() {
    let mut m = carousel(true);
    m.bodies[3].start.angle = 0.4;
    let mut system = Reduced::new(m.clone(), weight(&m), &[3]).unwrap();
    assert_eq!((system.degrees_of_freedom(), system.dimension()), (2, 4));
    let y = system.initial();
    let observed = system.observe(0.5, &y, Detail::Everything).bodies[3];
    assert_eq!((observed.angle, observed.rate), (0.9, 1.0));
}

/// An observation of the reduced form belongs to the requested state alone, with its own motion, after any previous evaluation.
#[test]
fn what_is_observed_is_of_the_state_asked_for() {
    let m = carousel(true);
    let fresh = || Reduced::new(m.clone(), weight(&m), &[]).unwrap();
    let (mut system, y) = (fresh(), fresh().initial());
    let mut z = y.clone();
    z[0] += 0.5;
    for (t, y) in [(0.0, &y), (0.2, &y), (0.2, &z), (0.0, &z)] {
        let mut other = fresh();
        let expected = other.observe(t, y, Detail::Everything);
        let observed = system.observe(t, y, Detail::Everything);
        assert_eq!(observed.bodies, expected.bodies);
        assert_eq!(observed.loads, expected.loads);
        assert_eq!(observed.driver_torques, expected.driver_torques);
        let (mut derivatives, mut same) = (vec![0.0; y.len()], vec![0.0; y.len()]);
        other.derivative(t, y, &mut derivatives);
        system.derivative_at_end(t, y, true, &mut same);
        assert_eq!(derivatives, same);
        system.derivative(t, &z, &mut derivatives);
    }
    system.observe(0.2, &y, Detail::Everything);
    let motion = Motion {
        rate: 7.0,
        ..Motion::default()
    };
    system.set_motion(0, motion);
    assert_eq!(
        system.observe(0.2, &y, Detail::Everything).bodies[0].rate,
        7.0
    );
    system.forces_mut().masses[3] = 2.0;
    let load = system.observe(0.2, &y, Detail::Everything).loads[3].fy;
    assert_relative_eq!(load, -2.0 * 9.81, max_relative = 1e-15);
}

/// A projected state is not projected again, unless the bodies have changed since.
#[test]
fn a_settled_state_is_evaluated_as_any_other() {
    let m = carousel(true);
    let fresh = || Lagrange::new(m.clone(), weight(&m), Stabilisation::Projection).unwrap();
    let mut y = fresh().initial();
    fresh().project(0.2, &mut y);
    let mut z = y.clone();
    z[5] += 0.3;
    let derivatives = |system: &mut Lagrange<Weight>, t: f64, y: &[f64]| {
        let mut derivatives = vec![0.0; y.len()];
        system.derivative(t, y, &mut derivatives);
        derivatives
    };
    let expected = derivatives(&mut fresh(), 0.2, &y);
    let mut system = fresh();
    system.project(0.2, &mut y.clone());
    assert_eq!(system.joint_error(0.2, &y), fresh().joint_error(0.2, &y));
    assert_eq!(derivatives(&mut system, 0.2, &y), expected);
    // Another state, another time, then the first again.
    for (t, state) in [(0.2, &z), (0.3, &y), (0.2, &y)] {
        assert_eq!(
            derivatives(&mut system, t, state),
            derivatives(&mut fresh(), t, state)
        );
    }
    let (mut e, mut i) = (y.clone(), y.clone());
    system.project(0.2, &mut y.clone());
    system.split_stage(0.2, 1e-3, &mut y.clone(), &mut e, &mut i);
    assert_eq!(derivatives(&mut system, 0.2, &y), expected);
    // An open joint is detected, and leaves no trace in the next evaluation, not even for a body at rest.
    let mut apart = y.clone();
    (apart[0], apart[m.bodies.len() * 3]) = (apart[0] + 0.3, 0.1);
    assert_relative_eq!(system.joint_error(0.2, &apart), 0.3, max_relative = 1e-12);
    assert_eq!(derivatives(&mut system, 0.2, &y), expected);
    // Neither does a wrong initial position.
    let mut off = m.clone();
    off.bodies[3].start.x += 0.1;
    let mut begun = Lagrange::new(off, weight(&m), Stabilisation::Projection).unwrap();
    assert_eq!(derivatives(&mut begun, 0.2, &y), expected);
    assert_eq!(
        begun.observe(0.2, &y, Detail::Everything).bodies,
        fresh().observe(0.2, &y, Detail::Everything).bodies
    );
    // f of a violating state is that of its projection.
    assert_eq!(derivatives(&mut system, 0.2, &apart), expected);
}

/// A body without a joint is not projected.
#[test]
fn free_bodies_are_projected_nowhere() {
    let mut m = carousel(true);
    m.bodies.push(body("free", 1.0, 0.1, BodyState::default()));
    let of = |how: Stabilisation| {
        let mut system = Lagrange::new(m.clone(), weight(&m), how).unwrap();
        let mut y = system.initial();
        for (k, y) in y.iter_mut().enumerate().filter(|(k, _)| k / 3 % 5 == 4) {
            *y = 0.1 * (k as f64 + 1.0);
        }
        let (mut derivatives, observed) = (
            vec![0.0; y.len()],
            system.observe(0.0, &y, Detail::Everything).bodies[4],
        );
        system.derivative(0.0, &y, &mut derivatives);
        system.project(0.0, &mut y);
        (
            derivatives[12..15].to_vec(),
            derivatives[27..].to_vec(),
            observed,
            y[12..15].to_vec(),
        )
    };
    let free = of(Stabilisation::None);
    let numbers = |from: f64| [from, from + 1.0, from + 2.0].map(|k| 0.1 * k);
    assert_eq!(
        (&free.0[..], &free.3[..]),
        (&numbers(28.0)[..], &numbers(13.0)[..])
    );
    assert_eq!(free, of(Stabilisation::Projection));
}

/// A method whose last stage is the next step's first evaluates f six times per step, with or without projection.
#[test]
fn settling_costs_no_evaluation() {
    let m = carousel(false);
    for how in [Stabilisation::None, Stabilisation::Projection] {
        let mut system = Lagrange::new(m.clone(), weight(&m), how).unwrap();
        let settings = StepSettings {
            step: 1e-3,
            tolerance: 1e-8,
        };
        let mut run = start("dopri5", settings, 0.0, &system.initial()).unwrap();
        for _ in 0..20 {
            run.step(&mut system).unwrap();
        }
        let counts = run.counts();
        let tried = counts.steps + counts.rejected;
        assert_eq!(counts.evaluations, 1 + 6 * tried, "{how:?}");
    }
}

#[test]
fn errors_are_scaled_by_their_kind() {
    let scales = ErrorScales {
        length: 2.0,
        angle: 3.0,
        frequency: 5.0,
    };
    let m = carousel(true);
    let lagrange = Lagrange::new(m.clone(), weight(&m), Stabilisation::None).unwrap();
    let reduced = Reduced::new(m.clone(), weight(&m), &[]).unwrap();
    let (y, z) = (vec![-4.0; 6], vec![-4.0; 24]);
    let (mut of, mut all) = (vec![0.0; 6], vec![0.0; 24]);
    reduced.scale(&y, &mut of);
    lagrange.scale(&z, &mut all);
    assert!(of.iter().chain(&all).all(|&s| s == 4.0));
    reduced.with_scales(scales).scale(&y, &mut of);
    lagrange.with_scales(scales).scale(&z, &mut all);
    assert_eq!(of, [3.0, 3.0, 3.0, 15.0, 15.0, 15.0]);
    let expected = [[2.0, 2.0, 3.0]; 4].into_iter();
    let expected = expected.chain([[10.0, 10.0, 15.0]; 4]).flatten();
    assert!(expected.eq(all));
}

#[test]
fn kinetic_energy_is_half_of_mass_times_square() {
    let state = BodyState {
        vx: 0.2,
        vy: -0.7,
        rate: 1.3,
        ..BodyState::default()
    };
    let m = Mechanism {
        bodies: vec![body("a", 1.3, 0.25, state), body("b", 2.0, 0.35, state)],
        ..Mechanism::default()
    };
    let expected = 0.5 * (3.3 * (0.04 + 0.49) + 0.6 * 1.69);
    let energy = m.kinetic_j(&[state; 2]);
    assert_relative_eq!(energy, expected, max_relative = 1e-15);
}

/// Force to the side and down on every body, and a moment that depends on the segment.
struct Wind {
    segment: f64,
}

impl Forces for Wind {
    fn apply(&mut self, _: f64, bodies: &[BodyState], loads: &mut [Wrench]) {
        for (load, body) in loads.iter_mut().zip(bodies) {
            load.fx += 3.0;
            load.fy -= 7.0;
            load.moment += self.segment - 2.0 * body.angle;
        }
    }

    fn restart_at(&mut self, from: f64) {
        self.segment = from;
    }
}

/// Two driven hubs with bodies, neither at the origin: positions, speeds and driver torques are equal in both formulations,
/// segment by segment.
#[test]
fn two_drivers_do_the_same_in_both_forms() {
    let motion = Motion {
        from_s: 0.1,
        angle: 0.4,
        rate: -1.0,
        acceleration: 2.0,
    };
    // f = 0.4 - 0.2 + 0.04 and f' = -1 + 0.4, 0.2 s later.
    let (angle, rate, acceleration) = motion.at(0.3);
    assert!((angle - 0.24).abs() < 1e-15 && (rate + 0.6).abs() < 1e-15 && acceleration == 2.0);
    let mut mechanism = carousel(true);
    let (angle, rate, _) = motion.at(0.0);
    (
        mechanism.bodies[3].start.angle,
        mechanism.bodies[3].start.rate,
    ) = (angle, rate);
    let base = mechanism.bodies[3].start;
    let (s, c) = angle.sin_cos();
    let (x, y) = (0.2 * c - 0.5 * s, 0.2 * s + 0.5 * c);
    mechanism.bodies.push(body(
        "d",
        2.0,
        0.4,
        BodyState {
            x: base.x + x,
            y: base.y + y,
            angle: 0.3,
            vx: -rate * y,
            vy: rate * x,
            rate: 0.7,
        },
    ));
    mechanism.revolutes.push(Revolute {
        parent: Some(3),
        parent_point: [0.2, 0.5],
        child: 4,
        child_point: [0.0; 2],
    });
    mechanism.drivers.push(Driver {
        parent: None,
        child: 3,
        motion,
        ..Driver::default()
    });
    let mut reduced = Reduced::new(mechanism.clone(), Wind { segment: 0.0 }, &[]).unwrap();
    let stabilisation = Stabilisation::Projection;
    let mut lagrange = Lagrange::new(mechanism, Wind { segment: 0.0 }, stabilisation).unwrap();
    for segment in [0.0, 5.0] {
        reduced.restart_at(segment);
        lagrange.restart_at(segment);
        let (one, other) = (run(&mut reduced, 1e-3, 0.2), run(&mut lagrange, 1e-3, 0.2));
        let (one, other) = (
            reduced.observe(0.2, &one, Detail::Everything),
            lagrange.observe(0.2, &other, Detail::Everything),
        );
        for (a, b) in one.bodies.iter().zip(other.bodies) {
            for (a, b) in [
                (a.x, b.x),
                (a.y, b.y),
                (a.angle, b.angle),
                (a.vx, b.vx),
                (a.vy, b.vy),
                (a.rate, b.rate),
            ] {
                assert!((a - b).abs() < 1e-8, "{a} {b}");
            }
        }
        let (a, b) = (one.kinetic_j, other.kinetic_j);
        assert!((a - b).abs() < 1e-7 * b && b > 0.0, "{a} {b}");
        assert!(one.moments.is_some() && other.moments.is_none());
        assert_eq!(one.driver_torques.len(), 2);
        for (a, b) in one.driver_torques.iter().zip(other.driver_torques) {
            assert!((a - b).abs() < 1e-7 && a.abs() > 0.1, "{a} {b}");
        }
    }
    // Another state at the same time is evaluated again.
    let y = reduced.initial();
    let mut moved = y.clone();
    moved[0] += 0.1;
    let moments = |reduced: &mut Reduced<Wind>, y: &[f64]| {
        let observed = reduced.observe(0.0, y, Detail::Everything);
        observed.loads.iter().map(|load| load.moment).sum::<f64>()
    };
    let (before, after) = (moments(&mut reduced, &y), moments(&mut reduced, &moved));
    assert!((after - before + 0.2).abs() < 1e-12, "{before} {after}");
}
