//! Verdicts that follow from distances and uncertainties.

use pinwheel_compare::uncertainty::{Basis, Estimate};
use pinwheel_compare::verdict::{self, Allowed, Counts, Side};
use pinwheel_compare::{Assessment, Metric, Verdict};

const L2: Metric = Metric::RelativeL2;

/// Between U and 2 U two engines agree to 2 U if an order is unconfirmed, and differ if both are confirmed.
#[test]
fn an_unconfirmed_size_is_a_bound_at_twice_itself() {
    let at = |basis: Basis, distance: f64| {
        let estimate = Estimate {
            basis,
            ..Estimate::stated(1e-3)
        };
        let [a, b] = ["a", "b"].map(|name| Side::known(name, estimate));
        verdict::pair(L2, distance, [&a, &b], 0.01)
    };
    for basis in [
        Basis::Unconfirmed,
        Basis::TwoLevels,
        Basis::Tolerance,
        Basis::Series,
    ] {
        let pair = at(basis, 3e-3);
        assert_eq!((pair.verdict, pair.bound), (Verdict::Agree, Some(4e-3)));
    }
    for basis in [Basis::Observed, Basis::Rounding, Basis::Stated] {
        let differ = at(basis, 3e-3);
        assert_eq!(
            (differ.verdict, differ.bound),
            (Verdict::Differ, Some(2e-3))
        );
        let agree = at(basis, 2e-3);
        assert_eq!((agree.verdict, agree.bound), (Verdict::Agree, Some(2e-3)));
    }
}

/// With U above the resolution agreement is inconclusive whatever confirms U, and a difference needs confirmed orders.
#[test]
fn what_is_blunt_is_inconclusive() {
    let at = |basis: Basis, distance: f64| {
        let estimate = Estimate {
            basis,
            ..Estimate::stated(1e-3)
        };
        let [a, b] = ["a", "b"].map(|name| Side::known(name, estimate));
        verdict::pair(L2, distance, [&a, &b], 1e-3)
    };
    let blunt = |assessment: Assessment| assessment.verdict == Verdict::Inconclusive;
    assert!(blunt(at(Basis::Observed, 1e-3)) && blunt(at(Basis::Unconfirmed, 1e-3)));
    assert!(blunt(at(Basis::Unconfirmed, 9e-3)));
    assert_eq!(at(Basis::Observed, 9e-3).verdict, Verdict::Differ);
}

/// Required refinement of a run: by the order, at least 1, and none where no refinement would reach the target.
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

/// The gravest verdict decides, and verdicts without an action set no status.
#[test]
fn counts_amount_to_the_gravest() {
    let add = |counts: Counts, verdict: Verdict, actionable: bool| {
        let mut counts = counts;
        counts.add(&Assessment {
            verdict,
            actionable,
            ..Assessment::not_compared("")
        });
        counts
    };
    let nothing = add(Counts::default(), Verdict::NotCompared, false);
    assert_eq!((nothing.exit_status(), nothing.compared()), (0, 0));
    let agree = add(nothing, Verdict::Agree, false);
    let model_error = add(agree, Verdict::Differ, false);
    let recording = add(model_error, Verdict::Inconclusive, false);
    assert_eq!((recording.exit_status(), recording.compared()), (0, 3));
    let open = add(recording, Verdict::Inconclusive, true);
    assert_eq!(open.exit_status(), 4);
    let differ = add(open, Verdict::Differ, true);
    assert_eq!((differ.exit_status(), differ.differ), (1, 2));
}

/// The blunter side is named with its required refinement: to the rest that the other leaves of the resolution, or half of it.
#[test]
fn the_blunter_side_is_to_be_refined() {
    let at = |of_b: f64| {
        let of = |u: f64| Estimate {
            order: Some(1.0),
            ..Estimate::stated(u)
        };
        let [a, b] = [("a", 5e-3), ("b", of_b)].map(|(name, u)| Side::known(name, of(u)));
        let named = |assessment: Assessment| (assessment.participant.unwrap(), assessment.remedy);
        let advice = named(verdict::pair(L2, 1e-3, [&a, &b], 2e-3));
        assert_eq!(advice, named(verdict::pair(L2, 1e-3, [&b, &a], 2e-3)));
        assert_eq!(advice.0, "a");
        advice.1
    };
    assert_eq!(at(5e-4), "refine a 3.4 times");
    assert_eq!(at(1.9e-3), "refine a 5 times");
}

/// Models differ only beyond their stated tolerance; without a tolerance the interval is the result.
#[test]
fn models_beyond_what_they_state_differ() {
    let at = |tolerance: Option<f64>| {
        let [a, b] = ["a", "b"].map(|name| Side::known(name, Estimate::stated(1e-3)));
        let allowed = tolerance.map(|tolerance| Allowed {
            predicted: 0.01,
            tolerance,
            reason: "Test.",
        });
        verdict::model(L2, 0.02, [&a, &b], 0.01, allowed.ok_or("nothing is stated"))
    };
    let agree = at(Some(0.0085));
    assert_eq!((agree.verdict, agree.bound), (Verdict::Agree, Some(0.0105)));
    let differ = at(Some(0.0075));
    assert_eq!((differ.verdict, differ.actionable), (Verdict::Differ, true));
    let [low, high] = at(None).interval().unwrap();
    assert_eq!(at(None).verdict, Verdict::NotCompared);
    assert!((low - 0.018).abs() < 1e-15 && (high - 0.022).abs() < 1e-15);
}
