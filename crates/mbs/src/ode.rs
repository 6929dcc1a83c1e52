//! Interface between integrators and systems: functions for integrators, and observations of a formulation.

use crate::jacobian::{Jacobian, Structure};
use crate::{BodyState, ContactEnergy, Wrench};

/// System y' = f(t, y).
pub trait OdeSystem {
    /// Returns the length of y.
    fn dimension(&self) -> usize;

    /// Writes f(t, y). A state that cannot be evaluated gives NaN, never a panic.
    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]);

    /// Writes f(t, y) of the state at the end of a step. A `sampled` state is observed next ([`Formulation::observe`]), any
    /// other may be ([`Formulation::cached_observation`]); both may share the evaluation.
    fn derivative_at_end(&mut self, t: f64, y: &[f64], _sampled: bool, dydt: &mut [f64]) {
        self.derivative(t, y, dydt);
    }

    /// Solves one stage of a method that treats a stiff part of f = e + i implicitly: solves `y = y* + a i(t, y)` in place (`y`
    /// is y* on entry), then writes e and i at the solution.
    ///
    /// On entry `i` is the first estimate for an iterative solution; it is not read if a = 0. By default no part is stiff, and
    /// e is all of f. Without a solution the results are NaN.
    fn split_stage(&mut self, t: f64, _a: f64, y: &mut [f64], e: &mut [f64], i: &mut [f64]) {
        self.derivative(t, y, e);
        i.fill(0.0);
    }

    /// Returns the structure of the dependence of f on y, for methods that solve with df/dy; by default it is unknown.
    ///
    /// [`Structure::SecondOrder`] promises that the first half of f is the second half of y.
    fn structure(&self) -> Structure {
        Structure::FirstOrder
    }

    /// Adds df/dy and df/dt at (t, y) to `jacobian`, which has this system's [`structure`](Self::structure) and is 0 on entry.
    ///
    /// Returns false, the default, if no derivatives are available: nothing is added, and methods use differences. Derivatives
    /// must be exact: Rosenbrock methods lose their order with the digits of the Jacobian.
    fn jacobian(&mut self, _t: f64, _y: &[f64], _jacobian: &mut Jacobian) -> bool {
        false
    }

    /// True if the stiffest springs are always engaged and rotate with the mechanism. Terms omitted by the linear part then
    /// oscillate as fast as it does.
    fn has_turning_springs(&self) -> bool {
        false
    }

    /// Writes the scale of the error of each component, for methods that choose their steps: by default the magnitude of the
    /// component, but at least 1.
    fn scale(&self, y: &[f64], scale: &mut [f64]) {
        own_scale(y, scale);
    }

    /// Projects an accepted state onto the invariants of the system; by default there are none.
    ///
    /// The projection must not change f, which is always evaluated on the invariants.
    fn project(&mut self, _t: f64, _y: &mut [f64]) {}

    /// Switches f to the segment that begins at `from` (s), for all times until the next call.
    ///
    /// At a jump f has two values: one belongs to the segment that ends there, the other to the segment that begins there. By
    /// default f has no jumps.
    fn restart_at(&mut self, _from: f64) {}
}

/// Writes the magnitudes of the components, at least 1, as scales.
pub(crate) fn own_scale(y: &[f64], scale: &mut [f64]) {
    for (scale, y) in scale.iter_mut().zip(y) {
        *scale = y.abs().max(1.0);
    }
}

/// Scales of errors by kind of component, for methods that choose their steps. The deformation of a stiff mechanism is far
/// smaller than its coordinates, so that their magnitude is no measure of relevant errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorScales {
    /// Scale of positions, m.
    pub length: f64,
    /// Scale of angles, rad.
    pub angle: f64,
    /// Scale of rates, 1/s: speeds and angular velocities have `length` and `angle` times this.
    pub frequency: f64,
}

/// Detail of an observation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// Forces without joint reactions; positions and velocities of carried bodies may be of another time.
    Forces,
    /// All quantities.
    Everything,
}

/// Poses, loads, reactions and energies of one state.
#[derive(Debug, Clone, Copy)]
pub struct Observation<'a> {
    /// Time, s.
    pub time: f64,
    /// States of all bodies.
    pub bodies: &'a [BodyState],
    /// Applied loads on all bodies.
    pub loads: &'a [Wrench],
    /// Moments about the pins by body, N m, of its own load and of the loads of all bodies that it carries; `None` if not
    /// available.
    pub moments: Option<&'a [f64]>,
    /// Kinetic energy of all bodies, J.
    pub kinetic_j: f64,
    /// Torque of each driver on its child, N m.
    pub driver_torques: &'a [f64],
    /// Energy of the contacts; `None` if the forces do not provide it.
    pub energy: Option<ContactEnergy>,
    /// Force of each revolute on its child, N; `None` if not available.
    pub reactions: Option<&'a [[f64; 2]]>,
}

/// Equations of motion of a mechanism in some coordinates.
pub trait Formulation: OdeSystem {
    /// Returns the state at t = 0.
    fn initial(&self) -> Vec<f64>;

    /// Evaluates the state at (t, y).
    fn observe(&mut self, t: f64, y: &[f64], detail: Detail) -> Observation<'_>;

    /// Returns the observation of the forces at (t, y) if it requires no new evaluation, because the last one was
    /// [`OdeSystem::derivative_at_end`].
    fn cached_observation(&mut self, _t: f64, _y: &[f64]) -> Option<Observation<'_>> {
        None
    }

    /// Sets the time, s, from which ends of steps without a sample are observed, too.
    fn observe_from(&mut self, _t: f64) {}

    /// Returns the number of integrated velocities.
    fn degrees_of_freedom(&self) -> usize;

    /// Returns the number of Newton steps of all implicit stages so far, samples inside steps included.
    fn newton_steps(&self) -> u64 {
        0
    }

    /// Returns the largest position error of any joint at y, m.
    fn joint_error(&mut self, t: f64, y: &[f64]) -> f64;
}
