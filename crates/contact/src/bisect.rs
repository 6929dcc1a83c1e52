//! Bisection.

/// Halvings of an interval: each adds a bit, and a double has fewer.
const HALVINGS: usize = 60;

/// Returns the ends of the shortened interval: `is_before` holds at its beginning, and not at its end, or the ends stay.
pub fn bisect([mut low, mut high]: [f64; 2], mut is_before: impl FnMut(f64) -> bool) -> [f64; 2] {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        *(if is_before(middle) {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    [low, high]
}
