//! Bounds whose failure names method, quantity and excess.

/// Fails unless `value` is in `bound`; NaN is in none. `method`: integrator with further marks of the run.
#[track_caller]
pub(crate) fn holds(
    method: &str,
    what: &str,
    value: f64,
    bound: impl std::ops::RangeBounds<f64> + std::fmt::Debug,
) {
    assert!(
        bound.contains(&value),
        "{method}: {what} is {value:.3e}, bound {bound:?}"
    );
}
