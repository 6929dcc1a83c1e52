//! Cost of an error, from the runs of a series.

use pinwheel_studies::bench::CostAt;
use pinwheel_studies::internals::{cost_at, front};

/// A second-order method: error = cost^-2.
const LINE: [(f64, f64); 3] = [(10.0, 1e-2), (100.0, 1e-4), (1000.0, 1e-6)];

#[test]
fn between_points_on_the_straight_line() {
    let Some(CostAt::Interpolated(cost)) = cost_at(&LINE, 1e-3) else {
        panic!("interpolated");
    };
    assert!((cost / 1000.0_f64.sqrt() - 1.0).abs() < 1e-12, "{cost}");
    let Some(CostAt::Interpolated(cost)) = cost_at(&LINE, 1e-4) else {
        panic!("interpolated");
    };
    assert!((cost - 100.0).abs() < 1e-9, "{cost}");
}

#[test]
fn beyond_its_ends_only_bounds() {
    assert_eq!(cost_at(&LINE, 0.1), Some(CostAt::AtMost(10.0)));
    assert_eq!(cost_at(&LINE, 1e-7), Some(CostAt::MoreThan(1000.0)));
    assert_eq!(cost_at(&[], 1e-3), None);
    assert_eq!(cost_at(&[(1.0, f64::NAN)], 1e-3), None);
}

#[test]
fn beaten_points_are_not_on_the_front() {
    let mut points = LINE.to_vec();
    // Costlier and less accurate, equally costly and less accurate, and diverged.
    points.extend([(120.0, 5e-3), (100.0, 2e-4), (1.0, f64::INFINITY)]);
    points.reverse();
    assert_eq!(front(&points), LINE);
}
