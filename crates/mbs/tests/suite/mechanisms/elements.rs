//! Ready-made loads: gravity, constant torques, point-to-point springs.
//!
//! An [`Element`] acts on bodies of a mechanism and reacts on another body (or the ground), so that forces and moments balance.
//! [`Elements`] is a list of them and implements [`Forces`].

use pinwheel_mbs::{BodyId, BodyState, Forces, Mechanism, Wrench};

/// Point of a body, or of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Anchor {
    /// Body of the point; `None` for the ground.
    pub(crate) body: Option<BodyId>,
    /// Point in the body's frame (from its centre of mass), or in the ground's, m.
    pub(crate) point: [f64; 2],
}

/// Applied load.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Element {
    /// Equal acceleration on every body.
    Gravity {
        /// Acceleration, m/s^2, e.g. `[0.0, -9.81]`.
        acceleration: [f64; 2],
        /// Masses in body order, kg; see [`Element::gravity`].
        masses: Vec<f64>,
    },
    /// Constant torque on `body`, with its reaction on `reaction`.
    Torque {
        /// Body that is turned.
        body: BodyId,
        /// Body that takes the reaction; `None` for the ground.
        reaction: Option<BodyId>,
        /// Torque, N m, counter-clockwise on `body`.
        torque: f64,
    },
    /// Spring along the line between two points; the pull is `stiffness (length - free_length)`.
    Spring {
        /// One end.
        from: Anchor,
        /// Other end.
        to: Anchor,
        /// Stiffness, N/m.
        stiffness: f64,
        /// Length without force, m.
        free_length: f64,
    },
}

impl Element {
    /// Returns gravity on every body of `mechanism`; `acceleration` in m/s^2.
    pub(crate) fn gravity(mechanism: &Mechanism, acceleration: [f64; 2]) -> Self {
        Self::Gravity {
            acceleration,
            masses: mechanism.bodies.iter().map(|b| b.mass).collect(),
        }
    }

    /// Adds this element's loads.
    pub(crate) fn apply(&self, bodies: &[BodyState], loads: &mut [Wrench]) {
        match self {
            Self::Gravity {
                acceleration: [gx, gy],
                masses,
            } => {
                for (load, mass) in loads.iter_mut().zip(masses) {
                    load.fx += mass * gx;
                    load.fy += mass * gy;
                }
            }
            Self::Torque {
                body,
                reaction,
                torque,
            } => {
                loads[*body].moment += torque;
                if let Some(other) = reaction {
                    loads[*other].moment -= torque;
                }
            }
            Self::Spring {
                from,
                to,
                stiffness,
                free_length,
            } => {
                let (a, b) = (Placed::of(from, bodies), Placed::of(to, bodies));
                let line = [b.position[0] - a.position[0], b.position[1] - a.position[1]];
                let length = line[0].hypot(line[1]);
                if !(length > 0.0) {
                    return; // no direction to pull in
                }
                let unit = [line[0] / length, line[1] / length];
                let pull = stiffness * (length - free_length);
                let force = [pull * unit[0], pull * unit[1]];
                a.push(force, loads);
                b.push([-force[0], -force[1]], loads);
            }
        }
    }

    /// Returns the potential energy, J: weight by height of the centres, and energy of springs.
    pub(crate) fn potential(&self, bodies: &[BodyState]) -> f64 {
        match self {
            Self::Gravity {
                acceleration: [gx, gy],
                masses,
            } => bodies
                .iter()
                .zip(masses)
                .map(|(b, mass)| -mass * (gx * b.x + gy * b.y))
                .sum(),
            // The potential of a constant torque between two bodies is the angle between them.
            Self::Torque {
                body,
                reaction,
                torque,
            } => -torque * (bodies[*body].angle - reaction.map_or(0.0, |r| bodies[r].angle)),
            Self::Spring {
                from,
                to,
                stiffness,
                free_length,
            } => {
                let (a, b) = (Placed::of(from, bodies), Placed::of(to, bodies));
                let length = (b.position[0] - a.position[0]).hypot(b.position[1] - a.position[1]);
                0.5 * stiffness * (length - free_length).powi(2)
            }
        }
    }
}

/// Anchor in the ground frame.
struct Placed {
    body: Option<BodyId>,
    arm: [f64; 2],
    position: [f64; 2],
}

impl Placed {
    fn of(anchor: &Anchor, bodies: &[BodyState]) -> Self {
        let Some(k) = anchor.body else {
            return Self {
                body: None,
                arm: [0.0; 2],
                position: anchor.point,
            };
        };
        let b = bodies[k];
        let [ax, ay] = turned(anchor.point, b.angle);
        Self {
            body: anchor.body,
            arm: [ax, ay],
            position: [b.x + ax, b.y + ay],
        }
    }

    fn push(&self, [fx, fy]: [f64; 2], loads: &mut [Wrench]) {
        if let Some(k) = self.body {
            let load = &mut loads[k];
            load.fx += fx;
            load.fy += fy;
            load.moment += self.arm[0] * fy - self.arm[1] * fx;
        }
    }
}

/// All loads on a mechanism.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Elements(pub(crate) Vec<Element>);

impl Elements {
    /// Potential energy, J.
    pub(crate) fn potential(&self, bodies: &[BodyState]) -> f64 {
        self.0.iter().map(|e| e.potential(bodies)).sum()
    }
}

impl Forces for Elements {
    fn apply(&mut self, _time: f64, bodies: &[BodyState], loads: &mut [Wrench]) {
        for element in &self.0 {
            element.apply(bodies, loads);
        }
    }
}

/// Returns a point of a body in the ground frame.
pub(crate) fn turned([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (s, c) = angle.sin_cos();
    [c * x - s * y, s * x + c * y]
}
