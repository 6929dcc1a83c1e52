//! Reasons, windows and values that decide a verdict.

use super::common::{context, participant, time_series};
use super::refinement::levels;
use super::{FORCE, entry, native, other};
use pinwheel_compare::{
    Context, Divergence, Evidence, Metric, Rules, Scales, SharedModel, StatedLimit, Verdict,
    WindowKind, compare,
};
use pinwheel_timeseries::TimeSeries;

fn unknown(name: &str) -> Evidence {
    Evidence::unknown(name, "nobody knows", "ask")
}

/// Returns the time series with one force sample replaced.
fn spoiled(value: f64) -> TimeSeries {
    let base = time_series(1.0);
    let mut altered = TimeSeries::new(base.time_s().to_vec()).unwrap();
    for channel in base.channels() {
        let mut values = channel.values.clone();
        if channel.name.starts_with(FORCE) {
            values[500] = value;
        }
        altered.push(channel.name.clone(), values).unwrap();
    }
    altered
}

/// A final reason of one engine leaves the verdict on another engine unchanged.
#[test]
fn regress_a_reason_is_its_engines_own() {
    let at = |evidence: [Evidence; 2]| {
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let pair = [native(), other(SharedModel::SharedLaw, 1.0)];
        let report = compare(&context(), &pair, &rules).unwrap();
        let result = entry(&report, WindowKind::Steady).result.clone();
        assert_eq!(result.verdict, Verdict::Inconclusive);
        let name = result.participant.unwrap();
        (name, result.actionable, report.counts.exit_status())
    };
    let expected = |name: &str, actionable, status| (name.to_owned(), actionable, status);
    let actual = at([
        unknown("native"),
        unknown("other").finally("old", "it is old"),
    ]);
    assert_eq!(actual, expected("native", true, 4));
    let actual = at([
        unknown("native").finally("new", "it is new"),
        unknown("other"),
    ]);
    assert_eq!(actual, expected("native", false, 0));
}

/// A limit stated for one window of measured data applies in that window alone, up to its exact value.
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
        let pair = [native(), other(SharedModel::Measured, 0.99)];
        compare(&context(), &pair, &rules).unwrap()
    };
    let report = at(0.1);
    let result = &entry(&report, WindowKind::Steady).result;
    assert_eq!(result.verdict, Verdict::Agree);
    let transient = &entry(&report, WindowKind::Transient).result;
    assert_eq!(transient.verdict, Verdict::NotCompared, "{transient:?}");
    let value = result.difference.unwrap();
    assert_eq!(result.share(), value / 0.1);
    assert_eq!(
        entry(&at(value), WindowKind::Steady).result.verdict,
        Verdict::Agree
    );
    let below = at(value.next_down());
    let below = &entry(&below, WindowKind::Steady).result;
    assert_eq!(below.verdict, Verdict::Differ);
}

/// A mean in balance with the load agrees whatever its uncertainty; one out of balance is inconclusive if its uncertainty is
/// unknown.
#[test]
fn regress_an_unknown_mean_is_not_held_against_the_load() {
    let at = |scale: f64| {
        let base = time_series(1.0);
        let mut turned = TimeSeries::new(base.time_s().to_vec()).unwrap();
        for channel in base.channels() {
            let output = channel.name == "output_torque_n_m";
            let factor = if output { scale } else { 1.0 };
            let values = channel.values.iter().map(|v| factor * v).collect();
            turned.push(channel.name.clone(), values).unwrap();
        }
        let evidence = [unknown("native")];
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let one = [participant("native", SharedModel::Native, turned)];
        let report = compare(&context(), &one, &rules).unwrap();
        report.engines[0].judged[0].result.verdict
    };
    assert_eq!(at(1.0), Verdict::Agree);
    assert_eq!(at(1.01), Verdict::Inconclusive);
}

/// Beyond the divergence horizon means and RMS are judged, and no pointwise metric.
#[test]
fn regress_beyond_the_horizon_figures_are_judged() {
    let parted = Context {
        divergence: Some(Divergence {
            horizon_s: Some(0.1),
            largest_share: 1.0,
            told: String::new(),
        }),
        ..context()
    };
    for track in [SharedModel::SharedLaw, SharedModel::OwnContact] {
        let evidence = [unknown("native"), unknown("other")];
        let rules = Rules {
            evidence: &evidence,
            tolerances: &crate::common::TOLERANCES,
            ..Rules::default()
        };
        let pair = [native(), other(track, 1.0)];
        let report = compare(&parted, &pair, &rules).unwrap();
        let judged = &entry(&report, WindowKind::Steady).assessments;
        assert!(!judged.is_empty(), "{track:?}");
        assert!(
            judged.iter().all(|j| !j.metric.unwrap().is_pointwise()),
            "{judged:?}"
        );
        // Means are compared with uncertainties there; a model without a stated tolerance is not compared.
        let compared = judged.iter().any(|j| j.verdict != Verdict::NotCompared);
        assert_eq!(compared, track == SharedModel::SharedLaw, "{judged:?}");
    }
    // A model's tolerance on means applies on both sides of the horizon, its tolerance on samples before it only; otherwise the
    // assessment has a distance without a tolerance.
    let first = |scene: &Context, name: &str, quantity: &str| {
        let own = participant(name, SharedModel::OwnContact, time_series(1.0));
        let evidence = [unknown("native"), unknown(name)];
        let rules = Rules {
            evidence: &evidence,
            tolerances: &crate::common::TOLERANCES,
            ..Rules::default()
        };
        let report = compare(scene, &[native(), own], &rules).unwrap();
        let mut entries = report.pairs[0].entries.iter();
        let entry = entries.find(|e| e.quantity == quantity && e.window == WindowKind::Steady);
        let judged = &entry.unwrap().assessments;
        assert_eq!(judged.len(), 1, "{judged:?}");
        (
            judged[0].metric.unwrap(),
            !judged[0].reason.contains("state no tolerance"),
        )
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

/// A difference that is not finite is no agreement, and the verdict names the engine with that value.
#[test]
fn hard_what_is_not_finite_is_inconclusive() {
    for (a, b, who) in [(f64::NAN, 1.0, "native"), (1.0, f64::INFINITY, "other")] {
        let evidence =
            [unknown("native"), unknown("other")].map(|e| e.finally("peers", "no study"));
        let rules = Rules {
            evidence: &evidence,
            ..Rules::default()
        };
        let pair = [
            participant("native", SharedModel::Native, spoiled(a)),
            participant("other", SharedModel::SharedLaw, spoiled(b)),
        ];
        let report = compare(&context(), &pair, &rules).unwrap();
        let steady = entry(&report, WindowKind::Steady);
        let nan = steady.assessments.iter().filter(|j| j.difference.is_none());
        let nan: Vec<_> = nan.collect();
        assert!(!nan.is_empty() && nan.iter().all(|j| j.decides), "{nan:?}");
        assert_eq!(nan[0].verdict, Verdict::Inconclusive);
        assert_eq!(nan[0].participant.as_deref(), Some(who));
        assert!(nan[0].reason.contains("not finite"), "{:?}", nan[0]);
        assert_ne!(steady.result.verdict, Verdict::Agree);
    }
}

/// Two engines with all-zero results, in their coarser runs too, agree.
#[test]
fn zeros_agree() {
    let evidence =
        ["native", "other"].map(|name| levels(name, [time_series(0.0), time_series(0.0)]));
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    let free = Context {
        scales: Scales::default(),
        ..context()
    };
    let pair = [
        participant("native", SharedModel::Native, time_series(0.0)),
        other(SharedModel::SharedLaw, 0.0),
    ];
    let report = compare(&free, &pair, &rules).unwrap();
    let result = &entry(&report, WindowKind::Steady).result;
    assert_eq!(result.verdict, Verdict::Agree, "{result:?}");
}
