//! Whole comparisons with known outcomes.

mod common;

use common::{context, courses, participant};
use pinwheel_compare::limits::{Friction, TABLE};
use pinwheel_compare::{
    CompareError, Context, Divergence, Limit, Metric, Participant, Status, Track, Verdict,
    WindowKind, compare,
};
use pinwheel_courses::Courses;

fn limit(engine: &'static str, limit: f64) -> Limit {
    Limit {
        track: "*",
        engine,
        step_at_most_s: None,
        against: "native*",
        against_step_at_most_s: None,
        friction: Friction::Any,
        window: WindowKind::Steady,
        quantity: "*_force_n",
        metric: Metric::RelativeL2,
        limit,
        measured: None,
        reason: "Test.",
    }
}

fn native() -> Participant {
    participant("native", Track::Native, courses(1.0))
}

fn foreign(scale: f64) -> Participant {
    participant("foreign", Track::SharedLaw, courses(scale))
}

/// The verdict on the external forces of the first pair in the steady window.
fn verdict(participants: &[Participant], limits: &[Limit]) -> Verdict {
    let comparison = compare(&context(), participants, limits).unwrap();
    let entry = comparison.pairs[0]
        .entries
        .iter()
        .find(|e| e.quantity == "external_sleeve_force_n" && e.window == WindowKind::Steady);
    entry.unwrap().verdict.clone()
}

#[test]
fn within_and_exceeded() {
    let pair = [native(), foreign(0.99)];
    assert_eq!(verdict(&pair, &[limit("foreign", 0.0101)]), Verdict::Within);
    assert_eq!(
        verdict(&pair, &[limit("foreign", 0.0099)]),
        Verdict::Exceeded
    );
    let passed = |limit| compare(&context(), &pair, &[limit]).unwrap().passed;
    assert!(passed(limit("foreign", 0.0101)) && !passed(limit("foreign", 0.0099)));
    assert!(
        !passed(limit("another", 1.0)),
        "nothing judged is not passed"
    );
}

#[test]
fn the_first_row_that_fits_counts() {
    let pair = [native(), foreign(0.99)];
    let strict = Limit {
        step_at_most_s: Some(1e-6),
        ..limit("foreign", 1e-9)
    };
    assert_eq!(
        verdict(&pair, &[strict, limit("foreign", 0.1)]),
        Verdict::Within
    );
    assert_eq!(
        verdict(&pair, &[strict]),
        Verdict::NotJudged {
            reason: "the limit is for steps of foreign up to 1e-6 s; this run used 1e-5 s".into()
        }
    );
    let fine = Limit {
        step_at_most_s: Some(1e-5),
        ..strict
    };
    assert_eq!(
        verdict(&pair, &[fine, limit("foreign", 0.1)]),
        Verdict::Exceeded
    );
    let other = Limit {
        against_step_at_most_s: Some(2e-7),
        ..limit("foreign", 0.1)
    };
    assert!(matches!(
        verdict(&pair, &[other]),
        Verdict::NotJudged { .. }
    ));
}

#[test]
fn friction_chooses_the_row() {
    let pair = [native(), foreign(0.99)];
    let with = Limit {
        friction: Friction::With,
        ..limit("foreign", 0.1)
    };
    assert_eq!(
        verdict(&pair, &[with]),
        Verdict::NotJudged {
            reason: "the limit is for scenes with friction".into()
        }
    );
    let mut rough = context();
    rough.friction_coefficient = 0.1;
    assert!(compare(&rough, &pair, &[with]).unwrap().passed);
}

#[test]
fn two_foreign_engines_may_be_as_far_apart_as_their_limits_add_up_to() {
    let other = participant("other", Track::SharedLaw, courses(1.01));
    let pair = [foreign(0.99), other];
    // They are 0.02/1.01 apart.
    let rows = |each| [limit("foreign", each), limit("other", each)];
    assert_eq!(verdict(&pair, &rows(0.0099)), Verdict::Exceeded);
    assert_eq!(verdict(&pair, &rows(0.00995)), Verdict::Within);
}

/// What both may be from a native run is for pairs without a row of their own.
#[test]
fn two_foreign_engines_keep_their_own_limit() {
    let other = participant("other", Track::SharedLaw, courses(1.01));
    let own = Limit {
        against: "other",
        ..limit("foreign", 0.01)
    };
    let rows = [own, limit("foreign", 1.0), limit("other", 1.0)];
    assert_eq!(verdict(&[foreign(0.99), other], &rows), Verdict::Exceeded);
}

#[test]
fn not_finite_is_exceeded_not_overlooked() {
    let mut spoiled = Courses::new(courses(1.0).time_s().to_vec()).unwrap();
    for channel in courses(1.0).channels() {
        let mut values = channel.values.clone();
        values[599] = f64::NAN;
        spoiled.push(channel.name.clone(), values).unwrap();
    }
    let pair = [native(), participant("foreign", Track::SharedLaw, spoiled)];
    assert_eq!(verdict(&pair, &[limit("foreign", 10.0)]), Verdict::Exceeded);
    let comparison = compare(&context(), &pair, TABLE).unwrap();
    let judged = &comparison.engines[1].judged;
    assert_eq!(
        judged[0].verdict,
        Verdict::Exceeded,
        "its mean output torque is not finite either"
    );
}

#[test]
fn forces_that_are_only_rounding_are_not_judged() {
    let pair = [
        participant("native", Track::Native, courses(1e-13)),
        foreign(-1e-13),
    ];
    assert!(matches!(
        verdict(&pair, &[limit("foreign", 0.1)]),
        Verdict::NotJudged { .. }
    ));
}

#[test]
fn load_balance() {
    let comparison = compare(&context(), &[native()], TABLE).unwrap();
    assert_eq!(comparison.engines[0].judged[0].verdict, Verdict::Within);
    assert!(comparison.passed && comparison.pairs.is_empty() && comparison.matrices.is_empty());
    let mut heavier = context();
    heavier.load_n_m = Some(22.01);
    assert_eq!(
        compare(&heavier, &[native()], TABLE)
            .unwrap()
            .counts
            .exceeded,
        1
    );
    heavier.load_n_m = Some(0.0);
    assert_eq!(
        compare(&heavier, &[native()], TABLE)
            .unwrap()
            .counts
            .not_judged,
        1
    );
}

#[test]
fn efficiency() {
    // 22 N m at omega/15 over 1.45 N m at omega.
    let comparison = compare(&context(), &[native()], TABLE).unwrap();
    let wanted = 22.0 / 15.0 / 1.45;
    let found = comparison.engines[0].figures[0].efficiency.unwrap();
    // The ripple's mean over the window's 40.01 periods is not quite zero.
    assert!((found - wanted).abs() < 1e-4, "{found} {wanted}");
}

#[test]
fn tracks_are_never_mixed() {
    let own = participant("own", Track::OwnContact, courses(0.9));
    let all = [native(), own, foreign(0.99)];
    let comparison = compare(&context(), &all, TABLE).unwrap();
    let pairs: Vec<_> = comparison
        .pairs
        .iter()
        .map(|p| (&*p.a, &*p.b, p.track))
        .collect();
    assert_eq!(
        pairs,
        [
            ("native", "own", Track::OwnContact),
            ("native", "foreign", Track::SharedLaw)
        ]
    );
    let tables: Vec<_> = comparison
        .matrices
        .iter()
        .map(|m| (m.track, m.window, m.engines.join(" ")))
        .collect();
    assert_eq!(
        tables[0],
        (
            Track::SharedLaw,
            WindowKind::Steady,
            "native foreign".into()
        )
    );
    assert_eq!(
        tables[2],
        (Track::OwnContact, WindowKind::Steady, "native own".into())
    );
    let cell = comparison.matrices[0].cell(0, 1).unwrap();
    assert!((cell.worst.unwrap() - 0.01).abs() < 1e-12, "{cell:?}");
    assert_eq!(comparison.matrices[0].cell(1, 1), None);
}

#[test]
fn unfinished_runs_are_listed_not_judged() {
    let mut broken = participant("broken", Track::Native, Courses::default());
    broken.status = Status::Diverged {
        time_s: 0.01,
        quantity: "wheel angle NaN".into(),
    };
    let comparison = compare(&context(), &[broken, native(), foreign(1.0)], TABLE).unwrap();
    assert_eq!((comparison.unfinished, comparison.pairs.len()), (1, 1));
    assert_eq!(
        comparison.engines[0].status.reason().unwrap(),
        "diverged at t = 0.010000 s: wheel angle NaN"
    );
    let alone = [participant("x", Track::Native, Courses::default())].map(|mut p| {
        p.status = Status::Failed {
            reason: "not installed".into(),
        };
        p
    });
    assert!(!compare(&context(), &alone, TABLE).unwrap().passed);
}

#[test]
fn missing_channels_are_named() {
    let mut few = Courses::new(courses(1.0).time_s().to_vec()).unwrap();
    few.push("external_sleeve_force_n_0", vec![1.0; 601])
        .unwrap();
    let pair = [native(), participant("few", Track::SharedLaw, few)];
    let comparison = compare(&context(), &pair, TABLE).unwrap();
    let reasons: Vec<_> = comparison.pairs[0]
        .entries
        .iter()
        .map(|e| &e.verdict)
        .collect();
    let told = |reason: &str| {
        reasons.contains(&&Verdict::NotJudged {
            reason: reason.into(),
        })
    };
    assert!(told("few has no `input_torque_n_m`"), "{reasons:?}");
    assert!(told(
        "`external_sleeve_force_n` has channels that only one of the two has"
    ));
}

#[test]
fn faults() {
    let grid = |times: Vec<f64>| participant("other", Track::Native, Courses::new(times).unwrap());
    let mut times = courses(1.0).time_s().to_vec();
    times[17] += 1e-5;
    let error = compare(&context(), &[native(), grid(times.clone())], TABLE).unwrap_err();
    assert_eq!(
        error.to_string(),
        "sample 17 of `other` is at 0.01701 s, of `native` at 0.017 s: write both on one grid"
    );
    times[17] = 0.017 + 1e-12;
    assert!(
        compare(&context(), &[native(), grid(times.clone())], TABLE).is_ok(),
        "a rounding"
    );
    times.pop();
    let error = compare(&context(), &[native(), grid(times)], TABLE).unwrap_err();
    assert!(
        matches!(error, CompareError::Samples { samples_b: 600, .. }),
        "{error}"
    );
    assert!(matches!(
        compare(&context(), &[], TABLE),
        Err(CompareError::Empty)
    ));
    let twice = compare(&context(), &[native(), native()], TABLE);
    assert_eq!(twice, Err(CompareError::Duplicate("native".into())));
}

#[test]
fn a_recording_is_compared_at_its_own_samples() {
    let whole = courses(1.0);
    let rows: Vec<usize> = (0..whole.len()).step_by(3).collect();
    let mut recording = participant("mujoco-x", Track::SharedLaw, courses(1.001).select(&rows));
    let refused = compare(&context(), &[native(), recording.clone()], TABLE);
    assert!(
        matches!(refused, Err(CompareError::Grid { .. })),
        "no recording"
    );
    recording.cost.recorded = Some("earlier".to_owned());
    for order in [[native(), recording.clone()], [recording.clone(), native()]] {
        let comparison = compare(&context(), &order, TABLE).unwrap();
        assert_eq!(comparison.windows[0].samples, 301, "the live run's");
        for entry in &comparison.pairs[0].entries {
            let error = entry.metrics.as_ref().unwrap().relative_l2.unwrap();
            let wanted = match entry.quantity.as_str() {
                "output_torque_n_m" | "output_angle_rad" => 0.0,
                _ => 1e-3 / 1.001,
            };
            assert!(
                (error - wanted).abs() < 1e-12,
                "{}: {error}",
                entry.quantity
            );
        }
    }
    let judged = &compare(&context(), &[native(), recording.clone()], TABLE)
        .unwrap()
        .engines[1]
        .judged;
    assert!(
        matches!(judged[0].verdict, Verdict::NotJudged { .. }),
        "an aliased mean"
    );
    // A sample that the other has not is refused as ever.
    let shifted: Vec<f64> = recording
        .courses
        .time_s()
        .iter()
        .map(|t| t + 4e-4)
        .collect();
    recording.courses = Courses::new(shifted).unwrap();
    assert!(compare(&context(), &[native(), recording], TABLE).is_err());
}

#[test]
fn summary_is_plain_json() {
    let comparison = compare(&context(), &[native(), foreign(0.99)], TABLE).unwrap();
    let json: serde_json::Value = serde_json::to_value(&comparison).unwrap();
    let entry = &json["pairs"][0]["entries"][3];
    assert_eq!(entry["quantity"], "external_sleeve_force_n");
    assert_eq!(entry["window"], "steady");
    assert_eq!(entry["verdict"], "not-judged");
    assert!(entry["metrics"]["relative_l2"].as_f64().unwrap() > 0.0099);
    assert_eq!(json["engines"][0]["status"]["state"], "finished");
    assert_eq!(
        json["engines"][0]["judged"][0]["checks"][0]["metric"],
        "mean-against-load"
    );
}

/// Beyond the divergence horizon samples are not held against each other: only statistics are judged.
#[test]
fn beyond_the_horizon_only_statistics_are_judged() {
    let pair = [native(), foreign(0.99)];
    let at = |horizon_s: Option<f64>, limits: &[Limit]| {
        let context = Context {
            divergence: Some(Divergence {
                horizon_s,
                largest_share: 0.1,
                told: "Test.".to_owned(),
            }),
            ..context()
        };
        let comparison = compare(&context, &pair, limits).unwrap();
        let entries = &comparison.pairs[0].entries;
        let forces = |e: &&pinwheel_compare::comparison::PairEntry| {
            e.quantity == "external_sleeve_force_n" && e.window == WindowKind::Steady
        };
        let found = entries.iter().find(forces).unwrap();
        (found.verdict.clone(), found.checks.len())
    };
    let samples = limit("foreign", 0.0099);
    let mean = Limit {
        metric: Metric::Mean,
        ..limit("foreign", 0.02)
    };
    assert_eq!(at(None, &[samples, mean]), (Verdict::Exceeded, 2));
    assert_eq!(at(Some(0.6), &[samples, mean]), (Verdict::Exceeded, 2));
    // The steady window ends at 0.6 s.
    assert_eq!(at(Some(0.59), &[samples, mean]), (Verdict::Within, 1));
    let (verdict, checks) = at(Some(0.59), &[samples]);
    assert_eq!(checks, 0);
    assert!(
        matches!(&verdict, Verdict::NotJudged { reason } if reason.contains("horizon")),
        "{verdict:?}"
    );
}

/// Torques of the wrong sign do not balance the load, whatever their size.
#[test]
fn regress_the_load_balance_has_a_sign() {
    let base = courses(1.0);
    let mut flipped = Courses::new(base.time_s().to_vec()).unwrap();
    for channel in base.channels() {
        let sign = if channel.name == "output_torque_n_m" {
            -1.0
        } else {
            1.0
        };
        let values = channel.values.iter().map(|v| sign * v).collect();
        flipped.push(channel.name.clone(), values).unwrap();
    }
    let wrong = participant("native", Track::Native, flipped);
    let comparison = compare(&context(), &[wrong], TABLE).unwrap();
    assert_eq!(comparison.counts.exceeded, 1);
    assert!((comparison.engines[0].judged[0].checks[0].value.unwrap() - 2.0).abs() < 1e-12);
}

/// A grid may differ by a rounding, a millionth of its spacing, and by no more.
#[test]
fn regress_the_slack_of_the_grid() {
    let moved = |by: f64| {
        let mut times = courses(1.0).time_s().to_vec();
        times[17] += by * 1e-3;
        let other = participant("other", Track::Native, Courses::new(times).unwrap());
        compare(&context(), &[native(), other], TABLE).is_ok()
    };
    assert!(moved(0.5e-6) && moved(-0.5e-6));
    assert!(!moved(2e-6) && !moved(-2e-6));
    // The first time of a run that begins late: the slack is a share of the spacing, not of the time.
    let late = |by: f64| {
        let times: Vec<f64> = courses(1.0).time_s().iter().map(|t| t + 100.0).collect();
        let mut other = times.clone();
        other[0] += by * 1e-3;
        let [a, b] = [("a", times), ("b", other)]
            .map(|(name, t)| participant(name, Track::Native, Courses::new(t).unwrap()));
        compare(&context(), &[a, b], TABLE).is_ok()
    };
    assert!(late(0.5e-6) && !late(2e-6));
    // The same of a recording with every other sample.
    let sparse = |row: usize, by: f64| {
        let times: Vec<f64> = courses(1.0).time_s().iter().map(|t| t + 100.0).collect();
        let mut other: Vec<f64> = times.iter().copied().step_by(2).collect();
        other[row] += by * 1e-3;
        let [a, mut b] = [("a", times), ("b", other)]
            .map(|(name, t)| participant(name, Track::Native, Courses::new(t).unwrap()));
        b.cost.recorded = Some("earlier".to_owned());
        compare(&context(), &[a, b], TABLE).is_ok()
    };
    for row in [0, 17] {
        assert!(sparse(row, 0.5e-6) && !sparse(row, 2e-6), "{row}");
    }
}

/// Loads are rounding below 1e-11 of the scene's own, and judged above.
#[test]
fn regress_small_loads_are_judged() {
    let at = |size: f64| {
        let pair = [
            participant("native", Track::Native, courses(size)),
            foreign(-size),
        ];
        verdict(&pair, &[limit("foreign", 0.1)])
    };
    // Peaks of 100 N times the size, on a scale of 100 N.
    assert!(matches!(at(0.9e-11), Verdict::NotJudged { .. }));
    assert_eq!(at(1.2e-11), Verdict::Exceeded);
}

/// A gear that stands still turns by roundings, which nobody compares; what turns by more is judged.
#[test]
fn regress_a_gear_that_stands_still_is_not_compared() {
    let turned = |by: f64| {
        let base = courses(1.0);
        let mut courses = Courses::new(base.time_s().to_vec()).unwrap();
        let angle = base.time_s().iter().map(|t| by * t).collect();
        courses.push("output_angle_rad", angle).unwrap();
        courses
    };
    let of = |by: f64| {
        let limit = Limit {
            quantity: "output_angle_rad",
            ..limit("foreign", 0.1)
        };
        let pair = [
            participant("native", Track::Native, turned(by)),
            participant("foreign", Track::SharedLaw, turned(-by)),
        ];
        let comparison = compare(&context(), &pair, &[limit]).unwrap();
        let steady = |e: &&pinwheel_compare::comparison::PairEntry| e.window == WindowKind::Steady;
        let entry = comparison.pairs[0].entries.iter().find(steady).unwrap();
        entry.verdict.clone()
    };
    // Peaks at 0.6 s.
    assert!(matches!(of(1.6e-15), Verdict::NotJudged { .. }));
    assert_eq!(of(1.8e-15), Verdict::Exceeded);
}
