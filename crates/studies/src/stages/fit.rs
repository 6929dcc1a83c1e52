//! Least squares of a residual on changes of the model.

/// Result of the fit of changes to what a run shows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fit {
    /// Size of each change, and its error if all that is left is of one cause.
    pub sizes: Vec<[f64; 2]>,
    /// Share of the residual's square that the changes take away.
    pub explained: f64,
}

/// Steps of the fit.
const STEPS: usize = 16;
/// Share of what is left that a step gains at least.
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

/// Sizes of one or two changes that explain `residual` best, and the square of each slope's part that is not the other's.
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

/// Values of a model with changes of given sizes.
pub(super) type Predict<'a> = &'a mut dyn FnMut(&[f64]) -> Option<Vec<f64>>;

/// Change of the values by a small change per size, where they are `values` without it. A model that barely exists may have one
/// side alone.
pub(super) fn slope(small: f64, values: &[f64], predict: Predict<'_>) -> Option<Vec<f64>> {
    [small, -small].into_iter().find_map(|small| {
        let mut slope = less(&predict(&[small])?, values);
        slope.iter_mut().for_each(|value| *value /= small);
        Some(slope)
    })
}

/// Fits changes to `target`, by Newton's steps from no change, where the model gives `base` and the `slopes`. `limits` has of each
/// change a size that changes the model linearly, and the least size.
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
        // A model far away may not exist, or be worse; a secant of a curve may lead as far beyond.
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
            // A change that is no cause soon gains little, and so does every one at the bottom.
            if step > 0 { break } else { return None }
        };
        let mut moved = at.iter().zip(&next);
        let is_still = moved.all(|(at, next)| (next - at).abs() <= 1e-5 * next.abs());
        // Slopes by Broyden's method: those of a single change are secants.
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
