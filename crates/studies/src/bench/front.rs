//! Cost of an error: interpolation on the front of a series in the log-log plane.
//!
//! A point belongs to the front if no other point of the series has both lower cost and lower error. Between two of its points
//! the cost of an error follows the straight line in (log error, log cost). Beyond its ends there is only a bound.

use serde::Serialize;

/// Cost of an error, or a bound on it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", content = "value", rename_all = "kebab-case")]
pub enum CostAt {
    /// Interpolated cost between two runs.
    Interpolated(f64),
    /// Upper bound: the cheapest run is already more accurate.
    AtMost(f64),
    /// Lower bound: the most accurate run does not reach the error.
    MoreThan(f64),
}

impl CostAt {
    /// Returns the number, an estimate or a bound.
    pub fn value(self) -> f64 {
        match self {
            Self::Interpolated(v) | Self::AtMost(v) | Self::MoreThan(v) => v,
        }
    }

    /// True if a run reaches the error.
    pub fn reached(self) -> bool {
        !matches!(self, Self::MoreThan(_))
    }
}

/// Returns the points of the front by rising cost and falling error. Points are (cost, error); values that are not finite and
/// positive are left out.
pub fn front(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let sound = |x: f64| x.is_finite() && x > 0.0;
    let mut points = points.to_vec();
    points.retain(|&(cost, error)| sound(cost) && sound(error));
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut front: Vec<(f64, f64)> = Vec::new();
    for point in points {
        if front.last().is_none_or(|last| point.1 < last.1) {
            front.push(point);
        }
    }
    front
}

/// Returns the cost of `error` on the front of the points (cost, error); `None` without points.
pub fn cost_at(points: &[(f64, f64)], error: f64) -> Option<CostAt> {
    let front = front(points);
    let (first, last) = (front.first()?, front.last()?);
    if first.1 <= error {
        return Some(CostAt::AtMost(first.0));
    }
    if last.1 > error {
        return Some(CostAt::MoreThan(last.0));
    }
    let k = front.iter().position(|point| point.1 <= error)?;
    let ((c0, e0), (c1, e1)) = (front[k - 1], front[k]);
    let share = (e0 / error).ln() / (e0 / e1).ln();
    Some(CostAt::Interpolated(c0 * (c1 / c0).powf(share)))
}
