//! Least squares of a residual on one change of the model.

/// Result of the fit of a change to what a run shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fit {
    /// Size of the change.
    pub size: f64,
    /// Standard error of the size.
    pub plus_minus: f64,
    /// Share of the residual's square that the change takes away.
    pub explained: f64,
}

/// Share that the linear part has to explain before a change is followed further.
const LEAST: f64 = 0.2;
/// Gauss-Newton steps.
const STEPS: usize = 8;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Fits a change to `target`, by Gauss-Newton steps from no change, where the model gives `base`. `predict` gives the model's
/// values with a change of a given size, `None` where there is no such model; `small` is a size that changes them linearly, and no
/// size is below `least`.
pub(super) fn fit(
    target: &[f64],
    base: &[f64],
    [small, least]: [f64; 2],
    predict: &mut dyn FnMut(f64) -> Option<Vec<f64>>,
) -> Option<Fit> {
    let all = less(target, base);
    let whole = dot(&all, &all);
    let (mut size, mut left, mut values) = (0.0, all, base.to_vec());
    let mut slope_square = 0.0;
    for step in 0..STEPS {
        // A model that barely exists may have one side alone.
        let (near, small) = match predict(size + small) {
            Some(near) => (near, small),
            None => (predict(size - small)?, -small),
        };
        let slope = less(&near, &values);
        slope_square = dot(&slope, &slope) / (small * small);
        let along = dot(&slope, &left) / small;
        if !(slope_square > 0.0) || step == 0 && !(along * along / slope_square > LEAST * whole) {
            return None;
        }
        let mut change = (along / slope_square).max(least - size);
        // A model far away may not exist, or be worse.
        let mut halvings = 0..6;
        let next = loop {
            let tried = predict(size + change).filter(|values| {
                let left = less(target, values);
                dot(&left, &left) <= dot(&less(target, base), &less(target, base))
            });
            match tried {
                Some(values) => break values,
                None if halvings.next().is_some() => change *= 0.5,
                None => return None,
            }
        };
        let better = less(target, &next);
        let gained = dot(&left, &left) - dot(&better, &better);
        (size, left, values) = (size + change, better, next);
        if change.abs() <= 1e-5 * size.abs() || gained.abs() <= 1e-12 * whole {
            break;
        }
    }
    let rest = dot(&left, &left);
    let free = target.len().saturating_sub(1).max(1) as f64;
    Some(Fit {
        size,
        plus_minus: (rest / free / slope_square).sqrt(),
        explained: 1.0 - rest / whole,
    })
}
