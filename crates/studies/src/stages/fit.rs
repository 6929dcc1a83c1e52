//! Least-squares fit of changes of the model to a residual.

/// Result of a fit of changes to a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fit {
    /// Size of each change, and its error if the entire remaining residual is due to it.
    pub sizes: Vec<[f64; 2]>,
    /// Share of the squared residual that the changes remove.
    pub explained: f64,
}

/// Largest number of Newton steps.
const STEPS: usize = 16;
/// Least share of the remaining residual that a step must remove.
const LITTLE: f64 = 0.05;

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn add(to: &mut [f64], by: f64, of: &[f64]) {
    to.iter_mut().zip(of).for_each(|(a, b)| *a += by * b);
}

/// Returns the sizes of one or two changes that explain `residual` best, and the square of the part of each slope that is
/// independent of the other.
pub(super) fn sizes(slopes: &[&[f64]], residual: &[f64]) -> Vec<[f64; 2]> {
    let own = |k: usize| {
        let mut own = slopes[k].to_vec();
        for (_, other) in slopes.iter().enumerate().filter(|(j, _)| *j != k) {
            let share = dot(&own, other) / dot(other, other);
            add(&mut own, -share, other);
        }
        let square = dot(&own, &own);
        [dot(&own, residual) / square, square]
    };
    (0..slopes.len()).map(own).collect()
}

/// Function that evaluates a model with changes of given sizes.
pub(super) type Predict<'a> = &'a mut dyn FnMut(&[f64]) -> Option<Vec<f64>>;

/// Returns the derivative of the values with respect to the size of a change, by the difference to `values` at `small`; at
/// `-small` if the model exists only there.
pub(super) fn slope(small: f64, values: &[f64], predict: Predict<'_>) -> Option<Vec<f64>> {
    [small, -small].into_iter().find_map(|small| {
        let mut slope = less(&predict(&[small])?, values);
        slope.iter_mut().for_each(|value| *value /= small);
        Some(slope)
    })
}

/// Fits changes to `target` by Newton's method. Without changes the model gives `base` with the derivatives `slopes`. `limits`
/// has a small size and the least admissible size of each change.
pub(super) fn fit(
    target: &[f64],
    base: &[f64],
    slopes: Vec<Vec<f64>>,
    limits: &[[f64; 2]],
    predict: Predict<'_>,
) -> Option<Fit> {
    let mut slopes = slopes;
    let (mut at, mut left, mut values) =
        (vec![0.0; limits.len()], less(target, base), base.to_vec());
    let total = dot(&left, &left);
    let mut squares = Vec::new();
    for step in 0..STEPS {
        let views: Vec<&[f64]> = slopes.iter().map(Vec::as_slice).collect();
        let steps = sizes(&views, &left);
        squares = steps.iter().map(|[_, square]| *square).collect();
        if !steps
            .iter()
            .all(|[size, square]| size.is_finite() && *square > 0.0)
        {
            return None;
        }
        // A distant model may not exist or fit worse; secants of a curved response overshoot.
        let tried = (0..if step == 0 { 7 } else { 3 }).find_map(|halvings| {
            let part = 0.5_f64.powi(halvings);
            let next = at.iter().zip(&steps).zip(limits);
            let next: Vec<f64> = next
                .map(|((at, [size, _]), [_, least])| (at + part * size).max(*least))
                .collect();
            let values = predict(&next)?;
            let rest = less(target, &values);
            (dot(&rest, &rest) <= (1.0 - LITTLE) * dot(&left, &left))
                .then_some((next, values, rest))
        });
        let Some((next, nearer, rest)) = tried else {
            // Too small a gain means that the fit has converged or the change is no cause.
            if step > 0 { break } else { return None }
        };
        let mut moved = at.iter().zip(&next);
        let is_still = moved.all(|(at, next)| (next - at).abs() <= 1e-5 * next.abs());
        // Broyden's update of the slopes; for a single change it is the secant.
        let steps = less(&next, &at);
        let scaled = steps.iter().zip(limits);
        let scaled: Vec<f64> = scaled.map(|(step, [small, _])| step / small).collect();
        let long = dot(&scaled, &scaled);
        let mut untold = less(&nearer, &values);
        let expected = slopes.iter().zip(&steps);
        expected.for_each(|(slope, step)| add(&mut untold, -step, slope));
        let parts = slopes.iter_mut().zip(&scaled).zip(limits);
        parts.for_each(|((slope, part), [small, _])| add(slope, part / small / long, &untold));
        (at, left, values) = (next, rest, nearer);
        if is_still || dot(&left, &left) <= 1e-12 * total {
            break;
        }
    }
    let rest = dot(&left, &left);
    let sizes = at.iter().zip(&squares);
    let sizes = sizes.map(|(size, square)| [*size, (rest / square).sqrt()]);
    Some(Fit {
        sizes: sizes.collect(),
        explained: 1.0 - rest / total,
    })
}
