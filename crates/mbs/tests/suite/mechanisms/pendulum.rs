//! IFToMM benchmark A01: a point mass of 1 kg at 1 m, released at rest from the horizontal.
//!
//! A body needs a moment of inertia, so the point mass is replaced by the rigid body with the same
//! motion: `m l = 1 kg m` and `J + m l^2 = 1 kg m^2` with m = 2 kg, l = 0.5 m, J = 0.5 kg m^2.
//! Output: x, y, vx, vy of the point at 1 m.
//! Source: IFToMM Technical Committee for Multibody Dynamics, Library of Computational Benchmark Problems, A01.

use pinwheel_mbs::{Body, BodyState, Mechanism, Observation, Revolute};

use super::Problem;
use super::elements::{Element, Elements};

/// Returns the pendulum at x = -1, at rest.
pub(crate) fn pendulum() -> Problem {
    let half_turn = std::f64::consts::PI;
    let mechanism = Mechanism {
        bodies: vec![Body {
            name: "pendulum".into(),
            mass: 2.0,
            moment: 0.5,
            start: BodyState {
                x: -0.5,
                angle: half_turn,
                ..BodyState::default()
            },
        }],
        revolutes: vec![Revolute {
            parent: None,
            parent_point: [0.0, 0.0],
            child: 0,
            child_point: [-0.5, 0.0],
        }],
        drivers: Vec::new(),
    };
    let loads = Elements(vec![Element::gravity(&mechanism, [0.0, -9.81])]);
    Problem {
        name: "A01 pendulum".into(),
        mechanism,
        loads,
        read,
    }
}

fn read(observed: &Observation<'_>) -> Vec<f64> {
    let b = observed.bodies[0];
    let (s, c) = b.angle.sin_cos();
    let (ax, ay) = (0.5 * c, 0.5 * s);
    vec![b.x + ax, b.y + ay, b.vx - b.rate * ay, b.vy + b.rate * ax]
}
