//! Status 0 needs evidence for each item that the user brought.

use super::common::{context, participant, time_series};
use pinwheel_compare::shown::{Kind, Shown};
use pinwheel_compare::{
    Comparison, Evidence, Metric, Participant, Rules, SharedModel, StatedLimit, Status, WindowKind,
    compare,
};
use pinwheel_timeseries::TimeSeries;

/// Returns evidence of engines whose coarser runs differ by this share.
fn known(names: &[&str], share: f64) -> Vec<Evidence> {
    let evidence = names.iter().map(|name| Evidence {
        source: pinwheel_compare::uncertainty::Source::Exact(share),
        ..Evidence::unknown(*name, "", "")
    });
    evidence.collect()
}

fn judged(participants: &[Participant], evidence: &[Evidence], brought: &[&str]) -> Comparison {
    let rules = Rules {
        evidence,
        brought,
        ..Rules::default()
    };
    compare(&context(), participants, &rules).unwrap()
}

fn native(name: &str) -> Participant {
    participant(name, SharedModel::Native, time_series(1.0))
}

fn mine(scale: f64) -> Participant {
    participant("mine", SharedModel::SharedLaw, time_series(scale))
}

/// Two native runs agree in every quantity, so the solver's evidence alone decides.
#[test]
fn a_solver_needs_a_quantity_of_its_own() {
    let natives = ["a", "b"];
    let blunt = Evidence::unknown("mine", "nobody knows", "ask").finally("slow", "it is slow");
    let own = known(&natives, 1e-6);
    let sharp = known(&["a", "b", "mine"], 1e-6);
    let failed = Participant {
        status: Status::failed("broke"),
        time_series: TimeSeries::default(),
        ..mine(1.0)
    };
    let late = Participant {
        time_series: TimeSeries::default(),
        status: Status::TimedOut {
            time_s: 0.1,
            reason: "slow".to_owned(),
        },
        ..mine(1.0)
    };
    for (mine, evidence, status, shown, words) in [
        (
            mine(1.0),
            sharp.clone(),
            0,
            Shown::Agrees,
            "mine: agrees to 2.0e-6 (driver torque",
        ),
        (mine(1.03), sharp, 1, Shown::Differs, "mine: differs ("),
        (
            mine(1.0),
            [own.clone(), vec![blunt]].concat(),
            4,
            Shown::Nothing,
            "nobody knows; it is slow",
        ),
        (
            failed,
            own.clone(),
            4,
            Shown::Nothing,
            "mine: nothing shown: its run failed: broke",
        ),
        (late, own, 4, Shown::Nothing, "mine: nothing shown: its run"),
    ] {
        let report = judged(&[native("a"), native("b"), mine], &evidence, &["mine"]);
        let finding = &report.findings[0];
        assert_eq!(
            (finding.kind, finding.shown),
            (Kind::Solver, shown),
            "{finding:?}"
        );
        assert!(finding.line.contains(words), "{}", finding.line);
        assert_eq!(report.exit_status(), status, "{}", finding.line);
        assert_eq!(report.passed, status == 0);
    }
}

/// Without an item brought, a pair of engines must agree in every headline quantity.
#[test]
fn engines_alone_need_a_pair_that_agrees() {
    let pair = [native("a"), native("b")];
    let report = judged(&pair, &known(&["a", "b"], 1e-6), &[]);
    assert_eq!(report.exit_status(), 0, "{:?}", report.findings);
    assert!(
        report.findings[0]
            .line
            .starts_with("engines: agrees to 2.0e-6 (a and b)")
    );
    let own = [
        native("a"),
        participant("own", SharedModel::OwnContact, time_series(1.0)),
    ];
    for (participants, evidence) in [
        (&pair[..1], known(&["a"], 1e-6)),
        (&own, known(&["a", "own"], 1e-6)),
        (&pair, known(&["a", "b"], 0.1)),
    ] {
        let report = judged(participants, &evidence, &[]);
        assert_eq!(
            (report.exit_status(), report.passed),
            (4, false),
            "{:?}",
            report.findings
        );
        assert!(
            report.findings[0]
                .line
                .contains("nothing shown: no pair of engines agrees in each of driver torque")
        );
    }
}

/// A record of few samples is not judged, so its limit has no evidence; a judged limit counts.
#[test]
fn a_limit_has_to_be_judged() {
    let limit = StatedLimit {
        engine: "rig".to_owned(),
        window: WindowKind::Steady,
        quantity: "input_torque_n_m".to_owned(),
        metric: Metric::RelativeL2,
        limit: 0.05,
        reason: String::new(),
    };
    // Values of the last `samples` samples alone, 32 % off.
    let rig = |samples: usize, scale: f64| {
        let full = time_series(scale);
        let mut part = TimeSeries::new(full.time_s().to_vec()).unwrap();
        for channel in full.channels() {
            let mut values = channel.values.clone();
            let missing = values.len() - samples;
            values[..missing].fill(f64::NAN);
            part.push(channel.name.clone(), values).unwrap();
        }
        participant("rig", SharedModel::Measured, part)
    };
    for (samples, scale, limits, status, words) in [
        (
            1,
            1.32,
            1,
            4,
            "nothing shown: both have 1 samples in this window, fewer than 10",
        ),
        (
            9,
            1.32,
            1,
            4,
            "nothing shown: both have 9 samples in this window, fewer than 10",
        ),
        (10, 1.32, 1, 1, "rig: differs"),
        (200, 1.01, 1, 0, "rig: agrees to 5.0e-2 (driver torque)"),
        (
            200,
            1.01,
            0,
            4,
            "its map states neither `[[limits]]` nor `uncertainty`",
        ),
    ] {
        let stated = vec![limit.clone(); limits];
        let rules = Rules {
            stated: &stated,
            brought: &["rig"],
            ..Rules::default()
        };
        let report = compare(&context(), &[native("a"), rig(samples, scale)], &rules).unwrap();
        let lines: Vec<&str> = report.findings.iter().map(|f| f.line.as_str()).collect();
        assert_eq!(report.exit_status(), status, "{samples}: {lines:?}");
        assert!(
            lines.iter().any(|line| line.contains(words)),
            "{samples}: {lines:?}"
        );
    }
}
