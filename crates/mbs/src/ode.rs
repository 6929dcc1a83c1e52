//! Interface between integrators and systems: the facts that an integrator needs, and the state that a formulation
//! gives.

use crate::jacobian::{Jacobian, Structure};
use crate::{BodyState, ContactEnergy, Wrench};

/// y' = f(t, y).
pub trait OdeSystem {
    /// Length of y.
    fn dimension(&self) -> usize;

    /// Writes f(t, y). A state that cannot be evaluated gives NaN, never a panic.
    fn derivative(&mut self, t: f64, y: &[f64], dydt: &mut [f64]);

    /// Writes f(t, y) of the state at the end of a step, which is observed next if it is `sampled`
    /// ([`Formulation::observe`]) and may be otherwise ([`Formulation::cached_observation`]): both may share the evaluation.
    fn derivative_at_end(&mut self, t: f64, y: &[f64], _sampled: bool, dydt: &mut [f64]) {
        self.derivative(t, y, dydt);
    }

    /// One stage of a method that treats a stiff part of f = e + i implicitly: solves
    /// `y = y* + a i(t, y)` in place (`y` holds y*), then writes e and i at the solution.
    ///
    /// `i` holds a guess of itself on entry, which a solution by iteration begins with; with a = 0 it is not read.
    /// By default nothing is stiff and everything is e. What cannot be solved gives NaN.
    fn split_stage(&mut self, t: f64, _a: f64, y: &mut [f64], e: &mut [f64], i: &mut [f64]) {
        self.derivative(t, y, e);
        i.fill(0.0);
    }

    /// How f depends on y, for methods that solve with df/dy; by default nothing is known.
    ///
    /// [`Structure::SecondOrder`] promises that the first half of f is the second half of y.
    fn structure(&self) -> Structure {
        Structure::FirstOrder
    }

    /// Adds df/dy and df/dt at (t, y) to `jacobian`, which has this system's [`structure`](Self::structure) and holds 0.
    ///
    /// False, the default, and nothing was added: the derivatives are not known, and methods take differences. They must be
    /// exact: Rosenbrock methods lose their order with the digits of the Jacobian.
    fn jacobian(&mut self, _t: f64, _y: &[f64], _jacobian: &mut Jacobian) -> bool {
        false
    }

    /// True if the stiffest springs stay closed and turn with the mechanism. Terms that the linear part leaves out then
    /// oscillate as fast as the linear part.
    fn has_turning_springs(&self) -> bool {
        false
    }

    /// Size of an error in each component that counts as 1, for methods that choose their steps:
    /// by default the component itself, but at least 1.
    fn scale(&self, y: &[f64], scale: &mut [f64]) {
        own_scale(y, scale);
    }

    /// Puts an accepted state back onto the invariants the system keeps; by default there are none.
    ///
    /// f must not change by it: who evaluates f of a state sees it on the invariants already.
    fn project(&mut self, _t: f64, _y: &mut [f64]) {}

    /// From now on f is that of the segment which begins at `from` (s), wherever it is asked for, until the next call.
    ///
    /// At a time where f jumps it has two values: the segment that ends there has the one, the segment that begins there
    /// the other. By default f has no jumps.
    fn restart_at(&mut self, _from: f64) {}
}

/// The components themselves, but at least 1.
pub(crate) fn own_scale(y: &[f64], scale: &mut [f64]) {
    for (scale, y) in scale.iter_mut().zip(y) {
        *scale = y.abs().max(1.0);
    }
}

/// Errors that count as 1 in each kind of component, for methods that choose their steps. A stiff
/// mechanism deforms by far less than its coordinates, so their size says little of what matters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorScales {
    /// Scale of positions, m.
    pub length: f64,
    /// Scale of angles, rad.
    pub angle: f64,
    /// Rate of change that counts as 1 s^-1 of either: speeds and angular velocities are scaled by
    /// `length` and `angle` times this.
    pub frequency: f64,
}

/// Detail of an observation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// Without joint reactions, and positions and velocities of bodies that others carry, which may be of another time.
    Forces,
    /// All.
    Everything,
}

/// Poses, loads, reactions and energies of one state.
#[derive(Debug, Clone, Copy)]
pub struct Observation<'a> {
    /// Time, s.
    pub time: f64,
    /// All bodies.
    pub bodies: &'a [BodyState],
    /// Applied loads on all bodies.
    pub loads: &'a [Wrench],
    /// Moments about the pins by body, N m: its own load's, and those of all that it carries. `None` where the formulation does
    /// not know them.
    pub moments: Option<&'a [f64]>,
    /// Kinetic energy of all bodies, J.
    pub kinetic_j: f64,
    /// Torque of each driver on its child, N m.
    pub driver_torques: &'a [f64],
    /// Energy of the contacts; `None` where the forces do not tell it.
    pub energy: Option<ContactEnergy>,
    /// Force of each revolute on its child, N; `None` where the formulation does not know them.
    pub reactions: Option<&'a [[f64; 2]]>,
}

/// Equations of motion of a mechanism in some coordinates.
pub trait Formulation: OdeSystem {
    /// State at t = 0.
    fn initial(&self) -> Vec<f64>;

    /// Evaluates the state at (t, y).
    fn observe(&mut self, t: f64, y: &[f64], detail: Detail) -> Observation<'_>;

    /// Returns the observation of the forces at (t, y), if it takes no new evaluation: the last one was
    /// [`OdeSystem::derivative_at_end`].
    fn cached_observation(&mut self, _t: f64, _y: &[f64]) -> Option<Observation<'_>> {
        None
    }

    /// Ends of steps that are not sampled are observed from this time on, s.
    fn observe_from(&mut self, _t: f64) {}

    /// Velocities integrated.
    fn degrees_of_freedom(&self) -> usize;

    /// Newton steps of all implicit stages so far, samples inside steps included.
    fn newton_steps(&self) -> u64 {
        0
    }

    /// Largest position error of any joint at y, m.
    fn joint_error(&mut self, t: f64, y: &[f64]) -> f64;
}
