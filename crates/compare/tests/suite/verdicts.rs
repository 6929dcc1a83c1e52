//! Comparisons with known outcomes.

use super::common;

use common::{context, participant, time_series};
use pinwheel_compare::{
    CompareError, Comparison, Context, Metric, Participant, Rules, SharedModel, StatedLimit,
    Status, Verdict, WindowKind, compare,
};
use pinwheel_timeseries::TimeSeries;

/// Returns a limit for the forces of the measured participant.
fn limit(limit: f64) -> StatedLimit {
    StatedLimit {
        engine: "rig".to_owned(),
        window: WindowKind::Steady,
        quantity: "*_force_n".to_owned(),
        metric: Metric::RelativeL2,
        limit,
        reason: "Test.".to_owned(),
    }
}

fn native() -> Participant {
    participant("native", SharedModel::Native, time_series(1.0))
}

fn foreign(scale: f64) -> Participant {
    participant("foreign", SharedModel::SharedLaw, time_series(scale))
}

fn rig(scale: f64) -> Participant {
    participant("rig", SharedModel::Measured, time_series(scale))
}

fn held(participants: &[Participant], stated: &[StatedLimit]) -> Comparison {
    let rules = Rules {
        stated,
        ..Rules::default()
    };
    compare(&context(), participants, &rules).unwrap()
}

/// Returns the verdict on the external forces of the first pair in the steady window.
fn verdict(participants: &[Participant], stated: &[StatedLimit]) -> Verdict {
    let comparison = held(participants, stated);
    let entry = comparison.pairs[0]
        .entries
        .iter()
        .find(|e| e.quantity == "external_sleeve_force_n" && e.window == WindowKind::Steady);
    entry.unwrap().result.verdict
}

#[test]
fn limits_are_held_up_to_their_value() {
    let pair = [native(), rig(0.99)];
    assert_eq!(verdict(&pair, &[limit(0.0101)]), Verdict::Agree);
    assert_eq!(verdict(&pair, &[limit(0.0099)]), Verdict::Differ);
    assert!(held(&pair, &[limit(0.0101)]).passed && !held(&pair, &[limit(0.0099)]).passed);
    assert_eq!(held(&pair, &[limit(0.0099)]).counts.exit_status(), 1);
    let heavier = Context {
        load_n_m: None,
        ..context()
    };
    let nothing = compare(&heavier, &pair, &Rules::default()).unwrap();
    assert!(!nothing.passed, "nothing compared is not passed");
}

#[test]
fn not_finite_is_beyond_every_limit() {
    let mut spoiled = TimeSeries::new(time_series(1.0).time_s().to_vec()).unwrap();
    for channel in time_series(1.0).channels() {
        let mut values = channel.values.clone();
        values[599] = f64::NAN;
        spoiled.push(channel.name.clone(), values).unwrap();
    }
    let pair = [
        native(),
        participant("rig", SharedModel::Measured, spoiled.clone()),
    ];
    assert_eq!(verdict(&pair, &[limit(10.0)]), Verdict::Differ);
    let pair = [
        native(),
        participant("foreign", SharedModel::SharedLaw, spoiled),
    ];
    let comparison = compare(&context(), &pair, &Rules::default()).unwrap();
    let judged = &comparison.engines[1].judged;
    assert_eq!(
        judged[0].result.verdict,
        Verdict::Differ,
        "its mean output torque is not finite either"
    );
}

#[test]
fn forces_that_are_only_rounding_are_not_judged() {
    let pair = [
        participant("native", SharedModel::Native, time_series(1e-13)),
        rig(-1e-13),
    ];
    assert_eq!(verdict(&pair, &[limit(0.1)]), Verdict::NotCompared);
}

#[test]
fn load_balance() {
    let comparison = compare(&context(), &[native()], &Rules::default()).unwrap();
    let result = &comparison.engines[0].judged[0].result;
    assert_eq!(result.verdict, Verdict::Agree);
    assert!(comparison.pairs.is_empty() && comparison.matrices.is_empty());
    // One engine alone gives no evidence for its forces.
    assert_eq!((comparison.passed, comparison.exit_status()), (false, 4));
    let mut heavier = context();
    heavier.load_n_m = Some(22.01);
    assert_eq!(
        compare(&heavier, &[native()], &Rules::default())
            .unwrap()
            .counts
            .differ,
        2
    );
    heavier.load_n_m = Some(0.0);
    assert_eq!(
        compare(&heavier, &[native()], &Rules::default())
            .unwrap()
            .counts
            .not_compared,
        2
    );
}

#[test]
fn efficiency() {
    // 22 N m at omega/15 over 1.45 N m at omega.
    let mut rubs = context();
    rubs.friction_coefficient = 0.1;
    let of = |context: &Context| {
        let comparison = compare(context, &[native()], &Rules::default()).unwrap();
        comparison.engines[0].figures[0].clone()
    };
    // Output power exceeds input power, and this engine has no account: no efficiency above 1 appears.
    let above = of(&rubs);
    assert!(above.efficiency.is_none() && above.efficiency_reason.unwrap().contains("above 1"));
    rubs.input_speed_rad_s = rubs.input_speed_rad_s.map(|speed| 1.05 * speed);
    let wanted = 22.0 / 15.0 / 1.45 / 1.05;
    let efficiency = of(&rubs).efficiency.unwrap();
    // The ripple's mean over the window's 40.01 periods is not quite zero.
    assert!((efficiency - wanted).abs() < 1e-4, "{efficiency} {wanted}");
}

#[test]
fn tracks_are_never_mixed() {
    let own = participant("own", SharedModel::OwnContact, time_series(0.9));
    let all = [native(), own, foreign(0.99)];
    let comparison = compare(&context(), &all, &Rules::default()).unwrap();
    let pairs: Vec<_> = comparison
        .pairs
        .iter()
        .map(|p| (&*p.a, &*p.b, p.track))
        .collect();
    assert_eq!(
        pairs,
        [
            ("native", "own", SharedModel::OwnContact),
            ("native", "foreign", SharedModel::SharedLaw)
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
            SharedModel::SharedLaw,
            WindowKind::Steady,
            "native foreign".into()
        )
    );
    assert_eq!(
        tables[2],
        (
            SharedModel::OwnContact,
            WindowKind::Steady,
            "native own".into()
        )
    );
    let cell = comparison.matrices[0].cell(0, 1).unwrap();
    assert!(
        (cell.result.difference.unwrap() - 0.01).abs() < 1e-12,
        "{cell:?}"
    );
    assert_eq!(comparison.matrices[0].cell(1, 1), None);
}

#[test]
fn unfinished_runs_are_listed_not_judged() {
    let mut broken = participant("broken", SharedModel::Native, TimeSeries::default());
    broken.status = Status::Diverged {
        time_s: 0.01,
        quantity: "disc angle NaN".into(),
    };
    let comparison = compare(
        &context(),
        &[broken, native(), foreign(1.0)],
        &Rules::default(),
    )
    .unwrap();
    assert_eq!((comparison.unfinished, comparison.pairs.len()), (1, 1));
    assert_eq!(
        comparison.engines[0].status.reason().unwrap(),
        "diverged at t = 0.010000 s: disc angle NaN"
    );
    let alone = [participant("x", SharedModel::Native, TimeSeries::default())].map(|mut p| {
        p.status = Status::Failed {
            reason: "not installed".into(),
        };
        p
    });
    assert!(
        !compare(&context(), &alone, &Rules::default())
            .unwrap()
            .passed
    );
}

#[test]
fn missing_channels_are_named() {
    let mut few = TimeSeries::new(time_series(1.0).time_s().to_vec()).unwrap();
    few.push("external_sleeve_force_n_0", vec![1.0; 601])
        .unwrap();
    let pair = [native(), participant("few", SharedModel::SharedLaw, few)];
    let comparison = compare(&context(), &pair, &Rules::default()).unwrap();
    let reasons: Vec<_> = comparison.pairs[0]
        .entries
        .iter()
        .map(|e| e.result.reason.as_str())
        .collect();
    let stated = |reason: &str| reasons.contains(&reason);
    assert!(stated("few has no `input_torque_n_m`"), "{reasons:?}");
    assert!(stated(
        "`external_sleeve_force_n` has channels that only one of the two has"
    ));
}

#[test]
fn faults() {
    let grid = |times: Vec<f64>| {
        participant(
            "other",
            SharedModel::Native,
            TimeSeries::new(times).unwrap(),
        )
    };
    let mut times = time_series(1.0).time_s().to_vec();
    times[17] += 1e-5;
    let error = compare(
        &context(),
        &[native(), grid(times.clone())],
        &Rules::default(),
    )
    .unwrap_err();
    assert_eq!(
        error.to_string(),
        "sample 17 of `other` is at 0.01701 s, of `native` at 0.017 s: write both on one grid"
    );
    times[17] = 0.017 + 1e-12;
    assert!(
        compare(
            &context(),
            &[native(), grid(times.clone())],
            &Rules::default()
        )
        .is_ok(),
        "a rounding"
    );
    times.pop();
    let error = compare(&context(), &[native(), grid(times)], &Rules::default()).unwrap_err();
    assert!(
        matches!(error, CompareError::Samples { samples_b: 600, .. }),
        "{error}"
    );
    assert!(matches!(
        compare(&context(), &[], &Rules::default()),
        Err(CompareError::Empty)
    ));
    let twice = compare(&context(), &[native(), native()], &Rules::default());
    assert_eq!(twice, Err(CompareError::Duplicate("native".into())));
}

#[test]
fn a_recording_is_compared_at_its_own_samples() {
    let complete = time_series(1.0);
    let rows: Vec<usize> = (0..complete.len()).step_by(3).collect();
    let mut recording = participant(
        "mujoco-x",
        SharedModel::SharedLaw,
        time_series(1.001).select(&rows),
    );
    let refused = compare(
        &context(),
        &[native(), recording.clone()],
        &Rules::default(),
    );
    assert!(
        matches!(refused, Err(CompareError::Grid { .. })),
        "no recording"
    );
    recording.cost.recorded = Some("earlier".to_owned());
    for order in [[native(), recording.clone()], [recording.clone(), native()]] {
        let comparison = compare(&context(), &order, &Rules::default()).unwrap();
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
    // A sample that the other run lacks is refused.
    let shifted: Vec<f64> = recording
        .time_series
        .time_s()
        .iter()
        .map(|t| t + 4e-4)
        .collect();
    recording.time_series = TimeSeries::new(shifted).unwrap();
    assert!(compare(&context(), &[native(), recording], &Rules::default()).is_err());
}

#[test]
fn summary_is_plain_json() {
    let comparison = compare(&context(), &[native(), foreign(0.99)], &Rules::default()).unwrap();
    let json: serde_json::Value = serde_json::to_value(&comparison).unwrap();
    let entry = &json["pairs"][0]["entries"][3];
    assert_eq!(entry["quantity"], "external_sleeve_force_n");
    assert_eq!(entry["window"], "steady");
    assert_eq!(entry["verdict"], "not-compared");
    assert!(entry["metrics"]["relative_l2"].as_f64().unwrap() > 0.0099);
    assert_eq!(json["engines"][0]["status"]["state"], "finished");
    assert_eq!(
        json["engines"][0]["judged"][0]["metric"],
        "mean-against-load"
    );
}

/// The mean torque of an oscillating shaft is in balance with its inertia in every window, to rounding and quadrature, for a
/// recording with few samples too. An additional torque is detected; an under-sampled oscillation is not judged.
#[test]
fn published_a_swinging_shaft_is_in_balance() {
    let inertia = 0.4;
    let context = Context {
        output_inertia_kg_m2: Some(inertia),
        ..context()
    };
    // 0.2 rad at `rate` rad/s about a steady turn: Newton's second law for a shaft.
    let swings = |rate: f64, samples: u32, off_n_m: f64| {
        let spacing = 0.6 / f64::from(samples);
        let time: Vec<f64> = (0..=samples).map(|k| f64::from(k) * spacing).collect();
        let of = |f: &dyn Fn(f64) -> f64| time.iter().map(|&t| f(t)).collect::<Vec<_>>();
        let angle = of(&|t| -3.0 * t + 0.2 * (rate * t).sin());
        let torque = of(&|t| off_n_m - 22.0 - inertia * 0.2 * rate * rate * (rate * t).sin());
        let mut series = TimeSeries::new(time).unwrap();
        series.push("output_torque_n_m", torque).unwrap();
        series.push("output_angle_rad", angle).unwrap();
        let one = [participant("native", SharedModel::Native, series)];
        let comparison = compare(&context, &one, &Rules::default()).unwrap();
        let judged = comparison.engines[0].judged.iter();
        judged.map(|j| j.result.clone()).collect::<Vec<_>>()
    };
    for (rate, samples, sharp) in [(20.0, 600, 1e-6), (7.0, 600, 1e-7), (20.0, 120, 1e-3)] {
        let results = swings(rate, samples, 0.0);
        assert_eq!(results.len(), 2, "steady and transient");
        for one in results {
            assert_eq!(one.verdict, Verdict::Agree, "{rate} {samples}: {one:?}");
            assert!(one.bound.unwrap() < sharp, "{rate} {samples}: {one:?}");
        }
        for one in swings(rate, samples, 2.0 * 22.0 * sharp) {
            assert_eq!(one.verdict, Verdict::Differ, "{rate} {samples}: {one:?}");
        }
    }
    for one in swings(1800.0, 600, 0.0) {
        assert_eq!(one.verdict, Verdict::NotCompared, "{one:?}");
        assert!(one.reason.contains("too far apart"), "{one:?}");
    }
}

/// Contacts that close between samples are no imbalance, with a kink or a jump of their forces, even if all samples and every
/// other one miss them alike. A larger imbalance is detected.
#[test]
fn regress_kinks_between_samples_are_no_imbalance() {
    let inertia = 0.4;
    let context = Context {
        output_inertia_kg_m2: Some(inertia),
        ..context()
    };
    let spacing = 0.01;
    let time: Vec<f64> = (0..=60).map(|k| f64::from(k) * spacing).collect();
    // Kinks: their times and sizes.
    let judged = |order: i32, kinks: &[(f64, f64)], off_n_m: f64| {
        let sum = |part: &dyn Fn(f64) -> f64, t: f64| -> f64 {
            let since = kinks.iter().filter(|(at, _)| t > *at);
            since.map(|(at, size)| size * part(t - at)).sum()
        };
        let unit = spacing.powi(order);
        let n = f64::from(order);
        let (force, turn) = (
            |d: f64| d.powi(order) / unit,
            |d: f64| d.powi(order + 2) / (unit * inertia * (n + 1.0) * (n + 2.0)),
        );
        let torque = |&t: &f64| off_n_m - 22.0 + sum(&force, t);
        let angle = |&t: &f64| -3.0 * t + sum(&turn, t);
        let mut series = TimeSeries::new(time.clone()).unwrap();
        let values = time.iter().map(torque).collect();
        series.push("output_torque_n_m", values).unwrap();
        let values = time.iter().map(angle).collect();
        series.push("output_angle_rad", values).unwrap();
        let one = [participant("native", SharedModel::Native, series)];
        let comparison = compare(&context, &one, &Rules::default()).unwrap();
        let judged = comparison.engines[0].judged.iter();
        judged.map(|j| j.result.verdict).collect::<Vec<_>>()
    };
    for order in [0, 1] {
        let (mut all, mut alarms) = (0.0, 0.0);
        for k in 0..500 {
            // Evenly distributed, and not commensurate with the samples.
            let drawn = |by: f64| (f64::from(k) * by.sqrt()).fract();
            let kink = |by: f64| (0.02 + 0.56 * drawn(by), 0.2 * (drawn(by + 1.0) - 0.5));
            let kinks = [kink(2.0), kink(5.0), kink(10.0)];
            for verdict in judged(order, &kinks[..1 + k as usize % 3], 0.0) {
                all += 1.0;
                alarms += f64::from(verdict == Verdict::Differ);
            }
            assert!(!judged(order, &kinks, 2.0).contains(&Verdict::Agree));
        }
        assert!(alarms <= 0.01 * all, "{order}: {alarms} of {all}");
    }
}

/// Torques of the wrong sign do not balance the load at any size.
#[test]
fn regress_the_load_balance_has_a_sign() {
    let base = time_series(1.0);
    let mut flipped = TimeSeries::new(base.time_s().to_vec()).unwrap();
    for channel in base.channels() {
        let sign = if channel.name == "output_torque_n_m" {
            -1.0
        } else {
            1.0
        };
        let values = channel.values.iter().map(|v| sign * v).collect();
        flipped.push(channel.name.clone(), values).unwrap();
    }
    let wrong = participant("native", SharedModel::Native, flipped);
    let comparison = compare(&context(), &[wrong], &Rules::default()).unwrap();
    assert_eq!(comparison.counts.differ, 2);
    assert!((comparison.engines[0].judged[0].result.difference.unwrap() - 2.0).abs() < 1e-12);
}

/// Sample times may differ by a rounding, a millionth of their spacing, and by no more.
#[test]
fn regress_the_slack_of_the_grid() {
    let moved = |by: f64| {
        let mut times = time_series(1.0).time_s().to_vec();
        times[17] += by * 1e-3;
        let other = participant(
            "other",
            SharedModel::Native,
            TimeSeries::new(times).unwrap(),
        );
        compare(&context(), &[native(), other], &Rules::default()).is_ok()
    };
    assert!(moved(0.5e-6) && moved(-0.5e-6));
    assert!(!moved(2e-6) && !moved(-2e-6));
    // First time of a run that begins late: the tolerance is a share of the spacing, not of the time.
    let late = |by: f64| {
        let times: Vec<f64> = time_series(1.0)
            .time_s()
            .iter()
            .map(|t| t + 100.0)
            .collect();
        let mut other = times.clone();
        other[0] += by * 1e-3;
        let [a, b] = [("a", times), ("b", other)]
            .map(|(name, t)| participant(name, SharedModel::Native, TimeSeries::new(t).unwrap()));
        compare(&context(), &[a, b], &Rules::default()).is_ok()
    };
    assert!(late(0.5e-6) && !late(2e-6));
    // Recording with every other sample.
    let sparse = |row: usize, by: f64| {
        let times: Vec<f64> = time_series(1.0)
            .time_s()
            .iter()
            .map(|t| t + 100.0)
            .collect();
        let mut other: Vec<f64> = times.iter().copied().step_by(2).collect();
        other[row] += by * 1e-3;
        let [a, mut b] = [("a", times), ("b", other)]
            .map(|(name, t)| participant(name, SharedModel::Native, TimeSeries::new(t).unwrap()));
        b.cost.recorded = Some("earlier".to_owned());
        compare(&context(), &[a, b], &Rules::default()).is_ok()
    };
    for row in [0, 17] {
        assert!(sparse(row, 0.5e-6) && !sparse(row, 2e-6), "{row}");
    }
}

/// Loads are rounding below 1e-11 of the scene's scale, and judged above.
#[test]
fn regress_small_loads_are_judged() {
    let at = |size: f64| {
        let pair = [
            participant("native", SharedModel::Native, time_series(size)),
            rig(-size),
        ];
        verdict(&pair, &[limit(0.1)])
    };
    // Peaks of 100 N times the size, on a scale of 100 N.
    assert_eq!(at(0.9e-11), Verdict::NotCompared);
    assert_eq!(at(1.2e-11), Verdict::Differ);
}

/// A gear that stands still turns by roundings, which are not compared; larger rotations are judged.
#[test]
fn regress_a_gear_that_stands_still_is_not_compared() {
    let turned = |by: f64| {
        let base = time_series(1.0);
        let mut time_series = TimeSeries::new(base.time_s().to_vec()).unwrap();
        let angle = base.time_s().iter().map(|t| by * t).collect();
        time_series.push("output_angle_rad", angle).unwrap();
        time_series
    };
    let of = |by: f64| {
        let limit = StatedLimit {
            quantity: "output_angle_rad".to_owned(),
            ..limit(0.1)
        };
        let pair = [
            participant("native", SharedModel::Native, turned(by)),
            participant("rig", SharedModel::Measured, turned(-by)),
        ];
        let comparison = held(&pair, &[limit]);
        let steady = |e: &&pinwheel_compare::comparison::PairEntry| e.window == WindowKind::Steady;
        let entry = comparison.pairs[0].entries.iter().find(steady).unwrap();
        entry.result.verdict
    };
    // Peaks at 0.6 s.
    assert_eq!(of(1.6e-15), Verdict::NotCompared);
    assert_eq!(of(1.8e-15), Verdict::Differ);
}
