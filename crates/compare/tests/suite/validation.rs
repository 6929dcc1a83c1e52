//! Budgets of uncertainty.

use pinwheel_compare::validation::Budget;

#[test]
fn budgets_by_hand() {
    let budget = Budget::new(0.006, 0.004, 0.012);
    assert!((budget.validation() - 0.013).abs() < 1e-15, "3, 4, 12: 13");
    let shares = budget.shares().unwrap();
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    assert!((shares[2] - 144.0 / 169.0).abs() < 1e-14);
    assert!((budget.bound() - 0.026).abs() < 1e-15);
    assert_eq!(Budget::new(0.0, 0.0, 0.0).shares(), None);
}
