//! Other contact models and measurements: intervals against a prediction, budgets, stated limits.

use super::common::{context, participant, time_series};
use super::{FORCE, TORQUE, anywhere, compared, engine, entry, native};
use pinwheel_compare::comparison::Comparison;
use pinwheel_compare::{
    Context, DataUncertainty, Energy, Metric, Rules, SharedModel, StatedLimit, Verdict, WindowKind,
    compare,
};
use pinwheel_timeseries::TimeSeries;

fn account(remainder_share: f64) -> Energy {
    Energy {
        from_s: 0.3,
        to_s: 0.6,
        driver_j: 20.0,
        load_j: -20.19,
        remainder_j: 20.0 * remainder_share,
        remainder_share: Some(remainder_share),
        ..Energy::default()
    }
}

#[test]
fn own_contact_is_an_interval_against_a_prediction() {
    let run = |torque: f64, energy: Option<f64>, error: f64| {
        let mut own = engine(
            "mujoco-own-contact",
            SharedModel::OwnContact,
            &time_series(torque),
            error,
            2.0,
            &[2.0, 4.0],
        );
        own.0.cost.notes.clear();
        let (mut native, evidence) = native(1e-5);
        native.cost.energy = energy.map(account).into_iter().collect();
        compared(&anywhere(), vec![(native, evidence), own])
    };
    // The law creates 0.95 % of the power: the conservative bed needs more torque by as much.
    let comparison = run(1.0095, Some(0.0095), 1e-5);
    let of_torque = |comparison: &Comparison| entry(comparison, TORQUE).assessments[0].clone();
    let torque = of_torque(&comparison);
    assert_eq!(
        (torque.verdict, torque.predicted, torque.tolerance),
        (Verdict::Agree, -0.0095, Some(5e-3))
    );
    let [low, high] = torque.interval().unwrap();
    // With a stated tolerance no other metric is judged.
    let judged = &entry(&comparison, TORQUE).assessments;
    assert!(judged.iter().all(|j| j.tolerance.is_some()), "{judged:?}");
    let difference = -0.0095 / 1.0095;
    assert!(
        low < difference && difference < high && high - low < 1e-4,
        "{low} {high}"
    );
    // An equal difference without a prediction exceeds the tolerance of a bed.
    let conservative = run(1.0095, Some(0.0), 1e-5);
    assert_eq!(of_torque(&conservative).verdict, Verdict::Differ);
    assert_eq!(conservative.counts.exit_status(), 1);
    // A difference of the opposite sign exceeds it, too.
    let wrong = of_torque(&run(0.9905, Some(0.0095), 1e-5)).verdict;
    assert_eq!(wrong, Verdict::Differ);
    // Without an account there is no prediction: the interval is the result.
    let unknown = of_torque(&run(1.0095, None, 1e-5));
    assert_eq!(unknown.verdict, Verdict::NotCompared);
    assert!(unknown.interval().is_some());
    // A blunt study does not pass by being blunt.
    let blunt = of_torque(&run(1.0095, Some(0.0095), 3e-2)).verdict;
    assert_eq!(blunt, Verdict::Inconclusive);
}

#[test]
fn the_matrix_shows_the_figure_that_was_judged() {
    // Waveforms 41 % apart, for which colliders state no tolerance; their means are judged and agree.
    let base = time_series(1.0);
    let mut waves = TimeSeries::new(base.time_s().to_vec()).unwrap();
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
        SharedModel::OwnContact,
        &waves,
        1e-5,
        2.0,
        &[2.0, 4.0],
    );
    let (mut native, evidence) = native(1e-5);
    native.cost.energy = vec![account(0.0)];
    let comparison = compared(&anywhere(), vec![(native, evidence), own]);
    let metrics = entry(&comparison, FORCE).metrics.as_ref().unwrap();
    assert!(metrics.relative_l2.unwrap() > 0.4);
    let cell = comparison.matrices[0].cell(0, 1).unwrap();
    assert_eq!(cell.result.verdict, Verdict::Agree);
    assert_eq!(cell.result.metric, Some(Metric::Mean));
    assert!(cell.result.difference.unwrap() < 0.05 && cell.force.unwrap() > 0.4);
    // Pairs that differ name the differing quantity.
    let far = engine(
        "rapier-own-contact-colliders",
        SharedModel::OwnContact,
        &time_series(1.3),
        1e-5,
        2.0,
        &[2.0, 4.0],
    );
    let (mut native, evidence) = super::native(1e-5);
    native.cost.energy = vec![account(0.0)];
    let comparison = compared(&anywhere(), vec![(native, evidence), far]);
    let cell = comparison.matrices[0].cell(0, 1).unwrap();
    assert_eq!(cell.result.verdict, Verdict::Differ);
    assert!((cell.result.difference.unwrap().abs() - 0.3 / 1.3).abs() < 1e-4);
}

#[test]
fn measured_data_get_a_budget() {
    let run = |scale: f64, data: &[DataUncertainty]| {
        let (native, evidence) = native(1e-4);
        let rig = participant("rig", SharedModel::Measured, time_series(scale));
        let rules = Rules {
            evidence: &[evidence],
            data,
            ..Rules::default()
        };
        compare(&anywhere(), &[native, rig], &rules).unwrap()
    };
    let stated = DataUncertainty {
        engine: "rig".to_owned(),
        quantity: "*_force_n".to_owned(),
        data: 0.004,
        input: 0.003,
    };
    let comparison = run(1.009, std::slice::from_ref(&stated));
    let judgement = &entry(&comparison, FORCE).assessments[0];
    let budget = judgement.budget.unwrap();
    assert!((budget.validation() - 0.005).abs() < 1e-5, "{budget:?}");
    // Each side's own uncertainty: the simulation's numerics, the rig's statement.
    assert_eq!(judgement.u_b, Some(0.004));
    assert!(
        judgement.u_a.is_some_and(|u| u > 1e-4 && u < 2e-4),
        "{judgement:?}"
    );
    let result = &entry(&comparison, FORCE).result;
    assert_eq!(result.verdict, Verdict::Agree);
    assert!((result.bound.unwrap() - 0.01).abs() < 1e-5);
    let nothing = entry(&comparison, TORQUE).result.verdict;
    assert_eq!(nothing, Verdict::NotCompared, "nothing stated of it");
    let comparison = run(1.02, std::slice::from_ref(&stated));
    assert_eq!(entry(&comparison, FORCE).result.verdict, Verdict::Differ);
    let [low, high] = entry(&comparison, FORCE).result.interval().unwrap();
    assert!((high - low - 0.02).abs() < 1e-4 && low > 0.009);
    // The simulation's mean is the smaller one: E = S - D < 0, in either order.
    let mean = entry(&comparison, FORCE)
        .assessments
        .iter()
        .find(|j| j.metric == Some(Metric::Mean))
        .unwrap();
    assert!(
        (mean.difference.unwrap() + 0.02 / 1.02).abs() < 1e-3,
        "{mean:?}"
    );
    assert_eq!(
        (comparison.counts.differ, comparison.counts.exit_status()),
        (2, 0),
        "steady and transient; a model error is a result, not a failure"
    );
    let (simulation, evidence) = native(1e-4);
    let rig = participant("rig", SharedModel::Measured, time_series(1.02));
    let rules = Rules {
        evidence: &[evidence],
        data: &[stated],
        ..Rules::default()
    };
    let comparison = compare(&anywhere(), &[rig, simulation], &rules).unwrap();
    let mut judged = entry(&comparison, FORCE).assessments.iter();
    let mean = judged.find(|j| j.metric == Some(Metric::Mean)).unwrap();
    assert!(
        (mean.difference.unwrap() + 0.02 / 1.02).abs() < 1e-3,
        "{mean:?}"
    );
    assert_eq!(mean.u_a, Some(0.004));
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
            participant("rig", SharedModel::Measured, time_series(1.0)),
        ];
        let rules = Rules {
            stated: &stated,
            ..Rules::default()
        };
        compare(&anywhere(), &pair, &rules)
    };
    assert_eq!(
        run("*_force_n", WindowKind::Steady).unwrap().counts.agree,
        3
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
        let comparison = compare(context, &[native(0.0).0], &Rules::default()).unwrap();
        let figures = comparison.engines[0].figures[0].clone();
        (
            figures.efficiency,
            figures.efficiency_reason.unwrap_or_default(),
        )
    };
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
    assert_eq!(of(&still), (None, "the driver does not turn".to_owned()));
    let back = Context {
        input_speed_rad_s: Some(-52.34),
        ..context()
    };
    assert_eq!(of(&back), (None, "no power goes in".to_owned()));
    // A load of rounding size is none; output power far above the input comes from stored energy.
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
    // With a law that creates energy there is no efficiency; with a nearly conservative one it is the contacts' loss.
    let rubs = Context {
        friction_coefficient: 0.1,
        ..context()
    };
    let with = |created: f64| {
        let mut run = native(0.0).0;
        run.cost.energy = vec![account(created)];
        let comparison = compare(&rubs, &[run], &Rules::default()).unwrap();
        comparison.engines[0].figures[0].clone()
    };
    let creates = with(0.0095);
    let why = creates.efficiency_reason.unwrap();
    assert!(
        creates.efficiency.is_none() && why.contains("creates 0.95 %"),
        "{why}"
    );
    assert_eq!(with(5e-4).efficiency, Some(1.0), "never above");
    let (none, why) = of(&context());
    assert!(none.is_none() && why.contains("no friction"), "{why}");
}
