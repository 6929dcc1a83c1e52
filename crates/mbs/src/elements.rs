//! Ready-made applied loads: gravity, constant torques, point-to-point springs with dampers.
//!
//! An [`Element`] acts on bodies of a mechanism and reacts on the body (or ground) it is tied to,
//! so that forces and moments balance. [`Elements`] is a list of them and serves as [`Forces`].

use crate::forces::Forces;
use crate::mechanism::Mechanism;
use crate::state::{BodyId, BodyState, Wrench};
use crate::tree::turned;

/// A point of a body, or of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// The body; `None` is the ground.
    pub body: Option<BodyId>,
    /// The point in the body's frame (from its centre of mass), or in the ground's, m.
    pub point: [f64; 2],
}

/// One applied load.
#[derive(Debug, Clone, PartialEq)]
pub enum Element {
    /// The same acceleration on every body.
    Gravity {
        /// m/s^2, e.g. `[0.0, -9.81]`.
        acceleration: [f64; 2],
        /// Masses in body order, kg; see [`Element::gravity`].
        masses: Vec<f64>,
    },
    /// A constant torque on `body`, its reaction on `reaction`.
    Torque {
        /// Who is turned.
        body: BodyId,
        /// Who takes the reaction; `None` is the ground.
        reaction: Option<BodyId>,
        /// N m, counter-clockwise on `body`.
        torque: f64,
    },
    /// A spring with a damper along the line between two points:
    /// the pull is `stiffness (length - free_length) + damping d(length)/dt`.
    Spring {
        /// One end.
        from: Anchor,
        /// The other.
        to: Anchor,
        /// N/m.
        stiffness: f64,
        /// Length without force, m.
        free_length: f64,
        /// N s/m.
        damping: f64,
    },
}

impl Element {
    /// Gravity on every body of `mechanism`; `acceleration` in m/s^2.
    #[must_use]
    pub fn gravity(mechanism: &Mechanism, acceleration: [f64; 2]) -> Self {
        Self::Gravity {
            acceleration,
            masses: mechanism.bodies.iter().map(|b| b.mass).collect(),
        }
    }

    /// Adds this element's loads.
    pub fn apply(&self, bodies: &[BodyState], loads: &mut [Wrench]) {
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
                damping,
            } => {
                let (a, b) = (Placed::of(from, bodies), Placed::of(to, bodies));
                let line = [b.position[0] - a.position[0], b.position[1] - a.position[1]];
                let length = line[0].hypot(line[1]);
                if !(length > 0.0) {
                    return; // no direction to pull in
                }
                let unit = [line[0] / length, line[1] / length];
                let rate = (b.velocity[0] - a.velocity[0]) * unit[0]
                    + (b.velocity[1] - a.velocity[1]) * unit[1];
                let pull = stiffness * (length - free_length) + damping * rate;
                let force = [pull * unit[0], pull * unit[1]];
                a.push(force, loads);
                b.push([-force[0], -force[1]], loads);
            }
        }
    }

    /// Potential energy, J: weight by height of the centres, and what springs hold.
    #[must_use]
    pub fn potential(&self, bodies: &[BodyState]) -> f64 {
        match self {
            Self::Gravity {
                acceleration: [gx, gy],
                masses,
            } => bodies
                .iter()
                .zip(masses)
                .map(|(b, mass)| -mass * (gx * b.x + gy * b.y))
                .sum(),
            // A constant torque between two bodies has the angle between them as its potential.
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
                ..
            } => {
                let (a, b) = (Placed::of(from, bodies), Placed::of(to, bodies));
                let length = (b.position[0] - a.position[0]).hypot(b.position[1] - a.position[1]);
                0.5 * stiffness * (length - free_length).powi(2)
            }
        }
    }
}

/// An anchor in the ground frame.
struct Placed {
    body: Option<BodyId>,
    arm: [f64; 2],
    position: [f64; 2],
    velocity: [f64; 2],
}

impl Placed {
    fn of(anchor: &Anchor, bodies: &[BodyState]) -> Self {
        let Some(k) = anchor.body else {
            return Self {
                body: None,
                arm: [0.0; 2],
                position: anchor.point,
                velocity: [0.0; 2],
            };
        };
        let b = bodies[k];
        let [ax, ay] = turned(anchor.point, b.angle);
        Self {
            body: anchor.body,
            arm: [ax, ay],
            position: [b.x + ax, b.y + ay],
            velocity: [b.vx - b.rate * ay, b.vy + b.rate * ax],
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
pub struct Elements(pub Vec<Element>);

impl Elements {
    /// Potential energy, J.
    #[must_use]
    pub fn potential(&self, bodies: &[BodyState]) -> f64 {
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

/// Kinetic energy of all bodies, J.
#[must_use]
pub fn kinetic_energy(mechanism: &Mechanism, bodies: &[BodyState]) -> f64 {
    mechanism
        .bodies
        .iter()
        .zip(bodies)
        .map(|(body, s)| {
            0.5 * (body.mass * (s.vx * s.vx + s.vy * s.vy) + body.moment * s.rate * s.rate)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::Body;

    fn pair() -> (Mechanism, Vec<BodyState>) {
        let body = |x: f64, y: f64, angle: f64| Body {
            name: "b".into(),
            mass: 1.0 + x.abs(),
            moment: 0.3,
            start: BodyState {
                x,
                y,
                angle,
                vx: 0.2,
                vy: -0.7,
                rate: 1.3,
            },
        };
        let mechanism = Mechanism {
            bodies: vec![body(0.3, -0.1, 0.4), body(-1.0, 0.6, -2.0)],
            ..Mechanism::default()
        };
        let states = mechanism.bodies.iter().map(|b| b.start).collect();
        (mechanism, states)
    }

    fn elements(mechanism: &Mechanism, damping: f64) -> Elements {
        let anchor = |body, x, y| Anchor {
            body,
            point: [x, y],
        };
        let spring = |from, to| Element::Spring {
            from,
            to,
            stiffness: 30.0,
            free_length: 0.4,
            damping,
        };
        Elements(vec![
            Element::gravity(mechanism, [0.3, -9.81]),
            spring(anchor(Some(0), 0.1, 0.2), anchor(Some(1), -0.3, 0.05)),
            spring(anchor(Some(1), 0.2, 0.0), anchor(None, 0.5, 0.5)),
            Element::Torque {
                body: 0,
                reaction: Some(1),
                torque: 2.0,
            },
        ])
    }

    /// Loads are minus the gradient of the potential, for every element and coordinate.
    #[test]
    fn loads_follow_from_the_potential() {
        let (mechanism, states) = pair();
        let mut forces = elements(&mechanism, 0.0);
        let mut loads = vec![Wrench::default(); 2];
        forces.apply(0.0, &states, &mut loads);
        let h = 1e-6;
        for body in 0..2 {
            for axis in 0..3 {
                let at = |sign: f64| {
                    let mut moved = states.clone();
                    let s = &mut moved[body];
                    *[&mut s.x, &mut s.y, &mut s.angle][axis] += sign * h;
                    forces.potential(&moved)
                };
                let expected = -(at(1.0) - at(-1.0)) / (2.0 * h);
                let load = [loads[body].fx, loads[body].fy, loads[body].moment][axis];
                assert!(
                    (load - expected).abs() < 1e-7,
                    "{body} {axis}: {load} {expected}"
                );
            }
        }
    }

    /// A damper takes power out, never in.
    #[test]
    fn dampers_dissipate() {
        let (mechanism, states) = pair();
        let power = |damping| {
            let mut loads = vec![Wrench::default(); 2];
            elements(&mechanism, damping).apply(0.0, &states, &mut loads);
            let one = |(l, s): (&Wrench, &BodyState)| l.fx * s.vx + l.fy * s.vy + l.moment * s.rate;
            loads.iter().zip(&states).map(one).sum::<f64>()
        };
        assert!(power(5.0) < power(0.0));
    }

    /// A spring with a damper takes from two moving, turning bodies what its length and the change of its length say.
    #[test]
    fn dampers_feel_the_change_of_length() {
        let anchor = |body, point| Anchor { body, point };
        let body = |x, y, angle, vx, vy, rate| BodyState {
            x,
            y,
            angle,
            vx,
            vy,
            rate,
        };
        let bodies = [
            body(0.3, -0.2, 0.4, 0.7, -1.1, 2.0),
            body(1.7, 0.9, -0.8, -0.4, 0.6, -3.0),
        ];
        let ends = [anchor(Some(0), [0.2, 0.1]), anchor(Some(1), [-0.3, 0.25])];
        let length = |t: f64| {
            let [a, b] = [0, 1].map(|k| {
                let b = &bodies[k];
                let [x, y] = turned(ends[k].point, b.angle + b.rate * t);
                [b.x + b.vx * t + x, b.y + b.vy * t + y]
            });
            (b[0] - a[0]).hypot(b[1] - a[1])
        };
        let change = (length(1e-5) - length(-1e-5)) / 2e-5;
        for (stiffness, damping) in [(50.0, 0.0), (50.0, 7.0)] {
            let spring = Element::Spring {
                from: ends[0],
                to: ends[1],
                stiffness,
                free_length: 1.0,
                damping,
            };
            let mut loads = [Wrench::default(); 2];
            spring.apply(&bodies, &mut loads);
            let power: f64 = loads
                .iter()
                .zip(&bodies)
                .map(|(l, b)| l.fx * b.vx + l.fy * b.vy + l.moment * b.rate)
                .sum();
            let pull = stiffness * (length(0.0) - 1.0) + damping * change;
            assert!(change.abs() > 0.1 && (power + pull * change).abs() < 1e-6 * power.abs());
            assert!((loads[0].fx.hypot(loads[0].fy) - pull.abs()).abs() < 1e-6 * pull.abs());
        }
        // Ends that coincide are pulled nowhere.
        let spring = Element::Spring {
            from: ends[0],
            to: ends[0],
            stiffness: 50.0,
            free_length: 1.0,
            damping: 7.0,
        };
        let mut loads = [Wrench::default(); 2];
        spring.apply(&bodies, &mut loads);
        assert_eq!(loads, [Wrench::default(); 2]);
    }
}
