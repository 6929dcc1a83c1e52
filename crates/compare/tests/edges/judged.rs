//! Whose excuse, row, window and value it is that judges.

use crate::common::{context, courses, participant};
use crate::ladders::rungs;
use crate::{FORCE, entry, native, other};
use pinwheel_compare::limits::{Friction, Limit};
use pinwheel_compare::{
    Context, Divergence, Evidence, Metric, Rules, Scales, StatedLimit, Track, Verdict, WindowKind,
    compare_with,
};
use pinwheel_courses::Courses;

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

/// Two engines that show nothing but zeros, and so do their coarser runs, agree: there is nothing to be uncertain of.
#[test]
fn zeros_agree() {
    let evidence = ["native", "other"].map(|name| rungs(name, [courses(0.0), courses(0.0)]));
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    let free = Context {
        guarded: None,
        scales: Scales::default(),
        ..context()
    };
    let pair = [
        participant("native", Track::Native, courses(0.0)),
        other(Track::SharedLaw, 0.0),
    ];
    let found = compare_with(&free, &pair, &rules).unwrap();
    let verdict = &entry(&found, WindowKind::Steady).verdict;
    assert!(matches!(verdict, Verdict::Agree { .. }), "{verdict:?}");
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
