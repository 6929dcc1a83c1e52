//! Block factorisation against a dense LU of all of Eq. 2, written independently.

use nalgebra::{DMatrix, DVector};
use pinwheel_mbs::{
    Body, BodyState, Detail, Driver, Forces, Formulation, Lagrange, Mechanism, Motion, OdeSystem,
    Revolute, Stabilisation, Wrench,
};
use proptest::prelude::*;

/// Constant loads.
struct Loads(Vec<Wrench>);

impl Forces for Loads {
    fn apply(&mut self, _: f64, _: &[BodyState], loads: &mut [Wrench]) {
        loads.copy_from_slice(&self.0);
    }
}

/// Returns accelerations and multipliers of `[M -D'; D 0][a; lambda] = [F; gamma]` by dense LU.
fn dense(mechanism: &Mechanism, loads: &[Wrench]) -> (Vec<f64>, Vec<f64>) {
    let (n, m) = (3 * mechanism.bodies.len(), mechanism.constraints());
    let mut a = DMatrix::zeros(n + m, n + m);
    let mut b = DVector::zeros(n + m);
    for (k, (body, load)) in mechanism.bodies.iter().zip(loads).enumerate() {
        for (i, (mass, force)) in [
            (body.mass, load.fx),
            (body.mass, load.fy),
            (body.moment, load.moment),
        ]
        .into_iter()
        .enumerate()
        {
            a[(3 * k + i, 3 * k + i)] = mass;
            b[3 * k + i] = force;
        }
    }
    let mut d = DMatrix::zeros(m, n);
    for (k, joint) in mechanism.revolutes.iter().enumerate() {
        let mut side = |body: usize, point: [f64; 2], sign: f64| {
            let state = mechanism.bodies[body].start;
            let (s, c) = state.angle.sin_cos();
            let arm = [c * point[0] - s * point[1], s * point[0] + c * point[1]];
            d[(2 * k, 3 * body)] += sign;
            d[(2 * k + 1, 3 * body + 1)] += sign;
            d[(2 * k, 3 * body + 2)] -= sign * arm[1];
            d[(2 * k + 1, 3 * body + 2)] += sign * arm[0];
            for i in 0..2 {
                b[n + 2 * k + i] += sign * state.rate * state.rate * arm[i];
            }
        };
        side(joint.child, joint.child_point, 1.0);
        if let Some(parent) = joint.parent {
            side(parent, joint.parent_point, -1.0);
        }
    }
    let first = 2 * mechanism.revolutes.len();
    for (k, driver) in mechanism.drivers.iter().enumerate() {
        d[(first + k, 3 * driver.child + 2)] = 1.0;
        if let Some(parent) = driver.parent {
            d[(first + k, 3 * parent + 2)] = -1.0;
        }
        b[n + first + k] = driver.motion.acceleration;
    }
    a.view_mut((n, 0), (m, n)).copy_from(&d);
    a.view_mut((0, n), (n, m)).copy_from(&(-d.transpose()));
    let x = a.lu().solve(&b).expect("the random mechanism is regular");
    (
        x.rows(0, n).iter().copied().collect(),
        x.rows(n, m).iter().copied().collect(),
    )
}

/// Builds a mechanism from numbers in (-1, 1), twelve for each body.
fn mechanism(
    seeds: &[[f64; 12]],
    closures: &[(usize, usize)],
    driven: bool,
) -> (Mechanism, Vec<Wrench>) {
    let mut m = Mechanism::default();
    let mut loads = Vec::new();
    for (k, s) in seeds.iter().enumerate() {
        m.bodies.push(Body {
            name: format!("body {k}"),
            mass: 1.1 + s[0],
            moment: 10f64.powf(2.0 * s[1]),
            start: BodyState {
                x: s[2],
                y: s[3],
                angle: 3.0 * s[4],
                vx: 0.0,
                vy: 0.0,
                rate: 5.0 * s[5],
            },
        });
        // Random tree: body k is joined to an earlier body or the ground, sometimes at its centre of mass.
        let parent = ((s[6].abs() * (k as f64 + 1.0)) as usize).checked_sub(1);
        let child_point = if s[7] > 0.0 { [s[8], s[9]] } else { [0.0; 2] };
        m.revolutes.push(if s[11] > 0.5 && parent.is_some() {
            // Joint with parent and child exchanged.
            Revolute {
                parent: Some(k),
                parent_point: child_point,
                child: parent.unwrap_or(0),
                child_point: [s[10], s[11]],
            }
        } else {
            Revolute {
                parent,
                parent_point: [s[10], s[11]],
                child: k,
                child_point,
            }
        });
        loads.push(Wrench {
            fx: s[9],
            fy: s[10],
            moment: s[11],
        });
    }
    for &(a, b) in closures {
        let (a, b) = (a % seeds.len(), b % seeds.len());
        if a != b {
            m.revolutes.push(Revolute {
                parent: Some(a),
                parent_point: [0.4, -0.3],
                child: b,
                child_point: [-0.2, 0.7],
            });
        }
    }
    if driven {
        m.drivers.push(Driver {
            parent: None,
            child: 0,
            motion: Motion {
                from_s: 0.0,
                angle: 0.0,
                rate: 1.0,
                acceleration: 0.3,
            },
            ..Driver::default()
        });
    }
    (m, loads)
}

fn compare(m: &Mechanism, loads: &[Wrench], tolerance: f64) -> Result<(), TestCaseError> {
    let (accelerations, multipliers) = dense(m, loads);
    let mut system =
        Lagrange::new(m.clone(), Loads(loads.to_vec()), Stabilisation::None).expect("regular");
    let y = system.initial();
    let mut dydt = vec![0.0; y.len()];
    system.derivative(0.0, &y, &mut dydt);
    let largest = |v: &[f64]| v.iter().fold(1e-3f64, |a, x| a.max(x.abs()));
    let scale = largest(&accelerations);
    for (value, exact) in dydt[y.len() / 2..].iter().zip(&accelerations) {
        prop_assert!((value - exact).abs() < tolerance * scale, "{value} {exact}");
    }
    let scale = largest(&multipliers);
    let output = system.observe(0.0, &y, Detail::Everything);
    let reactions = output
        .reactions
        .expect("the Lagrange form knows them")
        .iter()
        .flatten();
    for (value, exact) in reactions.chain(output.driver_torques).zip(&multipliers) {
        prop_assert!((value - exact).abs() < tolerance * scale, "{value} {exact}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn trees_of_joints(
        seeds in prop::collection::vec(prop::array::uniform12(-1.0f64..1.0), 1..20), driven: bool,
    ) {
        let (m, loads) = mechanism(&seeds, &[], driven);
        compare(&m, &loads, 1e-8)?;
    }

    /// Shafts and pendulums with bodies at their centres: nothing is factored.
    #[test]
    fn hubs_and_leaves(
        seeds in prop::collection::vec(prop::array::uniform12(-1.0f64..1.0), 3..20), driven: bool,
    ) {
        let (mut m, loads) = mechanism(&seeds, &[], driven);
        m.revolutes.clear();
        for (k, s) in seeds.iter().enumerate() {
            let parent = [None, Some(0), Some(1)][k % 3].filter(|_| k > 1);
            let pinned = k > 1 || s[7] > 0.5;
            m.revolutes.push(Revolute {
                parent,
                parent_point: [s[10], s[11]],
                child: k,
                child_point: if pinned { [0.0; 2] } else { [s[8], s[9]] },
            });
        }
        prop_assert_eq!(pinwheel_mbs::SaddlePoint::new(&m).blocks(), 0);
        compare(&m, &loads, 1e-10)?;
        // With a driver between the two they are no hubs.
        if driven {
            m.drivers[0].parent = Some(1);
            prop_assert!(pinwheel_mbs::SaddlePoint::new(&m).blocks() > 0);
            compare(&m, &loads, 1e-8)?;
        }
    }

    #[test]
    fn closed_loops(
        seeds in prop::collection::vec(prop::array::uniform12(-1.0f64..1.0), 6..14), a in 0usize..14, b in 0usize..14,
    ) {
        let (m, loads) = mechanism(&seeds, &[(a, b)], false);
        prop_assume!(Lagrange::new(m.clone(), Loads(loads.clone()), Stabilisation::None).is_ok());
        compare(&m, &loads, 1e-6)?;
    }
}

#[test]
fn dependent_constraints_are_named() {
    let (mut m, loads) = mechanism(&[[0.1; 12]], &[], true);
    m.drivers.push(m.drivers[0].clone());
    let error = Lagrange::new(m, Loads(loads), Stabilisation::None)
        .err()
        .expect("driven twice");
    assert!(error.to_string().contains("driver"), "{error}");
    let (mut m, loads) = mechanism(&[[0.1; 12]], &[], false);
    let second = Revolute {
        parent_point: [0.9, 0.9],
        child_point: [0.5, -0.4],
        ..m.revolutes[0]
    };
    m.revolutes.push(second);
    let error = Lagrange::new(m, Loads(loads), Stabilisation::None)
        .err()
        .expect("held twice");
    assert!(error.to_string().contains("revolute"), "{error}");
}

#[test]
fn star_of_a_gears_size() -> Result<(), TestCaseError> {
    // 2 bodies on the ground, 30 on the second, none held at its centre. The first carries nothing and has no equation left.
    let mut seeds = vec![[0.3; 12]; 32];
    for (k, s) in seeds.iter_mut().enumerate() {
        s[6] = 0.0;
        s[8..11].fill(k as f64 / 32.0);
    }
    let (mut m, loads) = mechanism(&seeds, &[], true);
    for joint in &mut m.revolutes[2..] {
        joint.parent = Some(1);
    }
    prop_assert_eq!(pinwheel_mbs::SaddlePoint::new(&m).blocks(), 31 * 32 / 2);
    compare(&m, &loads, 1e-8)
}
