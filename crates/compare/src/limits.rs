//! The regression guard: limits in one table, with what each applies to, what was measured, and why.
//!
//! The table holds what was measured on the scenes of [`MEASURED_ON`] and guards those, no other: what one gear's
//! engines are apart says nothing of another's. Verdicts on any scene come from verified uncertainty
//! ([`crate::uncertainty`]). The one exception is the balance with the load, which is mechanics and no calibration.
//!
//! Patterns: `*` stands for any characters, `|` separates alternatives. The first row that fits a
//! pair, window, quantity and metric is the one that counts, so stricter conditions stand first.

use pinwheel_courses::columns;
use serde::Serialize;

pub use crate::metrics::Metric;
use crate::windows::WindowKind;

/// Which scenes a row applies to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Friction {
    /// All.
    Any,
    /// mu = 0.
    Without,
    /// mu > 0.
    With,
}

/// One row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    /// Track of the pair ([`Track`](crate::Track)), a pattern.
    pub track: &'static str,
    /// One engine, a pattern.
    pub engine: &'static str,
    /// The other engine, a pattern; pairs fit in either order. Unused by one-engine metrics.
    pub against: &'static str,
    /// Frictionless scenes, those with friction, or all.
    pub friction: Friction,
    /// Largest step of `engine`, s; `None` for any.
    pub step_at_most_s: Option<f64>,
    /// Largest step of `against`, s; `None` for any.
    pub against_step_at_most_s: Option<f64>,
    /// Window.
    pub window: WindowKind,
    /// Quantity, a pattern.
    pub quantity: &'static str,
    /// Metric.
    pub metric: Metric,
    /// The limit itself.
    pub limit: f64,
    /// What was measured when it was set; `None` until then.
    pub measured: Option<f64>,
    /// Why it is what it is.
    pub reason: &'static str,
}

/// A limit that the owner of measured data states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StatedLimit {
    /// Name of the participant.
    pub engine: String,
    /// Window.
    pub window: WindowKind,
    /// Quantity, a pattern.
    pub quantity: String,
    /// Metric.
    pub metric: Metric,
    /// The limit itself.
    pub limit: f64,
    /// Why it is what it is.
    pub reason: String,
}

/// Presets the table was measured on; [`Context::guarded`](crate::Context::guarded) names the one a scene is.
pub const MEASURED_ON: [&str; 6] = [
    "paper",
    "paper-friction",
    "backlash-0.6",
    "steel",
    "eleven-pins",
    "forty-pins",
];

/// Forces and torques below this share of the scene's own scale are rounding, and are not judged: 16 digits, times
/// some ten thousand for what 28 bodies and a solver add.
pub const NEGLIGIBLE_SHARE: f64 = 1e-11;

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

/// The columns that every engine of a gearbox records.
const CONTRACT: &str = "*_sleeve_force_n|input_torque_n_m|output_torque_n_m|output_angle_rad";

/// These, and the channels that follow the forces as closely (measured: nowhere twice as far apart).
/// Not among them are what divides by a power that passes through zero (efficiency), small differences
/// of large numbers (relative velocities, losses, the shafts' bearings between wheels in phase), counts,
/// and friction on single pairs.
const FOLLOWING: &str = "*_sleeve_force_n|input_torque_n_m|output_torque_n_m|output_angle_rad|*_arcmin|\
     eccentric_bearing_*|*_pin_force_*|input_power_w|wheel_*_penetration_m|wheel_*_stiffness_n_m15|\
     wheel_*_contact_x_m|wheel_*_contact_y_m|wheel_*_normal_force_n";

/// The table. Columns: track, engine, its largest step, against, its largest step, friction,
/// window, quantity, metric, limit, measured; then the reason.
pub const TABLE: &[Limit] = rows! {
    // Any engine, judged alone.
    "*", "*", None, "the load", None, Any, Steady, columns::OUTPUT_TORQUE, MeanAgainstLoad, 1e-4, None,
    "In the mean the contact forces on the output shaft balance the load, whatever the law and engine.";

    // Native formulations against each other.
    "native", "native*lagrange*|native*reduced*", None, "native*lagrange*|native*reduced*", None, Without, Transient, FOLLOWING, RelativeL2, 1e-9, Some(1.5e-13),
    "The same equations, step and method; the elimination is exact, so only rounding parts them.";
    "native", "native*lagrange*|native*reduced*", None, "native*lagrange*|native*reduced*", None, Without, Steady, FOLLOWING, RelativeL2, 1e-7, Some(2e-12),
    "Rounding grows along the run; the frictionless gear is periodic, so it does not grow without bound.";

    // The scene's own integrator against the resolved run: what its step costs.
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
    "A bed of 4000 springs or 8000 segments: 2.8 % for the paper's gear, 3.8 % with forty thin sleeves; falls with their number.";
    "own-contact", "mujoco*|exudyn*", None, "native*", None, Without, Steady, columns::INTERNAL_FORCE, RelativeL2, 1.5e-2, Some(8.8e-3),
    "The law itself but for the ramp S, under external forces that differ: 0.4 to 0.9 % for four gears; times 1.7.";

    // rapier, colliders: polyline wheels and rapier's own spring; wave forms are not comparable.
    "own-contact", "rapier*collider*", None, "native*", None, With, Steady, "*_torque_n_m", Mean, 2.5e-2, Some(1.8e-2),
    "As without friction, and its Coulomb friction holds sleeves that the regularised one lets creep.";
    "own-contact", "rapier*collider*", None, "native*", None, Any, Steady, "*_torque_n_m", Mean, 1.5e-2, Some(1e-2),
    "Measured 1 to 1.5 %: rapier's spring is linear and its stiffness depends on pairwise masses.";
    "own-contact", "rapier*collider*", None, "native*", None, Any, Steady, "*_force_n", Mean, 1e-1, Some(1e-1),
    "Measured about 10 %: the load spreads over the sleeves otherwise under a linear spring.";
};

/// Whether `text` fits `pattern`: `*` stands for any characters, `|` separates alternatives.
#[must_use]
pub fn fits(pattern: &str, text: &str) -> bool {
    pattern.split('|').any(|pattern| fits_one(pattern, text))
}

/// The walk with one place to fall back to: a pattern of many `*`, which a map may hold, takes no longer than others.
fn fits_one(pattern: &str, text: &str) -> bool {
    let (pattern, text) = (pattern.as_bytes(), text.as_bytes());
    let (mut p, mut t) = (0, 0);
    let mut star: Option<(usize, usize)> = None;
    while t < text.len() {
        match (pattern.get(p), &mut star) {
            (Some(b'*'), _) => {
                star = Some((p, t));
                p += 1;
            }
            (Some(c), _) if *c == text[t] => (p, t) = (p + 1, t + 1),
            (_, Some((at, from))) => {
                *from += 1;
                (p, t) = (*at + 1, *from);
            }
            (_, None) => return false,
        }
    }
    pattern[p..].iter().all(|&c| c == b'*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns() {
        for (pattern, text, wanted) in [
            ("*", "", true),
            ("*", "anything", true),
            ("native*", "native", true),
            ("native*", "native-reduced", true),
            ("native", "native-reduced", false),
            ("*_force_n", "external_sleeve_force_n", true),
            ("*_force_n", "force_n", false),
            ("rapier*hook*", "rapier-contact-hook", true),
            ("rapier*hook*", "rapier-shared-law", false),
            ("a|b*", "bc", true),
            ("a|b*", "ab", false),
            ("", "a", false),
            ("*a*b", "aab", true),
            ("*ab", "aab", true),
            ("*\u{e9}", "caf\u{e9}", true),
        ] {
            assert_eq!(fits(pattern, text), wanted, "{pattern} {text}");
        }
    }

    /// One fallback for every star would take 1e26 steps here.
    #[test]
    fn bad_input_patterns_of_many_stars_end() {
        let stars = "*".repeat(60_000);
        assert!(fits(&stars, "external_sleeve_force_n"));
        assert!(!fits(&format!("{stars}x"), "external_sleeve_force_n"));
        assert!(!fits(&"*e".repeat(9), "external_sleeve_force_n"));
    }

    #[test]
    fn rows_are_sound() {
        for row in TABLE {
            assert!(row.limit > 0.0 && row.limit.is_finite(), "{row:?}");
            assert!(
                row.measured.is_none_or(|m| m > 0.0 && m <= row.limit),
                "no margin: {row:?}"
            );
            assert!(row.reason.ends_with('.'), "{row:?}");
        }
    }
}
