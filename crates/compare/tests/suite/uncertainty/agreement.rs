//! Agreement and difference under numerical uncertainty alone.

use super::common::{Random, participant, time_series};
use super::{FORCE, anywhere, compared, engine, entry, native, off};
use pinwheel_compare::uncertainty::order::Rough;
use pinwheel_compare::uncertainty::{Basis, Method, Source};
use pinwheel_compare::{
    Context, Evidence, Ladder, Level, Metric, Rules, Scales, SharedModel, Verdict, compare,
};
use pinwheel_timeseries::TimeSeries;

#[test]
fn one_law_agrees_to_the_sum_of_both_uncertainties() {
    let peer = engine(
        "peer",
        SharedModel::SharedLaw,
        &time_series(1.0),
        1e-5,
        4.0,
        &[2.0, 4.0],
    );
    let check = compared(&anywhere(), vec![native(1e-4), peer]);
    let entry = entry(&check, FORCE);
    let judgement = &entry.assessments[0];
    assert_eq!(
        (judgement.metric, judgement.decides),
        (Some(Metric::RelativeL2), true)
    );
    let (u_a, u_b) = (judgement.u_a.unwrap(), judgement.u_b.unwrap());
    // Fs times the error's own norm: about 1.25 sqrt(1.5) times its size.
    assert!((1.2e-4..2e-4).contains(&u_a), "{u_a}");
    assert!(
        (1.2e-5..2e-5).contains(&u_b),
        "the other one is sharper: {u_b}"
    );
    let result = (entry.result.verdict, entry.result.bound);
    assert_eq!(result, (Verdict::Agree, Some(u_a + u_b)));
    assert!(judgement.difference.unwrap() < u_a);
    assert_eq!((check.passed, check.counts.exit_status()), (true, 0));
    // Every quantity and window is resolved; each engine has its uncertainties.
    let alone = check.engines.iter().map(|e| e.judged.len()).sum::<usize>();
    assert_eq!(check.counts.agree, check.pairs[0].entries.len() + alone);
    let own = &check.engines[0].uncertainty;
    assert_eq!(own.len(), check.windows.len() * check.quantities.len());
    assert_eq!(own[0].l2.estimate().unwrap().basis, Basis::Observed);
    assert!((own[0].l2.estimate().unwrap().observed_order.unwrap() - 2.0).abs() < 0.01);
}

#[test]
fn crossval_a_fault_of_a_thousandth_is_a_finding() {
    // 0.1 % more force in an engine with an error of 1e-5: `differ`, by at least the excess over U.
    let fault = engine(
        "peer",
        SharedModel::SharedLaw,
        &time_series(1.001),
        1e-5,
        2.0,
        &[2.0, 4.0],
    );
    let check = compared(&anywhere(), vec![native(1e-5), fault]);
    let result = &entry(&check, FORCE).result;
    assert_eq!(result.verdict, Verdict::Differ);
    let at_least = result.difference.unwrap() - result.bound.unwrap();
    assert!((0.9e-3..1e-3).contains(&at_least), "{at_least}");
    assert_eq!(check.counts.exit_status(), 1);
    // A study as coarse as the fault cannot detect it, and states the bound of agreement.
    let blunt = engine(
        "peer",
        SharedModel::SharedLaw,
        &time_series(1.001),
        6e-3,
        2.0,
        &[2.0, 4.0],
    );
    let check = compared(&anywhere(), vec![native(1e-5), blunt]);
    let result = &entry(&check, FORCE).result;
    assert_eq!(result.verdict, Verdict::Agree);
    assert!(result.bound.unwrap() > 1e-3);
}

/// A false alarm: two adaptive runs at a tolerance of 1e-6 are 5e-4 apart, "454954 times the limit".
#[test]
fn regress_adaptive_runs_agree_to_their_tolerance() {
    let adaptive = |name: &str, errors: [f64; 3]| {
        let level = |refinement: f64, error: f64| Level {
            setting: 1e-6 * refinement,
            run: Ok(off(&time_series(1.0), error)),
            wall_s: 1.0,
        };
        let ladder = Ladder {
            method: Method::Tolerance { order: 1.0 },
            finest: 1e-6,
            floor: 0.0,
            coarser: vec![level(100.0, errors[2]), level(10.0, errors[1])],
        };
        let course = off(&time_series(1.0), errors[0]);
        (
            participant(name, SharedModel::Native, course),
            Evidence::refinement(name, ladder),
        )
    };
    let list = || {
        vec![
            adaptive("native-reduced", [3e-4, 2.5e-3, 2.8e-2]),
            adaptive("native-lagrange", [-2e-4, 2.9e-3, 2.2e-2]),
        ]
    };
    let check = compared(&anywhere(), list());
    let entry = entry(&check, FORCE);
    let distance = entry.assessments[0].difference.unwrap();
    assert!((4e-4..7e-4).contains(&distance), "{distance}");
    assert_eq!(entry.result.verdict, Verdict::Agree);
    assert!(entry.result.bound.unwrap() < 5e-3, "{:?}", entry.result);
    assert_eq!(check.counts.exit_status(), 0);
    let basis = check.engines[0].uncertainty[0].l2.estimate().unwrap().basis;
    assert_eq!(basis, Basis::Tolerance);
}

/// An empty pass: two native runs 101 % apart at a coarse step, "13 of 13 within".
#[test]
fn regress_coarse_runs_far_apart_are_never_within() {
    // Runs that bounce where none should: each level another waveform, none near another.
    let wild = |seed: u64| {
        let mut random = Random::new(seed);
        let base = time_series(1.0);
        let mut time_series = TimeSeries::new(base.time_s().to_vec()).unwrap();
        for channel in base.channels() {
            let values = channel.values.iter().map(|v| v * random.between(-1.0, 3.0));
            time_series
                .push(channel.name.clone(), values.collect())
                .unwrap();
        }
        time_series
    };
    for levels in [1, 2, 3] {
        let coarse = |name: &str, seed: u64| {
            let level = |k: u64| Level {
                setting: 4e-5 * 2f64.powf(k as f64),
                run: Ok(wild(seed + k)),
                wall_s: 1.0,
            };
            let ladder = Ladder {
                method: Method::Step {
                    order: 2.0,
                    rough: Some(Rough::Friction),
                },
                finest: 4e-5,
                floor: 0.0,
                coarser: (1..=levels).map(level).collect(),
            };
            (
                participant(name, SharedModel::Native, wild(seed)),
                Evidence::refinement(name, ladder),
            )
        };
        let check = compared(
            &anywhere(),
            vec![coarse("native-reduced", 10), coarse("native-lagrange", 20)],
        );
        for entry in &check.pairs[0].entries {
            let verdict = entry.result.verdict;
            assert_eq!(verdict, Verdict::Inconclusive, "{levels}: {entry:?}");
        }
        assert_eq!(check.counts.exit_status(), 4);
        let of_pairs = check.pairs[0].entries.iter().map(|e| e.result.verdict);
        assert!(of_pairs.eq(check.pairs[0].entries.iter().map(|_| Verdict::Inconclusive)));
        let cell = &check.matrices[0].cells[0].result;
        assert_eq!(cell.verdict.word(), "inconclusive");
    }
    // Without any uncertainty nothing is compared.
    let pair = [
        participant("native", SharedModel::Native, wild(1)),
        participant("native-b", SharedModel::Native, wild(2)),
    ];
    let check = compare(&anywhere(), &pair, &Rules::default()).unwrap();
    let judged = check.pairs[0]
        .entries
        .iter()
        .any(|e| e.result.verdict != Verdict::NotCompared);
    assert!(!judged);
}

/// With friction, 5 % more stiffness in one native engine was once "3 of 3 within".
#[test]
fn regress_a_fault_under_friction_is_detected() {
    let rough = Context {
        friction_coefficient: 0.1,
        ..anywhere()
    };
    let fault = engine(
        "native-lagrange",
        SharedModel::Native,
        &time_series(1.05),
        1e-4,
        1.0,
        &[2.0, 4.0],
    );
    let check = compared(&rough, vec![native(1e-4), fault]);
    let result = &entry(&check, FORCE).result;
    assert_eq!(result.verdict, Verdict::Differ);
    assert!(result.difference.unwrap() - result.bound.unwrap() > 0.045);
}

#[test]
fn rounding_alone_agrees() {
    let (mut a, mut ladder_a) = native(0.0);
    let (b, ladder_b) = engine(
        "native-b",
        SharedModel::Native,
        &time_series(1.0 + 1e-14),
        0.0,
        2.0,
        &[2.0],
    );
    // Levels that differ by rounding, without any order.
    if let Source::Refinement(study) = &mut ladder_a.source {
        for (k, level) in study.coarser.iter_mut().enumerate() {
            level.run = Ok(time_series(1.0 + 3e-15 * (2.0 - k as f64)));
        }
    }
    a.time_series = time_series(1.0);
    let check = compared(&anywhere(), vec![(a, ladder_a), (b, ladder_b)]);
    let result = &entry(&check, FORCE).result;
    assert_eq!(result.verdict, Verdict::Agree);
    assert!(result.bound.unwrap() < 1e-11);
    assert_eq!(
        check.engines[0].uncertainty[0].l2.estimate().unwrap().basis,
        Basis::Rounding
    );
}

#[test]
fn similar_gears_have_the_same_verdicts() {
    // Lengths and forces scaled by 1e-3: torques by 1e-6.
    let small = |time_series: &TimeSeries, grow: f64| {
        let mut scaled = TimeSeries::new(time_series.time_s().to_vec()).unwrap();
        for channel in time_series.channels() {
            let factor = match &channel.name {
                name if name.ends_with("_n_m") => grow * grow,
                name if name.contains("_force_n") => grow,
                _ => 1.0,
            };
            scaled
                .push(
                    channel.name.clone(),
                    channel.values.iter().map(|v| v * factor).collect(),
                )
                .unwrap();
        }
        scaled
    };
    let run = |grow: f64, peer_scale: f64, stated: bool| {
        let mut list = vec![
            native(1e-4),
            engine(
                "peer",
                SharedModel::SharedLaw,
                &time_series(peer_scale),
                1e-4,
                2.0,
                &[2.0, 4.0],
            ),
        ];
        for (participant, evidence) in &mut list {
            participant.time_series = small(&participant.time_series, grow);
            if let Source::Refinement(study) = &mut evidence.source {
                for level in &mut study.coarser {
                    level.run = level
                        .run
                        .clone()
                        .map(|time_series| small(&time_series, grow));
                }
            }
        }
        let scales = Scales {
            force_n: Some(100.0 * grow),
            torque_n_m: Some(22.0 * grow * grow),
        };
        let context = Context {
            load_n_m: Some(22.0 * grow * grow),
            scales: if stated { scales } else { Scales::default() },
            ..anywhere()
        };
        let check = compared(&context, list);
        let words: Vec<String> = check.pairs[0]
            .entries
            .iter()
            .map(|e| e.result.verdict.word().to_owned())
            .collect();
        (
            words,
            check.counts,
            check.engines[0].judged[0].result.verdict,
        )
    };
    for peer in [1.0, 1.01, 1e-14] {
        for stated in [true, false] {
            let (words, counts, load) = run(1.0, peer, stated);
            for grow in [1e-3, 1e-6, 1e3] {
                let (other, other_counts, other_load) = run(grow, peer, stated);
                assert_eq!(
                    (&words, counts, &load),
                    (&other, other_counts, &other_load),
                    "{grow} {peer}"
                );
            }
        }
    }
}
