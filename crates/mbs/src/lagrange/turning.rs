//! Arms of revolutes that rotate with their bodies, and the last state projected onto the constraints.

use nalgebra::Vector3;

use crate::mechanism::{Mechanism, Revolute};
use crate::state::BodyId;
use crate::tree::Arms;

/// Arm of a revolute on a body.
#[derive(Debug, Clone, Copy)]
struct Arm {
    revolute: usize,
    /// True if the body is the revolute's child, else its parent.
    child: bool,
    /// Point on the body, m.
    point: [f64; 2],
}

/// Body with its arms; arms on the ground are fixed, and a joint at a centre of mass has none.
#[derive(Debug, Clone)]
pub(super) struct Turning {
    pub(super) body: BodyId,
    arms: Vec<Arm>,
}

/// Returns the fixed arms of a revolute; others are 0.
pub(super) fn at_rest(joint: &Revolute) -> Arms {
    let parent = match joint.parent {
        None => joint.parent_point,
        Some(_) => [0.0; 2],
    };
    Arms {
        parent,
        child: [0.0; 2],
    }
}

impl Turning {
    /// Returns all bodies with rotating arms.
    pub(super) fn of(mechanism: &Mechanism) -> Vec<Self> {
        let arms_of = |body: BodyId| {
            let mut arms = Vec::new();
            for (revolute, j) in mechanism.revolutes.iter().enumerate() {
                let child_end = (Some(j.child), true, j.child_point);
                for (of, child, point) in [child_end, (j.parent, false, j.parent_point)] {
                    if of == Some(body) && point != [0.0; 2] {
                        arms.push(Arm {
                            revolute,
                            child,
                            point,
                        });
                    }
                }
            }
            arms
        };
        let all = (0..mechanism.bodies.len()).map(|body| Self {
            body,
            arms: arms_of(body),
        });
        all.filter(|turning| !turning.arms.is_empty()).collect()
    }

    /// Sets the arms for the body's `angle`.
    #[inline]
    pub(super) fn rotate(&self, angle: f64, arms: &mut [Arms]) {
        let (s, c) = angle.sin_cos();
        for arm in &self.arms {
            let ([x, y], arms) = (arm.point, &mut arms[arm.revolute]);
            let turned = [c * x - s * y, s * x + c * y];
            *(if arm.child {
                &mut arms.child
            } else {
                &mut arms.parent
            }) = turned;
        }
    }

    /// Adds the arms' terms to gamma; `squared` is the square of the body's rate.
    #[inline]
    pub(super) fn add_gamma(&self, squared: f64, arms: &[Arms], gammas: &mut [Vector3<f64>]) {
        for arm in &self.arms {
            let arms = arms[arm.revolute];
            let ([x, y], squared) = if arm.child {
                (arms.child, squared)
            } else {
                (arms.parent, -squared)
            };
            let gamma = &mut gammas[arm.revolute];
            (gamma.x, gamma.y) = (gamma.x + squared * x, gamma.y + squared * y);
        }
    }
}

/// State last projected onto the constraints, if bodies and arms still have it.
#[derive(Debug, Clone)]
pub(super) struct Projected {
    pub(super) valid: bool,
    time: f64,
    y: Vec<f64>,
}

impl Projected {
    pub(super) fn new(dimension: usize) -> Self {
        Self {
            valid: false,
            time: 0.0,
            y: vec![0.0; dimension],
        }
    }

    pub(super) fn set(&mut self, time: f64, y: &[f64]) {
        (self.valid, self.time) = (true, time);
        self.y.copy_from_slice(y);
    }

    pub(super) fn is(&self, time: f64, y: &[f64]) -> bool {
        // All components are compared, because without an early exit the comparison processes several at a time.
        let same = |all: bool, (a, b): (&f64, &f64)| all & (a == b);
        self.valid && self.time == time && self.y.iter().zip(y).fold(true, same)
    }
}
