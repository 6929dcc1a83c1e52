//! Who must show what, and what limits guard.

use crate::common::{context, courses};
use crate::{FORCE, anywhere, compared, engine, entry, native};
use pinwheel_compare::uncertainty::{Method, Source, Unresolved};
use pinwheel_compare::{
    CompareError, Context, Evidence, Ladder, Outcome, Rules, Rung, Track, Verdict, compare_with,
};
use pinwheel_courses::Courses;

/// The table guards the scenes it was measured on and no other; where it does, a finding of it stands.
#[test]
fn the_table_guards_its_own_scenes() {
    let apart = || {
        vec![
            engine(
                "native-reduced",
                Track::Native,
                &courses(1.0),
                1e-4,
                2.0,
                &[2.0, 4.0],
            ),
            engine(
                "native-lagrange",
                Track::Native,
                &courses(1.0),
                1.5e-4,
                2.0,
                &[2.0, 4.0],
            ),
        ]
    };
    let found = compared(&anywhere(), apart());
    assert_eq!((found.counts.exceeded, found.outcome), (0, Outcome::Passed));
    // On `paper` both take the same steps and must be equal to 1e-7: 5e-5 apart is a regression.
    let found = compared(&context(), apart());
    assert!(found.counts.exceeded > 0 && found.outcome == Outcome::Finding);
    let unknown = Context {
        guarded: Some("one-wheel".to_owned()),
        ..context()
    };
    assert_eq!(
        compared(&unknown, apart()).counts.exceeded,
        0,
        "never measured"
    );
}

#[test]
fn a_participant_without_evidence_is_named() {
    let (bare, _) = engine("peer", Track::SharedLaw, &courses(1.0), 1e-5, 2.0, &[]);
    let (own, ladder) = native(1e-5);
    let found = |peer: Option<Source>| {
        let mut evidence = vec![ladder.clone()];
        evidence.extend(peer.map(|source| Evidence {
            engine: "peer".to_owned(),
            source,
            excuse: None,
            floor: 0.0,
        }));
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let found = compare_with(&anywhere(), &[own.clone(), bare.clone()], &rules).unwrap();
        let verdict = entry(&found, FORCE).verdict.clone();
        (verdict, found)
    };
    let named = |verdict: &Verdict, words: &str| match verdict {
        Verdict::NotResolved {
            participant,
            reason,
            remedy,
            ..
        } => participant == "peer" && reason.contains(words) && !remedy.is_empty(),
        _ => false,
    };
    assert!(named(&found(None).0, "not known"));
    let unknown = Source::Unknown(Unresolved {
        reason: "its recording says nothing of its error".to_owned(),
        remedy: "run it live".to_owned(),
    });
    assert!(named(&found(Some(unknown)).0, "recording says nothing"));
    let ladder_of = |run: Result<Courses, String>, refinement: f64| {
        Source::Ladder(Ladder {
            method: Method::Tolerance { smooth: true },
            finest: 1e-6,
            coarser: vec![Rung {
                refinement,
                run,
                wall_s: 0.0,
            }],
        })
    };
    let failed = ladder_of(Err("diverged at t = 0.01 s".to_owned()), 10.0);
    assert!(named(&found(Some(failed)).0, "diverged at t = 0.01 s"));
    let few: Vec<usize> = (0..600).collect();
    assert!(named(
        &found(Some(ladder_of(Ok(courses(1.0).select(&few)), 10.0))).0,
        "sample times"
    ));
    assert!(named(
        &found(Some(ladder_of(Ok(courses(1.0)), 1.0))).0,
        "refinement 1"
    ));
    assert!(named(
        &found(Some(ladder_of(
            Ok(Courses::new(courses(1.0).time_s().to_vec()).unwrap()),
            2.0
        )))
        .0,
        "lacks"
    ));
    // A closed form, and uncertainties that were written down with a recording.
    assert!(matches!(
        found(Some(Source::Exact(1e-12))).0,
        Verdict::Agree { .. } | Verdict::Differ { .. }
    ));
    let (_, live) = found(Some(
        engine(
            "peer",
            Track::SharedLaw,
            &courses(1.0),
            1e-5,
            2.0,
            &[2.0, 4.0],
        )
        .1
        .source,
    ));
    let list = live.engines[1].uncertainty.clone();
    let written = serde_json::to_string(&list).unwrap();
    let recorded = Source::Recorded(serde_json::from_str(&written).unwrap());
    assert_eq!(found(Some(recorded)).0, entry(&live, FORCE).verdict);
    assert!(named(
        &found(Some(Source::Recorded(Vec::new()))).0,
        "recording holds no"
    ));
}

#[test]
fn bad_input_evidence_for_nobody() {
    let (own, evidence) = native(1e-5);
    let refused = |list: &[Evidence]| {
        let rules = Rules {
            evidence: list,
            ..Rules::default()
        };
        compare_with(&anywhere(), std::slice::from_ref(&own), &rules).unwrap_err()
    };
    let other = Evidence {
        engine: "nobody".to_owned(),
        ..evidence.clone()
    };
    assert_eq!(
        refused(&[other]),
        CompareError::Evidence("nobody".to_owned())
    );
    assert_eq!(
        refused(&[evidence.clone(), evidence.clone()]),
        CompareError::Evidence("native".to_owned())
    );
}
