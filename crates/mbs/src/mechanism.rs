//! Planar mechanism as data: rigid bodies, revolute joints, drivers.
//!
//! Conventions (paper, Eq. 3-9): ground frame x right, y up, angles counter-clockwise; body coordinates are the position of the
//! centre of mass and the angle. A revolute joins a point of a *parent* (body 1, or ground) to a point of a *child* (body 2):
//! `Phi = r_child - r_parent = 0`. Its multiplier is the force **on the child** at the joint; the opposite force acts on the
//! parent. A driver prescribes `angle_child - angle_parent = f(t)`; its multiplier is the torque **on the child**.

use serde::{Deserialize, Serialize};

use crate::{BodyId, BodyState};

/// Rigid body with its initial state.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name in messages.
    pub name: String,
    /// Mass, kg, > 0.
    pub mass: f64,
    /// Moment of inertia about the centre of mass, kg m^2, > 0.
    pub moment: f64,
    /// State at t = 0.
    pub start: BodyState,
}

/// Revolute joint without friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Revolute {
    /// Body 1; `None` for the ground, in whose frame the point is then given.
    pub parent: Option<BodyId>,
    /// Position of the joint in the parent's frame (from its centre of mass), m.
    pub parent_point: [f64; 2],
    /// Body 2.
    pub child: BodyId,
    /// Position of the joint in the child's frame (from its centre of mass), m.
    pub child_point: [f64; 2],
}

/// Prescribed motion f(t) = angle + rate (t - from) + acceleration (t - from)^2/2.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Motion {
    /// Start time, s.
    pub from_s: f64,
    /// Angle f(from), rad.
    pub angle: f64,
    /// Rate f'(from), rad/s.
    pub rate: f64,
    /// Acceleration f'', rad/s^2.
    pub acceleration: f64,
}

impl Motion {
    /// Returns f, f' and f'' at `t`.
    #[inline]
    pub fn at(&self, t: f64) -> (f64, f64, f64) {
        let t = t - self.from_s;
        (
            self.angle + t * (self.rate + 0.5 * t * self.acceleration),
            self.rate + t * self.acceleration,
            self.acceleration,
        )
    }
}

/// Driver: prescribed relative rotation (Eq. 4).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Driver {
    /// Reference body of the angle; `None` for the ground.
    pub parent: Option<BodyId>,
    /// Driven body.
    pub child: BodyId,
    /// Prescribed angle, in the present segment.
    pub motion: Motion,
    /// Motions of all segments, beginning with the start; empty if `motion` applies at all times.
    pub segments: Vec<Motion>,
}

/// Reason why a mechanism cannot be solved.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MechanismError {
    /// A joint refers to a body that does not exist, or joins a body to itself.
    #[error("{joint} refers to body {body}, which does not exist or is its own partner")]
    Body {
        /// Name of the joint, e.g. `revolute 3`.
        joint: String,
        /// Index in the joint.
        body: usize,
    },
    /// A mass, moment, point or motion that is not finite or not positive.
    #[error("{what} must be finite and, for masses and moments, positive")]
    Value {
        /// Name of the value.
        what: String,
    },
    /// Constraints that exceed the coordinates, contradict each other, or repeat one.
    #[error("constraints are redundant: {constraint} adds nothing to the others")]
    Redundant {
        /// Number of the first constraint that depends on the others.
        constraint: String,
    },
    /// The exact elimination does not apply, for the given reason.
    #[error("the reduced form needs centre-pinned bodies: {0}; use the Lagrange form")]
    NotReducible(String),
}

/// Bodies and their joints.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mechanism {
    /// All bodies except the ground.
    pub bodies: Vec<Body>,
    /// All revolutes.
    pub revolutes: Vec<Revolute>,
    /// All drivers.
    pub drivers: Vec<Driver>,
}

impl Mechanism {
    /// Returns the number of scalar constraints: two for each revolute, one for each driver.
    pub fn constraints(&self) -> usize {
        2 * self.revolutes.len() + self.drivers.len()
    }

    /// Returns child and parent of every revolute, then of every driver.
    pub(crate) fn ends(&self) -> Vec<(BodyId, Option<BodyId>)> {
        let joints = self.revolutes.iter().map(|j| (j.child, j.parent));
        let drivers = self.drivers.iter().map(|d| (d.child, d.parent));
        joints.chain(drivers).collect()
    }

    /// Returns the kinetic energy of the bodies in the given states, J.
    pub fn kinetic_j(&self, states: &[BodyState]) -> f64 {
        let of = |(body, v): (&Body, &BodyState)| {
            body.mass * (v.vx * v.vx + v.vy * v.vy) + body.moment * v.rate * v.rate
        };
        0.5 * self.bodies.iter().zip(states).map(of).sum::<f64>()
    }

    /// Switches the drivers to the segment that begins at `from`, s ([`OdeSystem::restart_at`](crate::OdeSystem::restart_at)).
    pub(crate) fn restart_at(&mut self, from: f64) {
        for driver in &mut self.drivers {
            if let Some(&begun) = driver.segments.iter().rfind(|m| m.from_s <= from) {
                driver.motion = begun;
            }
        }
    }

    /// Checks indices and values.
    ///
    /// # Errors
    /// Returns the first fault as an error.
    pub fn check(&self) -> Result<(), MechanismError> {
        let n = self.bodies.len();
        let value = |what: String| Err(MechanismError::Value { what });
        let ends = |joint: String, parent: Option<BodyId>, child: BodyId| {
            let bad = |body| {
                Err(MechanismError::Body {
                    joint: joint.clone(),
                    body,
                })
            };
            match parent {
                _ if child >= n => bad(child),
                Some(p) if p >= n || p == child => bad(p),
                _ => Ok(()),
            }
        };
        for body in &self.bodies {
            let positive = body.mass > 0.0 && body.moment > 0.0;
            if !(positive && body.mass.is_finite() && body.moment.is_finite()) {
                return value(format!("mass and moment of `{}`", body.name));
            }
        }
        for (k, joint) in self.revolutes.iter().enumerate() {
            ends(format!("revolute {k}"), joint.parent, joint.child)?;
            let points = [joint.parent_point, joint.child_point];
            if !points.iter().flatten().all(|x| x.is_finite()) {
                return value(format!("points of revolute {k}"));
            }
        }
        for (k, driver) in self.drivers.iter().enumerate() {
            ends(format!("driver {k}"), driver.parent, driver.child)?;
            for m in driver.segments.iter().chain([&driver.motion]) {
                let numbers = [m.from_s, m.angle, m.rate, m.acceleration];
                if !numbers.iter().all(|x| x.is_finite()) {
                    return value(format!("motion of driver {k}"));
                }
            }
        }
        Ok(())
    }
}
