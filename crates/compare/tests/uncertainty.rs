//! Whole comparisons by numerical uncertainty, on ladders whose errors are known.

mod common;

use common::{Random, context, courses, participant};
use pinwheel_compare::comparison::{Comparison, PairEntry};
use pinwheel_compare::model::TOLERANCES;
use pinwheel_compare::uncertainty::{Basis, Method, Norm, Source, Unresolved};
use pinwheel_compare::{
    CompareError, Context, DataUncertainty, Divergence, Energy, Evidence, Ladder, Metric, Outcome,
    Participant, Rules, Rung, Scales, StatedLimit, Track, Verdict, WindowKind, compare,
    compare_with, limits,
};
use pinwheel_courses::Courses;

const FORCE: &str = "external_sleeve_force_n";
const TORQUE: &str = "input_torque_n_m";

/// The gear nobody calibrated.
fn anywhere() -> Context {
    Context {
        guarded: None,
        ..context()
    }
}

/// `base` with an error of relative size `error` in every channel: a wave of its own, the same for every rung.
fn off(base: &Courses, error: f64) -> Courses {
    let mut courses = Courses::new(base.time_s().to_vec()).unwrap();
    for (k, channel) in base.channels().iter().enumerate() {
        let shape = |t: f64| 1.0 + error * (1.0 + (35.0 * t + k as f64).sin());
        let values = channel
            .values
            .iter()
            .zip(base.time_s())
            .map(|(v, &t)| v * shape(t));
        courses
            .push(channel.name.clone(), values.collect())
            .unwrap();
    }
    courses
}

/// An engine whose error at H times its step is `error * H^order`, and its ladder at the refinements.
fn engine(
    name: &str,
    on: Track,
    base: &Courses,
    error: f64,
    order: f64,
    refinements: &[f64],
) -> (Participant, Evidence) {
    let at = |h: f64| off(base, error * h.powf(order));
    let rung = |&refinement: &f64| Rung {
        refinement,
        run: Ok(at(refinement)),
        wall_s: 1.0,
    };
    let ladder = Ladder {
        method: Method::Step { order, limit: None },
        finest: 1e-5,
        coarser: refinements.iter().map(rung).collect(),
    };
    let mut participant = participant(name, on, at(1.0));
    participant.cost.steps = 60_000;
    (participant, Evidence::ladder(name, ladder))
}

fn compared(context: &Context, list: Vec<(Participant, Evidence)>) -> Comparison {
    let (participants, evidence): (Vec<_>, Vec<_>) = list.into_iter().unzip();
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    compare_with(context, &participants, &rules).unwrap()
}

fn entry<'a>(comparison: &'a Comparison, quantity: &str) -> &'a PairEntry {
    let entries = comparison.pairs[0].entries.iter();
    let mut steady = entries.filter(|e| e.window == WindowKind::Steady);
    steady.find(|e| e.quantity == quantity).unwrap()
}

fn native(error: f64) -> (Participant, Evidence) {
    engine(
        "native",
        Track::Native,
        &courses(1.0),
        error,
        2.0,
        &[2.0, 4.0],
    )
}

#[test]
fn one_law_agrees_to_the_sum_of_both_uncertainties() {
    let peer = engine(
        "peer",
        Track::SharedLaw,
        &courses(1.0),
        1e-5,
        4.0,
        &[2.0, 4.0],
    );
    let found = compared(&anywhere(), vec![native(1e-4), peer]);
    let entry = entry(&found, FORCE);
    let judgement = &entry.judgements[0];
    assert_eq!(
        (judgement.metric, judgement.counts),
        (Metric::RelativeL2, true)
    );
    let (u_a, u_b) = (judgement.u_a.unwrap(), judgement.u_b.unwrap());
    // Fs times the error's own norm: about 1.25 sqrt(1.5) times its size.
    assert!((1.2e-4..2e-4).contains(&u_a), "{u_a}");
    assert!(
        (1.2e-5..2e-5).contains(&u_b),
        "the other one is sharper: {u_b}"
    );
    assert_eq!(entry.verdict, Verdict::Agree { to: u_a + u_b });
    assert!(judgement.distance.unwrap() < u_a);
    assert_eq!(
        (found.outcome, found.passed, found.outcome.exit_status()),
        (Outcome::Passed, true, 0)
    );
    // Every quantity and window has been resolved; the uncertainties stand with each engine.
    assert_eq!(found.counts.agree, found.pairs[0].entries.len());
    let own = &found.engines[0].uncertainty;
    assert_eq!(own.len(), found.windows.len() * found.quantities.len());
    assert_eq!(own[0].l2.estimate().unwrap().basis, Basis::Observed);
    assert!((own[0].l2.estimate().unwrap().observed_order.unwrap() - 2.0).abs() < 0.01);
}

#[test]
fn crossval_a_fault_of_a_thousandth_is_a_finding() {
    // 0.1 % more force, in an engine that is right to 1e-5: `differ`, by at least what is left beyond U.
    let fault = engine(
        "peer",
        Track::SharedLaw,
        &courses(1.001),
        1e-5,
        2.0,
        &[2.0, 4.0],
    );
    let found = compared(&anywhere(), vec![native(1e-5), fault]);
    let Verdict::Differ { at_least } = entry(&found, FORCE).verdict else {
        panic!("{:?}", entry(&found, FORCE).verdict);
    };
    assert!((0.9e-3..1e-3).contains(&at_least), "{at_least}");
    assert_eq!(
        (found.outcome, found.outcome.exit_status()),
        (Outcome::Finding, 1)
    );
    // A ladder as coarse as the fault cannot tell, and says to what it agrees.
    let blunt = engine(
        "peer",
        Track::SharedLaw,
        &courses(1.001),
        6e-3,
        2.0,
        &[2.0, 4.0],
    );
    let found = compared(&anywhere(), vec![native(1e-5), blunt]);
    assert!(matches!(entry(&found, FORCE).verdict, Verdict::Agree { to } if to > 1e-3));
}

/// The false alarm: two adaptive runs at a tolerance of 1e-6 are 5e-4 apart, "454954 times the limit".
#[test]
fn regress_adaptive_runs_agree_to_their_tolerance() {
    let adaptive = |name: &str, errors: [f64; 3]| {
        let rung = |refinement: f64, error: f64| Rung {
            refinement,
            run: Ok(off(&courses(1.0), error)),
            wall_s: 1.0,
        };
        let ladder = Ladder {
            method: Method::Tolerance { smooth: true },
            finest: 1e-6,
            coarser: vec![rung(100.0, errors[2]), rung(10.0, errors[1])],
        };
        let course = off(&courses(1.0), errors[0]);
        (
            participant(name, Track::Native, course),
            Evidence::ladder(name, ladder),
        )
    };
    let list = || {
        vec![
            adaptive("native-reduced", [3e-4, 2.5e-3, 2.8e-2]),
            adaptive("native-lagrange", [-2e-4, 2.9e-3, 2.2e-2]),
        ]
    };
    let found = compared(&anywhere(), list());
    let entry = entry(&found, FORCE);
    let distance = entry.judgements[0].distance.unwrap();
    assert!((4e-4..7e-4).contains(&distance), "{distance}");
    assert!(
        matches!(entry.verdict, Verdict::Agree { to } if to < 5e-3),
        "{:?}",
        entry.verdict
    );
    assert_eq!(found.outcome.exit_status(), 0);
    let basis = found.engines[0].uncertainty[0].l2.estimate().unwrap().basis;
    assert_eq!(basis, Basis::Tolerance);
}

/// The empty pass: two native runs 101 % apart at a coarse step, "13 of 13 within".
#[test]
fn regress_coarse_runs_far_apart_are_never_within() {
    // Runs that bounce where none should: each rung another waveform, none near another.
    let wild = |seed: u64| {
        let mut random = Random::new(seed);
        let base = courses(1.0);
        let mut courses = Courses::new(base.time_s().to_vec()).unwrap();
        for channel in base.channels() {
            let values = channel.values.iter().map(|v| v * random.between(-1.0, 3.0));
            courses
                .push(channel.name.clone(), values.collect())
                .unwrap();
        }
        courses
    };
    for rungs in [1, 2, 3] {
        let coarse = |name: &str, seed: u64| {
            let rung = |k: u64| Rung {
                refinement: 2f64.powf(k as f64),
                run: Ok(wild(seed + k)),
                wall_s: 1.0,
            };
            let ladder = Ladder {
                method: Method::Step {
                    order: 2.0,
                    limit: Some(1.0),
                },
                finest: 4e-5,
                coarser: (1..=rungs).map(rung).collect(),
            };
            (
                participant(name, Track::Native, wild(seed)),
                Evidence::ladder(name, ladder),
            )
        };
        let found = compared(
            &anywhere(),
            vec![coarse("native-reduced", 10), coarse("native-lagrange", 20)],
        );
        for entry in &found.pairs[0].entries {
            assert!(
                matches!(entry.verdict, Verdict::NotResolved { .. }),
                "{rungs}: {entry:?}"
            );
        }
        assert_eq!(found.outcome.exit_status(), 1);
        assert_eq!((found.counts.agree, found.counts.within), (0, 0), "{rungs}");
        assert_eq!(found.matrices[0].cells[0].verdict.word(), "not resolved");
    }
    // By limits alone nothing is judged of a gear that nobody measured, which is no pass.
    let pair = [
        participant("native", Track::Native, wild(1)),
        participant("native-b", Track::Native, wild(2)),
    ];
    let found = compare(&anywhere(), &pair, limits::TABLE).unwrap();
    let judged = found.pairs[0]
        .entries
        .iter()
        .any(|e| e.verdict.outcome() != Outcome::Nothing);
    assert!(!judged);
}

/// With friction, 5 % more stiffness in one native engine was "3 of 3 within".
#[test]
fn regress_a_fault_under_friction_is_seen() {
    let rough = Context {
        friction_coefficient: 0.1,
        ..anywhere()
    };
    let fault = engine(
        "native-lagrange",
        Track::Native,
        &courses(1.05),
        1e-4,
        1.0,
        &[2.0, 4.0],
    );
    let found = compared(&rough, vec![native(1e-4), fault]);
    assert!(
        matches!(entry(&found, FORCE).verdict, Verdict::Differ { at_least } if at_least > 0.045)
    );
}

/// A scene that amplifies roundings decides by itself how sharp its figures are: stated and no failure, and no pass.
#[test]
fn hard_chaos_is_stated() {
    let chaotic = Context {
        divergence: Some(Divergence {
            horizon_s: Some(0.0),
            largest_share: 1.0,
            told: String::new(),
        }),
        ..anywhere()
    };
    let peer = || {
        engine(
            "native-lagrange",
            Track::Native,
            &courses(1.0),
            0.3,
            2.0,
            &[2.0, 4.0],
        )
    };
    let found = compared(&chaotic, vec![native(0.3), peer()]);
    assert!(
        found.counts.stated > 0 && found.counts.not_resolved == 0,
        "{:?}",
        found.counts
    );
    assert_eq!(found.outcome.exit_status(), 0);
    // The same before the horizon is a failure.
    let found = compared(&anywhere(), vec![native(0.3), peer()]);
    assert!(
        found.counts.stated == 0 && found.counts.not_resolved > 0,
        "{:?}",
        found.counts
    );
}

/// What an engine's own iterations leave no step takes off: it bounds how sharp a statement may be.
#[test]
fn regress_iterations_leave_a_floor() {
    let offset = |floor: f64| {
        let base = off(&courses(1.0), 1e-9);
        let steps = [2.0, 4.0];
        let (peer, evidence) = engine("implicit", Track::Native, &base, 1e-12, 2.0, &steps);
        compared(
            &anywhere(),
            vec![native(1e-12), (peer, evidence.with_floor(floor))],
        )
    };
    assert!(matches!(
        entry(&offset(0.0), FORCE).verdict,
        Verdict::Differ { .. }
    ));
    assert!(matches!(
        entry(&offset(1e-8), FORCE).verdict,
        Verdict::Agree { .. }
    ));
}

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

#[test]
fn rounding_alone_agrees() {
    let (mut a, mut ladder_a) = native(0.0);
    let (b, ladder_b) = engine(
        "native-b",
        Track::Native,
        &courses(1.0 + 1e-14),
        0.0,
        2.0,
        &[2.0],
    );
    // Rungs that differ by rounding in no order at all.
    if let Source::Ladder(ladder) = &mut ladder_a.source {
        for (k, rung) in ladder.coarser.iter_mut().enumerate() {
            rung.run = Ok(courses(1.0 + 3e-15 * (2.0 - k as f64)));
        }
    }
    a.courses = courses(1.0);
    let found = compared(&anywhere(), vec![(a, ladder_a), (b, ladder_b)]);
    assert!(matches!(entry(&found, FORCE).verdict, Verdict::Agree { to } if to < 1e-11));
    assert_eq!(
        found.engines[0].uncertainty[0].l2.estimate().unwrap().basis,
        Basis::Rounding
    );
}

/// A bounce that one run of the ladder has and another has not. Two rungs that both miss it cannot know.
#[test]
fn hard_a_bounce_that_coarser_runs_miss() {
    let bounce = |base: Courses| {
        let mut courses = Courses::new(base.time_s().to_vec()).unwrap();
        for channel in base.channels() {
            let mut values = channel.values.clone();
            if channel.name.starts_with(FORCE) {
                values[450] = 0.0;
                values[451] = 300.0;
            }
            courses.push(channel.name.clone(), values).unwrap();
        }
        courses
    };
    let exact = engine(
        "exact",
        Track::Native,
        &bounce(courses(1.0)),
        1e-6,
        2.0,
        &[2.0, 4.0],
    );
    let (mut seeing, mut ladder) = native(1e-6);
    seeing.courses = bounce(seeing.courses);
    let found = compared(
        &anywhere(),
        vec![exact.clone(), (seeing.clone(), ladder.clone())],
    );
    assert!(
        matches!(&entry(&found, FORCE).verdict, Verdict::NotResolved { participant, .. } if participant == "native"),
        "only the finest has it"
    );
    if let Source::Ladder(ladder) = &mut ladder.source {
        let fine = ladder.coarser[0].run.clone().unwrap();
        ladder.coarser[0].run = Ok(bounce(fine));
    }
    let found = compared(&anywhere(), vec![exact, (seeing, ladder)]);
    // The coarsest misses it: super-convergence by accident, which costs sharpness and no more.
    let estimate = *found.engines[1]
        .uncertainty
        .iter()
        .find(|u| u.quantity == FORCE)
        .unwrap()
        .l2
        .estimate()
        .unwrap();
    assert_eq!(estimate.basis, Basis::Unconfirmed);
    assert!(!matches!(
        entry(&found, FORCE).verdict,
        Verdict::Differ { .. }
    ));
}

#[test]
fn similar_gears_have_the_same_verdicts() {
    // Lengths and forces a thousandth: torques a millionth.
    let small = |courses: &Courses, grow: f64| {
        let mut scaled = Courses::new(courses.time_s().to_vec()).unwrap();
        for channel in courses.channels() {
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
                Track::SharedLaw,
                &courses(peer_scale),
                1e-4,
                2.0,
                &[2.0, 4.0],
            ),
        ];
        for (participant, evidence) in &mut list {
            participant.courses = small(&participant.courses, grow);
            if let Source::Ladder(ladder) = &mut evidence.source {
                for rung in &mut ladder.coarser {
                    rung.run = rung.run.clone().map(|courses| small(&courses, grow));
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
        let found = compared(&context, list);
        let words: Vec<String> = found.pairs[0]
            .entries
            .iter()
            .map(|e| e.verdict.word().to_owned())
            .collect();
        (
            words,
            found.counts,
            found.engines[0].judged[0].verdict.clone(),
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

fn account(remainder_share: f64) -> Energy {
    Energy {
        from_s: 0.3,
        to_s: 0.6,
        driver_j: 20.0,
        load_j: -20.19,
        kinetic_j: 0.0,
        stored_j: 0.0,
        damping_j: 0.0,
        friction_j: 0.0,
        remainder_j: 20.0 * remainder_share,
        remainder_share: Some(remainder_share),
    }
}

#[test]
fn own_contact_is_an_interval_against_a_prediction() {
    let run = |torque: f64, energy: Option<f64>, error: f64| {
        let mut own = engine(
            "mujoco-own-contact",
            Track::OwnContact,
            &courses(torque),
            error,
            2.0,
            &[2.0, 4.0],
        );
        own.0.cost.notes.clear();
        let (mut native, evidence) = native(1e-5);
        native.cost.energy = energy.map(account).into_iter().collect();
        compared(&anywhere(), vec![(native, evidence), own])
    };
    // The law creates 0.95 % of the power: the conservative bed needs as much more torque.
    let found = run(1.0095, Some(0.0095), 1e-5);
    let of_torque = |found: &Comparison| entry(found, TORQUE).judgements[0].clone();
    let Verdict::ModelDifference {
        low,
        high,
        predicted,
        tolerance,
        within,
    } = of_torque(&found).verdict
    else {
        panic!("{:?}", of_torque(&found));
    };
    assert_eq!(
        (predicted, tolerance, within),
        (-0.0095, Some(5e-3), Some(true))
    );
    let difference = -0.0095 / 1.0095;
    assert!(
        low < difference && difference < high && high - low < 1e-4,
        "{low} {high}"
    );
    // The same difference where none is predicted is beyond what a bed states.
    let conservative = of_torque(&run(1.0095, Some(0.0), 1e-5)).verdict;
    assert!(
        matches!(
            conservative,
            Verdict::ModelDifference {
                within: Some(false),
                ..
            }
        ),
        "{conservative:?}"
    );
    assert_eq!(run(1.0095, Some(0.0), 1e-5).outcome, Outcome::Finding);
    // In the wrong direction too.
    let wrong = of_torque(&run(0.9905, Some(0.0095), 1e-5)).verdict;
    assert!(matches!(
        wrong,
        Verdict::ModelDifference {
            within: Some(false),
            ..
        }
    ));
    // Without an account there is no prediction, so nothing to be within of.
    let unknown = of_torque(&run(1.0095, None, 1e-5)).verdict;
    assert!(matches!(
        unknown,
        Verdict::ModelDifference { within: None, .. }
    ));
    // A blunt ladder does not pass by being blunt.
    let blunt = of_torque(&run(1.0095, Some(0.0095), 3e-2)).verdict;
    assert!(matches!(blunt, Verdict::NotResolved { .. }), "{blunt:?}");
    for row in TOLERANCES {
        assert!(row.tolerance >= 0.0 && row.reason.ends_with('.'), "{row:?}");
    }
}

#[test]
fn the_matrix_shows_the_figure_that_was_judged() {
    // Wave forms 41 % apart, which nobody judges of colliders; their means are, and agree.
    let base = courses(1.0);
    let mut waves = Courses::new(base.time_s().to_vec()).unwrap();
    for channel in base.channels() {
        let flipped = |v: &f64| {
            if channel.name.starts_with(FORCE) {
                120.0 - v
            } else {
                *v
            }
        };
        waves
            .push(
                channel.name.clone(),
                channel.values.iter().map(flipped).collect(),
            )
            .unwrap();
    }
    let own = engine(
        "rapier-own-contact-colliders",
        Track::OwnContact,
        &waves,
        1e-5,
        2.0,
        &[2.0, 4.0],
    );
    let (mut native, evidence) = native(1e-5);
    native.cost.energy = vec![account(0.0)];
    let found = compared(&anywhere(), vec![(native, evidence), own]);
    let metrics = entry(&found, FORCE).metrics.as_ref().unwrap();
    assert!(metrics.relative_l2.unwrap() > 0.4);
    let cell = found.matrices[0].cell(0, 1).unwrap();
    assert_eq!(cell.verdict.word(), "model difference");
    assert_eq!(cell.worst_metric, Some(Metric::Mean));
    assert!(cell.worst.unwrap() < 0.05, "{cell:?}");
    // By the table as well.
    let rules = Rules::default();
    let pair = [
        participant("native", Track::Native, base),
        participant("rapier-own-contact-colliders", Track::OwnContact, waves),
    ];
    let found = compare_with(&context(), &pair, &rules).unwrap();
    let cell = found.matrices[0].cell(0, 1).unwrap();
    assert_eq!(
        (cell.verdict.word(), cell.worst_metric),
        ("within", Some(Metric::Mean))
    );
    assert!(cell.worst.unwrap() < 0.05 && cell.force.unwrap() > 0.4);
    // Exceeded pairs show what exceeded.
    let far = [
        pair[0].clone(),
        participant(
            "rapier-own-contact-colliders",
            Track::OwnContact,
            courses(1.3),
        ),
    ];
    let found = compare_with(&context(), &far, &rules).unwrap();
    let cell = found.matrices[0].cell(0, 1).unwrap();
    assert_eq!(cell.verdict, Verdict::Exceeded);
    assert!((cell.worst.unwrap() - 0.3 / 1.3).abs() < 1e-6);
}

#[test]
fn measured_data_get_a_budget() {
    let run = |scale: f64, data: &[DataUncertainty]| {
        let (native, evidence) = native(1e-4);
        let rig = participant("rig", Track::Measured, courses(scale));
        let rules = Rules {
            evidence: &[evidence],
            data,
            ..Rules::default()
        };
        compare_with(&anywhere(), &[native, rig], &rules).unwrap()
    };
    let stated = DataUncertainty {
        engine: "rig".to_owned(),
        quantity: "*_force_n".to_owned(),
        data: 0.004,
        input: 0.003,
    };
    let found = run(1.009, std::slice::from_ref(&stated));
    let judgement = &entry(&found, FORCE).judgements[0];
    let budget = judgement.budget.unwrap();
    assert!((budget.validation() - 0.005).abs() < 1e-5, "{budget:?}");
    assert!(
        matches!(entry(&found, FORCE).verdict, Verdict::NotDistinguishable { level } if (level - 0.01).abs() < 1e-5)
    );
    assert!(
        matches!(entry(&found, TORQUE).verdict, Verdict::NotJudged { .. }),
        "nothing stated of it"
    );
    let found = run(1.02, std::slice::from_ref(&stated));
    let Verdict::ModelError { low, high } = entry(&found, FORCE).verdict else {
        panic!();
    };
    assert!((high - low - 0.02).abs() < 1e-4 && low > 0.009);
    // The simulation's mean is the smaller one: E = S - D < 0, in either order.
    let mean = entry(&found, FORCE)
        .judgements
        .iter()
        .find(|j| j.metric == Metric::Mean)
        .unwrap();
    assert!(
        (mean.distance.unwrap() + 0.02 / 1.02).abs() < 1e-3,
        "{mean:?}"
    );
    assert_eq!(
        found.counts.model, 2,
        "steady and transient; a model error is a result, not a failure"
    );
}

#[test]
fn bad_input_a_stated_limit_that_matches_nothing() {
    let run = |quantity: &str, window: WindowKind| {
        let stated = [StatedLimit {
            engine: "rig".to_owned(),
            window,
            quantity: quantity.to_owned(),
            metric: Metric::Mean,
            limit: 1e-3,
            reason: "Test.".to_owned(),
        }];
        let pair = [
            native(0.0).0,
            participant("rig", Track::Measured, courses(1.0)),
        ];
        let rules = Rules {
            stated: &stated,
            ..Rules::default()
        };
        compare_with(&anywhere(), &pair, &rules)
    };
    assert_eq!(
        run("*_force_n", WindowKind::Steady).unwrap().counts.within,
        2
    );
    let error = run("*_torqe_n_m", WindowKind::Steady)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("`*_torqe_n_m`") && error.contains("input_torque_n_m"),
        "{error}"
    );
    let error = run("*_force_n", WindowKind::Whole).unwrap_err().to_string();
    assert!(error.contains("the windows steady, transient"), "{error}");
}

#[test]
fn undefined_efficiencies_have_a_reason() {
    let of = |context: &Context| {
        let found = compare(context, &[native(0.0).0], limits::TABLE).unwrap();
        let figures = found.engines[0].figures[0].clone();
        (
            figures.efficiency,
            figures.efficiency_reason.unwrap_or_default(),
        )
    };
    assert!(of(&context()).0.is_some());
    let unloaded = Context {
        load_n_m: Some(0.0),
        ..context()
    };
    assert_eq!(
        of(&unloaded),
        (
            None,
            "the scene has no load, so no power is delivered".to_owned()
        )
    );
    let still = Context {
        input_speed_rad_s: Some(0.0),
        ..context()
    };
    assert_eq!(of(&still), (None, "the driver stands still".to_owned()));
    let back = Context {
        input_speed_rad_s: Some(-52.34),
        ..context()
    };
    assert_eq!(of(&back), (None, "no power goes in".to_owned()));
    // Rounding is no load, and a power far above what goes in comes from what was stored.
    let next_to_nothing = Context {
        load_n_m: Some(2e-10),
        ..context()
    };
    assert_eq!(of(&next_to_nothing), of(&unloaded));
    let creeping = Context {
        input_speed_rad_s: Some(1e-9),
        ..context()
    };
    let (none, reason) = of(&creeping);
    assert!(
        none.is_none() && reason.contains("does not come from the input"),
        "{reason}"
    );
    // With an account the energy that the law creates is taken out.
    let mut run = native(0.0).0;
    run.cost.energy = vec![account(0.0095)];
    let found = compare(&context(), &[run], limits::TABLE).unwrap();
    let figures = &found.engines[0].figures[0];
    let share = figures.efficiency_accounted.unwrap() / figures.efficiency.unwrap();
    assert!((share - 1.0 / 1.0095).abs() < 1e-12);
}

/// Extrapolated series are nearer to the truth, by an order of magnitude, and say so.
#[test]
fn crossval_extrapolation_sharpens() {
    let peer = engine(
        "peer",
        Track::SharedLaw,
        &courses(1.0),
        3e-4,
        2.0,
        &[2.0, 4.0],
    );
    let found = compared(&anywhere(), vec![native(1e-4), peer]);
    let entry = entry(&found, FORCE);
    let plain = entry.judgements[0].combined().unwrap();
    let sharp = entry.extrapolated.as_ref().unwrap();
    assert!(
        sharp.combined().unwrap() < plain / 10.0,
        "{sharp:?} {plain}"
    );
    assert!(sharp.distance.unwrap() < entry.judgements[0].distance.unwrap() / 100.0);
    assert!(matches!(sharp.verdict, Verdict::Agree { .. }));
    // A fault below U is seen there; it does not count for the verdict, and stands beside it.
    let fault = engine(
        "peer",
        Track::SharedLaw,
        &courses(1.0001),
        3e-4,
        2.0,
        &[2.0, 4.0],
    );
    let found = compared(&anywhere(), vec![native(3e-4), fault]);
    let entry = self::entry(&found, FORCE);
    assert!(matches!(entry.verdict, Verdict::Agree { .. }));
    assert!(
        matches!(entry.extrapolated.as_ref().unwrap().verdict, Verdict::Differ { at_least } if at_least > 5e-5)
    );
}

/// Every norm and figure: u is at least the true error in 95 of 100 cases, and not blunt. The errors of the rungs have
/// shapes of their own beside the common one.
#[test]
fn crossval_series_and_figures_are_covered() {
    let mut random = Random::new(11);
    let truth = courses(1.0);
    let norms = [Norm::L2, Norm::Linf, Norm::Mean, Norm::Peak, Norm::Rms];
    let (mut honest, mut cases, mut ratios) = ([0usize; 5], [0usize; 5], vec![Vec::new(); 5]);
    for _ in 0..60 {
        let order = if random.between(0.0, 1.0) < 0.5 {
            2.0
        } else {
            4.0
        };
        let size = 10f64.powf(random.between(-6.0, -3.5));
        let (phase, rate) = (random.between(0.0, 6.0), random.between(20.0, 200.0));
        let mut at = |h: f64| {
            let (own, shift) = (random.between(-0.15, 0.15), random.between(0.0, 6.0));
            let mut courses = Courses::new(truth.time_s().to_vec()).unwrap();
            for (k, channel) in truth.channels().iter().enumerate() {
                let scale = channel.values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                let error = |t: f64| {
                    let common = (rate * t + phase + k as f64).sin();
                    size * h.powf(order) * scale * (common + own * (77.0 * t + shift).cos())
                };
                let values = channel
                    .values
                    .iter()
                    .zip(truth.time_s())
                    .map(|(v, &t)| v + error(t));
                courses
                    .push(channel.name.clone(), values.collect())
                    .unwrap();
            }
            courses
        };
        let finest = at(1.0);
        let rungs = [2.0, 4.0].map(|refinement| Rung {
            refinement,
            run: Ok(at(refinement)),
            wall_s: 1.0,
        });
        let ladder = Ladder {
            method: Method::Step { order, limit: None },
            finest: 1e-5,
            coarser: rungs.to_vec(),
        };
        let list = [
            participant("a", Track::Native, finest),
            participant("truth", Track::Native, truth.clone()),
        ];
        let evidence = [
            Evidence::ladder("a", ladder),
            Evidence {
                engine: "truth".to_owned(),
                source: Source::Exact(0.0),
                excuse: None,
                floor: 0.0,
            },
        ];
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let found = compare_with(&anywhere(), &list, &rules).unwrap();
        for (entry, own) in found.pairs[0]
            .entries
            .iter()
            .zip(&found.engines[0].uncertainty)
        {
            let figures = |k: usize| {
                let figures = found.engines[k]
                    .figures
                    .iter()
                    .find(|f| f.window == entry.window)
                    .unwrap();
                figures.quantities[&entry.quantity]
            };
            let (a, b) = (figures(0), figures(1));
            let metrics = entry.metrics.as_ref().unwrap();
            let errors = [
                metrics.difference_rms.unwrap(),
                metrics.difference_max.unwrap(),
                (a.mean - b.mean).abs(),
                (a.peak - b.peak).abs(),
                (a.rms - b.rms).abs(),
            ];
            assert_eq!(own.quantity, entry.quantity);
            for (k, norm) in norms.iter().enumerate() {
                if let Some(u) = own.of(*norm).u() {
                    cases[k] += 1;
                    honest[k] += usize::from(u >= errors[k]);
                    ratios[k].push(u / errors[k]);
                }
            }
        }
    }
    for k in 0..5 {
        let mut of = std::mem::take(&mut ratios[k]);
        of.sort_by(f64::total_cmp);
        let (coverage, median) = (honest[k] as f64 / cases[k] as f64, of[of.len() / 2]);
        println!(
            "{:?}: {} cases, coverage {coverage:.3}, median u/error {median:.2}",
            norms[k], cases[k]
        );
        assert!(coverage >= 0.95, "{:?} {coverage}", norms[k]);
        assert!(median < 5.0, "{:?} {median}", norms[k]);
    }
}
