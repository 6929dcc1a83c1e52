//! Andrews' squeezing mechanism: seven bodies, ten revolutes, a spring and a torque; one degree of freedom.
//!
//! The Test Set uses seven joint angles q = (beta, Theta, gamma, Phi, delta, Omega, epsilon) and six loop equations. The model
//! here has seven bodies in the plane, from which the angles are derived: K1 is at beta, K2 at beta + Theta, K3 at gamma, K4 at
//! delta + Phi, K5 at delta, K6 at epsilon + Omega, K7 at epsilon. K3, K4 and K6 are joined to the end P of K2; the forces
//! there are the Test Set's multipliers. Output: q (7), q' (7), lambda (6).
//! Source: Test Set for Initial Value Problem Solvers, problem "andrews"; [Hairer & Wanner 1996, VII.7].

use pinwheel_mbs::{Body, BodyState, Mechanism, Observation, Revolute};

use super::Problem;
use super::elements::turned;
use super::elements::{Anchor, Element, Elements};

const MASSES: [f64; 7] = [
    0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498,
];
const MOMENTS: [f64; 7] = [
    2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5,
];
const A: [f64; 2] = [-0.06934, -0.00227];
const B: [f64; 2] = [-0.03635, 0.03273];
const C: [f64; 2] = [0.014, 0.072];
/// Spring: N/m and m; torque on K1: N m.
const C0: f64 = 4530.0;
const L0: f64 = 0.07785;
const MOM: f64 = 0.033;
const D: f64 = 0.028;
const DA: f64 = 0.0115;
const E: f64 = 0.02;
const EA: f64 = 0.01421;
const RR: f64 = 0.007;
const RA: f64 = 0.00092;
const SS: f64 = 0.035;
const SA: f64 = 0.01874;
const SB: f64 = 0.01043;
const SC: f64 = 0.018;
const SD: f64 = 0.02;
const TA: f64 = 0.02308;
const TB: f64 = 0.00916;
const U: f64 = 0.04;
const UA: f64 = 0.01228;
const UB: f64 = 0.00449;
const ZF: f64 = 0.02;
const ZT: f64 = 0.04;
const FA: f64 = 0.01421;

/// Consistent angles at rest, to 20 digits.
const START: [f64; 7] = [
    -0.061_713_890_014_276_5,
    0.0,
    0.455_279_819_163_070_4,
    0.222_668_390_165_885_88,
    0.487_364_979_543_842_55,
    -0.222_668_390_165_885_88,
    1.230_547_444_549_821_2,
];

/// End P of K2 in K2's frame, from its joint with K1, and the corresponding ends of the other bodies.
const K1_TIP: [f64; 2] = [RR, 0.0];
const K2_END: [f64; 2] = [-D, 0.0];
const K3_END: [f64; 2] = [0.0, -SS];
const K4_END: [f64; 2] = [0.0, -E];
const K5_TIP: [f64; 2] = [ZT, 0.0];
const K6_END: [f64; 2] = [ZF, 0.0];
const K7_TIP: [f64; 2] = [0.0, -U];

/// Centres of mass, from the same joints as the ends. K3, K5 and K7 turn about the ground, so that only the distance of their
/// centre from there matters.
const CENTRES: [[f64; 2]; 7] = [
    [RA, 0.0],
    [-DA, 0.0],
    [SB, -SA],
    [0.0, EA - E],
    [TA, TB],
    [ZF - FA, 0.0],
    [UB, -UA],
];

/// First of the three revolutes at P: K3, K4 and K6 on K2.
const AT_P: usize = 7;

/// Returns the mechanism at rest.
pub(crate) fn andrews() -> Problem {
    let [be, th, ga, ph, de, om, ep] = START;
    let angles = [be, be + th, ga, de + ph, de, ep + om, ep];
    let add = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
    // Joint at which each body is held: K1 in the origin, K2 at K1's tip, and so on.
    let held = [
        [0.0, 0.0],
        turned(K1_TIP, angles[0]),
        B,
        add(A, turned(K5_TIP, angles[4])),
        A,
        add(A, turned(K7_TIP, angles[6])),
        A,
    ];
    let bodies = (0..7)
        .map(|k| {
            let [x, y] = add(held[k], turned(CENTRES[k], angles[k]));
            Body {
                name: format!("K{}", k + 1),
                mass: MASSES[k],
                moment: MOMENTS[k],
                start: BodyState {
                    x,
                    y,
                    angle: angles[k],
                    ..BodyState::default()
                },
            }
        })
        .collect();
    let from_centre =
        |k: usize, point: [f64; 2]| [point[0] - CENTRES[k][0], point[1] - CENTRES[k][1]];
    let ground = |at: [f64; 2], child: usize| Revolute {
        parent: None,
        parent_point: at,
        child,
        child_point: from_centre(child, [0.0; 2]),
    };
    let joint = |parent: usize, at: [f64; 2], child: usize, end: [f64; 2]| Revolute {
        parent: Some(parent),
        parent_point: from_centre(parent, at),
        child,
        child_point: from_centre(child, end),
    };
    let mechanism = Mechanism {
        bodies,
        revolutes: vec![
            ground([0.0; 2], 0),
            joint(0, K1_TIP, 1, [0.0; 2]),
            ground(B, 2),
            ground(A, 4),
            ground(A, 6),
            joint(4, K5_TIP, 3, [0.0; 2]),
            joint(6, K7_TIP, 5, [0.0; 2]),
            joint(1, K2_END, 2, K3_END),
            joint(1, K2_END, 3, K4_END),
            joint(1, K2_END, 5, K6_END),
        ],
        drivers: Vec::new(),
    };
    let spring = Element::Spring {
        from: Anchor {
            body: None,
            point: C,
        },
        to: Anchor {
            body: Some(2),
            point: from_centre(2, [SD, -SC]),
        },
        stiffness: C0,
        free_length: L0,
    };
    let torque = Element::Torque {
        body: 0,
        reaction: None,
        torque: MOM,
    };
    Problem {
        name: "Andrews' squeezer".into(),
        mechanism,
        loads: Elements(vec![spring, torque]),
        read,
    }
}

fn read(observed: &Observation<'_>) -> Vec<f64> {
    let b = observed.bodies;
    let of = |get: fn(&BodyState) -> f64| {
        let a: Vec<f64> = b.iter().map(get).collect();
        [
            a[0],
            a[1] - a[0],
            a[2],
            a[3] - a[4],
            a[4],
            a[5] - a[6],
            a[6],
        ]
    };
    let mut values: Vec<f64> = of(|s| s.angle).into_iter().chain(of(|s| s.rate)).collect();
    if let Some(reactions) = observed.reactions {
        values.extend(reactions[AT_P..].iter().flatten());
    }
    values
}
