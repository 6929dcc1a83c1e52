//! Evidence required of participants.

use super::common::time_series;
use super::{FORCE, anywhere, engine, entry, native};
use pinwheel_compare::uncertainty::{Method, Source, Unresolved};
use pinwheel_compare::{
    Assessment, CompareError, Evidence, Ladder, Level, Rules, SharedModel, Verdict, compare,
    uncertainties,
};
use pinwheel_timeseries::TimeSeries;

#[test]
fn a_participant_without_evidence_is_named() {
    let (bare, _) = engine(
        "peer",
        SharedModel::SharedLaw,
        &time_series(1.0),
        1e-5,
        2.0,
        &[],
    );
    let (own, study) = native(1e-5);
    let with_peer = |peer: Option<Source>| {
        let mut evidence = vec![study.clone()];
        evidence.extend(peer.map(|source| Evidence {
            engine: "peer".to_owned(),
            source,
            is_final: None,
        }));
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let comparison = compare(&anywhere(), &[own.clone(), bare.clone()], &rules).unwrap();
        let result = entry(&comparison, FORCE).result.clone();
        (result, comparison)
    };
    let named = |assessment: &Assessment, words: &str| {
        assessment.verdict == Verdict::Inconclusive
            && assessment.participant.as_deref() == Some("peer")
            && assessment.reason.contains(words)
            && !assessment.remedy.is_empty()
    };
    assert!(named(&with_peer(None).0, "not known"));
    let unknown = Source::Unknown(Unresolved {
        reason: "its recording says nothing of its error".to_owned(),
        remedy: "run it live".to_owned(),
    });
    assert!(named(&with_peer(Some(unknown)).0, "recording says nothing"));
    let ladder_of = |run: Result<TimeSeries, String>, refinement: f64| {
        Source::Refinement(Ladder {
            method: Method::Tolerance { order: 1.0 },
            finest: 1e-6,
            floor: 0.0,
            coarser: vec![Level {
                setting: 1e-6 * refinement,
                run,
                wall_s: 0.0,
            }],
        })
    };
    let failed = ladder_of(Err("diverged at t = 0.01 s".to_owned()), 10.0);
    assert!(named(&with_peer(Some(failed)).0, "diverged at t = 0.01 s"));
    let few: Vec<usize> = (0..600).collect();
    assert!(named(
        &with_peer(Some(ladder_of(Ok(time_series(1.0).select(&few)), 10.0))).0,
        "sample times"
    ));
    assert!(named(
        &with_peer(Some(ladder_of(Ok(time_series(1.0)), 1.0))).0,
        "refinement 1"
    ));
    assert!(named(
        &with_peer(Some(ladder_of(
            Ok(TimeSeries::new(time_series(1.0).time_s().to_vec()).unwrap()),
            2.0
        )))
        .0,
        "lacks"
    ));
    // A closed form, and uncertainties stored with a recording.
    let exact = with_peer(Some(Source::Exact(1e-12))).0.verdict;
    assert!(matches!(exact, Verdict::Agree | Verdict::Differ));
    let (_, live) = with_peer(Some(
        engine(
            "peer",
            SharedModel::SharedLaw,
            &time_series(1.0),
            1e-5,
            2.0,
            &[2.0, 4.0],
        )
        .1
        .source,
    ));
    let window = |kind| live.windows.iter().find(|w| w.kind == kind).unwrap();
    let list = live.engines[1].uncertainty.iter();
    let list = list.map(|known| known.to_record(window(known.window)));
    let recorded = with_peer(Some(Source::Recorded(list.collect()))).0;
    assert_eq!(recorded, entry(&live, FORCE).result);
    assert!(named(
        &with_peer(Some(Source::Recorded(Vec::new()))).0,
        "recording holds no"
    ));
}

/// A coarser run may have half of the samples: all runs are compared at these.
#[test]
fn a_level_at_every_other_sample_is_compared_there() {
    let base = time_series(1.0);
    let (finest, all) = engine(
        "peer",
        SharedModel::SharedLaw,
        &base,
        1e-5,
        2.0,
        &[2.0, 4.0],
    );
    let mut thin = all.clone();
    let Source::Refinement(ladder) = &mut thin.source else {
        panic!("{thin:?}");
    };
    let rows: Vec<usize> = (0..base.len()).step_by(2).collect();
    for run in ladder
        .coarser
        .iter_mut()
        .skip(1)
        .flat_map(|level| &mut level.run)
    {
        *run = run.select(&rows);
    }
    let known = |evidence| {
        let list = uncertainties(&anywhere(), &finest, evidence);
        list.into_iter().map(|(_, known)| known.l2.u().unwrap())
    };
    let both: Vec<(f64, f64)> = known(&all).zip(known(&thin)).collect();
    assert!(both.len() >= 4, "{both:?}");
    for (all, thin) in both {
        assert!(all > 0.0 && (thin / all - 1.0).abs() < 0.05, "{all} {thin}");
    }
}

#[test]
fn bad_input_evidence_for_nobody() {
    let (own, evidence) = native(1e-5);
    let refused = |list: &[Evidence]| {
        let rules = Rules {
            evidence: list,
            ..Rules::default()
        };
        compare(&anywhere(), std::slice::from_ref(&own), &rules).unwrap_err()
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
