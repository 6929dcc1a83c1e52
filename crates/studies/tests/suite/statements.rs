//! Statements of the paper, and our verdicts.

use pinwheel_studies::internals::{Measured, Statement, Statements, number};
use pinwheel_studies::paper::ClaimVerdict;

#[test]
fn sentences_and_verdicts() {
    let mut of = Measured::default();
    of.numbers = vec![number("a, b", 0.1234, ""), number("c", -2.0, "N")];
    of.words = vec![("who", "Ours".to_owned())];
    let claimed = |row: &str| toml::from_str::<Statement>(row).unwrap().claim(&of);
    let filled = claimed("found = '{who}: {a, b:+.1%} %, {c:.1e}; {a, b:.2}.'");
    assert_eq!(filled.figure, "Ours: +12.3 %, -2.0e0; 0.12.");
    assert_eq!(filled.numbers, [0.1234, -2.0, 0.1234]);
    let judged = |rules: &str| claimed(rules).verdict;
    let holds =
        "holds_if = [{ number = 'c', over = 'a, b', below = -16.0 }, { number = 'c', above = -3 }]";
    assert_eq!(judged(holds), ClaimVerdict::Holds);
    let partly = "holds_if = [{ number = 'none', above = 0 }]\npartly_if_any = [{ number = 'c', below = 0 }]";
    assert_eq!(judged(partly), ClaimVerdict::Conditional);
    assert_eq!(judged("partly_if = []"), ClaimVerdict::DoesNotHold);
    assert_eq!(judged("verdict = 'meaningless'"), ClaimVerdict::Meaningless);
}

/// All statements are readable. Misspelt names, which make a condition false silently, are detected by the `published_` tests.
#[test]
fn the_file_can_be_read() {
    let all = Statements::read().unwrap();
    for claim in &all.claim {
        let known = all.figure.iter().any(|figure| figure.id == claim.figure);
        assert!(known || claim.figure == "cost", "{}", claim.id);
        assert!(!claim.judged_by.is_empty() && !claim.why.is_empty());
    }
}
