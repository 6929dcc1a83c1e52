//! What distances and uncertainties amount to.

use pinwheel_compare::Verdict;
use pinwheel_compare::uncertainty::{Basis, Estimate};
use pinwheel_compare::verdict::{self, Counts, Outcome, Side};

/// Between U and 2 U two engines agree to 2 U where an order was not confirmed, and differ where both were.
#[test]
fn an_unconfirmed_size_is_a_bound_at_twice_itself() {
    let at = |basis: Basis, distance: f64| {
        let estimate = Estimate {
            basis,
            ..Estimate::stated(1e-3)
        };
        let [a, b] = ["a", "b"].map(|name| Side::known(name, estimate));
        verdict::pair(distance, &a, &b, 0.01)
    };
    for basis in [
        Basis::Unconfirmed,
        Basis::TwoRungs,
        Basis::Tolerance,
        Basis::Series,
    ] {
        assert_eq!(at(basis, 3e-3), Verdict::Agree { to: 4e-3 }, "{basis:?}");
    }
    for basis in [Basis::Observed, Basis::Rounding, Basis::Stated] {
        let differ = at(basis, 3e-3);
        assert!(matches!(differ, Verdict::Differ { at_least } if (at_least - 1e-3).abs() < 1e-12));
        assert_eq!(at(basis, 2e-3), Verdict::Agree { to: 2e-3 }, "{basis:?}");
    }
}

/// Above the resolution agreement says nothing, whatever confirms U, and a difference is told by confirmed orders alone.
#[test]
fn what_is_blunt_is_not_resolved() {
    let at = |basis: Basis, distance: f64| {
        let estimate = Estimate {
            basis,
            ..Estimate::stated(1e-3)
        };
        let [a, b] = ["a", "b"].map(|name| Side::known(name, estimate));
        verdict::pair(distance, &a, &b, 1e-3)
    };
    let blunt = |found: Verdict| matches!(found, Verdict::NotResolved { .. });
    assert!(blunt(at(Basis::Observed, 1e-3)) && blunt(at(Basis::Unconfirmed, 1e-3)));
    assert!(blunt(at(Basis::Unconfirmed, 9e-3)));
    assert!(matches!(at(Basis::Observed, 9e-3), Verdict::Differ { .. }));
}

/// How much finer a run must be: by the order, never coarser, and no number where none would do.
#[test]
fn what_a_target_asks_of_a_run() {
    let estimate = Estimate {
        order: Some(2.0),
        ..Estimate::stated(1e-3)
    };
    assert_eq!(estimate.refinement_for(1e-3 / 16.0), Some(4.0));
    assert_eq!(estimate.refinement_for(1.0), Some(1.0));
    for target in [0.0, -1e-3, f64::NAN] {
        assert_eq!(estimate.refinement_for(target), None, "{target}");
    }
    let first = Estimate {
        order: Some(1.0),
        ..estimate
    };
    assert_eq!(first.refinement_for(-1e-3), None);
    let rounding = Estimate {
        basis: Basis::Rounding,
        ..estimate
    };
    assert_eq!(rounding.refinement_for(1e-4), None);
}

/// What counts amount to: the gravest decides, and nothing judged is not the same as nothing to judge.
#[test]
fn counts_amount_to_the_gravest() {
    let nothing = Counts::default();
    assert_eq!(nothing.outcome(), Outcome::Nothing);
    let stated = Counts {
        stated: 1,
        ..nothing
    };
    assert_eq!(stated.outcome(), Outcome::Stated);
    for passed in [
        Counts { agree: 1, ..stated },
        Counts {
            within: 1,
            ..stated
        },
        Counts { model: 1, ..stated },
    ] {
        assert_eq!(passed.outcome(), Outcome::Passed);
        let open = Counts {
            not_resolved: 1,
            ..passed
        };
        assert_eq!(open.outcome(), Outcome::NotResolved);
        for found in [
            Counts { differ: 1, ..open },
            Counts {
                exceeded: 1,
                ..open
            },
            Counts {
                model_beyond: 1,
                ..open
            },
        ] {
            assert_eq!(found.outcome(), Outcome::Finding);
        }
    }
}

/// The blunter side is named, with what it must be refined by: to what the other leaves of the resolution, or half of it.
#[test]
fn the_blunter_side_is_to_be_refined() {
    let at = |of_b: f64| {
        let of = |u: f64| Estimate {
            order: Some(1.0),
            ..Estimate::stated(u)
        };
        let [a, b] = [("a", 5e-3), ("b", of_b)].map(|(name, u)| Side::known(name, of(u)));
        let told = |v: Verdict| match v {
            Verdict::NotResolved {
                participant,
                remedy,
                ..
            } => (participant, remedy),
            other => panic!("{other:?}"),
        };
        let found = told(verdict::pair(1e-3, &a, &b, 2e-3));
        assert_eq!(found, told(verdict::pair(1e-3, &b, &a, 2e-3)));
        assert_eq!(found.0, "a");
        found.1
    };
    assert_eq!(at(5e-4), "refine a 3.4 times");
    assert_eq!(at(1.9e-3), "refine a 5 times");
}

/// A model's difference counts as a finding where it is beyond what is stated, and only there.
#[test]
fn models_beyond_what_they_state_are_counted() {
    for (within, beyond) in [(Some(true), 0), (None, 0), (Some(false), 1)] {
        let mut counts = Counts::default();
        counts.add(&Verdict::ModelDifference {
            low: 0.0,
            high: 1.0,
            predicted: 0.0,
            tolerance: None,
            within,
        });
        assert_eq!((counts.model, counts.model_beyond), (1, beyond));
    }
}
