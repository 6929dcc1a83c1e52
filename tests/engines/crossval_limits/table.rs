//! Table of limits, each with its scope, the measured value, and the reason: a measured value times a margin.
//!
//! They are valid for the presets of the measurement. Patterns: `*` matches any characters, `|` separates alternatives. The
//! first row that matches a pair, window, quantity and metric applies, so stricter conditions come first.

use pinwheel_compare::limits::Friction;
use pinwheel_compare::{Metric, WindowKind};
use pinwheel_timeseries::columns;

/// Row of the table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limit {
    /// Pattern of the model that the pair shares (`SharedModel`).
    pub(crate) track: &'static str,
    /// One engine, a pattern.
    pub(crate) engine: &'static str,
    /// The other engine, a pattern; pairs match in either order. Unused by one-engine metrics.
    pub(crate) against: &'static str,
    /// Frictionless scenes, those with friction, or all.
    pub(crate) friction: Friction,
    /// Largest step of `engine`, s; `None` for any.
    pub(crate) step_at_most_s: Option<f64>,
    /// Largest step of `against`, s; `None` for any.
    pub(crate) against_step_at_most_s: Option<f64>,
    /// Window.
    pub(crate) window: WindowKind,
    /// Quantity, a pattern.
    pub(crate) quantity: &'static str,
    /// Metric.
    pub(crate) metric: Metric,
    /// Limit of the metric.
    pub(crate) limit: f64,
    /// Measured value at the time of setting; `None` before that.
    pub(crate) measured: Option<f64>,
    /// Reason for the limit.
    pub(crate) reason: &'static str,
}

/// One row per line of the table below, its reason on a second.
macro_rules! rows {
    ($($track:literal, $engine:literal, $step:expr, $against:literal, $against_step:expr,
       $friction:ident, $window:ident, $quantity:expr, $metric:ident,
       $limit:literal, $measured:expr, $reason:literal;)*) => {
        &[$(Limit {
            track: $track,
            engine: $engine,
            step_at_most_s: $step,
            against: $against,
            against_step_at_most_s: $against_step,
            friction: Friction::$friction,
            window: WindowKind::$window,
            quantity: $quantity,
            metric: Metric::$metric,
            limit: $limit,
            measured: $measured,
            reason: $reason,
        },)*]
    };
}

/// Columns that every engine of a gearbox records.
const CONTRACT: &str = "*_sleeve_force_n|input_torque_n_m|output_torque_n_m|output_angle_rad";

/// Columns of [`CONTRACT`], and channels that follow the forces as closely (measured: never twice as far apart). It
/// excludes quotients by a power that passes through zero (efficiency), small differences of large numbers (relative
/// velocities, losses, the shafts' bearings between discs in phase), counts, and friction on single pairs.
const FOLLOWING: &str = "*_sleeve_force_n|input_torque_n_m|output_torque_n_m|output_angle_rad|*_arcmin|\
     eccentric_bearing_*|*_pin_force_*|input_power_w|wheel_*_penetration_m|wheel_*_stiffness_n_m15|\
     wheel_*_contact_x_m|wheel_*_contact_y_m|wheel_*_normal_force_n";

/// Table of limits. Columns: track, engine, its largest step, against, its largest step, friction, window, quantity,
/// metric, limit, measured; then the reason.
pub(crate) const TABLE: &[Limit] = rows! {
    // Native formulations against each other.
    "native", "native*lagrange*|native*reduced*", None, "native*lagrange*|native*reduced*", None, Without, Transient, FOLLOWING, RelativeL2, 1e-9, Some(1.5e-13),
    "The same equations, step and method; the elimination is exact, so only rounding parts them.";
    "native", "native*lagrange*|native*reduced*", None, "native*lagrange*|native*reduced*", None, Without, Steady, FOLLOWING, RelativeL2, 1e-7, Some(2e-12),
    "Rounding grows along the run; the frictionless gear is periodic, so it does not grow without bound.";

    // The scene's integrator against the resolved run: the error of its step.
    "native", "native-resolved", None, "native*lagrange*|native*reduced*", Some(1.001e-5), Without, Steady, FOLLOWING, RelativeL2, 1e-3, Some(2.4e-4),
    "Heun's own error at 1e-5 s, the paper's method and step, times 4: it grows with backlash.";
    "native", "native-resolved", None, "native*lagrange*|native*reduced*", Some(1.001e-5), Without, Transient, FOLLOWING, RelativeL2, 3e-2, Some(5.5e-3),
    "Heun's own error at 1e-5 s while the start-up rings at 1.2 kHz, times 5: 2.4e-2 with 0.6 mm of backlash.";

    // rapier, shared law.
    "shared-law", "rapier*", Some(1.001e-5), "native-resolved", None, Without, Steady, FOLLOWING, RelativeL2, 1e-4, Some(5.9e-5),
    "Measured 5.9e-5 at 1e-5 s, all of it the leapfrog's own error.";
    "shared-law", "rapier*", Some(2.001e-6), "native-resolved", None, Without, Transient, FOLLOWING, RelativeL2, 2e-4, Some(7.5e-5),
    "Measured 7.5e-5 at 2e-6 s, the leapfrog's own error; the start-up rings at 1.2 kHz.";
    "shared-law", "rapier*", Some(1.001e-5), "native-resolved", None, Without, Transient, FOLLOWING, RelativeL2, 4e-3, Some(1.9e-3),
    "Second order from the figure at 2e-6 s: 25 times 7.5e-5 is 1.9e-3, times 2.";
    "shared-law", "rapier*", Some(1.001e-5), "native*", Some(1.001e-5), Without, Steady, FOLLOWING, RelativeL2, 4e-4, Some(1.8e-4),
    "Two errors of the step add up, of which Heun's is the larger (see native-resolved); times 2.";
    "shared-law", "rapier*", Some(1.001e-5), "native*", Some(1.001e-5), Without, Transient, FOLLOWING, RelativeL2, 1e-2, Some(3.9e-3),
    "Two errors of the step add up, of which Heun's is the larger (see native-resolved); times 2.5.";

    // rapier, contact hook: exact normals and depths, rapier's own solver and Coulomb friction.
    "own-contact", "rapier*hook*", Some(1.001e-5), "native-resolved", None, With, Steady, CONTRACT, RelativeL2, 2e-3, Some(1.2e-3),
    "Implicit Coulomb friction at 1e-5 s against a native run that resolves the friction.";
    "own-contact", "rapier*hook*", Some(1.001e-5), "native-resolved", None, Without, Steady, FOLLOWING, RelativeL2, 2e-4, Some(5.9e-5),
    "Without friction rapier's solver hands our normal force on: the leapfrog's own error is left.";
    "own-contact", "rapier*hook*", Some(1.001e-5), "native*", Some(1.001e-5), Without, Steady, FOLLOWING, RelativeL2, 4e-4, Some(1.8e-4),
    "Two errors of the step add up, of which Heun's is the larger (see native-resolved); times 2.";

    // exudyn and MuJoCo, shared law. Explicit: hinges as coordinates, Runge-Kutta 4 at the scene's step.
    "shared-law", "mujoco*|exudyn*explicit", Some(1.001e-5), "mujoco*|exudyn*explicit", Some(1.001e-5), Without, Steady, "*", RelativeL2, 1e-7, Some(2.3e-9),
    "The same method in two programs: rounding, and the nine digits of a recording.";
    "shared-law", "mujoco*|exudyn*explicit", Some(1.001e-5), "mujoco*|exudyn*explicit", Some(1.001e-5), Without, Transient, "*", RelativeL2, 1e-7, Some(2.3e-9),
    "The same method in two programs: rounding, and the nine digits of a recording.";
    "shared-law", "mujoco*|exudyn*explicit", Some(1.001e-5), "native-resolved", None, Without, Steady, "*", RelativeL2, 1e-6, Some(2.5e-7),
    "Runge-Kutta 4's own error at 1e-5 s: 3.9e-8 for the paper's gear, 2.5e-7 with 0.6 mm of backlash, times 4.";
    "shared-law", "mujoco*|exudyn*explicit", Some(1.001e-5), "native-resolved", None, Without, Transient, "*", RelativeL2, 2e-4, Some(7.4e-5),
    "Runge-Kutta 4's own error at 1e-5 s: 7.4e-6 for the paper's gear, 7.4e-5 with 0.6 mm of backlash, times 2.7.";
    "shared-law", "mujoco*|exudyn*explicit", Some(1.001e-5), "native*", Some(1.001e-5), Without, Steady, "*", RelativeL2, 1e-3, Some(2.4e-4),
    "Heun's error at 1e-5 s, the paper's method and step, is all of it (see native-resolved); times 4.";
    "shared-law", "mujoco*|exudyn*explicit", Some(1.001e-5), "native*", Some(1.001e-5), Without, Transient, "*", RelativeL2, 5e-2, Some(2.9e-2),
    "Heun's error at 1e-5 s is all of it: 5.1e-3 for the paper's gear, 2.9e-2 with 0.6 mm of backlash; times 1.7.";

    // exudyn, constrained: 28 bodies, 29 joints, multipliers; the implicit trapezoidal rule.
    "shared-law", "exudyn*constrained", Some(1.001e-5), "native-resolved", None, Without, Steady, "*", RelativeL2, 5e-4, Some(1.2e-4),
    "The trapezoidal rule's own error at 1e-5 s: a quarter at half the step; times 4.";
    "shared-law", "exudyn*constrained", Some(1.001e-5), "native-resolved", None, Without, Transient, "*", RelativeL2, 3e-2, Some(1.4e-2),
    "The trapezoidal rule's own error at 1e-5 s: 2.8e-3 for the paper's gear, 1.4e-2 with 0.6 mm of backlash; times 2.";
    "shared-law", "exudyn*constrained", Some(1.001e-5), "native*", Some(1.001e-5), Without, Steady, "*", RelativeL2, 1.5e-3, Some(3.6e-4),
    "The trapezoidal rule's error and Heun's add up; times 4.";
    "shared-law", "exudyn*constrained", Some(1.001e-5), "native*", Some(1.001e-5), Without, Transient, "*", RelativeL2, 8e-2, Some(4.3e-2),
    "The trapezoidal rule's error and Heun's add up: 7.9e-3 for the paper's gear, 4.3e-2 with 0.6 mm of backlash; times 1.9.";

    "shared-law", "exudyn*constrained", Some(1.001e-5), "native-resolved", None, With, Steady, "*", RelativeL2, 3e-4, Some(7.2e-5),
    "Implicit friction at 1e-5 s against a native run that resolves it; times 4.";
    "shared-law", "exudyn*constrained", Some(1.001e-5), "native-resolved", None, With, Transient, "*", RelativeL2, 2e-3, Some(6.3e-4),
    "Implicit friction at 1e-5 s against a native run that resolves it; times 3.";

    // Simbody and SUNDIALS IDA, shared law: steps by error control at a tolerance of 1e-6.
    "shared-law", "simbody*", None, "native-resolved", None, Without, Steady, "*", RelativeL2, 5e-6, Some(1.2e-6),
    "Its error at this tolerance: 1.8e-7 for the paper's gear, 1.2e-6 for steel; times 4.";
    "shared-law", "simbody*", None, "native-resolved", None, Without, Transient, "*", RelativeL2, 4e-6, Some(9.7e-7),
    "Its error at this tolerance: 3.0e-7 for the paper's gear, 9.7e-7 for eleven pins; times 4.";
    "shared-law", "simbody*", None, "native-resolved", None, With, Steady, "*", RelativeL2, 3e-6, Some(2.7e-7),
    "Below what native-resolved states of itself under friction, 5e-7 in the forces and 2.1e-6 in the driver torque: times 1.4 of that.";
    "shared-law", "simbody*", None, "native-resolved", None, With, Transient, "*", RelativeL2, 1e-5, Some(1.6e-6),
    "Below what native-resolved states of itself under friction, 6.3e-6 over the first 0.01 s: times 1.6 of that.";
    "shared-law", "ida*", None, "native-resolved", None, Without, Steady, "*", RelativeL2, 2e-4, Some(4.8e-5),
    "BDF's error at this tolerance: 2.6e-6 for the paper's gear, 4.8e-5 for steel, whose ringing it damps; times 4.";
    "shared-law", "ida*", None, "native-resolved", None, Without, Transient, "*", RelativeL2, 1.5e-3, Some(3.7e-4),
    "BDF's error at this tolerance: 5.8e-6 for the paper's gear, 3.7e-4 for steel, whose ringing it damps; times 4.";
    "shared-law", "ida*", None, "native-resolved", None, With, Steady, "*", RelativeL2, 1.2e-5, Some(3.1e-6),
    "BDF's error at this tolerance, friction included; times 4.";
    "shared-law", "ida*", None, "native-resolved", None, With, Transient, "*", RelativeL2, 2e-5, Some(4.8e-6),
    "BDF's error at this tolerance, friction included; times 4.";
    "shared-law", "simbody*|ida*", None, "native*", Some(1.001e-5), Without, Steady, "*", RelativeL2, 1e-3, Some(2.4e-4),
    "Heun's error at 1e-5 s, the paper's method and step, is all of it (see native-resolved); times 4.";
    "shared-law", "simbody*|ida*", None, "native*", Some(1.001e-5), Without, Transient, "*", RelativeL2, 5e-2, Some(2.9e-2),
    "Heun's error at 1e-5 s is all of it: 5.1e-3 for the paper's gear, 2.9e-2 with 0.6 mm of backlash; times 1.7.";

    // exudyn and MuJoCo, own contact: beds of springs; no friction, no ramp, another transient.
    "own-contact", "mujoco*|exudyn*", None, "native*", None, Without, Steady, columns::INPUT_TORQUE, RelativeL2, 1.7e-2, Some(1.3e-2),
    "A bed of springs conserves energy, the paper's law creates 1 % of the power: that is most of the difference.";
    "own-contact", "mujoco*|exudyn*", None, "native*", None, Without, Steady, columns::OUTPUT_TORQUE, RelativeL2, 1e-2, Some(4.8e-3),
    "Ripple about the same mean; times 2.";
    "own-contact", "mujoco*|exudyn*", None, "native*", None, Without, Steady, columns::EXTERNAL_FORCE, RelativeL2, 4.5e-2, Some(3.8e-2),
    "A bed of 4000 springs or 8000 segments: 2.8 % for the paper's gear, 3.8 % with forty thin pins; falls with their number.";
    "own-contact", "mujoco*|exudyn*", None, "native*", None, Without, Steady, columns::INTERNAL_FORCE, RelativeL2, 1.5e-2, Some(8.8e-3),
    "The law itself but for the ramp S, under external forces that differ: 0.4 to 0.9 % for four gears; times 1.7.";

    // rapier, colliders: polyline discs and rapier's own spring; wave forms are not comparable.
    "own-contact", "rapier*collider*", None, "native*", None, With, Steady, "*_torque_n_m", Mean, 2.5e-2, Some(1.8e-2),
    "As without friction, and its Coulomb friction holds pins that the regularised one lets creep.";
    "own-contact", "rapier*collider*", None, "native*", None, Any, Steady, "*_torque_n_m", Mean, 1.5e-2, Some(1e-2),
    "Measured 1 to 1.5 %: rapier's spring is linear and its stiffness depends on pairwise masses.";
    "own-contact", "rapier*collider*", None, "native*", None, Any, Steady, "*_force_n", Mean, 1e-1, Some(1e-1),
    "Measured about 10 %: the load spreads over the pins otherwise under a linear spring.";
};
