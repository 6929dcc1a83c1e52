//! What a run of mutants over the judge left alive: each test kills one that nothing else did (docs/mutation.md).

mod common;

use common::{context, courses, participant};
use pinwheel_compare::comparison::{Comparison, PairEntry};
use pinwheel_compare::limits::{Friction, Limit};
use pinwheel_compare::uncertainty::{Basis, Estimate, Method, order};
use pinwheel_compare::verdict::{self, Counts, Outcome, Side};
use pinwheel_compare::{
    Context, Divergence, Evidence, Ladder, Metric, Participant, Rules, Rung, StatedLimit, Track,
    Verdict, WindowKind, compare_with,
};
use pinwheel_courses::Courses;

const FORCE: &str = "external_sleeve_force_n";

fn native() -> Participant {
    participant("native", Track::Native, courses(1.0))
}

fn other(track: Track, scale: f64) -> Participant {
    participant("other", track, courses(scale))
}

fn row(window: WindowKind, limit: f64) -> Limit {
    Limit {
        track: "*",
        engine: "other",
        step_at_most_s: None,
        against: "native*",
        against_step_at_most_s: None,
        friction: Friction::Any,
        window,
        quantity: "*_force_n",
        metric: Metric::RelativeL2,
        limit,
        measured: None,
        reason: "Test.",
    }
}

fn unknown(name: &str) -> Evidence {
    Evidence::unknown(name, "nobody knows", "ask")
}

fn entry(found: &Comparison, window: WindowKind) -> &PairEntry {
    let mut entries = found.pairs[0].entries.iter();
    entries
        .find(|e| e.quantity == FORCE && e.window == window)
        .unwrap()
}

/// The forces with one value replaced.
fn spoiled(value: f64) -> Courses {
    let base = courses(1.0);
    let mut found = Courses::new(base.time_s().to_vec()).unwrap();
    for channel in base.channels() {
        let mut values = channel.values.clone();
        if channel.name.starts_with(FORCE) {
            values[500] = value;
        }
        found.push(channel.name.clone(), values).unwrap();
    }
    found
}

/// Another engine's excuse excuses nobody else.
#[test]
fn regress_an_excuse_is_its_engines_own() {
    let at = |evidence: [Evidence; 2]| {
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let free = Context {
            guarded: None,
            ..context()
        };
        let pair = [native(), other(Track::SharedLaw, 1.0)];
        let found = compare_with(&free, &pair, &rules).unwrap();
        let verdict = entry(&found, WindowKind::Steady).verdict.clone();
        let Verdict::NotResolved {
            participant,
            stated,
            ..
        } = verdict
        else {
            panic!("{verdict:?}");
        };
        (participant, stated, found.outcome.exit_status())
    };
    let (name, stated, status) = at([unknown("native"), unknown("other").excused("it is old")]);
    assert_eq!((name.as_str(), stated, status), ("native", false, 1));
    let (name, stated, _) = at([unknown("native").excused("it is new"), unknown("other")]);
    assert_eq!((name.as_str(), stated), ("native", true));
}

/// A limit stated for one window of measured data says nothing of the other, and holds up to its very value.
#[test]
fn regress_stated_limits_hold_in_their_window() {
    let at = |limit: f64| {
        let stated = [StatedLimit {
            engine: "other".to_owned(),
            window: WindowKind::Steady,
            quantity: "*_force_n".to_owned(),
            metric: Metric::RelativeL2,
            limit,
            reason: "Test.".to_owned(),
        }];
        let rules = Rules {
            stated: &stated,
            ..Rules::default()
        };
        let pair = [native(), other(Track::Measured, 0.99)];
        compare_with(&context(), &pair, &rules).unwrap()
    };
    let found = at(0.1);
    assert_eq!(entry(&found, WindowKind::Steady).verdict, Verdict::Within);
    let transient = entry(&found, WindowKind::Transient);
    assert!(transient.checks.is_empty(), "{transient:?}");
    let check = &entry(&found, WindowKind::Steady).checks[0];
    let value = check.value.unwrap();
    assert_eq!(check.share(), value / 0.1);
    assert_eq!(
        entry(&at(value), WindowKind::Steady).verdict,
        Verdict::Within
    );
    let below = at(value.next_down());
    assert_eq!(entry(&below, WindowKind::Steady).verdict, Verdict::Exceeded);
}

/// A row of the table is about its window alone.
#[test]
fn regress_rows_of_the_table_hold_in_their_window() {
    let rules = Rules {
        limits: &[row(WindowKind::Transient, 1e-9)],
        ..Rules::default()
    };
    let pair = [native(), other(Track::SharedLaw, 0.99)];
    let found = compare_with(&context(), &pair, &rules).unwrap();
    assert_eq!(
        entry(&found, WindowKind::Transient).verdict,
        Verdict::Exceeded
    );
    assert!(entry(&found, WindowKind::Steady).checks.is_empty());
}

/// Where the table speaks, an unknown uncertainty takes nothing from it; where it is silent, the same is not resolved.
#[test]
fn regress_the_table_speaks_where_ladders_are_silent() {
    let evidence = [unknown("native"), unknown("other")];
    let rules = Rules {
        limits: &[row(WindowKind::Steady, 0.1)],
        evidence: &evidence,
        ..Rules::default()
    };
    let pair = [native(), other(Track::SharedLaw, 0.99)];
    let found = compare_with(&context(), &pair, &rules).unwrap();
    assert_eq!(entry(&found, WindowKind::Steady).verdict, Verdict::Within);
    let transient = &entry(&found, WindowKind::Transient).verdict;
    assert!(
        matches!(transient, Verdict::NotResolved { .. }),
        "{transient:?}"
    );
}

/// A mean that balances the load does so whatever is known of it; one that does not is not resolved where its
/// uncertainty is not known.
#[test]
fn regress_an_unknown_mean_is_not_held_against_the_load() {
    let at = |scale: f64| {
        let base = courses(1.0);
        let mut turned = Courses::new(base.time_s().to_vec()).unwrap();
        for channel in base.channels() {
            let output = channel.name == "output_torque_n_m";
            let factor = if output { scale } else { 1.0 };
            let values = channel.values.iter().map(|v| factor * v).collect();
            turned.push(channel.name.clone(), values).unwrap();
        }
        let evidence = [unknown("native")];
        let rules = Rules {
            evidence: &evidence,
            limits: pinwheel_compare::limits::TABLE,
            ..Rules::default()
        };
        let one = [participant("native", Track::Native, turned)];
        let found = compare_with(&context(), &one, &rules).unwrap();
        found.engines[0].judged[0].verdict.clone()
    };
    assert_eq!(at(1.0), Verdict::Within);
    let off = at(1.01);
    assert!(matches!(off, Verdict::NotResolved { .. }), "{off:?}");
}

/// Beyond the horizon means and RMS are judged, and no sample is held against a sample.
#[test]
fn regress_beyond_the_horizon_figures_are_judged() {
    let parted = Context {
        guarded: None,
        divergence: Some(Divergence {
            horizon_s: Some(0.1),
            largest_share: 1.0,
            told: String::new(),
        }),
        ..context()
    };
    for track in [Track::SharedLaw, Track::OwnContact] {
        let evidence = [unknown("native"), unknown("other")];
        let rules = Rules {
            evidence: &evidence,
            tolerances: pinwheel_compare::model::TOLERANCES,
            ..Rules::default()
        };
        let pair = [native(), other(track, 1.0)];
        let found = compare_with(&parted, &pair, &rules).unwrap();
        let judged = &entry(&found, WindowKind::Steady).judgements;
        assert!(!judged.is_empty(), "{track:?}");
        assert!(
            judged.iter().all(|j| !j.metric.is_pointwise()),
            "{judged:?}"
        );
        // Means count there; of a model of which nothing is stated nothing does.
        let counted = judged.iter().any(|j| j.counts);
        assert_eq!(counted, track == Track::SharedLaw, "{judged:?}");
    }
    // What a model states of means is judged on both sides of the horizon, what it states of samples before it alone; in the
    // place of what is not stated stands a distance without a statement.
    let first = |scene: &Context, name: &str, quantity: &str| {
        let own = participant(name, Track::OwnContact, courses(1.0));
        let evidence = [unknown("native"), unknown(name)];
        let rules = Rules {
            evidence: &evidence,
            limits: &[],
            ..Rules::default()
        };
        let found = compare_with(scene, &[native(), own], &rules).unwrap();
        let mut entries = found.pairs[0].entries.iter();
        let entry = entries.find(|e| e.quantity == quantity && e.window == WindowKind::Steady);
        let judged = &entry.unwrap().judgements;
        assert_eq!(judged.len(), 1, "{judged:?}");
        (judged[0].metric, !judged[0].reason.is_empty())
    };
    let (bed, torque) = ("mujoco-own-contact", "input_torque_n_m");
    assert_eq!(first(&context(), bed, torque), (Metric::Mean, true));
    assert_eq!(first(&parted, bed, torque), (Metric::Mean, true));
    assert_eq!(first(&context(), bed, FORCE), (Metric::RelativeL2, true));
    assert_eq!(first(&parted, bed, FORCE), (Metric::Mean, false));
    let other = "other";
    assert_eq!(first(&context(), other, FORCE), (Metric::RelativeL2, false));
    assert_eq!(first(&parted, other, FORCE), (Metric::Mean, false));
}

/// What is not a number is no agreement, and the engine that gave it is named.
#[test]
fn hard_what_is_not_finite_is_not_resolved() {
    for (a, b, who) in [(f64::NAN, 1.0, "native"), (1.0, f64::INFINITY, "other")] {
        let evidence = [unknown("native"), unknown("other")].map(|e| e.excused("no ladder"));
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let pair = [
            participant("native", Track::Native, spoiled(a)),
            participant("other", Track::SharedLaw, spoiled(b)),
        ];
        let found = compare_with(&context(), &pair, &rules).unwrap();
        let steady = entry(&found, WindowKind::Steady);
        let told = steady.judgements.iter().filter(|j| j.distance.is_none());
        let told: Vec<_> = told.collect();
        assert!(
            !told.is_empty() && told.iter().all(|j| j.counts),
            "{told:?}"
        );
        let Verdict::NotResolved {
            participant,
            reason,
            ..
        } = &told[0].verdict
        else {
            panic!("{:?}", told[0].verdict);
        };
        assert_eq!(participant, who);
        assert!(reason.contains("not finite"), "{reason}");
        assert!(!matches!(
            steady.verdict,
            Verdict::Agree { .. } | Verdict::Within
        ));
    }
}

/// Of an error A h^2 + B h^3 Richardson's extrapolation leaves 4/3 B, and says 28/3 B: its next term is taken for one of the
/// same order.
#[test]
fn extrapolation_leaves_the_next_term() {
    let (a, b) = (1e-3, 1e-5);
    let at = |h: f64| courses(1.0 + a * h * h + b * h * h * h);
    let rung = |refinement: f64| Rung {
        refinement,
        run: Ok(at(refinement)),
        wall_s: 1.0,
    };
    let ladder = Ladder {
        method: Method::Step {
            order: 2.0,
            limit: None,
        },
        finest: 1e-5,
        coarser: vec![rung(2.0), rung(4.0)],
    };
    let exact = Ladder {
        coarser: [2.0, 4.0]
            .map(|r| Rung {
                run: Ok(courses(1.0)),
                ..rung(r)
            })
            .to_vec(),
        ..ladder.clone()
    };
    let evidence = [
        Evidence::ladder("native", ladder),
        Evidence::ladder("other", exact),
    ];
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    let pair = [
        participant("native", Track::Native, at(1.0)),
        other(Track::SharedLaw, 1.0),
    ];
    let found = compare_with(&context(), &pair, &rules).unwrap();
    let sharp = entry(&found, WindowKind::Steady)
        .extrapolated
        .as_ref()
        .unwrap();
    let near = |value: f64, wanted: f64| (value / wanted - 1.0).abs() < 0.01;
    assert!(near(sharp.distance.unwrap(), 4.0 / 3.0 * b), "{sharp:?}");
    assert!(near(sharp.u_a.unwrap(), 28.0 / 3.0 * b), "{sharp:?}");
}

/// A run with these values as its only course.
fn torque(values: &dyn Fn(usize) -> f64) -> Courses {
    let time = courses(1.0).time_s().to_vec();
    let values = (0..time.len()).map(values).collect();
    let mut found = Courses::new(time).unwrap();
    found.push("input_torque_n_m", values).unwrap();
    found
}

/// The evidence of a method of order 2 without kinks.
fn rungs(name: &str, coarser: [Courses; 2]) -> Evidence {
    let [two, three] = coarser;
    let rung = |refinement: f64, run: Courses| Rung {
        refinement,
        run: Ok(run),
        wall_s: 1.0,
    };
    let ladder = Ladder {
        method: Method::Step {
            order: 2.0,
            limit: None,
        },
        finest: 1e-5,
        coarser: vec![rung(2.0, two), rung(4.0, three)],
    };
    Evidence::ladder(name, ladder)
}

/// Differences of the right size confirm an order only where they point the same way: a cosine of a half and more.
#[test]
fn an_order_is_confirmed_by_differences_that_point_the_same_way() {
    for (cosine, wanted) in [
        (1.0, Basis::Observed),
        (0.55, Basis::Observed),
        (0.45, Basis::Unconfirmed),
        (0.0, Basis::Unconfirmed),
        (-1.0, Basis::Unconfirmed),
    ] {
        let across = f64::sqrt(1.0 - cosine * cosine);
        let turn = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let small = 1e-3;
        let two = move |_: usize| 1.0 + small;
        let three = move |k: usize| two(k) + 4.0 * small * (cosine + across * turn(k));
        let evidence = [rungs("native", [torque(&two), torque(&three)])];
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let one = [participant("native", Track::Native, torque(&|_| 1.0))];
        let found = compare_with(&context(), &one, &rules).unwrap();
        let steady = found.engines[0].uncertainty.iter();
        let mut steady = steady.filter(|u| u.window == WindowKind::Steady);
        let basis = steady.next().unwrap().l2.estimate().unwrap().basis;
        assert_eq!(basis, wanted, "{cosine}");
    }
    // Of one sign throughout, and large at other samples: a cosine of 0.2.
    let large = |even: bool| {
        move |k: usize| {
            if k.is_multiple_of(2) == even {
                1.0
            } else {
                0.1
            }
        }
    };
    let two = move |k: usize| 1.0 + 1e-3 * large(true)(k);
    let three = move |k: usize| two(k) + 4e-3 * large(false)(k);
    let evidence = [rungs("native", [torque(&two), torque(&three)])];
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    let one = [participant("native", Track::Native, torque(&|_| 1.0))];
    let found = compare_with(&context(), &one, &rules).unwrap();
    let mut steady = found.engines[0].uncertainty.iter();
    let steady = steady.find(|u| u.window == WindowKind::Steady).unwrap();
    assert_eq!(
        steady.l2.estimate().unwrap().basis,
        Basis::Unconfirmed,
        "across"
    );
}

/// Beyond the horizon every run is a sample: u of a figure is three times how far the furthest is from the finest.
#[test]
fn beyond_the_horizon_u_is_three_times_the_spread() {
    let parted = Context {
        divergence: Some(Divergence {
            horizon_s: Some(0.1),
            largest_share: 1.0,
            told: String::new(),
        }),
        ..context()
    };
    let evidence = [rungs("native", [torque(&|_| 1.001), torque(&|_| 0.998)])];
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    let one = [participant("native", Track::Native, torque(&|_| 1.0))];
    let found = compare_with(&parted, &one, &rules).unwrap();
    let mut steady = found.engines[0].uncertainty.iter();
    let steady = steady.find(|u| u.window == WindowKind::Steady).unwrap();
    let u = steady.mean.estimate().unwrap();
    assert_eq!(u.basis, Basis::Spread);
    // Of samples nothing is known there.
    assert!(steady.l2.estimate().is_none() && steady.linf.estimate().is_none());
    assert!((u.u - 3.0 * 2e-3).abs() < 1e-12, "{u:?}");
}

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

/// The order of kinks confirms a method that is better than that; with friction nothing but the method's own does.
#[test]
fn kinks_confirm_and_friction_does_not() {
    let at = |observed: f64, limit: f64| {
        let step = |difference: f64| order::Step {
            ratio: 2.0,
            difference,
        };
        let steps = [step(1.0), step(2_f64.powf(observed))];
        let method = Method::Step {
            order: 4.0,
            limit: Some(limit),
        };
        order::estimate(&steps, Some(1.0), method, 0.0)
            .unwrap()
            .basis
    };
    assert_eq!(at(2.5, order::CONTACTS), Basis::Observed);
    assert_eq!(at(1.0, order::FRICTION), Basis::Unconfirmed);
    assert_eq!(at(2.5, order::FRICTION), Basis::Unconfirmed);
    assert_eq!(at(4.0, order::FRICTION), Basis::Observed);
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

/// Differences and ratios that are no such thing are told, not computed with.
#[test]
fn a_ladder_that_makes_no_sense_says_so() {
    let of = |ratio: f64, difference: f64| {
        let fine = order::Step {
            ratio: 2.0,
            difference: 1e-6,
        };
        let steps = [fine, order::Step { ratio, difference }];
        let method = Method::Step {
            order: 2.0,
            limit: None,
        };
        order::estimate(&steps, Some(1.0), method, 0.0)
    };
    assert!(of(2.0, 4e-6).is_ok());
    for difference in [f64::NAN, f64::INFINITY] {
        let reason = of(2.0, difference).unwrap_err().reason;
        assert!(reason.contains("not finite"), "{reason}");
    }
    for ratio in [1.0, 0.5, f64::INFINITY, f64::NAN] {
        let reason = of(ratio, 4e-6).unwrap_err().reason;
        assert!(reason.contains("not ordered"), "{ratio}: {reason}");
    }
}

/// A figure confirms an order by differences of one sign, whatever the samples behind it do.
#[test]
fn a_figure_confirms_by_its_own_sign() {
    let basis_of_the_mean = |first: f64, sign: f64| {
        let turn = |k: usize| if k.is_multiple_of(2) { 3.0 } else { -3.0 };
        let two = move |k: usize| 1.0 + 1e-3 * (first + turn(k));
        let three = move |k: usize| two(k) + 4e-3 * (sign + turn(k));
        let evidence = [rungs("native", [torque(&two), torque(&three)])];
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let one = [participant("native", Track::Native, torque(&|_| 1.0))];
        let found = compare_with(&context(), &one, &rules).unwrap();
        let mut all = found.engines[0].uncertainty.iter();
        let steady = all.find(|u| u.window == WindowKind::Steady).unwrap();
        assert_eq!(steady.l2.estimate().unwrap().basis, Basis::Observed);
        steady.mean.estimate().unwrap().basis
    };
    for first in [1.0, -1.0] {
        assert_eq!(basis_of_the_mean(first, first), Basis::Observed);
        assert_eq!(basis_of_the_mean(first, -first), Basis::Unconfirmed);
    }
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

/// A row that is for other scenes says for which.
#[test]
fn a_row_for_other_scenes_says_so() {
    let at = |friction_coefficient: f64, friction: Friction| {
        let rules = Rules {
            limits: &[Limit {
                friction,
                ..row(WindowKind::Steady, 0.1)
            }],
            ..Rules::default()
        };
        let scene = Context {
            friction_coefficient,
            ..context()
        };
        let pair = [native(), other(Track::SharedLaw, 0.99)];
        let found = compare_with(&scene, &pair, &rules).unwrap();
        format!("{:?}", entry(&found, WindowKind::Steady).verdict)
    };
    let with = at(0.0, Friction::With);
    assert!(with.contains("scenes with friction"), "{with}");
    let without = at(0.1, Friction::Without);
    assert!(without.contains("scenes without friction"), "{without}");
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

/// Richardson's formula needs one leading term, of an order that three runs showed.
#[test]
fn nothing_is_extrapolated_without_one_leading_term() {
    let is_sharp = |shown: f64, limit: Option<f64>| {
        let method = Method::Step { order: 2.0, limit };
        let at = |h: f64| courses(1.0 + 1e-3 * h.powf(shown));
        let ladder = |run: &dyn Fn(f64) -> Courses| Ladder {
            method,
            finest: 1e-5,
            coarser: [2.0, 4.0]
                .map(|refinement| Rung {
                    refinement,
                    run: Ok(run(refinement)),
                    wall_s: 1.0,
                })
                .to_vec(),
        };
        let evidence = [
            Evidence::ladder("native", ladder(&at)),
            Evidence::ladder("other", ladder(&|_| courses(1.0))),
        ];
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let pair = [
            participant("native", Track::Native, at(1.0)),
            other(Track::SharedLaw, 1.0),
        ];
        let found = compare_with(&context(), &pair, &rules).unwrap();
        entry(&found, WindowKind::Steady).extrapolated.is_some()
    };
    assert!(is_sharp(2.0, None));
    assert!(!is_sharp(1.5, Some(1.5)), "a kink's error beside its own");
    assert!(!is_sharp(1.0, None), "not the order of the method");
}

#[test]
fn orders_of_tolerances_and_of_no_differences() {
    let allowed = |smooth| Method::Tolerance { smooth }.allowed_order();
    assert_eq!((allowed(true), allowed(false)), (1.0, 0.5));
    let step = |ratio: f64, difference: f64| order::Step { ratio, difference };
    let good = step(2.0, 1.0);
    let seen = order::observed_order(good, step(2.0, 4.0)).unwrap();
    assert!((seen - 2.0).abs() < 1e-12, "{seen}");
    for bad in [
        step(2.0, 0.0),
        step(1.0, 1.0),
        step(2.0, f64::NAN),
        step(2.0, f64::INFINITY),
    ] {
        assert_eq!(order::observed_order(bad, good), None, "{bad:?}");
        assert_eq!(order::observed_order(good, bad), None, "{bad:?}");
    }
}

/// A rung with one sample more is not on the grid.
#[test]
fn a_rung_with_more_samples_is_refused() {
    let base = courses(1.0);
    let mut times = base.time_s().to_vec();
    times.push(0.601);
    let mut longer = Courses::new(times).unwrap();
    for channel in base.channels() {
        let mut values = channel.values.clone();
        values.push(0.0);
        longer.push(channel.name.clone(), values).unwrap();
    }
    let evidence = [
        rungs("native", [longer.clone(), longer]),
        rungs("other", [courses(1.0), courses(1.0)]),
    ];
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    let pair = [native(), other(Track::SharedLaw, 1.0)];
    let found = compare_with(&context(), &pair, &rules).unwrap();
    let told = format!("{:?}", entry(&found, WindowKind::Steady).verdict);
    assert!(told.contains("other sample times"), "{told}");
}

/// What is relative is so to the quantity's own size; rounding is a share of it.
#[test]
fn relative_sizes_are_of_the_quantity() {
    let with = |floor: f64| {
        let evidence = rungs("native", [torque(&|_| 2.001), torque(&|_| 2.005)]);
        let rules = Rules {
            evidence: &[evidence.with_floor(floor)],
            ..Rules::default()
        };
        let one = [participant("native", Track::Native, torque(&|_| 2.0))];
        let found = compare_with(&context(), &one, &rules).unwrap();
        let mut all = found.engines[0].uncertainty.iter();
        let steady = all.find(|u| u.window == WindowKind::Steady).unwrap();
        steady.clone()
    };
    let steady = with(0.0);
    let l2 = steady.l2.estimate().unwrap();
    assert_eq!(l2.basis, Basis::Observed);
    assert_eq!(steady.relative_l2, Some(l2.u / 2.0));
    let rounding = with(1e-3);
    let linf = rounding.linf.estimate().unwrap();
    assert_eq!((linf.basis, linf.u), (Basis::Rounding, 2e-3));
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
