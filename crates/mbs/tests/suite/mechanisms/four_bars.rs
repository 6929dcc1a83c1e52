//! IFToMM benchmark A02: N four-bar linkages in a row, 2N + 1 rods of 1 m and 1 kg.
//!
//! N + 1 cranks are 1 m apart on the ground, and N couplers join their tips. All cranks start upright with the tips at +1 m/s.
//! Once in each half turn all rods are on one line, where N of the constraints depend on the others and the motion may branch;
//! on the branch of parallel cranks
//!
//! ```text
//! theta'' = -(3 (3 N + 1) g / (2 (4 N + 1))) cos(theta),   theta(0) = pi/2, theta'(0) = -1
//! ```
//! Output: x, y, vx, vy of the first crank's tip.
//! Source: IFToMM Technical Committee for Multibody Dynamics, Library of Computational Benchmark Problems, A02.

use pinwheel_mbs::{Body, BodyState, Mechanism, Observation, Revolute};

use super::Problem;
use super::elements::{Element, Elements};

/// Returns a row of `loops` = N >= 1 four-bars.
pub(crate) fn four_bars(loops: usize) -> Problem {
    let upright = std::f64::consts::FRAC_PI_2;
    let rod = |name: String, start: BodyState| Body {
        name,
        mass: 1.0,
        moment: 1.0 / 12.0,
        start,
    };
    let mut mechanism = Mechanism::default();
    for k in 0..=loops {
        let start = BodyState {
            x: k as f64,
            y: 0.5,
            angle: upright,
            vx: 0.5,
            vy: 0.0,
            rate: -1.0,
        };
        mechanism.bodies.push(rod(format!("crank {k}"), start));
        mechanism.revolutes.push(Revolute {
            parent: None,
            parent_point: [k as f64, 0.0],
            child: k,
            child_point: [-0.5, 0.0],
        });
    }
    for k in 0..loops {
        let start = BodyState {
            x: k as f64 + 0.5,
            y: 1.0,
            angle: 0.0,
            vx: 1.0,
            ..BodyState::default()
        };
        let coupler = mechanism.bodies.len();
        mechanism.bodies.push(rod(format!("coupler {k}"), start));
        for (crank, end) in [(k, -0.5), (k + 1, 0.5)] {
            mechanism.revolutes.push(Revolute {
                parent: Some(crank),
                parent_point: [0.5, 0.0],
                child: coupler,
                child_point: [end, 0.0],
            });
        }
    }
    let loads = Elements(vec![Element::gravity(&mechanism, [0.0, -9.81])]);
    Problem {
        name: format!("A02 {loops} four-bars"),
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
