//! Bounds whose failure says which method missed what, by how much.

/// Fails unless `value` lies in `bound`; NaN lies nowhere. `method`: the integrator, with what else tells the run.
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
