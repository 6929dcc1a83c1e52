//! Points distributed over the unit cube.

use crate::rng::Rng;

/// Returns one coordinate of a Latin hypercube (McKay, Beckman, Conover 1979): a value in each of `count` equal parts of 0
/// to 1, in random order.
pub(crate) fn hypercube(rng: &mut Rng, count: usize) -> Vec<f64> {
    let mut parts: Vec<usize> = (0..count).collect();
    for last in (1..count).rev() {
        parts.swap(last, rng.integer(0, last));
    }
    let within = |part: usize| (part as f64 + rng.share()) / count as f64;
    parts.into_iter().map(within).collect()
}
