//! Wording of a run's numerical error.

use pinwheel_gearbox::Distance;
use pinwheel_gearbox::internals::remedy;
use pinwheel_gearbox::resolve::{Level, Uncertainty, Verdict};

#[test]
fn notes_report_costs_and_failures() {
    let level = |evaluations, failure: Option<&str>| Level {
        integrator: "dopri5".to_owned(),
        setting: "a tolerance of 1e-6".to_owned(),
        evaluations,
        moved: None,
        failure: failure.map(str::to_owned),
    };
    let mut uncertainty = Uncertainty {
        target: 1e-3,
        error: None,
        verdict: Verdict::Resolved,
        chosen: 1,
        levels: vec![level(100, None), level(200, None)],
        ladder: None,
    };
    assert!(uncertainty.is_resolved());
    assert_eq!((uncertainty.cost(), uncertainty.notes().len()), (1.5, 1));
    uncertainty.levels.push(level(100, Some("t = 1 s: a disc")));
    uncertainty.verdict = Verdict::NotResolved {
        reason: String::new(),
        remedy: String::new(),
    };
    assert!(!uncertainty.is_resolved());
    assert_eq!(uncertainty.cost(), 2.0);
    let notes = uncertainty.notes();
    assert!(notes[1].contains("1 of 3 runs") && notes[1].contains("a disc"));
}

/// Nearly sufficient accuracy needs a slightly finer setting; meaningless time series need another scene.
#[test]
fn remedies_suit_what_was_reached() {
    let of = |forces: f64| {
        let error = Distance {
            forces,
            ..Distance::default()
        };
        remedy(1e-3, Some(error), 1000)
    };
    assert!(of(0.09).contains("hold to 9e-2"));
    assert!(of(0.1).contains("not to be trusted"));
    assert!(of(f64::NAN).contains("Nothing is known"));
}
