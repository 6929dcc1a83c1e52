//! Thresholds of a baseline check, each with the measurement that it comes from (`docs/baselines.md` repeats them).

use pinwheel_timeseries::table::Table;

/// Multiple of the largest difference under perturbed rounding, measured at recording, up to which results count as equal.
/// The seven perturbations are other vector instructions, the scalar loop, and an inertia and a radius one digit up and
/// down. They include every instruction set of the contact loops; other differences between machines (the system's sine,
/// the compiler) resemble those of the inertias, and of the radius if a run starts in equilibrium.
pub const ROUNDING_MARGIN: f64 = 30.0;

/// Multiple for runs in which a rounding turned an accepted step into a rejected one. Their differences are those of two
/// runs of one tolerance, a large share of the error already.
pub const FLIP_MARGIN: f64 = 3.0;

/// Bound of accumulated rounding, as a share of the quantity's size. A larger difference is due to a rejected step as
/// for [`FLIP_MARGIN`] (measured: roundings make 1e-15 to 6e-10, the largest on steel; one step more or less makes 1e-7
/// and more).
pub const LARGEST_ROUNDING: f64 = 1e-8;

/// Least relevant relative difference: 1e4 steps with roundings of 1e-16 each, all in one direction.
pub const ROUNDING_FLOOR: f64 = 1e-12;

/// Largest rounding and error of a converged run in a baseline, as shares of the quantity's size: beyond, a change has no
/// significance. The accepted baseline has 3e-7 and 2e-3.
pub const LARGEST_RECORDED: f64 = 0.1;

/// Error against the converged run, as a share, above which `record` names the case: the resolution of a comparison.
pub const FAR_OFF: f64 = 0.01;

/// Returns the largest change that counts as rounding, if perturbed rounding gave `recorded` (shares of the quantity's size).
pub fn same_up_to(recorded: f64) -> f64 {
    let flip = (FLIP_MARGIN * recorded).max(LARGEST_ROUNDING);
    (ROUNDING_MARGIN * recorded).min(flip).max(ROUNDING_FLOOR)
}

/// Least relevant relative change of the error. Methods of one order differ by factors in their errors (rk2 and rk4 on the
/// paper's gear by 700, dopri5 between two step controls of one tolerance by 1.3), and an error from a few statistics is
/// accurate only to some per cent.
pub const ERROR_SHARE: f64 = 0.1;

/// Least permitted relative change of the counts of adaptive methods; three times their change under perturbed rounding if
/// that is more. One step rejected by rounding shifts all later ones.
pub const ADAPTIVE_COUNT_SHARE: f64 = 0.03;

/// Permitted change of the number of rejections, besides [`ADAPTIVE_COUNT_SHARE`] of the steps, since rejections are few.
pub const REJECTIONS: f64 = 5.0;

/// Permitted relative change of the number of Newton steps: contacts near a switch need one more or one less.
pub const NEWTON_SHARE: f64 = 0.02;

/// Returns the table of the limits.
pub fn table() -> Table {
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let adaptive = percent(ADAPTIVE_COUNT_SHARE);
    let rows = [
        (
            "same to rounding",
            format!(
                "{ROUNDING_MARGIN:.0} x recorded up to {LARGEST_ROUNDING:.0e}, beyond that {FLIP_MARGIN:.0} x; at least {ROUNDING_FLOOR:.0e}"
            ),
            "largest difference when recording between vector instructions, the scalar loop, and inertias and radii one digit apart",
        ),
        (
            "error",
            format!("{} of it + the reference's own error", percent(ERROR_SHARE)),
            "what statistics tell of an error; below its own error the converged run tells nothing",
        ),
        (
            "right-hand sides, steps",
            format!("none; with a step control {adaptive}"),
            "a fixed step has no choice; a rounding can reject a step and move all that follow",
        ),
        (
            "rejections",
            format!("{REJECTIONS:.0} + {adaptive} of the steps"),
            "few, so counted and not only a share",
        ),
        (
            "Newton steps",
            percent(NEWTON_SHARE),
            "contacts near a switch need one more or one less",
        ),
    ];
    Table::of("What a figure may move by", &rows)
        .text("figure", "Figure", |(name, ..)| *name)
        .text("limit", "Limit", |(_, value, _)| value)
        .text("reason", "Reason", |(.., reason)| *reason)
        .done()
}
